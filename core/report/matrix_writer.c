/* Writes arrays of floats as Radiance matrix files. */
#include <oriel/annual/annual_report.h>

#include <stdio.h>
#include <string.h>

#include "base/io/out_file.h"

/* Writes each value as three equal components, block by block. */
static void write_grey(const struct orl_out_file *file, const float *values, size_t n)
{
    enum { CHUNK = 4096 };
    float grey[3 * CHUNK];
    for (size_t at = 0; at < n && orl_out_continues(file); at += CHUNK) {
        const size_t count = n - at < CHUNK ? n - at : CHUNK;
        for (size_t i = 0; i < count; i++)
            grey[3 * i] = grey[3 * i + 1] = grey[3 * i + 2] = values[at + i];
        fwrite(grey, sizeof *grey, 3 * count, file->stream);
    }
}

static void write_ascii(const struct orl_out_file *file, const float *values, size_t rows,
                        size_t columns)
{
    for (size_t r = 0; r < rows && orl_out_continues(file); r++)
        for (size_t c = 0; c < columns; c++)
            fprintf(file->stream, "%.6g%c", (double)values[r * columns + c],
                    c + 1 < columns ? '\t' : '\n');
}

int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           const atomic_bool *cancel, struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fprintf(file.stream,
            "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=3\nBigEndian=%d\nFORMAT=float\n\n", rows,
            columns, big);
    write_grey(&file, values, rows * columns);
    return orl_out_close(&file, 0, err);
}

int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     const atomic_bool *cancel, struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    fprintf(file.stream, "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=1\n", rows, columns);
    if (!ascii)
        fprintf(file.stream, "BigEndian=%d\n", big);
    fprintf(file.stream, "FORMAT=%s\n\n", ascii ? "ascii" : "float");
    if (ascii)
        write_ascii(&file, values, rows, columns);
    else
        orl_out_floats(&file, values, rows * columns);
    return orl_out_close(&file, 0, err);
}
