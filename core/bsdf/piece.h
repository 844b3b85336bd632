/*
 * The piece of material that a BSDF file is of: how large, and its geometry, where the file says.
 * Streamed with expat like the data themselves (xml.c); a document type declaration is refused.
 */
#ifndef ORL_BSDF_PIECE_H
#define ORL_BSDF_PIECE_H

#include <stddef.h>

#include <oriel/error.h>

struct orl_bsdf_piece {
    double width, height, thickness; /* m; 0 when not given */
    char *geometry;                  /* MGF, owned; NULL for none */
    size_t geometry_size;
    double geometry_unit; /* of its lengths, m */
    int geometry_line;    /* of the file, at which it begins */
};

/* Of the file's first layer. ORL_ERR_SYNTAX, _UNSUPPORTED (geometry that is no MGF), _RANGE
 * (sizes), _NOMEM, with file and line. ret_piece is to be passed to orl_bsdf_piece_done. */
int orl_bsdf_piece_read(const char *name, const char *xml, size_t size,
                        struct orl_bsdf_piece *ret_piece, struct orl_error *err);
void orl_bsdf_piece_done(struct orl_bsdf_piece *piece);

#endif
