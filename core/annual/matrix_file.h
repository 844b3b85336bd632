/*
 * Radiance's matrices as files, as rfluxmtx, rcontrib, gendaymtx, dctimestep and rmtxop write them:
 * "#?RADIANCE", lines of a header with NROWS, NCOLS, NCOMP (3, or 1: grey), FORMAT=ascii, float or
 * double, BigEndian and EXPOSURE, an empty line, and values row after row. NROWS may be missing:
 * the size tells it then. Pictures are no matrices here.
 */
#ifndef ORL_ANNUAL_MATRIX_FILE_H
#define ORL_ANNUAL_MATRIX_FILE_H

#include <stddef.h>

#include <oriel/error.h>

struct orl_rgb_matrix {
    size_t rows, columns;
    float *values; /* [row][column][3]; owned */
};

/* ORL_ERR_NOMEM. All are 0. */
int orl_rgb_matrix_init(struct orl_rgb_matrix *matrix, size_t rows, size_t columns,
                        struct orl_error *err);
/* ORL_ERR_SYNTAX, _RANGE (sizes, what is not finite), _UNSUPPORTED (another format), _LIMIT,
 * _NOMEM, with file, and line as far as there are lines. */
int orl_rgb_matrix_read(const char *name, const char *text, size_t size,
                        struct orl_rgb_matrix *ret_matrix, struct orl_error *err);
void orl_rgb_matrix_done(struct orl_rgb_matrix *matrix); /* zeros are fine */

/* a times b, by channel, by the crew. ORL_ERR_NOMEM, _CANCELLED; sizes must fit. */
struct orl_crew;
int orl_rgb_matrix_multiply(const struct orl_rgb_matrix *a, const struct orl_rgb_matrix *b,
                            struct orl_crew *crew, struct orl_rgb_matrix *ret_product,
                            struct orl_error *err);

#endif
