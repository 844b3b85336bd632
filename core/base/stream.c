#include "base/stream.h"

#include <stdlib.h>
#include <string.h>

#include "base/arena.h"

enum { ALIGNMENT = 16 };

struct orl_stream orl_stream_to(struct orl_sealed_writer *out)
{
    return (struct orl_stream){.out = out};
}

struct orl_stream orl_stream_from(const struct orl_sealed_file *file)
{
    return (struct orl_stream){
        .begin = file->data, .at = file->data + ORL_SEALED_HEADER, .end = file->data + file->size};
}

void orl_stream_fail(struct orl_stream *stream, int code)
{
    if (stream->code == 0)
        stream->code = code;
}

/* Returns true if so many items can still be read. */
static bool has_left(struct orl_stream *stream, size_t count, size_t item)
{
    if (item > 0 && count > (size_t)(stream->end - stream->at) / item)
        orl_stream_fail(stream, ORL_ERR_CORRUPT);
    return stream->code == 0;
}

void orl_stream_bytes(struct orl_stream *stream, void *data, size_t bytes)
{
    if (stream->out) {
        orl_sealed_put(stream->out, data, bytes);
    } else if (!has_left(stream, bytes, 1)) {
        memset(data, 0, bytes);
    } else if (bytes > 0) {
        memcpy(data, stream->at, bytes);
        stream->at += bytes;
    }
}

void orl_stream_room(struct orl_stream *stream, void *slot, size_t count, size_t item)
{
    if (stream->out || !has_left(stream, count, 1))
        return;
    void *const made = calloc(count + 1, item);
    if (!made)
        orl_stream_fail(stream, ORL_ERR_NOMEM);
    memcpy(slot, &made, sizeof made);
}

static void pass_array(struct orl_stream *stream, struct orl_arena *arena, void *slot, size_t bytes)
{
    void *data = NULL;
    if (stream->out) {
        memcpy(&data, slot, sizeof data);
    } else if (has_left(stream, bytes, 1)) {
        data = arena ? orl_arena_take(arena, bytes) : malloc(bytes);
        if (!data)
            orl_stream_fail(stream, ORL_ERR_NOMEM);
        memcpy(slot, &data, sizeof data);
    }
    if (data)
        orl_stream_bytes(stream, data, bytes);
}

void orl_stream_array(struct orl_stream *stream, void *slot, size_t count, size_t item)
{
    if (stream->out || has_left(stream, count, item))
        pass_array(stream, NULL, slot, count * item);
}

void orl_stream_kept(struct orl_stream *stream, struct orl_arena *arena, void *slot, size_t count,
                     size_t item)
{
    static void *const none = NULL;
    if (count == 0 && orl_stream_reads(stream))
        memcpy(slot, &none, sizeof none);
    else if (count > 0 && (stream->out || has_left(stream, count, item)))
        pass_array(stream, arena, slot, count * item);
}

void orl_stream_text(struct orl_stream *stream, struct orl_arena *arena, const char **text)
{
    uint32_t length = stream->out && *text ? (uint32_t)strlen(*text) + 1 : 0;
    orl_stream_value(stream, &length);
    if (stream->out) {
        orl_stream_bytes(stream, (void *)(uintptr_t)*text, length);
        return;
    }
    *text = NULL;
    if (length == 0 || !has_left(stream, length, 1))
        return;
    *text = orl_arena_text(arena, stream->at, length - 1);
    if (!*text)
        orl_stream_fail(stream, ORL_ERR_NOMEM);
    stream->at += length;
}

const void *orl_stream_in_place(struct orl_stream *stream, const void *data, size_t bytes)
{
    if (stream->out) {
        orl_sealed_align(stream->out, ALIGNMENT);
        orl_sealed_put(stream->out, data, bytes);
        return data;
    }
    const size_t at = (size_t)(stream->at - stream->begin);
    const size_t skipped = (ALIGNMENT - at % ALIGNMENT) % ALIGNMENT;
    if (!has_left(stream, skipped, 1))
        return NULL;
    stream->at += skipped;
    if (!has_left(stream, bytes, 1))
        return NULL;
    const void *const here = stream->at;
    stream->at += bytes;
    return here;
}
