/*
 * Light at a place from photon maps, for all techniques that read them. It is the sum of three
 * parts:
 *   direct     from suns and lamps, by shadow rays, through thin glass (at sensors in free
 *              space also by flat mirrors);
 *   caustic    from suns and lights after a mirror, a lobe or a BSDF: density of caustic photons;
 *   rest       all other light. At a surface that a view sees, or that a sensor lies on, each
 *              technique has an estimator of its own (orl_indirect_estimator).
 * Every light path belongs to exactly one of the three. Every technique uses a hemisphere of rays
 * where no photons are stored (in free space, outside), and where a search finds none.
 *
 * Surfaces that these rays and those of glossy lobes meet are lit by what the estimator reads
 * there, or by all three parts again. The density of global photons is read from texels for
 * views' hemispheres on flat surfaces, and from leaves otherwise. Rays pass through glass and are
 * sampled through BSDFs and mirrors. If the first surface met is a dim pane, both ways are
 * followed, because the daylight behind it may be most of the light. Rays that leave a sealed
 * building continue as exterior paths.
 *
 * Diffuse surfaces nearer than the density's own width are not read from the map, so that corners
 * are not dark. They are lit again, directly and by one more ray, or by irradiance records if there
 * are some: half of what is seen from a line where walls meet is near, and one ray is noisy. The
 * same holds for near-occluded places (photon/density/leaf_sites.h) at any distance: between
 * slats the density's width is as large as the gap between the slats that occlude each other.
 * Texels do not detect near-occluded places.
 *
 * A scene point is inside or outside (light/lit_scene.h); callers carry that along with the point.
 */
#ifndef ORL_RENDER_GATHER_GATHER_H
#define ORL_RENDER_GATHER_GATHER_H

#include "base/sampling/sampling.h"
#include "base/statistics/estimate.h"
#include "light/exterior.h"
#include "photon/density/adaptive_density.h"
#include "photon/density/density_estimate.h"
#include "photon/density/irradiance_tables.h"
#include "photon/shooting/shoot.h"
#include "render/gather/photon_guiding.h"

struct orl_direction_sampler;
struct orl_gather;
struct orl_icache;
struct orl_tally;

/* The estimator of the rest at surfaces, by which the techniques differ. render/technique/ defines
 * one for each of them. */
struct orl_indirect_estimator {
    const char *name;
    enum orl_map_kind map; /* the map that it reads, global or precomputed; the other is ignored */
    /* True if hemispheres of rays give the rest at all places, and the global map holds photons of
     * all light. Otherwise at_surface does inside, and the map holds photons of the rest alone
     * (omit.counted_light). */
    bool gathered;
    /* True if at_surface also returns the spread of what it has read. Where that is large, views
     * gather in spite of it (render/image/lighting.h). */
    bool knows_spread;
    /* Makes the data in *gather that only this estimator reads. Called if there is a map. Returns
     * 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. NULL: there are none. */
    int (*init)(struct orl_gather *gather, double widest, struct orl_thread_pool *pool,
                struct orl_search *search);
    /* Estimates the irradiance at a surface point that a view sees or a sensor lies on. Called if
     * there is a map. found is 0 if it holds nothing there. NULL: it is gathered. */
    struct orl_density (*at_surface)(const struct orl_gather *gather,
                                     const struct orl_surface_point *surface_point,
                                     struct orl_search *search);
    /*
     * Reads the irradiance of a diffuse surface that a ray meets. roughly: the ray is one of many
     * that are averaged. *relit: in: the surface is near; out: it must be lit again, and the
     * result counts in addition. The tally receives the parts.
     */
    struct orl_rgb (*at_hit)(const struct orl_gather *gather,
                             const struct orl_surface_point *surface_point, bool roughly,
                             bool *relit, struct orl_search *search, struct orl_tally *tally);
};

