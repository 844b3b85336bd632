/*
 * Sealed files: what one program works out and the next maps, as it stands in memory. A header of
 * 128 bytes, and what its kind has to say.
 *
 * They are for the machine that wrote them. A file is refused as ORL_ERR_VERSION when it is of
 * another version, byte order or shape of structs, and as ORL_ERR_CORRUPT when it is cut, damaged
 * (all of it is verified, at the speed of reading) or of another content; what passes is taken as
 * this program wrote it, since only it writes there.
 */
#ifndef ORL_BASE_SEALED_H
#define ORL_BASE_SEALED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

#include "base/checksum.h"

enum { ORL_SEALED_CONTENT = 32, ORL_SEALED_HEADER = 128, ORL_SEALED_BOUNDARY = 64 };

struct orl_sealed_kind {
    char magic[8];
    uint32_t version;
    uint64_t shape;   /* of the structs that are written as they stand */
    const char *what; /* "BSDF", for messages */
};

static inline uint64_t orl_sealed_aligned(uint64_t offset)
{
    return (offset + ORL_SEALED_BOUNDARY - 1) / ORL_SEALED_BOUNDARY * ORL_SEALED_BOUNDARY;
}

/* ---- Writing --------------------------------------------------------------------------------- */

enum { ORL_SEALED_BUFFER = 1 << 16 };

struct orl_sealed_writer {
    const struct orl_sealed_kind *kind;
    const char *path; /* borrowed */
    int fd, error;    /* error: an errno, once something failed; what follows is dropped then */
    uint64_t size;    /* so far, header included */
    struct orl_checksum sum;
    size_t filled;
    char buffer[ORL_SEALED_BUFFER];
};

/* Makes the file. ORL_ERR_IO, _FULL, _NOMEM; the writer is big: not for the stack. */
int orl_sealed_begin(struct orl_sealed_writer *writer, const struct orl_sealed_kind *kind,
                     const char *path, struct orl_error *err);
void orl_sealed_put(struct orl_sealed_writer *writer, const void *data, size_t bytes);
/* Zeros up to a multiple of step, of 64 at the most. */
void orl_sealed_align(struct orl_sealed_writer *writer, size_t step);
/* Writes the header, and closes the file, which is not synced; where anything failed, it is gone.
 * content: of what the file was made. */
int orl_sealed_end(struct orl_sealed_writer *writer,
                   const unsigned char content[ORL_SEALED_CONTENT], uint64_t *ret_bytes,
                   struct orl_error *err);
/* ---- Opening --------------------------------------------------------------------------------- */

/* A file that is mapped, read-only. It may go, even be replaced, while it is in use. */
struct orl_sealed_file {
    char *data; /* the header first */
    size_t size;
};

int orl_sealed_open(const struct orl_sealed_kind *kind, const char *path,
                    const unsigned char content[ORL_SEALED_CONTENT],
                    struct orl_sealed_file *ret_file, struct orl_error *err);
/* One of no data is allowed. */
void orl_sealed_close(struct orl_sealed_file *file);

#endif
