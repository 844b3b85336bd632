/*
 * The techniques of photon maps: light at a point is
 *   direct     from suns and lamps, by shadow rays, through thin glass (at sensors in mid-air by
 *              flat mirrors too);
 *   caustic    from suns and lights after a mirror, a lobe or a BSDF: density of caustic photons;
 *   rest       all else. At a surface seen by a view, or with a sensor on it,
 *     gathered   (technique gather, the paper's GCx) by a hemisphere of rays that see the domes,
 *                glow, and the radiance of diffuse surfaces by the density of global photons;
 *     density    (direct) by the density right there of global photons, bias held down by the
 *                choice of bandwidth (photon/density/adaptive_density.h);
 *     records    (precomputed, xCP) from irradiance precomputed at a fraction of the photons
 *                (photon/density/records.h): the global map itself is not needed. Where those about
 * a place differ much views gather (lighting.h). Every path of light is in exactly one of the
 * three. Where no photons land (in mid-air, outside) a hemisphere of rays serves every technique,
 * and so it does where there happen to be none.
 *
 * Where it is gathered, the global map holds photons of all light; else of the rest alone
 * (omit.counted_light). What such rays, and those of glossy lobes, meet is lit by the density of
 * global photons (views' hemispheres: by texels where it is flat; else by leaves), or by all three
 * parts once more. Rays pass on through glass and are sampled through BSDFs and mirrors; where the
 * first thing met is a dim pane they go both ways, for the day behind it may be most of the light;
 * where they leave a sealed building they go on as exterior paths. Diffuse surfaces nearer than the
 * density's own width are not read from the map but lit again, directly and by one more ray, so
 * that corners are not dark; or by irradiance records, where there are some by then: half of what
 * is seen from the line where walls meet is near, and one ray's noise is much. So are crowded
 * places (photon/density/crowd.h), however far: between slats a density's width is as wide as what
 * hides them from each other, and from who looks. Texels do not know of those.
 *
 * A scene point is inside or outside (light/world.h); callers carry that along with the point.
 */
#ifndef ORL_RENDER_GATHER_GATHER_H
#define ORL_RENDER_GATHER_GATHER_H

#include "base/estimate.h"
#include "base/sobol.h"
#include "light/exterior.h"
#include "photon/density/adaptive_density.h"
#include "photon/density/kernel_density.h"
#include "photon/density/leaves.h"
#include "photon/density/texels.h"
#include "photon/shooting/shoot.h"
#include "render/gather/bright.h"

enum orl_rest { ORL_REST_GATHERED, ORL_REST_DENSITY, ORL_REST_RECORDS };

struct orl_aim;
struct orl_icache;

struct orl_gather {
    const struct orl_world *world;
    enum orl_rest rest;                               /* how it is read at surfaces */
    const struct orl_photon_map *maps[ORL_MAP_KINDS]; /* NULL: no photons of that kind */
    uint32_t k[ORL_MAP_KINDS];                        /* neighbours */
    double max_radius[ORL_MAP_KINDS];
    double near;               /* hits closer than this are lit again */
    double reach;              /* a sensor so close to a surface lies on it */
    bool by_images;            /* suns in flat mirrors are all the caustics there are: air.h */
    struct orl_leaves *leaves; /* of the global map, owned; NULL when there is none */
    struct orl_texels *texels; /* of the same, for flat surfaces; NULL until views want them, as */
    struct orl_kernel_density
        *caustic_widths;               /* are the radii that are normal among caustic photons */
    struct orl_bright bright;          /* of the global map: where sensors' rays are drawn to */
    struct orl_adaptive_density adapt; /* ORL_REST_DENSITY: for its estimates */
    const struct orl_aim *aim;         /* of sensors' rays, borrowed; NULL: none are aimed */
    struct orl_sobol sobol;
    uint64_t seed;
    const atomic_bool *cancel; /* ends a sensor's sampling, whose value is none then; or NULL */
};

