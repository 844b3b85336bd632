/* Glare of Radiance pictures. */
#include <stdlib.h>

#include "metrics/worst_direction.h"
#include "render/film/read_hdr.h"

int orl_glare_read_mask(const struct orl_picture_bytes *bytes, uint32_t width, uint32_t height,
                        float **ret_mask, struct orl_error *err)
{
    struct orl_hdr_picture mask = {0};
    int code = orl_hdr_read(bytes->name, bytes->data, bytes->size, &mask, err);
    if (code == 0 && (mask.film.width != width || mask.film.height != height)) {
        code = orl_error_set(err, ORL_ERR_RANGE, "the mask has %u x %u pixels, the picture %u x %u",
                             mask.film.width, mask.film.height, width, height);
        orl_error_at(err, bytes->name, 0, NULL);
    }
    if (code == 0) {
        *ret_mask = orl_film_luminances(&mask.film);
        if (!*ret_mask)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a mask");
    }
    orl_hdr_done(&mask);
    return code;
}

static int evaluate_picture(const struct orl_hdr_picture *picture,
                            const struct orl_picture_bytes *mask,
                            const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                            struct orl_error *err)
{
    float *cd_m2 = orl_film_luminances(&picture->film), *masked = NULL;
    int code = cd_m2 ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for luminances");
    if (code == 0 && mask)
        code = orl_glare_read_mask(mask, picture->film.width, picture->film.height, &masked, err);
    const struct orl_glare_picture glare_picture = {
        &picture->view, picture->film.width, picture->film.height, cd_m2, masked, NULL};
    if (code == 0)
        code = orl_glare_worst_direction(&glare_picture, settings, ret_glare, err);
    free(cd_m2);
    free(masked);
    return code;
}

int orl_glare_of_picture(const struct orl_picture_bytes *picture, const char *view,
                         const struct orl_picture_bytes *mask,
                         const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                         struct orl_error *err)
{
    struct orl_hdr_picture hdr = {0};
    int code = orl_glare_settings_check(settings, err);
    if (code == 0)
        code = orl_hdr_read(picture->name, picture->data, picture->size, &hdr, err);
    if (code < 0)
        return code;
    if (view)
        code = orl_view_parse(view, &hdr.view, err);
    else if (!hdr.has_view) {
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the picture has no VIEW line");
        orl_error_at(err, picture->name, 0, NULL);
        orl_error_hint(err, "Give its view, such as -vta -vh 180 -vv 180");
    }
    if (code == 0)
        code = evaluate_picture(&hdr, mask, settings, ret_glare, err);
    orl_hdr_done(&hdr);
    return code;
}
