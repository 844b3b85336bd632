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
 * sampled separately (render/image/small_lights.h), and are always found. Before that, with two
 * lamps of a fifth of a pixel and 16 samples per pixel, 1 run in 120 saw none. It gave a small
 * error for a DGP that was 0.06 too low. Small sources seen in mirrors, and skies between slats,
 * are still left to chance.
 *
 * At most ORL_VIEW_BATCHES are kept. When they are full, neighbours are merged, so that there are
 * always at least half as many. Threads: the lead's only.
 */
#ifndef ORL_METRICS_VIEW_BATCHES_H
#define ORL_METRICS_VIEW_BATCHES_H

#include "metrics/worst_direction.h"

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