/*
 * Chooses neighbours and radii from the maps themselves. With ORL_REST_RECORDS the global map is
 * not looked at, otherwise the precomputed one. bandwidths: areas of kernels
 * in terms of the usual ones; NULL: as usual. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_gather_init(struct orl_gather *gather, const struct orl_world *world, enum orl_rest rest,
                    const struct orl_photon_map *const maps[ORL_MAP_KINDS],
                    const double bandwidths[ORL_MAP_KINDS], uint64_t seed, struct orl_crew *crew,
                    struct orl_search *search);

/*
 * What only views read, if it is not there: texels, where the rest is gathered, and how wide
 * kernels of caustics are to be at the most. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
int orl_gather_for_views(struct orl_gather *gather, struct orl_crew *crew);

void orl_gather_done(struct orl_gather *gather);

/*
 * Between jobs (gather_kept.c): of one that is paused only the world and the maps are forgotten,
 * and what was worked out from them stays, for a job with the same scene, maps and bandwidths to
 * resume with its own copies of them; or for orl_gather_done. Pausing returns the bytes it takes.
 */
uint64_t orl_gather_pause(struct orl_gather *gather);
void orl_gather_resume(struct orl_gather *gather, const struct orl_world *world,
                       const struct orl_photon_map *const maps[ORL_MAP_KINDS], uint64_t seed);

/* Where light is asked for. */
struct orl_place {
    struct orl_vec3 point;  /* on or off a surface, clear of it */
    struct orl_vec3 normal; /* unit */
    bool outside;
    bool in_air;   /* off any surface: no photon lands there, or images tell better */
    bool proxied;  /* on a surface that a BSDF stands for: lit as views see it; then outside too */
    bool textured; /* seen by a view that turns the normal: light is asked for ... */
    struct orl_vec3
        shading; /* ... about this one, unit; but what is below the surface counts not */
};

/* What the batches of emission hold of a sum, map by map: maps are independent of each other. */
struct orl_tally {
    struct orl_batches parts[ORL_MAP_KINDS];
    double known; /* standard errors of what records have told (icache.h), which share theirs */
};
double orl_tally_variance(const struct orl_tally *tally);

/* A texel that a ray is yet to read, on its way from memory; NULL: none. */
struct orl_glimpse {
    const struct orl_texel *texel;
    struct orl_rgb weight; /* of its irradiance in the ray's radiance */
};

/* Three numbers in [0,1), those after the first `skip` of a point of a Sobol sequence, so that of
 * many rays through a pane even shares are mirrored and sent on. Most rays come to need none. */
struct orl_even {
    uint32_t index, sequence, skip;
};

/* A ray that gathers. */
struct orl_gather_ray {
    struct orl_vec3 origin, direction;
    bool outside;
    /* Of a view's lobe, where no density counts caustics: the ray is to find them. Or NULL. */
    const struct orl_chance *of_lobe;
    const struct orl_even *first; /* for what happens at the first surface; NULL: by chance */
    /* Where it is known what is met first: that hit, or nothing_ahead. Else NULL and false. */
    const struct orl_hit *ahead;
    bool nothing_ahead;
    bool to_ports; /* where it goes on from a matt surface, some rays are aimed at ports */
    /* Flat surfaces may be read by texels: for hemispheres, which themselves are averaged. */
    bool by_texels;
    /* NULL, or records that tell the rest where they reach what is met near. */
    const struct orl_icache *known;
    struct orl_tally *tally; /* NULL, or what the radiance's parts are added to */
    double share;            /* of the radiance in it */
    double *ret_distance;    /* NULL, or takes how far the first thing met inside is, if any is */
    /* NULL, or empty at first: takes the first texel met, whose light is then not in the radiance
     * (orl_gather_read). Who follows many rays has memory answer all of them meanwhile. */
    struct orl_glimpse *ret_glimpse;
};

/* Radiance along it: suns not seen straight; of lamps what its lobe leaves to it. */
struct orl_rgb orl_gather_radiance(const struct orl_gather *gather,
                                   const struct orl_gather_ray *ray, struct orl_random *random,
                                   struct orl_search *search);

/* What such a texel adds to the radiance of the ray, whose tally takes its parts. */
struct orl_rgb orl_gather_read(const struct orl_gather_ray *ray, const struct orl_glimpse *glimpse);

/*
 * The surface at a place that came without its facet; false when there is none within rounding.
 */
bool orl_gather_footing(const struct orl_gather *gather, struct orl_vec3 point,
                        struct orl_vec3 normal, struct orl_footing *ret_footing);

/* The caustic part, by density, for a point of a surface: by k photons, and by as many as are
 * usual. */
struct orl_density orl_gather_caustic_by(const struct orl_gather *gather,
                                         const struct orl_footing *footing, uint32_t k,
                                         struct orl_search *search);
struct orl_density orl_gather_caustic(const struct orl_gather *gather,
                                      const struct orl_footing *footing, struct orl_search *search);

