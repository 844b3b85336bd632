#include "scene/material/scatter.h"

#include "scene/material/kinds.h"

static bool is_mixture(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_MIXTURE;
}

static const struct orl_mixture_callbacks callbacks = {
    orl_material_diffuse,    orl_material_straight,  orl_material_mirrored, orl_material_albedo,
    orl_material_eval_lobes, orl_material_sample_at, orl_material_pdf};

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
    case ORL_MATERIAL_FUNCTION_LOBES:
        return orl_function_lobes_transmits(material);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_is_window(material);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_any(material, orl_material_is_window);
    default:
        return false;
    }
}

struct orl_rgb orl_material_diffuse(const struct orl_material *material, const struct orl_hit *hit)
{
    if (orl_material_is_reflector(material))
        return orl_reflector_diffuse(material, hit);
    if (is_mixture(material))
        return orl_mixture_diffuse(&callbacks, material, hit);
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        return orl_function_lobes_diffuse(material, hit);
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
        return orl_rgb_max(orl_ashikhmin_of(material)->gloss) > 0;
    case ORL_MATERIAL_FUNCTION_LOBES:
        return orl_function_lobes_has_lobes(material);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_has_lobes(material);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_is_directed(material) ||
               orl_mixture_any(material, orl_material_has_lobes);
    default:
        return material->kind == ORL_MATERIAL_BSDF;
    }
}

bool orl_material_transmits_lobes(const struct orl_material *material)
{
    if (is_mixture(material))
        return orl_mixture_any(material, orl_material_transmits_lobes);
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        return orl_function_lobes_transmits(material);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_transmits_lobes(material);
    return orl_material_is_reflector(material) ? orl_reflector_transmits_lobes(material)
                                               : material->kind == ORL_MATERIAL_BSDF;
}

struct orl_rgb orl_material_straight(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 from)
{
    if (material->kind == ORL_MATERIAL_GLASS || orl_illum_transmits(material))
        return orl_glass_transmittance(material, hit, orl_cosine_at(material, hit, from));
    if (material->kind == ORL_MATERIAL_TRANS && !(orl_reflector_of(material)->roughness[0] > 0))
        return orl_trans_straight(material, hit);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_straight(material, hit, from);
    if (is_mixture(material))
        return orl_mixture_straight(&callbacks, material, hit, from);
    return material->kind == ORL_MATERIAL_BSDF ? orl_bsdf_surface_straight(material, hit, from)
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
    if (orl_material_is_reflector(material) && !(orl_reflector_of(material)->roughness[0] > 0))
        return orl_reflector_specular(material, hit);
    return is_mixture(material) ? orl_mixture_mirrored(&callbacks, material, hit, from)
                                : orl_gray(0);
}

int orl_material_deviated_rays(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 from, enum orl_transport transport,
                               struct orl_surface_sample ret_samples[ORL_PRISM_RAYS])
{
    if (material->kind == ORL_MATERIAL_PRISM)
        return orl_prism_deviated_rays(material, hit, from, transport, ret_samples);
    return orl_material_refract(material, hit, from, transport, ret_samples) ? 1 : 0;
}

/* Transmittance for light from a direction, of all kinds except BSDFs. */
static struct orl_rgb transmitted(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light)
{
    struct orl_surface_sample s;
    if (orl_material_refract(material, hit, light, ORL_TRANSPORT_LIGHT, &s))
        return s.weight;
    if (material->kind == ORL_MATERIAL_TRANS)
        return orl_rgb_add(orl_trans_diffuse(material, hit), orl_trans_straight(material, hit));
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
        return orl_bsdf_surface_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        return orl_function_lobes_albedo(material, hit, light, lobes);
    if (material->kind == ORL_MATERIAL_PRISM)
        return orl_prism_albedo(material, hit, light, lobes);
    if (is_mixture(material))
        return orl_mixture_albedo(&callbacks, material, hit, light, lobes);
    if (lobes & ORL_LOBE_DIFFUSE)
        sum = orl_rgb_add(sum, orl_material_diffuse(material, hit));
    if (lobes & ORL_LOBE_REFLECTED)
        sum = orl_rgb_add(sum, orl_material_is_reflector(material)
                                   ? orl_reflector_specular(material, hit)
                                   : orl_material_mirrored(material, hit, light));
    if (lobes & ORL_LOBE_REFLECTED && material->kind == ORL_MATERIAL_ASHIKHMIN)
        sum = orl_rgb_add(sum, orl_ashikhmin_gloss(material, hit, light));
    if (lobes & ORL_LOBE_TRANSMITTED)
        sum = orl_rgb_add(sum, transmitted(material, hit, light));
    return sum;
}

/* An illum transmits light from its front. From behind it transmits only light of suns and lamps,
 * because its emission replaces the rest. */
