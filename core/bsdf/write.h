/*
 * BSDF XML written in the WINDOW schema, the counterpart of xml.h: what is read of it is what was
 * written, to the last bit. Luminance is "Visible"; colour stands beside it as Radiance has it, CIE
 * X and Z of matrices, u' and v' of trees.
 *
 * A document as it is before its colour is turned into tints: orl_chroma.given says of both that
 * they are there, and orl_chroma.matrix has X and Z of matrices. Parts that are not present are not
 * written. Trees are their makers' to write, who have them in other forms. Only one basis of both
 * directions is known to the schema's readers, one of the standard ones.
 */
#ifndef ORL_BSDF_WRITE_H
#define ORL_BSDF_WRITE_H

#include <stdio.h>

#include "bsdf/document.h"

/* Luminance, then X and Z or u' and v'. */
enum orl_bsdf_channel {
    ORL_CHANNEL_VISIBLE,
    ORL_CHANNEL_FIRST,
    ORL_CHANNEL_SECOND,
    ORL_CHANNEL_COUNT
};

/* The braces of a part's tree. */
typedef void orl_bsdf_write_part(void *ctx, enum orl_bsdf_part part, enum orl_bsdf_channel channel,
                                 FILE *out);

/* What a file says beside data, name and thickness. */
struct orl_bsdf_labels {
    const char *manufacturer;
    double width_m, height_m;        /* 0: not told */
    const char *comment;             /* of how it was made; any text, lines and all; NULL: none */
    orl_bsdf_write_part *write_part; /* of trees, with ctx: writes the data of those present */
    void *ctx;
};

/* Whether it could be written is for the stream to say (ferror). */
void orl_document_write(const struct orl_document *document, const struct orl_bsdf_labels *labels,
                        FILE *out);

/* The shortest number that is read as that value again, and nothing longer than 15 bytes. */
void orl_write_value(FILE *out, float value);

/* The data of one channel: write_values.c. */
void orl_bsdf_write_matrix(const struct orl_matrix *matrix, FILE *out);

#endif