struct orl_gather {
    const struct orl_lit_scene *lit_scene;
    const struct orl_indirect_estimator *indirect;    /* estimator of the rest at surfaces */
    const struct orl_photon_map *maps[ORL_MAP_KINDS]; /* NULL: no photons of that kind */
    uint32_t k[ORL_MAP_KINDS];                        /* number of neighbours per estimate */
    double max_radius[ORL_MAP_KINDS];
    double near;            /* hits closer than this are lit again */
    double reach;           /* a sensor this close to a surface lies on it */
    bool only_virtual_suns; /* true if suns in flat mirrors are the only caustics (sensor_flux.h) */
    struct orl_leaf_irradiance
        *leaf_irradiance; /* leaves of the global map, owned; NULL if there is no global map */
    /* Texels of the global map's flat surfaces; NULL until a view is rendered. */
    struct orl_texels *texels;
    /* Usual kernel radii of caustic photons; NULL likewise. */
    struct orl_kernel_density *caustic_kernels;
    /* Bright patches of the global map, which guide sensors' rays, if the rest is gathered. */
    struct orl_photon_guide guide;
    struct orl_adaptive_density adaptive; /* data of the adaptive density, if that is read */
    /* True if sensors' rays are also drawn towards ports and targets, by the sampler. */
    bool importance_sampled;
    const struct orl_direction_sampler *sampler; /* borrowed; set if importance_sampled */
    struct orl_sobol sobol;
    uint64_t seed;
    /* If set, ends a sensor's sampling, whose value is then invalid; may be NULL. */
    const atomic_bool *cancel;
};

/*
 * Chooses neighbours and radii from the maps themselves. bandwidths: kernel areas relative to the
 * usual ones; NULL: the usual ones. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_gather_init(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                    const struct orl_indirect_estimator *indirect,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS],
                    const double bandwidths[ORL_MAP_KINDS], uint64_t seed,
                    struct orl_thread_pool *pool, struct orl_search *search);

/* Makes the data that only views read, unless it exists: texels, if the rest is gathered, and
 * maximum kernel widths of caustics. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_gather_for_views(struct orl_gather *gather, struct orl_thread_pool *pool);

void orl_gather_done(struct orl_gather *gather);

/*
 * orl_gather_detach removes a gather's references to its lit scene and maps between jobs. It caches
 * the results computed from them, and returns its size in bytes. orl_gather_attach gives it those
 * of a later job with the same scene, maps and bandwidths. orl_gather_done frees it.
 */
uint64_t orl_gather_detach(struct orl_gather *gather);
void orl_gather_attach(struct orl_gather *gather, const struct orl_lit_scene *lit_scene,
                       const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed);

/* A place at which light is estimated. */
struct orl_shading_point {
    struct orl_vec3 point;  /* on or off a surface, clear of it */
    struct orl_vec3 normal; /* unit */
    bool outside;
    /* Off any surface: no photon is stored there, or virtual suns are more accurate. */
    bool in_free_space;
    /* On a surface that a BSDF stands for: lit as views see it; outside is then true as well. */
    bool proxied;
    bool textured; /* seen by a view with a textured normal: light is estimated about `shading` */
    /* The textured normal, unit; light from below the surface does not count. */
    struct orl_vec3 shading;
};

/* Contributions of the emission batches to a sum, by map, because maps are independent. */
struct orl_tally {
    struct orl_batches parts[ORL_MAP_KINDS];
    /* Standard error of what was read from cached records (icache.h), which share theirs. */
    double record_error;
};
double orl_tally_variance(const struct orl_tally *tally);

/* A texel that a ray reads later, when it has arrived from memory; NULL: none. */
struct orl_texel_fetch {
    const struct orl_texel *texel;
    struct orl_rgb weight; /* weight of its irradiance in the ray's radiance */
};

/*
 * Three numbers in [0,1) for a ray's first surface, those after the first `skip` of a Sobol point.
 * They split many rays through a pane evenly into reflected and transmitted ones. Few rays need
 * them.
 */
struct orl_sobol_slice {
    uint32_t index, sequence, skip;
};

