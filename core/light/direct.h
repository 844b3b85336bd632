/*
 * Next-event estimation: light that arrives straight from suns and lamps, estimated by shadow rays,
 * through thin panes and by way of flat mirrors. MIS weights for lamps that both shadow rays and
 * BSDF-sampled rays can find.
 */
#ifndef ORL_LIGHT_DIRECT_H
#define ORL_LIGHT_DIRECT_H

#include "light/lit_scene.h"

/*
 * Sampling of points on lamps for shadow rays: uniform over the cone that a sphere fills, uniform
 * by area on any other surface. Directions are unit, points in moved coordinates.
 */

/* A sampled point of an emitter as seen from a point, and the solid angle that it stands for (1
 * / pdf). */
struct orl_light_sample {
    struct orl_vec3 light;  /* unit, towards the point */
    struct orl_vec3 normal; /* unit, at the point */
    double distance, measure_sr;
};
/* Samples a point of an emitter; u: two numbers in [0,1). Returns false if the point is seen
 * from its back, or a sphere from inside. */
bool orl_light_sample(const struct orl_lit_scene *lit_scene, const struct orl_emitter *emitter,
                      struct orl_vec3 from, const double u[2], struct orl_light_sample *ret_sample);

/* Returns the pdf of the sampled direction, 1/sr. */
static inline double orl_light_sample_pdf(const struct orl_light_sample *light_sample)
{
    return 1 / light_sample->measure_sr;
}

/* Returns the pdf, 1/sr, with which orl_light_sample at `from` samples the direction to that hit of
 * the lamp. */
double orl_light_pdf_of_hit(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                            struct orl_vec3 from);

/*
 * Returns the share of light that arrives straight from `direction`, from up to max_distance,
 * through thin glass on the way. If through_ports is false, ports block.
 */
struct orl_rgb orl_transmittance(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                                 struct orl_vec3 direction, double max_distance,
                                 bool through_ports);
/* Returns the transmittance towards a surface that is neither sun nor lamp. The front of an illum
 * blocks it: the illum shines in place of all such surfaces behind it. */
struct orl_rgb orl_transmittance_to_surface(const struct orl_lit_scene *lit_scene,
                                            struct orl_vec3 origin, struct orl_vec3 direction,
                                            double max_distance, bool through_ports);
/* Returns orl_transmittance for an infinite distance, through ports. If *port is ORL_NO_PORT, it
 * becomes the first port by which the ray leaves the building. Otherwise the path has left the
 * building before, and *port is unchanged. */
struct orl_rgb orl_transmittance_to_infinity(const struct orl_lit_scene *lit_scene,
                                             struct orl_vec3 origin, struct orl_vec3 direction,
                                             int32_t *port);

/* Returns the transmittance of panes on the way to a facet, and the hit on it. Returns zero if
 * anything opaque is in between; *ret_hit is then undefined. */
struct orl_rgb orl_transmittance_to_facet(const struct orl_lit_scene *lit_scene,
                                          struct orl_vec3 origin, struct orl_vec3 direction,
                                          bool through_ports, uint32_t facet,
                                          struct orl_hit *ret_hit);

/*
 * A query for the irradiance at a point with a unit normal, from suns and lamps that are sampled
 * directly, with one shadow ray each. If lobes is not NULL, the light is weighted by the lobes of
 * `hit` towards eye. The result is then radiance; of lamps it holds the shadow rays' share, and
 * rays sampled from the lobes add the rest.
 */
struct orl_direct_query {
    struct orl_vec3 point;          /* clear of the surface */
    struct orl_vec3 normal;         /* unit, towards the side that is lit */
    const struct orl_vec3 *shading; /* unit normal for the cosine; NULL: `normal` */
    bool through_ports;
    const struct orl_material *lobes;
    const struct orl_hit *hit;
    struct orl_vec3 eye;
    /* the point is in a volume, not on a surface: light is scattered towards eye by the phase
     * function of asymmetry (scene/built/scene.h) */
    bool mist;
    double asymmetry;
    bool mirrored; /* true to add the suns' and lamps' images in flat mirrors */
    /* two numbers in [0,1) of a low-discrepancy sequence; NULL: random ones */
    const double *u;
};
struct orl_rgb orl_direct_light(const struct orl_lit_scene *lit_scene,
                                const struct orl_direct_query *query, struct orl_random *random);

