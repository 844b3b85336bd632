/* Arrays of floats as files: Radiance's matrices. */
#include <oriel/annual_report.h>

#include <stdio.h>
#include <string.h>

#include "base/file.h"

static void write_grey(FILE *stream, const float *values, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        const float grey[3] = {values[i], values[i], values[i]};
        fwrite(grey, sizeof *grey, 3, stream);
    }
}

int orl_coefficients_write(const char *path, const float *values, size_t rows, size_t columns,
                           struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fprintf(file.stream,
            "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=3\nBigEndian=%d\nFORMAT=float\n\n", rows,
            columns, big);
    write_grey(file.stream, values, rows * columns);
    return orl_out_close(&file, 0, err);
}

int orl_matrix_write(const char *path, const float *values, size_t rows, size_t columns, bool ascii,
                     struct orl_error *err)
{
    const bool big = __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__;
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    fprintf(file.stream, "#?RADIANCE\nNROWS=%zu\nNCOLS=%zu\nNCOMP=1\n", rows, columns);
    if (!ascii)
        fprintf(file.stream, "BigEndian=%d\n", big);
    fprintf(file.stream, "FORMAT=%s\n\n", ascii ? "ascii" : "float");
    if (!ascii)
        fwrite(values, sizeof *values, rows * columns, file.stream);
    for (size_t i = 0; ascii && i < rows * columns; i++)
        fprintf(file.stream, "%.6g%c", (double)values[i], (i + 1) % columns ? '\t' : '\n');
    return orl_out_close(&file, 0, err);
}