/* Knowledge of the first hit of a ray that its caller has traced before. */
enum orl_first_hit { ORL_FIRST_HIT_UNKNOWN, ORL_FIRST_HIT_SURFACE, ORL_FIRST_HIT_NOTHING };

/* A ray of a final gather. */
struct orl_gather_ray {
    struct orl_vec3 origin, direction;
    bool outside;
    /* True for a ray of a view's lobe: no density counts caustics, so that the ray must find them.
     * lobe_mis_pdf is then the MIS density of its direction. */
    bool finds_caustics;
    struct orl_mis_pdf lobe_mis_pdf;
    /* True if the event at the first surface has the numbers of that slice, otherwise random ones.
     */
    bool stratified;
    const struct orl_sobol_slice *slice; /* set if stratified */
    enum orl_first_hit first_hit;
    const struct orl_hit *hit; /* set if first_hit is a surface */
    bool importance_sampled;   /* true if matt surfaces draw importance-sampled rays */
    /* True if flat surfaces may be read from texels: for hemispheres, which average many rays. */
    bool reads_texels;
    /* True if the irradiance cache gives the rest at near surfaces within its reach. Otherwise they
     * are all lit again by one more ray. */
    bool reads_records;
    const struct orl_icache *icache; /* set if reads_records */
    struct orl_tally *tally;         /* receives the parts of the radiance; may be NULL */
    double share;                    /* factor of the radiance in the tally */
    /* Receives the distance of the first surface inside, if any; may be NULL. */
    double *ret_distance;
    /* NULL, or empty at first. Receives the first texel met, whose light is then left out of the
     * radiance (orl_gather_read_texel). A caller that traces many rays thereby hides memory
     * latency. */
    struct orl_texel_fetch *ret_fetch;
};

/* Returns the radiance along a ray. Suns seen directly are left out; lamps count with the share
 * that their lobe's MIS weight leaves. */
struct orl_rgb orl_gather_radiance(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search);

/* Returns the radiance that a texel adds to the ray; the ray's tally receives its parts. */
struct orl_rgb orl_gather_read_texel(const struct orl_gather_ray *ray,
                                     const struct orl_texel_fetch *fetch);

/* Finds the surface at a place that came without its facet. Returns false if there is none within
 * rounding. */
bool orl_gather_find_surface(const struct orl_gather *gather, struct orl_vec3 point,
                             struct orl_vec3 normal, struct orl_surface_point *ret_surface_point);

/* Returns the caustic part by density at a point of a surface, from k photons. */
struct orl_density orl_gather_caustic_k(const struct orl_gather *gather,
                                        const struct orl_surface_point *surface_point, uint32_t k,
                                        struct orl_search *search);

/*
 * Returns the caustic part for views, from a disc no wider than usual among the photons found. In a
 * dark place beside a bright one the nearest photons are far, and a disc that holds enough of them
 * would carry the bright light over the edge.
 */
struct orl_density orl_gather_caustic_for_view(const struct orl_gather *gather,
                                               const struct orl_surface_point *surface_point,
                                               struct orl_search *search);

/* Returns the caustic part from the usual number of photons, with its bias. It takes twice the time
 * of orl_gather_caustic_k. */
struct orl_density orl_gather_caustic_with_bias(const struct orl_gather *gather,
                                                const struct orl_surface_point *surface_point,
                                                struct orl_search *search);

/*
 * The excess of that density through its kernel's width, for suns in flat mirrors: their images
 * averaged over the disc, less those at its centre, at Sobol points of that sequence. It is a
 * control variate: the density less this has only the bias of its other light. found is 0 if
 * nothing is mirrored or the surface is curved.
 */
struct orl_virtual_sun_blur {
    struct orl_estimate excess; /* without bias; its errors are those of the points alone */
    double mean;                /* luma of the images, averaged over the disc */
    uint32_t found;             /* number of points on the disc */
};
struct orl_virtual_sun_blur
orl_gather_virtual_sun_blur(const struct orl_gather *gather,
                            const struct orl_surface_point *surface_point, double radius,
                            uint32_t sequence);

