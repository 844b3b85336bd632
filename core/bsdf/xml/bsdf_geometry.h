/*
 * The sample of material in a BSDF file: its size and geometry, if the file has them. Streamed with
 * expat like the data (xml.c); a document type declaration is refused.
 */
#ifndef ORL_BSDF_XML_BSDF_GEOMETRY_H
#define ORL_BSDF_XML_BSDF_GEOMETRY_H

#include <stddef.h>

#include <oriel/base/error.h>

struct orl_bsdf_geometry {
    double width, height, thickness; /* m; 0 when not given */
    char *geometry;                  /* MGF, owned; NULL for none */
    size_t geometry_size;
    double geometry_unit; /* unit of its lengths, m */
    int geometry_line;    /* line of the file at which it begins */
};

/* Reads the file's first layer. Returns 0 or ORL_ERR_SYNTAX, _UNSUPPORTED (geometry that is not
 * MGF), _RANGE (sizes), _NOMEM, with file and line. Free ret_piece with orl_bsdf_geometry_done. */
int orl_bsdf_geometry_read(const char *name, const char *xml, size_t size,
                           struct orl_bsdf_geometry *ret_geometry, struct orl_error *err);
void orl_bsdf_geometry_done(struct orl_bsdf_geometry *piece);

#endif
