#include "photon/flight/found.h"

/* Returns the image node in which a photon starts; for a sun it is the sun's own node. */
static int16_t image_of(const struct orl_world *world, const struct orl_flight *flight)
{
    const struct orl_images *images = &world->images;
    if (flight->lamp || flight->image >= 0)
        return flight->lamp ? -1 : flight->image;
    for (size_t i = 0; i < images->n_nodes; i++)
        if (images->nodes[i].is_sun && images->nodes[i].sun == flight->sun)
            return (int16_t)i;
    return -1;
}

struct orl_found orl_found_at_first(const struct orl_world *world, const struct orl_flight *flight,
                                    bool paths)
{
    const struct orl_deflection way = flight->way;
    struct orl_found found = {.by = ORL_FOUND_BY_SHADOW_RAYS,
                              .image = image_of(world, flight),
                              .paths = paths,
                              .lamp = flight->lamp ? flight->lamp_facet : ORL_FOUND_NO_LAMP};
    const bool by_sensor =
        !paths && !flight->lamp; /* sensors sample only suns by one pane's lobes */
    if ((way.mirror && way.lobe) || (way.lobe && !by_sensor))
        found.by = paths ? ORL_FOUND_BY_LOBES : ORL_FOUND_BY_NOBODY;
    else if (way.mirror || way.lobe)
        found.by = way.mirror ? ORL_FOUND_BY_IMAGES : ORL_FOUND_BY_LOBES;
    return found;
}

static bool is_shown(const struct orl_found *found, const struct orl_world *world)
{
    return found->lamp_shown || (found->image >= 0 && world->images.nodes[found->image].shown);
}

bool orl_found_by_nobody(const struct orl_found *found, const struct orl_world *world)
{
    return found->by == ORL_FOUND_BY_NOBODY ||
           (found->by == ORL_FOUND_BY_IMAGES && !is_shown(found, world));
}

/* Handles a reflection by a mirror: updates the image. A lamp has images in its first mirror
 * only. */
static enum orl_found_by found_after_mirror(struct orl_found *found, const struct orl_world *world,
                                            uint32_t facet)
{
    const struct orl_images *images = &world->images;
    const int16_t class = orl_images_class(images, facet);
    if (found->lamp != ORL_FOUND_NO_LAMP) {
        found->lamp_shown = found->by == ORL_FOUND_BY_SHADOW_RAYS &&
                            orl_lamp_images_cover(&world->lamp_images, found->lamp, facet);
        return found->lamp_shown ? ORL_FOUND_BY_IMAGES : ORL_FOUND_BY_NOBODY;
    }
    found->image = class < 0 || found->image < 0
                       ? -1
                       : images->next[(size_t)found->image * images->n_mirrors + (size_t) class];
    return found->image < 0 ? ORL_FOUND_BY_NOBODY : ORL_FOUND_BY_IMAGES;
}

/* The first lobes on the light's path decide: backward paths that reach them sample lights from
 * there. */
static enum orl_found_by found_by_paths(struct orl_found *found, const struct orl_world *world,
                                        const struct orl_hit *hit, enum orl_event event)
{
    if (found->by == ORL_FOUND_BY_LOBES || found->by == ORL_FOUND_BY_NOBODY)
        return found->by;
    if (event == ORL_EVENT_MIRROR)
        return found_after_mirror(found, world, hit->facet);
    return event == ORL_EVENT_GLOSSY && !orl_found_by_nobody(found, world) ? ORL_FOUND_BY_LOBES
                                                                           : ORL_FOUND_BY_NOBODY;
}

static enum orl_found_by found_by_sensor(struct orl_found *found, const struct orl_world *world,
                                         const struct orl_hit *hit, enum orl_event event)
{
    const bool straight = found->by == ORL_FOUND_BY_SHADOW_RAYS && found->image >= 0;
    const bool lamp = found->lamp != ORL_FOUND_NO_LAMP;
    if (event == ORL_EVENT_MIRROR && (straight || lamp || found->by == ORL_FOUND_BY_IMAGES))
        return found_after_mirror(found, world, hit->facet);
    if (event == ORL_EVENT_GLOSSY && straight &&
        orl_material_transmits_lobes(orl_world_material(world, hit)))
        return ORL_FOUND_BY_LOBES;
    return ORL_FOUND_BY_NOBODY;
}

void orl_found_next(struct orl_found *found, const struct orl_world *world,
                    const struct orl_hit *hit, enum orl_event event)
{
    found->by = found->paths ? found_by_paths(found, world, hit, event)
                             : found_by_sensor(found, world, hit, event);
}