/* Returns the rest at a point of a surface by the estimator's at_surface. found is 0 if the map
 * holds nothing there, or if the rest is gathered. */
struct orl_density orl_gather_indirect(const struct orl_gather *gather,
                                       const struct orl_surface_point *surface_point,
                                       struct orl_search *search);

/* Reads the density of global photons from leaves, for orl_indirect_estimator.at_hit. */
struct orl_rgb orl_gather_read_leaf(const struct orl_gather *gather,
                                    const struct orl_surface_point *surface_point, bool roughly,
                                    bool *relit, struct orl_search *search,
                                    struct orl_tally *tally);

/*
 * Returns the gathered part at a place, by a stratified cosine-weighted hemisphere of rows x
 * columns rays. Strata whose neighbours differ get more rays; their own ray does not decide, so
 * that the mean stays unbiased. Also returns its gradients, the harmonic mean of the rays' lengths
 * (Ward and Heckbert 1992) and the least length. Standard errors, of its luma, are those of the
 * photons and of the rays. The rays' error compares each stratum with the next in its row, as if
 * both rays were drawn from both strata, which overestimates it. icache: records made before,
 * or NULL.
 */
enum { ORL_HEMISPHERE_ROWS = 18, ORL_HEMISPHERE_COLUMNS = 56 }; /* maximum */
struct orl_hemisphere {
    struct orl_rgb irradiance;
    struct orl_vec3 rotation_gradient[3], translation_gradient[3]; /* per channel */
    double mean_distance, least_distance;
    double photon_error, ray_error;
};
struct orl_hemisphere orl_gather_hemisphere(const struct orl_gather *gather,
                                            const struct orl_shading_point *place, uint32_t rows,
                                            uint32_t columns, const struct orl_icache *icache,
                                            struct orl_random *random, struct orl_search *search);

/*
 * Returns the direct light at a place: the mean of that many shadow rays per light. They use the
 * points first, first + 1, ... of one Sobol sequence, so that a pixel's rays can share it.
 * ret_variance may be NULL. It receives the variance of the mean's luma, as if points were random;
 * it is 0 for one ray.
 */
struct orl_rgb orl_gather_direct(const struct orl_gather *gather,
                                 const struct orl_shading_point *place, uint32_t sequence,
                                 uint32_t first, uint32_t rays, double *ret_variance);

/* Returns the place of a sensor. *ret_surface_point is set if it lies on a surface; otherwise the
 * place is in free space. */
struct orl_shading_point orl_gather_sensor_point(const struct orl_gather *gather,
                                                 struct orl_vec3 position,
                                                 struct orl_vec3 direction,
                                                 struct orl_surface_point *ret_surface_point);

/* Returns true if the place receives caustics otherwise than by density: inside, in free
 * space, and if there are any. */
bool orl_gather_has_free_caustics(const struct orl_gather *gather,
                                  const struct orl_shading_point *place);

/*
 * Returns the irradiance of a sensor, with all three parts. A sensor on a surface reads caustics by
 * density, less the excess by blurred suns in flat mirrors. Its place is treated as in free space
 * if the blur would show and virtual suns give all caustics. In free space, where no photon is
 * stored, the sun is sampled by points on panes with lobes and by virtual suns. sensor_flux.h
 * adds all other caustics. Small bright patches of the global map get some more rays
 * (photon_guiding.h).
 *
 * The standard error combines that of the photons, by their batches, and that of the rays, by a few
 * groups. Both contain the photons' scatter that single rays see, so that it is an overestimate if
 * rays are fewer than leaves.
 */
struct orl_estimate orl_gather_sensor(const struct orl_gather *gather,
                                      struct orl_shading_point *place,
                                      const struct orl_surface_point *surface_point,
                                      uint32_t samples, uint64_t index, struct orl_search *search);

#endif
