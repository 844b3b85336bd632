/* A year by matrices that others made. */
#ifndef ORL_ANNUAL_MATRICES_IMPORTED_MATRICES_H
#define ORL_ANNUAL_MATRICES_IMPORTED_MATRICES_H

#include <stddef.h>

#include <oriel/annual/annual.h>
#include <oriel/base/error.h>

/*
 * Radiance's matrix files, as rfluxmtx, rcontrib, gendaymtx, dctimestep and rmtxop write them. A
 * file starts with "#?RADIANCE". Its header has NROWS, NCOLS, NCOMP (3, or 1 for grey),
 * FORMAT=ascii, float or double, BigEndian and EXPOSURE. After an empty line follow the values row
 * by row. NROWS may be missing; it then follows from the size. Picture formats are not supported.
 */

struct orl_rgb_matrix {
    size_t rows, columns;
    float *values; /* [row][column][3]; owned */
};

/* Allocates a matrix of zeros. Returns 0 or ORL_ERR_NOMEM. */
int orl_rgb_matrix_init(struct orl_rgb_matrix *matrix, size_t rows, size_t columns,
                        struct orl_error *err);
/* Parses a file. Returns 0 or ORL_ERR_SYNTAX, _RANGE (sizes or values that are not finite),
 * _UNSUPPORTED (another format), _LIMIT or _NOMEM. err names the file, and the line for text. */
int orl_rgb_matrix_read(const char *name, const char *text, size_t size,
                        struct orl_rgb_matrix *ret_matrix, struct orl_error *err);
void orl_rgb_matrix_done(struct orl_rgb_matrix *matrix); /* zeros are allowed */

struct orl_thread_pool;
/* Computes a times b, by channel, on the thread pool. Sizes must match. Returns 0, ORL_ERR_NOMEM or
 * _CANCELLED. */
int orl_rgb_matrix_multiply(const struct orl_rgb_matrix *a, const struct orl_rgb_matrix *b,
                            struct orl_thread_pool *pool, struct orl_rgb_matrix *ret_product,
                            struct orl_error *err);

/* Returns the term's grid. If the term names no grid, fills room with all sensors and returns it.
 * Returns NULL if the named grid does not exist. */
const struct orl_annual_grid *orl_matrix_term_grid(const struct orl_annual_request *request,
                                                   const struct orl_matrix_term *term,
                                                   struct orl_annual_grid *room);

/* Does what orl_annual_run does, for a request that names matrices: light is the sum of products;
 * direct sunlight alone is computed by Oriel. Rows are not delivered one by one. */
int orl_annual_run_matrices(const struct orl_annual_request *request,
                            const struct orl_annual_env *env, struct orl_annual_result *ret_result,
                            struct orl_error *err);

#endif
