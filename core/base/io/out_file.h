/*
 * Output files that are whole or absent (path.part, sync, rename), and arrays in NumPy's format.
 * Devices and pipes, such as /dev/stdout, are written to directly.
 */
#ifndef ORL_BASE_IO_OUT_FILE_H
#define ORL_BASE_IO_OUT_FILE_H

#include <stddef.h>
#include <stdio.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>

struct orl_out_file {
    FILE *stream;
    const atomic_bool *cancel; /* set by the caller after opening; or NULL */
    char path[4096], part[4104];
};

int orl_out_open(struct orl_out_file *file, const char *path, struct orl_error *err);
/* Returns false once the file's cancel flag is set, so that long loops of writes can end. */
bool orl_out_continues(const struct orl_out_file *file);
/* Writes a comma and the number, or only the comma if it is not finite. */
void orl_out_number(FILE *stream, double value);
/* Writes n floats, and polls the cancel flag between chunks. */
void orl_out_floats(const struct orl_out_file *file, const float *values, size_t n);
/* Commits the file if code is 0 and it is not cancelled; otherwise removes it. Returns code,
 * ORL_ERR_CANCELLED, or ORL_ERR_IO if the commit failed. */
int orl_out_close(struct orl_out_file *file, int code, struct orl_error *err);

/* Closes a stream of open_memstream. Returns true if all of the text was written; otherwise frees
 * the text. */
bool orl_memstream_close(FILE *stream, char **text);

/*
 * Writes arrays in NumPy's format: NPY 1.0, float32, little-endian, row by row. Source: NumPy's
 * documentation, numpy.lib.format.
 */

/* Writes an array; on errors no file is left. columns 0: a one-dimensional array of `rows` numbers.
 * cancel is polled while writing; may be NULL. Returns 0, ORL_ERR_IO, ORL_ERR_FULL or
 * ORL_ERR_LIMIT, and ORL_ERR_CANCELLED once *cancel is set. */
int orl_npy_write(const char *path, const float *values, size_t rows, size_t columns,
                  const atomic_bool *cancel, struct orl_error *err);

#endif
