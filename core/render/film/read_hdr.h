/*
 * Reads Radiance pictures into films (base/io/rgbe.h).
 *
 * The header's EXPOSUREs and COLORCORRs are divided out, so that pixels are W/sr/m2 again. The last
 * VIEW line is the picture's. XYZE is rejected. The input may be hostile.
 */
#ifndef ORL_RENDER_FILM_READ_HDR_H
#define ORL_RENDER_FILM_READ_HDR_H

#include <stdbool.h>
#include <stddef.h>

#include "render/film/film.h"

struct orl_hdr_picture {
    struct orl_film film; /* errors are unknown */
    struct orl_view view; /* valid if has_view */
    bool has_view;
};

/* Reads a picture. Returns 0 or ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT, _RANGE (an impossible view)
 * or _NOMEM, with the name in err. The caller releases the picture. */
int orl_hdr_read(const char *name, const void *data, size_t size,
                 struct orl_hdr_picture *ret_picture, struct orl_error *err);
void orl_hdr_done(struct orl_hdr_picture *picture);

#endif
