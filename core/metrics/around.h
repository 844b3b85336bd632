/*
 * Glare of a picture along the lines of sight that settings ask for: the worst by DGP.
 *
 * Lines of sight are turned about the view's up. Of a picture that ends at the hemisphere before
 * its own line a turned one sees less; those of which it holds a fiftieth less than along the
 * view's own are left out, lest the dark beside the picture count as rest for the eye.
 */
#ifndef ORL_METRICS_AROUND_H
#define ORL_METRICS_AROUND_H

#include "metrics/glare.h"

struct orl_panorama {
    const struct orl_view *view;
    uint32_t width, height;
    const float *cd_m2, *mask; /* as many as pixels; mask may be NULL */
    const atomic_bool *cancel; /* borrowed; NULL: never */
};

/* Luminances of a mask, of a picture that has to be so large; owned. Errors are those of
 * orl_hdr_read; ORL_ERR_RANGE: it is not. */
int orl_glare_read_mask(const struct orl_picture_bytes *bytes, uint32_t width, uint32_t height,
                        float **ret_mask, struct orl_error *err);

/* ORL_ERR_UNSUPPORTED, _NOMEM, _CANCELLED. ret_glare is owned; its turned_deg says where one looks.
 */
int orl_glare_around(const struct orl_panorama *panorama, const struct orl_glare_settings *settings,
                     struct orl_glare *ret_glare, struct orl_error *err);

#endif
