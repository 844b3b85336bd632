/*
 * Bidirectional serialiser. One walk through a struct either writes it to a checksummed file
 * (checked_file.h) or reads it back, so that both directions always match. The walker passes each
 * field, which is written or filled.
 *
 * The first failure is kept; later calls do nothing, and later reads give 0. Units and frames:
 * none. Threads: one at a time.
 */
#ifndef ORL_BASE_IO_SERIALIZER_H
#define ORL_BASE_IO_SERIALIZER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/io/checked_file.h"

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
