#include "scene/material/scatter.h"

#include "scene/material/kinds.h"

static bool is_reflector(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_PLASTIC || material->kind == ORL_MATERIAL_METAL ||
           material->kind == ORL_MATERIAL_TRANS;
}

static bool is_mixture(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_MIXTURE;
}

static const struct orl_mixed_asks asks = {
    orl_material_diffuse,   orl_material_straight, orl_material_mirrored, orl_material_albedo,
    orl_scatter_eval_lobes, orl_scatter_sample_at, orl_scatter_pdf};

/* ---- Shares -----------------------------------------------------------------------------------
 */

bool orl_material_is_window(const struct orl_material *material)
{
    switch (material->kind) {
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_BSDF:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_PRISM:
        return true;
    case ORL_MATERIAL_TRANS:
        return orl_trans_transmits(material);
    case ORL_MATERIAL_LOBED:
        return orl_lobed_transmits(material);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_is_window(material);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_either(material, orl_material_is_window);
    default:
        return false;
    }
}

struct orl_rgb orl_material_diffuse(const struct orl_material *material, const struct orl_hit *hit)
{
    if (is_reflector(material))
        return orl_reflector_diffuse(material, hit);
    if (is_mixture(material))
        return orl_mixture_diffuse(&asks, material, hit);
    if (material->kind == ORL_MATERIAL_LOBED)
        return orl_lobed_diffuse(material, hit);
    return material->kind == ORL_MATERIAL_ASHIKHMIN ? orl_ashikhmin_diffuse(material, hit)
                                                    : orl_gray(0);
}

bool orl_material_has_lobes(const struct orl_material *material)
{
    switch (material->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return orl_reflector_has_lobes(material);
    case ORL_MATERIAL_ASHIKHMIN:
        return orl_rgb_max(material->gloss) > 0;
    case ORL_MATERIAL_LOBED:
        return orl_lobed_has_lobes(material);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_has_lobes(material);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_is_directed(material) ||
               orl_mixture_either(material, orl_material_has_lobes);
    default:
        return material->kind == ORL_MATERIAL_BSDF;
    }
}

bool orl_material_transmits_lobes(const struct orl_material *material)
{
    if (is_mixture(material))
        return orl_mixture_either(material, orl_material_transmits_lobes);
    if (material->kind == ORL_MATERIAL_LOBED)
        return orl_lobed_transmits(material);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_transmits_lobes(material);
    return is_reflector(material) ? orl_reflector_transmits_lobes(material)
                                  : material->kind == ORL_MATERIAL_BSDF;
}

struct orl_rgb orl_material_straight(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 from)
{
    if (material->kind == ORL_MATERIAL_GLASS || orl_illum_passes(material))
        return orl_glass_transmittance(material, hit, orl_cosine_at(material, hit, from));
    if (material->kind == ORL_MATERIAL_TRANS && !(material->roughness[0] > 0))
        return orl_trans_straight(material, hit);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_straight(material, hit, from);
    if (is_mixture(material))
        return orl_mixture_straight(&asks, material, hit, from);
    return material->kind == ORL_MATERIAL_BSDF ? orl_panel_straight(material, hit, from)
                                               : orl_gray(0);
}

struct orl_rgb orl_material_mirrored(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 from)
{
    if (material->kind == ORL_MATERIAL_GLASS)
        return orl_glass_reflectance(material, hit, orl_cosine_at(material, hit, from));
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_mirrored(material, hit, from);
    if (material->kind == ORL_MATERIAL_MIRROR)
        return orl_mirror_reflectance(material, hit, from);
    if (material->kind == ORL_MATERIAL_DIELECTRIC)
        return orl_gray(orl_dielectric_reflectance(material, hit, from));
    if (is_reflector(material) && !(material->roughness[0] > 0))
        return orl_reflector_specular(material, hit);
    return is_mixture(material) ? orl_mixture_mirrored(&asks, material, hit, from) : orl_gray(0);
}

