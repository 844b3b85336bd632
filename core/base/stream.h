/*
 * Bidirectional serialiser. One walk through a struct either writes it to a checksummed file
 * (sealed.h) or reads it back, so that both directions always match. The walker passes each field,
 * which is written or filled.
 *
 * The first failure is kept; later calls do nothing, and later reads give 0. Units and frames:
 * none. Threads: one at a time.
 */
#ifndef ORL_BASE_STREAM_H
#define ORL_BASE_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/sealed.h"

struct orl_arena;

struct orl_stream {
    struct orl_sealed_writer *out; /* NULL: reading */
    const char *begin, *at, *end;  /* reading: position in the file */
    int code;                      /* 0, ORL_ERR_CORRUPT (file ends early) or ORL_ERR_NOMEM */
};

struct orl_stream orl_stream_to(struct orl_sealed_writer *out);
struct orl_stream orl_stream_from(const struct orl_sealed_file *file);
static inline bool orl_stream_reads(const struct orl_stream *stream)
{
    return !stream->out;
}
void orl_stream_fail(struct orl_stream *stream, int code);

void orl_stream_bytes(struct orl_stream *stream, void *data, size_t bytes);
#define orl_stream_value(stream, value) orl_stream_bytes(stream, value, sizeof *(value))

/* When reading, allocates an array of count items by calloc and stores its pointer in *slot. Each
 * item must take at least one byte of the file. */
void orl_stream_room(struct orl_stream *stream, void *slot, size_t count, size_t item);

/* Passes an array allocated by malloc: *slot is a pointer to count items. */
void orl_stream_array(struct orl_stream *stream, void *slot, size_t count, size_t item);
/* Passes an array allocated in an arena (by malloc if arena is NULL). If count is 0, *slot reads as
 * NULL. */
void orl_stream_kept(struct orl_stream *stream, struct orl_arena *arena, void *slot, size_t count,
                     size_t item);
/* Passes a NUL-terminated text, or NULL, in an arena. */
void orl_stream_text(struct orl_stream *stream, struct orl_arena *arena, const char **text);

/* Passes data that is read in place: writes it, or returns a pointer into the file, aligned for
 * numbers and pointers. NULL: failed. */
const void *orl_stream_in_place(struct orl_stream *stream, const void *data, size_t bytes);

#endif
