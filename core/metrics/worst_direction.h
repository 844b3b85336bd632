/*
 * Glare of a picture along several lines of sight; the result is the worst by DGP.
 *
 * Lines of sight are rotated about the view's up. If a picture ends at the hemisphere before its
 * own line of sight, a rotated one covers less of the field of view. Lines of sight that cover 2 %
 * less than the view's own are left out, since the dark area outside the picture would lower the
 * glare.
 */
#ifndef ORL_METRICS_WORST_DIRECTION_H
#define ORL_METRICS_WORST_DIRECTION_H

#include "metrics/glare.h"

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

#endif