int orl_material_bent_ways(const struct orl_material *material, const struct orl_hit *hit,
                           struct orl_vec3 from, enum orl_transport transport,
                           struct orl_scatter ret_scatters[ORL_PRISM_WAYS])
{
    if (material->kind == ORL_MATERIAL_PRISM)
        return orl_prism_ways(material, hit, from, transport, ret_scatters);
    return orl_material_refract(material, hit, from, transport, ret_scatters) ? 1 : 0;
}

/* Transmittance for light from a direction, of all kinds except BSDFs. */
static struct orl_rgb transmitted(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light)
{
    struct orl_scatter s;
    if (orl_material_refract(material, hit, light, ORL_TRANSPORT_LIGHT, &s))
        return s.weight;
    if (material->kind == ORL_MATERIAL_TRANS)
        return orl_rgb_add(orl_trans_spread(material, hit), orl_trans_straight(material, hit));
    if (material->kind == ORL_MATERIAL_BSDF)
        return orl_gray(0); /* included in the BSDF's albedo */
    if (material->kind == ORL_MATERIAL_ILLUM && !(orl_dot(light, hit->normal) > 0))
        return orl_gray(0); /* from behind only light of suns and lamps passes */
    return orl_material_straight(material, hit, light);
}

struct orl_rgb orl_material_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, enum orl_lobes lobes)
{
    struct orl_rgb sum = orl_gray(0);
    if (material->kind == ORL_MATERIAL_BSDF)
        return orl_panel_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_LOBED)
        return orl_lobed_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_PRISM)
        return orl_prism_albedo(material, hit, light, lobes);
    if (is_mixture(material))
        return orl_mixture_albedo(&asks, material, hit, light, lobes);
    if (lobes & ORL_LOBE_DIFFUSE)
        sum = orl_rgb_add(sum, orl_material_diffuse(material, hit));
    if (lobes & ORL_LOBE_REFLECTED)
        sum =
            orl_rgb_add(sum, is_reflector(material) ? orl_reflector_specular(material, hit)
                                                    : orl_material_mirrored(material, hit, light));
    if (lobes & ORL_LOBE_REFLECTED && material->kind == ORL_MATERIAL_ASHIKHMIN)
        sum = orl_rgb_add(sum, orl_ashikhmin_gloss(material, hit, light));
    if (lobes & ORL_LOBE_TRANSMITTED)
        sum = orl_rgb_add(sum, transmitted(material, hit, light));
    return sum;
}

/* An illum transmits light from its front. From behind it transmits only light of suns and lamps,
 * because its emission replaces the rest. */
static struct orl_scatter sample_illum(const struct orl_draw *draw)
{
    const struct orl_rgb share = orl_material_straight(draw->material, draw->hit, draw->from);
    const bool before = orl_dot(draw->from, draw->hit->normal) > 0;
    const bool from_before = before == (draw->transport == ORL_TRANSPORT_LIGHT);
    const enum orl_lobes needed = from_before ? ORL_LOBE_TRANSMITTED : ORL_LOBE_ILLUM;
    if (!(draw->lobes & needed) || !(orl_rgb_max(share) > 0))
        return (struct orl_scatter){.event = ORL_EVENT_ABSORBED};
    return (struct orl_scatter){.event = ORL_EVENT_STRAIGHT,
                                .transmitted = true,
                                .direction = orl_neg(draw->from),
                                .weight = share};
}

