/*
 * Radiance pictures read into films (base/rgbe.h).
 *
 * The header's EXPOSUREs and COLORCORRs are divided out, so that pixels are W/sr/m2 again. The last
 * VIEW line is the picture's. XYZE is refused. Bytes may be anybody's.
 */
#ifndef ORL_RENDER_FILM_READ_HDR_H
#define ORL_RENDER_FILM_READ_HDR_H

#include <stdbool.h>
#include <stddef.h>

#include "render/film/film.h"

struct orl_hdr_picture {
    struct orl_film film; /* errors are not known */
    struct orl_view view; /* where has_view */
    bool has_view;
};

/* ORL_ERR_SYNTAX, _UNSUPPORTED, _LIMIT, _RANGE (a view that cannot be), _NOMEM, with the name in
 * err. The picture is the caller's to release. */
int orl_hdr_read(const char *name, const void *data, size_t size,
                 struct orl_hdr_picture *ret_picture, struct orl_error *err);
void orl_hdr_done(struct orl_hdr_picture *picture);

#endif
