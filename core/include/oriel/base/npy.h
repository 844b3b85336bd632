/*
 * Writes arrays in NumPy's format: NPY 1.0, float32, little-endian, row by row. Source: NumPy's
 * documentation, numpy.lib.format.
 */
#ifndef ORIEL_BASE_NPY_H
#define ORIEL_BASE_NPY_H

#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>

/* Writes an array; on errors no file is left. columns 0: a one-dimensional array of `rows` numbers.
 * cancel is polled while writing; may be NULL. Returns 0, ORL_ERR_IO, ORL_ERR_FULL or
 * ORL_ERR_LIMIT, and ORL_ERR_CANCELLED once *cancel is set. */
int orl_npy_write(const char *path, const float *values, size_t rows, size_t columns,
                  const atomic_bool *cancel, struct orl_error *err);

#endif
