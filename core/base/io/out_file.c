#include "base/io/out_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>

/* Devices and pipes, such as /dev/null and /dev/stdout, are written to but never replaced. */
static bool is_replaced(const char *path)
{
    struct stat info;
    return stat(path, &info) != 0 || S_ISREG(info.st_mode) || S_ISDIR(info.st_mode);
}

int orl_out_open(struct orl_out_file *file, const char *path, struct orl_error *err)
{
    const int length = snprintf(file->path, sizeof file->path, "%s", path);
    if (length < 0 || (size_t)length >= sizeof file->path)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path '%s' is too long", path);
    file->cancel = NULL;
    snprintf(file->part, sizeof file->part, "%s%s", file->path, is_replaced(path) ? ".part" : "");
    file->stream = strcmp(file->part, file->path) != 0 ? orl_fopen_regular(file->part, 'w')
                                                       : orl_fopen_device(file->path);
    if (!file->stream)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot create '%s': %s", file->part,
                             orl_open_reason(errno));
    return 0;
}

bool orl_out_continues(const struct orl_out_file *file)
{
    return !orl_is_cancelled(file->cancel);
}

void orl_out_number(FILE *stream, double value)
{
    if (isfinite(value))
        fprintf(stream, ",%.6g", value);
    else
        fputc(',', stream);
}

void orl_out_floats(const struct orl_out_file *file, const float *values, size_t n)
{
    enum { BLOCK = 1 << 20 };
    for (size_t at = 0; at < n && orl_out_continues(file); at += BLOCK)
        fwrite(values + at, sizeof *values, n - at < BLOCK ? n - at : BLOCK, file->stream);
}

/* Syncs a large file step by step, so that a cancel does not wait for all of it. */
static void sync_in_steps(const struct orl_out_file *file)
{
    enum { STEP = 32 << 20 };
    const int fd = fileno(file->stream);
    const unsigned whole =
        SYNC_FILE_RANGE_WAIT_BEFORE | SYNC_FILE_RANGE_WRITE | SYNC_FILE_RANGE_WAIT_AFTER;
    const off_t size = lseek(fd, 0, SEEK_END);
    for (off_t at = 0; file->cancel && at + STEP < size && orl_out_continues(file); at += STEP)
        if (sync_file_range(fd, at, STEP, whole) != 0)
            return; /* the final fsync reports the error */
}

int orl_out_close(struct orl_out_file *file, int code, struct orl_error *err)
{
    const bool replaces = strcmp(file->part, file->path) != 0;
    int why = 0;
    if (code == 0 && replaces && fflush(file->stream) == 0)
        sync_in_steps(file);
    if (code == 0 && !orl_out_continues(file))
        code = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while writing a file");
    if (code == 0 && (fflush(file->stream) != 0 || ferror(file->stream) ||
                      (replaces && fsync(fileno(file->stream)) != 0)))
        why = errno ? errno : EIO;
    if (fclose(file->stream) != 0 && why == 0)
        why = errno;
    if (code == 0 && why == 0 && replaces && rename(file->part, file->path) != 0)
        why = errno;
    if (code == 0 && why != 0)
        code = orl_error_set(err, orl_err_of_errno(why), "cannot write '%s': %s", file->path,
                             strerror(why));
    if (code < 0 && replaces)
        unlink(file->part);
    return code;
}

bool orl_memstream_close(FILE *stream, char **text)
{
    const bool fine = !ferror(stream);
    if (fclose(stream) == 0 && fine)
        return true;
    free(*text);
    *text = NULL;
    return false;
}

/* ---- NPY files ------------------------------------------------------------------------------- */

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
    const unsigned char size[2] = {(unsigned char)((whole - FIXED) & 0xff),
                                   (unsigned char)((whole - FIXED) >> 8)};
    fwrite("\x93NUMPY\1", 1, FIXED - sizeof size, stream);
    fwrite(size, 1, sizeof size, stream);
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
