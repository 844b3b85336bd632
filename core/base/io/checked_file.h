/*
 * Checksummed cache files: a struct image that one process writes and later ones map. They consist
 * of a header of 128 bytes and a body defined by the file's kind.
 *
 * Files are for the machine that wrote them. Opening returns ORL_ERR_VERSION if the version, byte
 * order or struct layout differs. It returns ORL_ERR_CORRUPT if the file is truncated, damaged (all
 * of it is verified, at the speed of reading) or made from other content. A file that passes is
 * trusted, since only this program writes there.
 */
#ifndef ORL_BASE_IO_CHECKED_FILE_H
#define ORL_BASE_IO_CHECKED_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

#include "base/io/checksum.h"

enum {
    ORL_CHECKED_FILE_CONTENT = 32,
    ORL_CHECKED_FILE_HEADER = 128,
    ORL_CHECKED_FILE_BOUNDARY = 64
};

struct orl_checked_file_kind {
    char magic[8];
    uint32_t version;
    uint64_t shape;   /* identifies the layout of the structs in the file */
    const char *what; /* "BSDF", for messages */
};

static inline uint64_t orl_checked_file_aligned(uint64_t offset)
{
    return (offset + ORL_CHECKED_FILE_BOUNDARY - 1) / ORL_CHECKED_FILE_BOUNDARY *
           ORL_CHECKED_FILE_BOUNDARY;
}

/* ---- Writing --------------------------------------------------------------------------------- */

enum { ORL_CHECKED_WRITER_BUFFER = 1 << 16 };

struct orl_checked_writer {
    const struct orl_checked_file_kind *kind;
    const char *path; /* borrowed */
    int fd, error;    /* error: first errno; later data are dropped */
    uint64_t size;    /* bytes so far, including the header */
    struct orl_checksum sum;
    size_t filled;
    char buffer[ORL_CHECKED_WRITER_BUFFER];
};

/* Creates the file. Returns 0, ORL_ERR_IO, _FULL or _NOMEM. The writer is too large for the
 * stack. */
int orl_checked_writer_begin(struct orl_checked_writer *writer,
                             const struct orl_checked_file_kind *kind, const char *path,
                             struct orl_error *err);
void orl_checked_writer_put(struct orl_checked_writer *writer, const void *data, size_t bytes);
/* Writes zeros up to a multiple of step, at most 64. */
void orl_checked_writer_align(struct orl_checked_writer *writer, size_t step);
/* Writes the header and closes the file without syncing it. After any failure the file is removed.
 * content: digest of the file's source. */
int orl_checked_writer_end(struct orl_checked_writer *writer,
                           const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                           uint64_t *ret_bytes, struct orl_error *err);
/* ---- Opening --------------------------------------------------------------------------------- */

/* Read-only mapping of a file. The file may be removed or replaced while it is in use. */
struct orl_checked_file {
    char *data; /* begins with the header */
    size_t size;
};

int orl_checked_file_open(const struct orl_checked_file_kind *kind, const char *path,
                          const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                          struct orl_checked_file *ret_file, struct orl_error *err);
/* Unmaps the file; a struct without data is allowed. */
void orl_checked_file_close(struct orl_checked_file *file);

#endif
