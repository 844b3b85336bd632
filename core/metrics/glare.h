/* Glare of a view: one line of sight, the worst of several, and errors from batches of samples. */
#ifndef ORL_METRICS_GLARE_H
#define ORL_METRICS_GLARE_H

#include "metrics/glare_sources.h"
#include "render/film/film.h"

/*
 * Evaluation of the luminances of a view for one line of sight: threshold, sources, and indices,
 * the results of oriel/job/glare.h.
 *
 * glare_sources.h defines the pixels that count and their weights. The illuminance at the eye is
 * the sum of luminance times solid angle and cosine over the field. A view smaller than the
 * hemisphere lacks the light from outside; settings->eye_lx can supply it, as evalglare's -i.
 *
 * Standard errors and intervals are left as unknown, and the class is that of the value;
 * orl_glare_errors computes them.
 */

/* Returns the luminances of a film, cd/m2; owned. NULL: out of memory. */
float *orl_film_luminances(const struct orl_film *film);

/* Evaluates a picture. mask: luminances of a mask, one per pixel, or NULL. ret_glare is owned.
 * Returns 0, ORL_ERR_NOMEM, _CANCELLED, or ORL_ERR_RANGE (the task lies outside, or luminances are
 * out of range). */
int orl_glare_evaluate(const struct orl_luminances *picture, const float *mask,
                       const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                       struct orl_error *err);

/* A disc that the view may show, such as the sun's. */
struct orl_glare_disc {
    struct orl_vec3 direction; /* unit, scene axes */
    double solid_angle_sr;
};

/*
 * Sets sharper_dgp and blurred_pixels: DGP if sources of few pixels had their own solid angle. A
 * source at one of the discs has at most that disc's; others are taken to be as bright as their
 * brightest pixel if that is 10^6 cd/m2 or more. orl_glare_evaluate does so without discs. Returns
 * 0 or ORL_ERR_NOMEM.
 */
int orl_glare_sharpen(const struct orl_glare_settings *settings, const struct orl_glare_disc *discs,
                      size_t n_discs, struct orl_glare *glare, struct orl_error *err);

/* Checks everything that needs no pixels: settings, a view with an eye and enough of a field. */
int orl_glare_view_check(const struct orl_view *view, const struct orl_glare_settings *settings,
                         struct orl_error *err);

/* Returns the class by the bounds 0.35, 0.40 and 0.45; undecided if the interval is known and
 * contains a bound. */
enum orl_glare_class orl_glare_class_of(const struct orl_glare_value *dgp);

/*
 * Glare of a picture along several lines of sight; the result is the worst by DGP.
 *
 * Lines of sight are rotated about the view's up. If a picture ends at the hemisphere before its
 * own line of sight, a rotated one covers less of the field of view. Lines of sight that cover 2 %
 * less than the view's own are left out, since the dark area outside the picture would lower the
 * glare.
 */

struct orl_glare_picture {
    const struct orl_view *view;
    uint32_t width, height;
    const float *cd_m2, *mask; /* one per pixel; mask may be NULL */
    const atomic_bool *cancel; /* borrowed; may be NULL */
};

/* Reads the luminances of a mask, which must have that size; *ret_mask is owned. Errors are those
 * of orl_hdr_read; ORL_ERR_RANGE for another size. */
int orl_glare_read_mask(const struct orl_picture_bytes *bytes, uint32_t width, uint32_t height,
                        float **ret_mask, struct orl_error *err);

/* Evaluates the glare. Returns 0, ORL_ERR_UNSUPPORTED, _NOMEM or _CANCELLED. ret_glare is owned;
 * its turned_deg gives the worst line of sight. */
int orl_glare_worst_direction(const struct orl_glare_picture *glare_picture,
                              const struct orl_glare_settings *settings,
                              struct orl_glare *ret_glare, struct orl_error *err);

/*
 * Independent batches of a view's samples, for the errors of its glare metrics.
 *
 * Every batch is a separate picture with a weight (effort); together they are the view. Each metric
 * is computed again without each batch in turn (a jackknife with groups of unequal size: Busing,
 * Meijer and van der Leeden 1999, Statistics and Computing 9, 3). The spread of these values gives
 * the standard error, and their mean gives the bias. The bias is due to noise, since some pixels
 * pass a threshold by chance. Values are those of the whole view, and are not corrected; their
 * intervals are wide enough for a bias of that size (base/statistics/estimate.h).
 *
 * Neither includes a source that no sample has found. Suns and small lamps seen directly are
 * sampled separately (render/image/small_lights.c), and are always found. Before that, with two
 * lamps of a fifth of a pixel and 16 samples per pixel, 1 run in 120 saw none. It gave a small
 * error for a DGP that was 0.06 too low. Small sources seen in mirrors, and skies between slats,
 * are still left to chance.
 *
 * At most ORL_VIEW_BATCHES are stored. When they are full, neighbours are merged, so that there are
 * always at least half as many. Threads: one thread only.
 */

enum { ORL_VIEW_BATCHES = 16 };

struct orl_view_batches { /* zero at first */
    size_t pixels;
    uint32_t count;
    float *cd_m2[ORL_VIEW_BATCHES]; /* luminances, cd/m2; owned */
    double weight[ORL_VIEW_BATCHES];
};

/* Adds the film of a batch. All films have the same size. Returns 0 or ORL_ERR_NOMEM. */
int orl_view_batches_add(struct orl_view_batches *batches, const struct orl_film *film,
                         double weight, struct orl_error *err);
void orl_view_batches_done(struct orl_view_batches *batches);

/* Fills standard errors, intervals and the class of the whole view's result. panorama and settings
 * are those of that result; the panorama's luminances and mask are not used. With fewer than two
 * batches the errors stay unknown. Returns 0, ORL_ERR_NOMEM or ORL_ERR_CANCELLED. */
int orl_glare_errors(const struct orl_view_batches *batches,
                     const struct orl_glare_picture *glare_picture,
                     const struct orl_glare_settings *settings, struct orl_glare *glare,
                     struct orl_error *err);

#endif
