#include "scene/material/scatter.h"

#include "scene/material/kinds.h"

static const struct orl_vec3 up = {0, 0, 1};

static struct orl_vec3 direction_at(bool front, double cosine)
{
    return orl_v3(0, sqrt(1 - cosine * cosine), front ? cosine : -cosine);
}

/* Returns a copy of the material with the maximum of its pattern. */
static struct orl_material at_most(const struct orl_material *material)
{
    struct orl_material maximum = *material;
    if (maximum.pattern)
        maximum.color = orl_patterned(maximum.color, maximum.pattern->maximum);
    maximum.pattern = NULL;
    return maximum;
}

/* For a mixture, the larger bound of the two materials, for any share; for a sum, their sum. */
static double both_most(const struct orl_material *mixture, double first, double second)
{
    return orl_mixture_of(mixture)->share ? fmax(first, second) : fmin(first + second, 1);
}

double orl_material_max_diffuse(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE && orl_mixture_is_directed(material))
        return 0;
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return both_most(material, orl_material_max_diffuse(&orl_mixture_of(material)->mixed[0]),
                         orl_material_max_diffuse(&orl_mixture_of(material)->mixed[1]));
    const bool only_back = orl_material_is_reflector(material) &&
                           orl_reflector_of(material)->diffuse_side == ORL_DIFFUSE_SIDE_BACK;
    const struct orl_hit hit = orl_hit_surface_mean(up, !only_back);
    const struct orl_material maximum = at_most(material);
    return orl_rgb_max(orl_material_diffuse(&maximum, &hit));
}

double orl_material_max_albedo(const struct orl_material *material, bool front, double cosine,
                               enum orl_lobes lobes)
{
    if (material->kind == ORL_MATERIAL_MIXTURE) {
        const enum orl_lobes within = orl_mixture_lobes_within(material, lobes);
        return both_most(
            material,
            orl_material_max_albedo(&orl_mixture_of(material)->mixed[0], front, cosine, within),
            orl_material_max_albedo(&orl_mixture_of(material)->mixed[1], front, cosine, within));
    }
    const struct orl_hit hit = orl_hit_surface_mean(up, front);
    const struct orl_material maximum = at_most(material);
    return orl_rgb_max(orl_material_albedo(&maximum, &hit, direction_at(front, cosine), lobes));
}

double orl_material_max_mirrored(const struct orl_material *material, bool front, double cosine)
{
    if (material->kind == ORL_MATERIAL_MIXTURE)
        return both_most(
            material, orl_material_max_mirrored(&orl_mixture_of(material)->mixed[0], front, cosine),
            orl_material_max_mirrored(&orl_mixture_of(material)->mixed[1], front, cosine));
    const struct orl_hit hit = orl_hit_surface_mean(up, front);
    const struct orl_material maximum = at_most(material);
    return orl_rgb_max(orl_material_mirrored(&maximum, &hit, direction_at(front, cosine)));
}

double orl_material_max_lobes(const struct orl_material *material, bool front, double cosine)
{
    if (material->kind == ORL_MATERIAL_BSDF) {
        const struct orl_bsdf_surface *const s = orl_bsdf_surface_of(material);
        return fmin(1, orl_bsdf_max_albedo(s->bsdf, front) +
                           orl_rgb_max(front ? s->diffuse.front : s->diffuse.back) +
                           orl_rgb_max(s->diffuse.through));
    }
    return orl_material_max_albedo(material, front, cosine,
                                   (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED));
}

bool orl_material_is_mirror(const struct orl_material *material)
{
    return orl_material_max_mirrored(material, true, 0.5) > 0;
}

/* For a mixture, assumes that its shares and its materials' radiances are uncorrelated. */
struct orl_rgb orl_material_mean_radiance(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE) {
        const double first = orl_smaller(orl_mixture_of(material)->share->mean.r, 1);
        return orl_rgb_add(
            orl_rgb_scale(orl_material_mean_radiance(&orl_mixture_of(material)->mixed[0]), first),
            orl_rgb_scale(orl_material_mean_radiance(&orl_mixture_of(material)->mixed[1]),
                          1 - first));
    }
    if (!orl_material_emits(material))
        return orl_gray(0);
    return material->pattern ? orl_rgb_mul(material->color, material->pattern->mean)
                             : material->color;
}

struct orl_rgb orl_material_max_radiance(const struct orl_material *material)
{
    if (material->kind == ORL_MATERIAL_MIXTURE) {
        const struct orl_rgb a = orl_material_max_radiance(&orl_mixture_of(material)->mixed[0]);
        const struct orl_rgb b = orl_material_max_radiance(&orl_mixture_of(material)->mixed[1]);
        return (struct orl_rgb){fmax(a.r, b.r), fmax(a.g, b.g), fmax(a.b, b.b)};
    }
    if (!orl_material_emits(material))
        return orl_gray(0);
    return material->pattern ? orl_rgb_mul(material->color, material->pattern->maximum)
                             : material->color;
}
