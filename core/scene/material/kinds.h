/*
 * The kinds of material that scatter.c dispatches to, one file each. Arguments are as in scatter.h;
 * u holds three numbers in [0,1), the last of which chooses between parts.
 */
#ifndef ORL_SCENE_MATERIAL_KINDS_H
#define ORL_SCENE_MATERIAL_KINDS_H

#include "scene/material/color_at.h"
#include "scene/material/patterns/texture.h"
#include "scene/material/scatter.h"

/* glass.c: thin panes. */
struct orl_rgb orl_glass_transmittance(const struct orl_material *material,
                                       const struct orl_hit *hit, double cosine);
struct orl_rgb orl_glass_reflectance(const struct orl_material *material, const struct orl_hit *hit,
                                     double cosine);
struct orl_surface_sample orl_glass_sample(const struct orl_bsdf_query *query, const double u[3]);

/* lamp.c: true if an illum transmits light (straight) at all. */
static inline bool orl_illum_transmits(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_ILLUM && orl_rgb_max(material->transmissivity) > 0;
}

/* reflector.c: plastic, metal, trans. Diffuse and specular reflectance; diffuse transmittance
 * (spread) and direct transmittance of trans (straight, or a lobe about straight if rough). */
struct orl_rgb orl_reflector_diffuse(const struct orl_material *material,
                                     const struct orl_hit *hit);
struct orl_rgb orl_reflector_specular(const struct orl_material *material,
                                      const struct orl_hit *hit);
struct orl_rgb orl_trans_diffuse(const struct orl_material *material, const struct orl_hit *hit);
struct orl_rgb orl_trans_straight(const struct orl_material *material, const struct orl_hit *hit);
bool orl_trans_transmits(const struct orl_material *material);
bool orl_reflector_has_lobes(const struct orl_material *material);
bool orl_reflector_transmits_lobes(const struct orl_material *material);
struct orl_rgb orl_reflector_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye);
struct orl_surface_sample orl_reflector_sample(const struct orl_bsdf_query *query,
                                               const double u[3]);
/* Samples materials that are only diffuse: the draws listed in `which`, at most
 * ORL_MATT_SAMPLES_MAX. */
enum { ORL_MATT_SAMPLES_MAX = 16 };
bool orl_reflector_is_matt(const struct orl_bsdf_query *query);
void orl_reflector_sample_matt_many(const struct orl_bsdf_query *queries, const double (*u)[3],
                                    const size_t *which, size_t n, struct orl_surface_sample *ret);
double orl_reflector_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards);

/* ashikhmin.c: ashik2. gloss: approximate reflectance of the lobe. */
struct orl_rgb orl_ashikhmin_diffuse(const struct orl_material *material,
                                     const struct orl_hit *hit);
struct orl_rgb orl_ashikhmin_gloss(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 from);
struct orl_rgb orl_ashikhmin_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye);
struct orl_surface_sample orl_ashikhmin_sample(const struct orl_bsdf_query *query,
                                               const double u[3]);
double orl_ashikhmin_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards);

/* glazing.c: specular shares by functions of the angle. */
bool orl_glazing_is_window(const struct orl_material *material);
bool orl_glazing_has_lobes(const struct orl_material *material);
bool orl_glazing_transmits_lobes(const struct orl_material *material);
struct orl_rgb orl_glazing_mirrored(const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 eye);
struct orl_rgb orl_glazing_straight(const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 eye);
struct orl_rgb orl_glazing_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light, enum orl_lobes lobes);
struct orl_rgb orl_glazing_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                 struct orl_vec3 light, struct orl_vec3 eye);
struct orl_surface_sample orl_glazing_sample(const struct orl_bsdf_query *query, const double u[3]);
double orl_glazing_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards);

/* dielectric.c: clear solids and liquids. */
double orl_dielectric_reflectance(const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 from);
struct orl_surface_sample orl_dielectric_sample(const struct orl_bsdf_query *query,
                                                const double u[3]);

/* prism.c: returns the number of scatters that an eye ray or light is sent on to. */
int orl_prism_deviated_rays(const struct orl_material *material, const struct orl_hit *hit,
                            struct orl_vec3 from, enum orl_transport transport,
                            struct orl_surface_sample ret_samples[ORL_PRISM_RAYS]);
struct orl_rgb orl_prism_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, enum orl_lobes lobes);
struct orl_surface_sample orl_prism_sample(const struct orl_bsdf_query *query, const double u[3]);

/* function_lobes.c: lobes by functions of both directions. */
struct orl_rgb orl_function_lobes_diffuse(const struct orl_material *material,
                                          const struct orl_hit *hit);
