/* Writes arrays of floats as NPY files. */
#include <oriel/base/npy.h>

#include <stdio.h>
#include <string.h>

#include "base/io/out_file.h"

/* The format requires a header length that is a multiple of 64 bytes, padded with spaces. */
static void write_npy_header(FILE *stream, size_t rows, size_t columns)
{
    enum { ALIGN = 64, FIXED = 10 };
    char text[160], more[32] = "";
    if (columns > 0)
        snprintf(more, sizeof more, " %zu", columns);
    const int length =
        snprintf(text, sizeof text, "{'descr': '<f4', 'fortran_order': False, 'shape': (%zu,%s), }",
                 rows, more);
    const size_t whole = ((size_t)length + 1 + FIXED + ALIGN - 1) / ALIGN * ALIGN;
    const unsigned char start[FIXED] = {0x93,
                                        'N',
                                        'U',
                                        'M',
                                        'P',
                                        'Y',
                                        1,
                                        0,
                                        (unsigned char)((whole - FIXED) & 0xff),
                                        (unsigned char)((whole - FIXED) >> 8)};
    fwrite(start, 1, sizeof start, stream);
    fputs(text, stream);
    for (size_t i = FIXED + (size_t)length; i + 1 < whole; i++)
        fputc(' ', stream);
    fputc('\n', stream);
}

static void write_little(const struct orl_out_file *file, const float *values, size_t n)
{
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    orl_out_floats(file, values, n);
#else
    for (size_t i = 0; i < n; i++) {
        unsigned char bytes[4], turned[4];
        memcpy(bytes, &values[i], 4);
        for (int k = 0; k < 4; k++)
            turned[k] = bytes[3 - k];
        fwrite(turned, 1, 4, file->stream);
    }
#endif
}

int orl_npy_write(const char *path, const float *values, size_t rows, size_t columns,
                  const atomic_bool *cancel, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    const int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    file.cancel = cancel;
    write_npy_header(file.stream, rows, columns);
    write_little(&file, values, columns > 0 ? rows * columns : rows);
    return orl_out_close(&file, 0, err);
}