/* Returns the lamp's radiance from the sampled point towards `from`, times the transmittance on
 * the way and the solid angle. Times a cosine it is irradiance. If through_ports is false, ports
 * block. */
struct orl_rgb orl_light_sample_radiance(const struct orl_lit_scene *lit_scene,
                                         const struct orl_emitter *emitter, struct orl_vec3 from,
                                         const struct orl_light_sample *light_sample,
                                         bool through_ports);

/* Returns the part of orl_direct_light that comes from the suns' images in flat mirrors;
 * query.mirrored is ignored. */
struct orl_rgb orl_direct_by_virtual_suns(const struct orl_lit_scene *lit_scene,
                                          const struct orl_direct_query *query,
                                          struct orl_random *random);

/*
 * Returns the radiance of suns and lamps that a volume scatters at a point towards an eye, whose
 * ray has the direction `along`. asymmetry: parameter of the phase function (scene/built/scene.h).
 * Traces one shadow ray for each light.
 */
struct orl_rgb orl_direct_in_volume(const struct orl_lit_scene *lit_scene, struct orl_vec3 point,
                                    struct orl_vec3 along, double asymmetry,
                                    struct orl_random *random);

/*
 * Returns the radiance of suns (their images in flat mirrors included) and lamps that the
 * material's lobes at a hit send towards eye. Both sides count if the material transmits. Traces
 * one shadow ray for each light. The rest of the lamps' light is left to rays sampled from the
 * lobes (orl_mis_pdf_update).
 */
struct orl_rgb orl_direct_by_lobes(const struct orl_lit_scene *lit_scene, const struct orl_hit *hit,
                                   const struct orl_material *material, struct orl_vec3 eye,
                                   struct orl_random *random);

/*
 * The pdf with which a ray's direction was sampled, for the MIS weight of lamps that the ray hits:
 * shadow rays may have sampled the same lamps. The weights are the balance heuristic (Veach 1997,
 * chapter 9), so rays count more in a narrow lobe, and shadow rays in a wide one. After one
 * reflection by a flat mirror with lamp images (virtual_lamps.h), the weights hold for the lamps of
 * these images.
 */
enum { ORL_MIRROR_NONE = 0, ORL_MIRROR_UNKNOWN = -1 };
struct orl_mis_pdf {
    /* 1/sr; 0: shadow rays have sampled all lamps; infinite: no shadow rays were traced */
    double pdf;
    /* the point where the ray was sampled from a lobe, or the point's mirror image */
    struct orl_vec3 from;
    /* 1 + the facet of the mirror that reflected the ray since, or ORL_MIRROR_NONE. After
     * ORL_MIRROR_UNKNOWN only rays find lamps. */
    int64_t mirror;
};

/* Returns the state of a ray whose lamps shadow rays have sampled, both straight and in mirrors. */
static inline struct orl_mis_pdf orl_mis_pdf_zero(void)
{
    return (struct orl_mis_pdf){.pdf = 0, .mirror = ORL_MIRROR_NONE};
}
/* Returns the state of a ray whose lamps shadow rays have sampled straight only. */
static inline struct orl_mis_pdf orl_mis_pdf_zero_straight(void)
{
    return (struct orl_mis_pdf){.pdf = 0, .mirror = ORL_MIRROR_UNKNOWN};
}
static inline struct orl_mis_pdf orl_mis_pdf_infinite(void)
{
    return (struct orl_mis_pdf){.pdf = INFINITY, .mirror = ORL_MIRROR_UNKNOWN};
}

/* Returns the radiance that the surface at a hit emits towards eye; for lamps it is multiplied
 * by the ray's MIS weight. */
struct orl_rgb orl_emitted_radiance(const struct orl_lit_scene *lit_scene,
                                    const struct orl_hit *hit, struct orl_vec3 eye,
                                    const struct orl_mis_pdf *mis_pdf);

/* Returns the MIS state after the event at a surface, where shadow rays have sampled suns and
 * lamps by way of its lobes. */
struct orl_mis_pdf orl_mis_pdf_update(const struct orl_lit_scene *lit_scene,
                                      const struct orl_hit *hit, struct orl_vec3 eye,
                                      const struct orl_surface_sample *sample,
                                      struct orl_mis_pdf before);

#endif