static struct orl_surface_sample sample_illum(const struct orl_bsdf_query *query)
{
    const struct orl_rgb share = orl_material_straight(query->material, query->hit, query->from);
    const bool before = orl_dot(query->from, query->hit->normal) > 0;
    const bool from_before = before == (query->transport == ORL_TRANSPORT_LIGHT);
    const enum orl_lobes needed = from_before ? ORL_LOBE_TRANSMITTED : ORL_LOBE_ILLUM;
    if (!(query->lobes & needed) || !(orl_rgb_max(share) > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    return (struct orl_surface_sample){.event = ORL_EVENT_STRAIGHT,
                                       .transmitted = true,
                                       .direction = orl_neg(query->from),
                                       .weight = share};
}

static struct orl_surface_sample sample_material(const struct orl_bsdf_query *query,
                                                 const double u[3])
{
    switch (query->material->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return orl_reflector_sample(query, u);
    case ORL_MATERIAL_ASHIKHMIN:
        return orl_ashikhmin_sample(query, u);
    case ORL_MATERIAL_GLASS:
        return orl_glass_sample(query, u);
    case ORL_MATERIAL_GLAZING:
        return orl_glazing_sample(query, u);
    case ORL_MATERIAL_BSDF:
        return orl_bsdf_surface_sample(query, u);
    case ORL_MATERIAL_DIELECTRIC:
        return orl_dielectric_sample(query, u);
    case ORL_MATERIAL_FUNCTION_LOBES:
        return orl_function_lobes_sample(query, u);
    case ORL_MATERIAL_PRISM:
        return orl_prism_sample(query, u);
    case ORL_MATERIAL_MIRROR:
        return orl_mirror_sample(query);
    case ORL_MATERIAL_MIXTURE:
        return orl_mixture_sample(&callbacks, query, u);
    case ORL_MATERIAL_ILLUM:
        return sample_illum(query);
    case ORL_MATERIAL_VOID:
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
    case ORL_MATERIAL_SPOTLIGHT:
    case ORL_MATERIAL_ANTIMATTER:
    case ORL_MATERIAL_MIST:
        break;
    }
    return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
}

struct orl_surface_sample orl_material_sample_at(const struct orl_material *material,
                                                 const struct orl_hit *hit, struct orl_vec3 from,
                                                 enum orl_transport transport, enum orl_lobes lobes,
                                                 const double u[3])
{
    const struct orl_bsdf_query query = {material, hit, from, transport, lobes};
    return sample_material(&query, u);
}

void orl_material_sample_many(const struct orl_bsdf_query *queries, const double (*u)[3], size_t n,
                              struct orl_surface_sample *ret_samples)
{
    size_t bsdf_surfaces[ORL_BSDF_SAMPLES_MAX], n_bsdf_surfaces = 0, matts[ORL_MATT_SAMPLES_MAX],
                                                n_matts = 0;
    for (size_t i = 0; i < n; i++) {
        if (orl_reflector_is_matt(&queries[i]))
            matts[n_matts++] = i;
        else if (orl_bsdf_surface_is_data_only(queries[i].material))
            bsdf_surfaces[n_bsdf_surfaces++] = i;
        else
            ret_samples[i] = sample_material(&queries[i], u[i]);
        if (n_matts == ORL_MATT_SAMPLES_MAX) {
            orl_reflector_sample_matt_many(queries, u, matts, n_matts, ret_samples);
            n_matts = 0;
        }
        if (n_bsdf_surfaces == ORL_BSDF_SAMPLES_MAX) {
            orl_bsdf_surface_sample_many(queries, u, bsdf_surfaces, n_bsdf_surfaces, ret_samples);
            n_bsdf_surfaces = 0;
        }
    }
    orl_reflector_sample_matt_many(queries, u, matts, n_matts, ret_samples);
    orl_bsdf_surface_sample_many(queries, u, bsdf_surfaces, n_bsdf_surfaces, ret_samples);
}

struct orl_surface_sample orl_material_sample(const struct orl_material *material,
                                              const struct orl_hit *hit, struct orl_vec3 from,
                                              enum orl_transport transport, enum orl_lobes lobes,
                                              struct orl_random *random)
{
    const double u0 = orl_random_uniform(random), u1 = orl_random_uniform(random);
    const double u[3] = {u0, u1, orl_random_uniform(random)};
    return orl_material_sample_at(material, hit, from, transport, lobes, u);
}

double orl_material_pdf(const struct orl_material *material, const struct orl_hit *hit,
                        struct orl_vec3 from, enum orl_transport transport, enum orl_lobes lobes,
                        struct orl_vec3 towards)
{
    const struct orl_bsdf_query query = {material, hit, from, transport, lobes};
    if (orl_material_is_reflector(material))
        return orl_reflector_pdf(&query, towards);
    if (material->kind == ORL_MATERIAL_ASHIKHMIN)
        return orl_ashikhmin_pdf(&query, towards);
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        return orl_function_lobes_pdf(&query, towards);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_pdf(&query, towards);
    if (is_mixture(material))
        return orl_mixture_pdf(&callbacks, &query, towards);
    return material->kind == ORL_MATERIAL_BSDF ? orl_bsdf_surface_pdf(&query, towards) : 0;
}

struct orl_rgb orl_material_eval_lobes(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 light,
                                       struct orl_vec3 eye)
{
    if (material->kind == ORL_MATERIAL_BSDF)
        return orl_bsdf_surface_lobes(material, hit, light, eye);
    if (orl_material_is_reflector(material))
        return orl_reflector_lobes(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_ASHIKHMIN)
        return orl_ashikhmin_lobes(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        return orl_function_lobes_eval(material, hit, light, eye);
    if (material->kind == ORL_MATERIAL_GLAZING)
        return orl_glazing_lobes(material, hit, light, eye);
    return is_mixture(material) ? orl_mixture_lobes(&callbacks, material, hit, light, eye)
                                : orl_gray(0);
}
