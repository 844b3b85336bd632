#include "base/io/serializer.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/arena.h"

enum { ALIGNMENT = 16 };

struct orl_serializer orl_serializer_to(struct orl_checked_writer *out)
{
    return (struct orl_serializer){.out = out};
}

struct orl_serializer orl_serializer_from(const struct orl_checked_file *file)
{
    return (struct orl_serializer){.begin = file->data,
                                   .at = file->data + ORL_CHECKED_FILE_HEADER,
                                   .end = file->data + file->size};
}

void orl_serializer_fail(struct orl_serializer *serializer, int code)
{
    if (serializer->code == 0)
        serializer->code = code;
}

/* Returns true if so many items can still be read. */
static bool has_left(struct orl_serializer *serializer, size_t count, size_t item)
{
    if (item > 0 && count > (size_t)(serializer->end - serializer->at) / item)
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    return serializer->code == 0;
}

void orl_serialize_bytes(struct orl_serializer *serializer, void *data, size_t bytes)
{
    if (serializer->out) {
        orl_checked_writer_put(serializer->out, data, bytes);
    } else if (!has_left(serializer, bytes, 1)) {
        memset(data, 0, bytes);
    } else if (bytes > 0) {
        memcpy(data, serializer->at, bytes);
        serializer->at += bytes;
    }
}

void orl_serializer_alloc(struct orl_serializer *serializer, void *slot, size_t count, size_t item)
{
    if (serializer->out || !has_left(serializer, count, 1))
        return;
    void *const made = calloc(count + 1, item);
    if (!made)
        orl_serializer_fail(serializer, ORL_ERR_NOMEM);
    memcpy(slot, &made, sizeof made);
}

static void pass_array(struct orl_serializer *serializer, struct orl_arena *arena, void *slot,
                       size_t bytes)
{
    void *data = NULL;
    if (serializer->out) {
        memcpy(&data, slot, sizeof data);
    } else if (has_left(serializer, bytes, 1)) {
        data = arena ? orl_arena_alloc(arena, bytes) : malloc(bytes);
        if (!data)
            orl_serializer_fail(serializer, ORL_ERR_NOMEM);
        memcpy(slot, &data, sizeof data);
    }
    if (data)
        orl_serialize_bytes(serializer, data, bytes);
}

void orl_serialize_array(struct orl_serializer *serializer, void *slot, size_t count, size_t item)
{
    if (serializer->out || has_left(serializer, count, item))
        pass_array(serializer, NULL, slot, count * item);
}

void orl_serialize_arena_array(struct orl_serializer *serializer, struct orl_arena *arena,
                               void *slot, size_t count, size_t item)
{
    static void *const none = NULL;
    if (count == 0 && orl_serializer_reads(serializer))
        memcpy(slot, &none, sizeof none);
    else if (count > 0 && (serializer->out || has_left(serializer, count, item)))
        pass_array(serializer, arena, slot, count * item);
}

void orl_serialize_text(struct orl_serializer *serializer, struct orl_arena *arena,
                        const char **text)
{
    uint32_t length = serializer->out && *text ? (uint32_t)strlen(*text) + 1 : 0;
    orl_serialize_value(serializer, &length);
    if (serializer->out) {
        orl_serialize_bytes(serializer, (void *)(uintptr_t)*text, length);
        return;
    }
    *text = NULL;
    if (length == 0 || !has_left(serializer, length, 1))
        return;
    *text = orl_arena_copy_text(arena, serializer->at, length - 1);
    if (!*text)
        orl_serializer_fail(serializer, ORL_ERR_NOMEM);
    serializer->at += length;
}

const void *orl_serialize_in_place(struct orl_serializer *serializer, const void *data,
                                   size_t bytes)
{
    if (serializer->out) {
        orl_checked_writer_align(serializer->out, ALIGNMENT);
        orl_checked_writer_put(serializer->out, data, bytes);
        return data;
    }
    const size_t at = (size_t)(serializer->at - serializer->begin);
    const size_t skipped = (ALIGNMENT - at % ALIGNMENT) % ALIGNMENT;
    if (!has_left(serializer, skipped, 1))
        return NULL;
    serializer->at += skipped;
    if (!has_left(serializer, bytes, 1))
        return NULL;
    const void *const here = serializer->at;
    serializer->at += bytes;
    return here;
}
