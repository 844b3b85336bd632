/*
 * Films of independent batches of a view's samples, and what they tell of the error of its glare.
 *
 * Every batch is a picture by itself, with so much effort; together they are the view. Each metric
 * is worked out once more without every batch in turn (a jackknife by groups of unequal size:
 * Busing, Meijer and van der Leeden 1999, Statistics and Computing 9, 3): from how far these lie
 * apart comes its standard error, and from their mean its bias, which noise makes: thresholds are
 * passed by pixels that are bright by chance. Values are those of the view as it is, and are not
 * corrected; their intervals are wide enough for a bias of that size (base/estimate.h).
 *
 * A source that no sample has met is in neither. Suns and small lamps that are seen straight are
 * drawn by rays of their own (render/image/discs.h), and met in any case: of two lamps of a fifth
 * of a pixel, 16 samples a pixel, 1 run in 120 saw none before, and was sure of a DGP that was 0.06
 * too low. What is small in mirrors, and skies between slats, is left to chance.
 *
 * No more than ORL_VIEW_BATCHES are kept: when there is no room, neighbours become one, so that
 * there are always half as many at least. Threads: the lead's only.
 */
#ifndef ORL_METRICS_VIEW_BATCHES_H
#define ORL_METRICS_VIEW_BATCHES_H

#include "metrics/around.h"

enum { ORL_VIEW_BATCHES = 16 };

struct orl_view_batches { /* zero at first */
    size_t pixels;
    uint32_t count;
    float *cd_m2[ORL_VIEW_BATCHES]; /* owned */
    double effort[ORL_VIEW_BATCHES];
};

/* Takes a batch's film. All have the same size. ORL_ERR_NOMEM. */
int orl_view_batches_add(struct orl_view_batches *batches, const struct orl_film *film,
                         double effort, struct orl_error *err);
void orl_view_batches_done(struct orl_view_batches *batches);

/* Fills in standard errors, intervals and the class of what was found in the whole view. panorama
 * and settings as there; its own luminances and mask are not looked at. Of fewer than two batches
 * nothing is known. ORL_ERR_NOMEM, ORL_ERR_CANCELLED. */
int orl_glare_errors(const struct orl_view_batches *batches, const struct orl_panorama *panorama,
                     const struct orl_glare_settings *settings, struct orl_glare *glare,
                     struct orl_error *err);

#endif
