/*
 * One walk through a struct that either writes it to a sealed file (sealed.h) or reads it back, so
 * that the two cannot differ: whoever walks passes each field, which is taken from there or filled.
 *
 * The first failure is kept, and nothing is read or written after it: what is read then is 0. Units
 * and frames: none. Threads: one at a time.
 */
#ifndef ORL_BASE_STREAM_H
#define ORL_BASE_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/sealed.h"

struct orl_arena;

struct orl_stream {
    struct orl_sealed_writer *out; /* NULL: it reads */
    const char *begin, *at, *end;  /* when it reads: of the file */
    int code;                      /* 0, ORL_ERR_CORRUPT (it ends early), ORL_ERR_NOMEM */
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

/* When it reads, makes room by calloc for an array of count items, each of which takes a byte of
 * the file at least; *slot is its pointer. */
void orl_stream_room(struct orl_stream *stream, void *slot, size_t count, size_t item);

/* Of an array of malloc: *slot is a pointer to count items. */
void orl_stream_array(struct orl_stream *stream, void *slot, size_t count, size_t item);
/* The same of one in an arena. NULL stays NULL where count is 0. */
void orl_stream_kept(struct orl_stream *stream, struct orl_arena *arena, void *slot, size_t count,
                     size_t item);
/* A NUL-terminated text, or NULL, in an arena. */
void orl_stream_text(struct orl_stream *stream, struct orl_arena *arena, const char **text);

/* Of what is to be read where it lies: writes it, or returns it; aligned for numbers and pointers.
 * NULL: failed. */
const void *orl_stream_in_place(struct orl_stream *stream, const void *data, size_t bytes);

#endif
