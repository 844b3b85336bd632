/*
 * BSDF XML for other folders: the sample's size and geometry, and the writer. The reader of data is
 * orl_document_read (document.h).
 */
#ifndef ORL_BSDF_XML_BSDF_XML_H
#define ORL_BSDF_XML_BSDF_XML_H

#include <stddef.h>
#include <stdio.h>

#include <oriel/base/error.h>

#include "bsdf/document.h"

/*
 * The sample of material in a BSDF file: its size and geometry, if the file has them. Streamed with
 * expat like the data (xml.c); a document type declaration is refused.
 */

struct orl_bsdf_geometry {
    double width, height, thickness; /* m; 0 when not given */
    char *geometry;                  /* MGF, owned; NULL for none */
    size_t geometry_size;
    double geometry_unit; /* unit of its lengths, m */
    int geometry_line;    /* line of the file at which it begins */
};

/* Reads the file's first layer. Returns 0 or ORL_ERR_SYNTAX, _UNSUPPORTED (geometry that is not
 * MGF), _RANGE (sizes) or _NOMEM, with file and line. Free the result with
 * orl_bsdf_geometry_done. */
int orl_bsdf_geometry_read(const char *name, const char *xml, size_t size,
                           struct orl_bsdf_geometry *ret_geometry, struct orl_error *err);
void orl_bsdf_geometry_done(struct orl_bsdf_geometry *geometry);

/*
 * Writer of BSDF XML in the WINDOW schema, the counterpart of xml.c; values read back are equal to
 * the last bit. Luminance is "Visible". Colour is written as in Radiance: CIE X and Z for matrices,
 * u' and v' for trees.
 *
 * The document is in the state before its colour is turned into tints: both orl_chroma.given are
 * set, and orl_chroma.matrix has X and Z of matrices. Parts that are not present are not written.
 * Trees are written by the caller's write_part, because callers hold them in other forms. A matrix
 * must have one standard basis for both directions, as readers of the schema expect.
 */

/* Luminance, then X and Z or u' and v'. */
enum orl_bsdf_channel {
    ORL_CHANNEL_VISIBLE,
    ORL_CHANNEL_FIRST,
    ORL_CHANNEL_SECOND,
    ORL_CHANNEL_COUNT
};

/* Writes the braces of a part's tree. */
typedef void orl_bsdf_write_part(void *ctx, enum orl_component_kind part,
                                 enum orl_bsdf_channel channel, FILE *out);

/* Contents of a file beside data, name and thickness. */
struct orl_bsdf_labels {
    const char *manufacturer;
    double width_m, height_m;        /* 0: not written */
    const char *comment;             /* text on how the data were made, any lines; NULL: none */
    orl_bsdf_write_part *write_part; /* for trees; called with ctx for each part present */
    void *ctx;
};

/* Writes the document. Check the stream for errors afterwards (ferror). */
void orl_document_write(const struct orl_document *document, const struct orl_bsdf_labels *labels,
                        FILE *out);

/* Writes the document to a text that the caller frees. Returns 0 or ORL_ERR_NOMEM. */
int orl_document_write_text(const struct orl_document *document,
                            const struct orl_bsdf_labels *labels, char **ret_text,
                            size_t *ret_size);

/* Writes the shortest number that is read back as that value, at most 15 bytes. */
void orl_write_value(FILE *out, float value);

#endif
