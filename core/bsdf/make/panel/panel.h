/*
 * The measured sample: its unit cell, its loading, its mirrors, one path through it, and means over
 * batches of paths.
 */
#ifndef ORL_BSDF_MAKE_PANEL_PANEL_H
#define ORL_BSDF_MAKE_PANEL_PANEL_H

#include <math.h>

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_make.h>

#include "base/sampling/sampling.h"
#include "light/path.h"

/*
 * The unit cell of an endless panel with periodic boundaries: rays that leave by a side enter by
 * the opposite one. Nothing is copied, and nothing outside the cell is hit.
 *
 * Surfaces in a side belong to the cell. Rays end beyond a side by a margin, and enter at the same
 * distance in front of the opposite side. Walls in either side are thus hit, one after the other.
 * The margin is a few times the offset of ray origins from surfaces (orl_hit_ray_origin). The
 * panel's period is too long by the margins only.
 *
 * Moved coordinates (scene/geometry/geometry.h). Immutable.
 */

struct orl_gonio_unit_cell {
    struct orl_vec3 low, high; /* bounds, including margins */
    double margin;
};

/* Makes the cell with these sides in x and y (from, to, from, to), around the geometry in z. */
struct orl_gonio_unit_cell orl_gonio_unit_cell_around(const struct orl_geometry *geometry,
                                                      const double sides[4]);

enum orl_gonio_crossing {
    ORL_GONIO_HIT_SURFACE,
    ORL_GONIO_LEFT_BACK,     /* left towards z < 0 */
    ORL_GONIO_LEFT_FRONT,    /* left towards z > 0 */
    ORL_GONIO_MANY_CROSSINGS /* crossed too many sides */
};

/* Follows the path to the next surface or out of the panel. Its origin becomes the place where it
 * last entered. */
enum orl_gonio_crossing orl_gonio_unit_cell_intersect(const struct orl_gonio_unit_cell *cell,
                                                      const struct orl_lit_scene *lit_scene,
                                                      struct orl_path *path,
                                                      struct orl_hit *ret_hit);

/*
 * The measured sample: a panel read from scene texts, with its unit cell, or a BSDF's file
 * (resample_bsdf.c). Immutable once loaded, shared by all threads.
 */

struct orl_gonio_sample {
    /* A BSDF's file, borrowed; NULL: the sample is a panel. With a file only source and depth are
     * set. */
    const struct orl_bsdf *file;
    const char *source;              /* description of the file; borrowed */
    struct orl_lit_scene *lit_scene; /* owned; without lights */
    struct orl_gonio_unit_cell cell;
    double sides[4], depth[2]; /* extents of the cell without margins, in the files' coordinates */
};

/* A sample, and how it is measured. All pointers are borrowed. */
struct orl_gonio_measurement {
    const struct orl_bsdf_make_request *request; /* its symmetry is not auto */
    const struct orl_bsdf_make_env *env;
    const struct orl_gonio_sample *sample;
    const struct orl_sobol *sobol;
};

/* Loads a panel; errors as for orl_bsdf_make. */
int orl_gonio_sample_load(const struct orl_bsdf_make_request *request,
                          const struct orl_bsdf_make_env *env, struct orl_gonio_sample *ret_sample,
                          struct orl_error *err);
void orl_gonio_sample_done(struct orl_gonio_sample *sample);

/*
 * Detects mirror symmetries of a panel. Random rays in the cell, and their mirror images, must hit
 * the same material on the same side at the same distance. An asymmetry that all rays miss affects
 * less than one in several thousand of the light.
 */

/* Returns the request's symmetry. If it is auto: for trees of rank 4 the mirrors found, otherwise
 * none. */
enum orl_bsdf_symmetry orl_gonio_mirrors_of(const struct orl_bsdf_make_request *request,
                                            const struct orl_gonio_sample *sample);

/*
 * Traces one path of light through the panel. It starts beside the panel, samples its materials,
 * and ends when it leaves, is absorbed, or is cut.
 */

/*
 * Random numbers of a path. The first scatterings use points of a Sobol sequence each, padded by
 * the path's seed (Burley 2020). Later ones use independent random numbers.
 */
struct orl_gonio_sampler {
    const struct orl_sobol *sobol;
    uint32_t index, seed;
    struct orl_random random;
};

/* Returns the random numbers of a path in a stream, and its first four uniforms. */
struct orl_gonio_sampler orl_gonio_sampler_at(const struct orl_gonio_measurement *measurement,
                                              uint64_t stream, uint32_t index, double ret_u[4]);

enum orl_gonio_path_end { ORL_GONIO_PATH_LEFT, ORL_GONIO_PATH_CUT };

struct orl_gonio_exit {
    enum orl_gonio_path_end end;
    bool front;                /* true if it left towards z > 0 */
    struct orl_vec3 direction; /* direction of travel */
    struct orl_rgb weight;     /* weight of a path that started with 1 */
};

/*
 * Traces a path that starts beside the panel, on its front or back, at u in [0,1)^2, and enters it.
 * towards: the direction as for light from the back. Calls on_exit for every end that is not
 * absorption. At clear surfaces the reflected and the transmitted part are both traced while they
 * are strong enough. In clear panels only the place of entry is then random.
 */
typedef void orl_gonio_on_exit(void *ctx, const struct orl_gonio_exit *exit);
void orl_gonio_trace(const struct orl_gonio_sample *sample, bool front, struct orl_vec3 towards,
                     const double u[2], struct orl_gonio_sampler *sampler,
                     orl_gonio_on_exit *on_exit, void *ctx);

enum { ORL_GONIO_BATCHES = ORL_BSDF_MAKE_BATCHES };

/* Returns the variance of the mean of values in independent batches. */
static inline double orl_gonio_batch_variance(const double values[ORL_GONIO_BATCHES])
{
    double sum = 0, squares = 0;
    for (int k = 0; k < ORL_GONIO_BATCHES; k++)
        sum += values[k];
    const double mean = sum / ORL_GONIO_BATCHES;
    for (int k = 0; k < ORL_GONIO_BATCHES; k++)
        squares += (values[k] - mean) * (values[k] - mean);
    return squares / (ORL_GONIO_BATCHES * (ORL_GONIO_BATCHES - 1.0));
}

/* Returns that mean, and its standard error. */
static inline struct orl_bsdf_share orl_gonio_batch_mean(const double values[ORL_GONIO_BATCHES])
{
    double sum = 0;
    for (int k = 0; k < ORL_GONIO_BATCHES; k++)
        sum += values[k];
    return (struct orl_bsdf_share){sum / ORL_GONIO_BATCHES, sqrt(orl_gonio_batch_variance(values))};
}

#endif