static struct orl_scatter sample_material(const struct orl_draw *draw, const double u[3])
{
    switch (draw->material->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return orl_reflector_sample(draw, u);
    case ORL_MATERIAL_ASHIKHMIN:
        return orl_ashikhmin_sample(draw, u);
    case ORL_MATERIAL_GLASS:
        return orl_glass_sample(draw, u);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_sample(draw, u);
    case ORL_MATERIAL_BSDF:
        return orl_panel_sample(draw, u);
    case ORL_MATERIAL_DIELECTRIC:
        return orl_dielectric_sample(draw, u);
    case ORL_MATERIAL_LOBED:
        return orl_lobed_sample(draw, u);
    case ORL_MATERIAL_PRISM:
        return orl_prism_sample(draw, u);
    case ORL_MATERIAL_MIRROR:
        return orl_mirror_sample(draw);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_sample(&asks, draw, u);
    case ORL_MATERIAL_ILLUM:
        return sample_illum(draw);
    case ORL_MATERIAL_VOID:
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
    case ORL_MATERIAL_SPOTLIGHT:
    case ORL_MATERIAL_ANTIMATTER:
    case ORL_MATERIAL_MIST:
        break;
    }
    return (struct orl_scatter){.event = ORL_EVENT_ABSORBED};
}

struct orl_scatter orl_scatter_sample_at(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 from,
                                         enum orl_transport transport, enum orl_lobes lobes,
                                         const double u[3])
{
    const struct orl_draw draw = {material, hit, from, transport, lobes};
    return sample_material(&draw, u);
}

void orl_scatter_sample_many(const struct orl_draw *draws, const double (*u)[3], size_t n,
                             struct orl_scatter *ret_scatters)
{
    size_t panels[ORL_PANELS_ABREAST], n_panels = 0, matts[ORL_MATTS_ABREAST], n_matts = 0;
    for (size_t i = 0; i < n; i++) {
        if (orl_reflector_is_matt(&draws[i]))
            matts[n_matts++] = i;
        else if (orl_panel_is_data_alone(draws[i].material))
            panels[n_panels++] = i;
        else
            ret_scatters[i] = sample_material(&draws[i], u[i]);
        if (n_matts == ORL_MATTS_ABREAST) {
            orl_reflector_sample_matts(draws, u, matts, n_matts, ret_scatters);
            n_matts = 0;
        }
        if (n_panels == ORL_PANELS_ABREAST) {
            orl_panel_sample_many(draws, u, panels, n_panels, ret_scatters);
            n_panels = 0;
        }
    }
    orl_reflector_sample_matts(draws, u, matts, n_matts, ret_scatters);
    orl_panel_sample_many(draws, u, panels, n_panels, ret_scatters);
}

struct orl_scatter orl_scatter_sample(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 from,
                                      enum orl_transport transport, enum orl_lobes lobes,
                                      struct orl_random *random)
{
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const double u[3] = {u0, u1, orl_random_uniform(random)};
    return orl_scatter_sample_at(material, hit, from, transport, lobes, u);
}

double orl_scatter_pdf(const struct orl_material *material, const struct orl_hit *hit,
                       struct orl_vec3 from, enum orl_transport transport, enum orl_lobes lobes,
                       struct orl_vec3 towards)
{
    const struct orl_draw draw = {material, hit, from, transport, lobes};
    if (is_reflector(material))
        return orl_reflector_pdf(&draw, towards);
    if (material->kind == ORL_MATERIAL_ASHIKHMIN)
        return orl_ashikhmin_pdf(&draw, towards);
    if (material->kind == ORL_MATERIAL_LOBED)
        return orl_lobed_pdf(&draw, towards);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_pdf(&draw, towards);
    if (is_mixture(material))
        return orl_mixture_pdf(&asks, &draw, towards);
    return material->kind == ORL_MATERIAL_BSDF ? orl_panel_pdf(&draw, towards) : 0;
}

struct orl_rgb orl_scatter_eval_lobes(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 light,
                                      struct orl_vec3 eye)
{
    if (material->kind == ORL_MATERIAL_BSDF)
        return orl_panel_lobes(material, hit, light, eye);
    if (is_reflector(material))
        return orl_reflector_lobes(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_ASHIKHMIN)
        return orl_ashikhmin_lobes(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_LOBED)
        return orl_lobed_lobes(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_lobes(material, hit, light, eye);
    return is_mixture(material) ? orl_mixture_lobes(&asks, material, hit, light, eye) : orl_gray(0);
}