/*
 * The same for views, by a disc no wider than is normal among the photons it has found: in a dark
 * place beside a bright one the nearest are far, and the disc that holds so many would carry the
 * bright one's light over the edge between them.
 */
struct orl_density orl_gather_caustic_seen(const struct orl_gather *gather,
                                           const struct orl_footing *footing,
                                           struct orl_search *search);

/* The first with its bias, for twice the time. */
struct orl_density orl_gather_caustic_with_bias(const struct orl_gather *gather,
                                                const struct orl_footing *footing,
                                                struct orl_search *search);

/*
 * What that density of a radius has too much, by its width, of suns in flat mirrors: their images
 * over its disc, less those at its middle, by points of the Sobol sequence of that name. A control
 * variate: the density less this has only the bias of its other light. found is 0 where nothing is
 * mirrored, or the surface is bent.
 */
struct orl_image_blur {
    struct orl_estimate excess; /* no bias, and errors of the points alone */
    double mean;                /* luma of the images over the disc */
    uint32_t found;             /* points of it */
};
struct orl_image_blur orl_gather_image_blur(const struct orl_gather *gather,
                                            const struct orl_footing *footing, double radius,
                                            uint32_t sequence);

/*
 * The rest at a point of a surface, by density or from records; found is 0 where there are none, or
 * when it is to be gathered.
 */
struct orl_density orl_gather_rest(const struct orl_gather *gather,
                                   const struct orl_footing *footing, struct orl_search *search);

/*
 * The gathered part at a place, by a stratified cosine-weighted hemisphere of rows x columns rays,
 * and more through those strata whose neighbours differ (their own ray has no say, so that the mean
 * stays what it is), with its gradients, the harmonic mean of the rays' lengths (Ward and Heckbert
 * 1992) and the least. Standard errors, of its luma, are the photons' and the rays': of these each
 * is compared with the next in its row, as if both were drawn from both strata (which errs on the
 * high side). known: records made before, or NULL.
 */
enum { ORL_HEMISPHERE_ROWS = 18, ORL_HEMISPHERE_COLUMNS = 56 }; /* at most */
struct orl_hemisphere {
    struct orl_rgb irradiance;
    struct orl_vec3 by_rotation[3], by_translation[3]; /* per channel */
    double mean_distance, least_distance;
    double error_by_photons, error_by_rays;
};
struct orl_hemisphere orl_gather_hemisphere(const struct orl_gather *gather,
                                            const struct orl_place *place, uint32_t rows,
                                            uint32_t columns, const struct orl_icache *known,
                                            struct orl_random *random, struct orl_search *search);

/*
 * Direct light at a place: mean of that many shadow rays per light, the points first, first + 1,
 * ... of the Sobol sequence of that name, so that a pixel's rays can share one. ret_variance is
 * NULL, or takes the mean's, of its luma, as if points fell by chance; of one ray it is 0.
 */
struct orl_rgb orl_gather_direct(const struct orl_gather *gather, const struct orl_place *place,
                                 uint32_t sequence, uint32_t first, uint32_t rays,
                                 double *ret_variance);

/*
 * Where a sensor is. One that lies on a surface has it as its footing, else it is in mid-air.
 */
struct orl_place orl_gather_place(const struct orl_gather *gather, struct orl_vec3 position,
                                  struct orl_vec3 direction, struct orl_footing *ret_footing);

/* Whether caustics are to come to it otherwise than by density: inside, in mid-air, if any are. */
bool orl_gather_catches(const struct orl_gather *gather, const struct orl_place *place);

/*
 * Irradiance of a sensor: all three parts. A sensor on a surface reads caustics by density, less
 * what that has blurred of suns in flat mirrors; where the blur would show and suns' images tell
 * all caustics, its place is as if in mid-air. There, where no photon lands, it takes the sun by
 * points on panes with lobes and by the sun's images in flat mirrors; all other caustics are to be
 * added by air.h. Where the global map shows small patches of much light some more rays are aimed
 * at them (bright.h). The standard error is that of the photons, by their batches, and of the rays,
 * by a few groups of them; what single rays see of the photons' scatter is in both, so that it is
 * on the high side where rays are fewer than leaves.
 */
struct orl_estimate orl_gather_sensor(const struct orl_gather *gather, struct orl_place *place,
                                      const struct orl_footing *footing, uint32_t samples,
                                      uint64_t index, struct orl_search *search);

#endif
