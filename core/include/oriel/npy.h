/*
 * Arrays of numbers as NumPy keeps them: NPY, format 1.0, float32, little-endian, row by row.
 * Source: NumPy's documentation, numpy.lib.format.
 *
 * Files are whole or absent. Returns 0, ORL_ERR_IO, ORL_ERR_FULL, ORL_ERR_LIMIT.
 */
#ifndef ORIEL_NPY_H
#define ORIEL_NPY_H

#include <stddef.h>

#include <oriel/crew.h>
#include <oriel/error.h>

/* cancel: polled while writing; or NULL. columns 0: an array of one dimension, of so many rows. */
int orl_npy_write(const char *path, const float *values, size_t rows, size_t columns,
                  const atomic_bool *cancel, struct orl_error *err);

#endif