bool orl_function_lobes_transmits(const struct orl_material *material);
bool orl_function_lobes_has_lobes(const struct orl_material *material);
struct orl_rgb orl_function_lobes_albedo(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 light,
                                         enum orl_lobes lobes);
struct orl_rgb orl_function_lobes_eval(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 light,
                                       struct orl_vec3 eye);
struct orl_surface_sample orl_function_lobes_sample(const struct orl_bsdf_query *query,
                                                    const double u[3]);
double orl_function_lobes_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards);

/* mixture.c: two materials of different kinds, mixed by shares or summed. It queries both through
 * these functions of scatter.h. */
struct orl_mixture_callbacks {
    struct orl_rgb (*diffuse)(const struct orl_material *material, const struct orl_hit *hit);
    struct orl_rgb (*straight)(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 from);
    struct orl_rgb (*mirrored)(const struct orl_material *material, const struct orl_hit *hit,
                               struct orl_vec3 from);
    struct orl_rgb (*albedo)(const struct orl_material *material, const struct orl_hit *hit,
                             struct orl_vec3 light, enum orl_lobes lobes);
    struct orl_rgb (*lobes)(const struct orl_material *material, const struct orl_hit *hit,
                            struct orl_vec3 light, struct orl_vec3 eye);
    struct orl_surface_sample (*sample)(const struct orl_material *material,
                                        const struct orl_hit *hit, struct orl_vec3 from,
                                        enum orl_transport transport, enum orl_lobes lobes,
                                        const double u[3]);
    double (*pdf)(const struct orl_material *material, const struct orl_hit *hit,
                  struct orl_vec3 from, enum orl_transport transport, enum orl_lobes lobes,
                  struct orl_vec3 towards);
};
bool orl_mixture_any(const struct orl_material *material,
                     bool (*is)(const struct orl_material *material));
bool orl_mixture_is_directed(const struct orl_material *material);
enum orl_lobes orl_mixture_lobes_within(const struct orl_material *material, enum orl_lobes lobes);
struct orl_rgb orl_mixture_diffuse(const struct orl_mixture_callbacks *callbacks,
                                   const struct orl_material *material, const struct orl_hit *hit);
struct orl_rgb orl_mixture_straight(const struct orl_mixture_callbacks *callbacks,
                                    const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 from);
struct orl_rgb orl_mixture_mirrored(const struct orl_mixture_callbacks *callbacks,
                                    const struct orl_material *material, const struct orl_hit *hit,
                                    struct orl_vec3 from);
struct orl_rgb orl_mixture_albedo(const struct orl_mixture_callbacks *callbacks,
                                  const struct orl_material *material, const struct orl_hit *hit,
                                  struct orl_vec3 light, enum orl_lobes lobes);
struct orl_rgb orl_mixture_lobes(const struct orl_mixture_callbacks *callbacks,
                                 const struct orl_material *material, const struct orl_hit *hit,
                                 struct orl_vec3 light, struct orl_vec3 eye);
struct orl_surface_sample orl_mixture_sample(const struct orl_mixture_callbacks *callbacks,
                                             const struct orl_bsdf_query *query, const double u[3]);
double orl_mixture_pdf(const struct orl_mixture_callbacks *callbacks,
                       const struct orl_bsdf_query *query, struct orl_vec3 towards);

/* mirror.c */
struct orl_rgb orl_mirror_reflectance(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 from);
struct orl_surface_sample orl_mirror_sample(const struct orl_bsdf_query *query);

/* bsdf_surface.c: surfaces described by a BSDF. */
struct orl_rgb orl_bsdf_surface_lobes(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 light,
                                      struct orl_vec3 eye);
struct orl_rgb orl_bsdf_surface_albedo(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 light,
                                       enum orl_lobes lobes);
/* Straight transmittance towards eye; 0 unless the material is an aBSDF. */
struct orl_rgb orl_bsdf_surface_straight(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 eye);
struct orl_surface_sample orl_bsdf_surface_sample(const struct orl_bsdf_query *query,
                                                  const double u[3]);
/* Samples BSDF materials by orl_bsdf_sample_many: the draws listed in `which`, at most
 * ORL_BSDF_SAMPLES_MAX. */
enum { ORL_BSDF_SAMPLES_MAX = 16 };
void orl_bsdf_surface_sample_many(const struct orl_bsdf_query *queries, const double (*u)[3],
                                  const size_t *which, size_t n, struct orl_surface_sample *ret);
double orl_bsdf_surface_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards);

#endif
