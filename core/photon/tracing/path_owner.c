#include "photon/tracing/path_owner.h"

/* Returns the image node in which a photon starts; for a sun it is the sun's own node. */
static int16_t image_of(const struct orl_lit_scene *lit_scene,
                        const struct orl_photon_ray *photon_ray)
{
    const struct orl_virtual_suns *images = &lit_scene->images;
    if (photon_ray->lamp || photon_ray->image >= 0)
        return photon_ray->lamp ? -1 : photon_ray->image;
    for (size_t i = 0; i < images->n_nodes; i++)
        if (images->nodes[i].is_sun && images->nodes[i].sun == photon_ray->sun)
            return (int16_t)i;
    return -1;
}

struct orl_path_owner orl_path_owner_init(const struct orl_lit_scene *lit_scene,
                                          const struct orl_photon_ray *photon_ray,
                                          bool for_backward_paths)
{
    const struct orl_deflection deflection = photon_ray->deflection;
    struct orl_path_owner path_owner = {.estimator = ORL_ESTIMATOR_SHADOW_RAYS,
                                        .image = image_of(lit_scene, photon_ray),
                                        .for_backward_paths = for_backward_paths,
                                        .lamp = photon_ray->lamp ? photon_ray->lamp_facet
                                                                 : ORL_OWNER_NO_LAMP};
    const bool by_sensor =
        !for_backward_paths && !photon_ray->lamp; /* sensors sample only suns by one pane's lobes */
    if ((deflection.mirror && deflection.lobe) || (deflection.lobe && !by_sensor))
        path_owner.estimator = for_backward_paths ? ORL_ESTIMATOR_LOBES : ORL_ESTIMATOR_NONE;
    else if (deflection.mirror || deflection.lobe)
        path_owner.estimator =
            deflection.mirror ? ORL_ESTIMATOR_VIRTUAL_LIGHTS : ORL_ESTIMATOR_LOBES;
    return path_owner;
}

static bool has_image(const struct orl_path_owner *path_owner,
                      const struct orl_lit_scene *lit_scene)
{
    return path_owner->lamp_has_image ||
           (path_owner->image >= 0 && lit_scene->images.nodes[path_owner->image].shown);
}

bool orl_path_owner_is_none(const struct orl_path_owner *path_owner,
                            const struct orl_lit_scene *lit_scene)
{
    return path_owner->estimator == ORL_ESTIMATOR_NONE ||
           (path_owner->estimator == ORL_ESTIMATOR_VIRTUAL_LIGHTS &&
            !has_image(path_owner, lit_scene));
}

/* Handles a reflection by a mirror: updates the image. A lamp has images in its first mirror
 * only. */
static enum orl_path_estimator estimator_after_mirror(struct orl_path_owner *path_owner,
                                                      const struct orl_lit_scene *lit_scene,
                                                      uint32_t facet)
{
    const struct orl_virtual_suns *images = &lit_scene->images;
    const int16_t class = orl_virtual_suns_class(images, facet);
    if (path_owner->lamp != ORL_OWNER_NO_LAMP) {
        path_owner->lamp_has_image =
            path_owner->estimator == ORL_ESTIMATOR_SHADOW_RAYS &&
            orl_virtual_lamps_contain(&lit_scene->virtual_lamps, path_owner->lamp, facet);
        return path_owner->lamp_has_image ? ORL_ESTIMATOR_VIRTUAL_LIGHTS : ORL_ESTIMATOR_NONE;
    }
    path_owner->image =
        class < 0 || path_owner->image < 0
            ? -1
            : images->next[(size_t)path_owner->image * images->n_mirrors + (size_t) class];
    return path_owner->image < 0 ? ORL_ESTIMATOR_NONE : ORL_ESTIMATOR_VIRTUAL_LIGHTS;
}

/* The first lobes on the light's path decide: backward paths that reach them sample lights from
 * there. */
static enum orl_path_estimator estimator_for_paths(struct orl_path_owner *path_owner,
                                                   const struct orl_lit_scene *lit_scene,
                                                   const struct orl_hit *hit,
                                                   enum orl_scatter_event event)
{
    if (path_owner->estimator == ORL_ESTIMATOR_LOBES || path_owner->estimator == ORL_ESTIMATOR_NONE)
        return path_owner->estimator;
    if (event == ORL_EVENT_MIRROR)
        return estimator_after_mirror(path_owner, lit_scene, hit->facet);
    return event == ORL_EVENT_GLOSSY && !orl_path_owner_is_none(path_owner, lit_scene)
               ? ORL_ESTIMATOR_LOBES
               : ORL_ESTIMATOR_NONE;
}

static enum orl_path_estimator estimator_for_sensor(struct orl_path_owner *path_owner,
                                                    const struct orl_lit_scene *lit_scene,
                                                    const struct orl_hit *hit,
                                                    enum orl_scatter_event event)
{
    const bool straight =
        path_owner->estimator == ORL_ESTIMATOR_SHADOW_RAYS && path_owner->image >= 0;
    const bool lamp = path_owner->lamp != ORL_OWNER_NO_LAMP;
    if (event == ORL_EVENT_MIRROR &&
        (straight || lamp || path_owner->estimator == ORL_ESTIMATOR_VIRTUAL_LIGHTS))
        return estimator_after_mirror(path_owner, lit_scene, hit->facet);
    if (event == ORL_EVENT_GLOSSY && straight &&
        orl_material_transmits_lobes(orl_lit_scene_material(lit_scene, hit)))
        return ORL_ESTIMATOR_LOBES;
    return ORL_ESTIMATOR_NONE;
}

void orl_path_owner_update(struct orl_path_owner *path_owner, const struct orl_lit_scene *lit_scene,
                           const struct orl_hit *hit, enum orl_scatter_event event)
{
    path_owner->estimator = path_owner->for_backward_paths
                                ? estimator_for_paths(path_owner, lit_scene, hit, event)
                                : estimator_for_sensor(path_owner, lit_scene, hit, event);
}
