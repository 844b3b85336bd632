/*
 * Cache files that one process writes and later ones map: their checksum, the files, and a
 * serialiser for structs in them.
 *
 * The checksum has 128 bits and is as fast as reading (XXH3 of xxHash, inlined). It detects files
 * that were damaged, truncated or exchanged, but not forged ones. It is the same on every machine.
 */
#ifndef ORL_BASE_IO_CHECKED_FILE_H
#define ORL_BASE_IO_CHECKED_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <oriel/base/error.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

enum { ORL_CHECKSUM_BYTES = 16 };

struct orl_checksum {
    XXH3_state_t state;
};

static inline void orl_checksum_init(struct orl_checksum *sum)
{
    XXH3_128bits_reset(&sum->state);
}

static inline void orl_checksum_add(struct orl_checksum *sum, const void *data, size_t size)
{
    XXH3_128bits_update(&sum->state, data, size);
}

/* Returns the checksum in xxHash's canonical byte order. */
static inline void orl_checksum_finish(const struct orl_checksum *sum,
                                       unsigned char ret[ORL_CHECKSUM_BYTES])
{
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(&sum->state));
    memcpy(ret, canonical.digest, ORL_CHECKSUM_BYTES);
}

/* Returns the checksum of one buffer. */
static inline void orl_checksum_of(const void *data, size_t size,
                                   unsigned char ret[ORL_CHECKSUM_BYTES])
{
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits(data, size));
    memcpy(ret, canonical.digest, ORL_CHECKSUM_BYTES);
}

/*
 * Checksummed cache files: a struct image that one process writes and later ones map. They consist
 * of a header of 128 bytes and a body defined by the file's kind.
 *
 * Files are for the machine that wrote them. Opening returns ORL_ERR_VERSION if the version, byte
 * order or struct layout differs. It returns ORL_ERR_CORRUPT if the file is truncated, damaged (all
 * of it is verified, at the speed of reading) or made from other content. A file that passes is
 * trusted, since only this program writes there.
 */

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

/*
 * Bidirectional serialiser. One walk through a struct either writes it to a checksummed file or
 * reads it back, so that both directions always match. The walker passes each field, which is
 * written or filled.
 *
 * The first failure is stored; later calls do nothing, and later reads give 0. Units and frames:
 * none. Threads: one at a time.
 */

struct orl_arena;

struct orl_serializer {
    struct orl_checked_writer *out; /* NULL: reading */
    const char *begin, *at, *end;   /* reading: position in the file */
    int code;                       /* 0, ORL_ERR_CORRUPT (file ends early) or ORL_ERR_NOMEM */
};

struct orl_serializer orl_serializer_to(struct orl_checked_writer *out);
struct orl_serializer orl_serializer_from(const struct orl_checked_file *file);
static inline bool orl_serializer_reads(const struct orl_serializer *serializer)
{
    return !serializer->out;
}
void orl_serializer_fail(struct orl_serializer *serializer, int code);

void orl_serialize_bytes(struct orl_serializer *serializer, void *data, size_t bytes);
#define orl_serialize_value(serializer, value)                                                     \
    orl_serialize_bytes(serializer, value, sizeof *(value))

/* When reading, allocates an array of count items by calloc and stores its pointer in *slot. Each
 * item must take at least one byte of the file. */
void orl_serializer_alloc(struct orl_serializer *serializer, void *slot, size_t count, size_t item);

/* Passes an array allocated by malloc: *slot is a pointer to count items. */
void orl_serialize_array(struct orl_serializer *serializer, void *slot, size_t count, size_t item);
/* Passes an array allocated in an arena (by malloc if arena is NULL). If count is 0, *slot reads as
 * NULL. */
void orl_serialize_arena_array(struct orl_serializer *serializer, struct orl_arena *arena,
                               void *slot, size_t count, size_t item);
/* Passes a NUL-terminated text, or NULL, in an arena. */
void orl_serialize_text(struct orl_serializer *serializer, struct orl_arena *arena,
                        const char **text);

/* Passes data that is read in place: writes it, or returns a pointer into the file, aligned for
 * numbers and pointers. NULL: failed. */
const void *orl_serialize_in_place(struct orl_serializer *serializer, const void *data,
                                   size_t bytes);

#endif
