#include <oriel/base/json_read.h>

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

/* State of jansson in this thread. reading: it parses. refused: an allocation has failed. */
static _Thread_local bool reading, refused;

/*
 * Reserve for jansson's token buffer. If the buffer cannot grow, jansson continues without the
 * byte, and an assertion may fail later and end the process. The reserve lets jansson finish the
 * token. All other allocations then fail, and parsing ends. The buffer's sizes are powers of two.
 * One thread uses the reserve at a time.
 */
enum { RESERVE = 512 << 10, BUFFER_LEAST = 32 };
static _Alignas(16) char reserve[RESERVE];
static size_t reserve_used;
static unsigned reserve_blocks;
static pthread_mutex_t reserve_mutex = PTHREAD_MUTEX_INITIALIZER;
static _Thread_local bool has_reserve;

static void *take_reserve(size_t size)
{
    void *block = NULL;
    pthread_mutex_lock(&reserve_mutex);
    if ((has_reserve || reserve_blocks == 0) && size <= RESERVE - reserve_used) {
        has_reserve = true;
        block = reserve + reserve_used;
        reserve_used += size;
        reserve_blocks++;
    }
    pthread_mutex_unlock(&reserve_mutex);
    return block;
}

static void *allocate_memory(size_t size)
{
    void *memory = malloc(size);
    if (memory || size == 0)
        return memory;
    refused = true;
    return reading && size >= BUFFER_LEAST && (size & (size - 1)) == 0 ? take_reserve(size) : NULL;
}

static void release_memory(void *memory)
{
    const uintptr_t at = (uintptr_t)memory, from = (uintptr_t)reserve;
    if (at < from || at >= from + RESERVE) {
        free(memory);
        return;
    }
    pthread_mutex_lock(&reserve_mutex);
    if (--reserve_blocks == 0)
        reserve_used = 0;
    pthread_mutex_unlock(&reserve_mutex);
}

/* Runs once, before any thread exists. Blocks allocated earlier by malloc are freed by free. */
__attribute__((constructor)) static void watch_allocations(void)
{
    json_set_alloc_funcs(allocate_memory, release_memory);
}

uint64_t orl_json_memory_estimate(const char *text, size_t size)
{
    /* Bytes in jansson 2.14 on 64 bits, including malloc's overhead: an empty object, an empty
     * array, a member's key, and any value. */
    enum { OBJECT = 256, ARRAY = 144, KEY = 80, VALUE = 40 };
    uint64_t weight = size;
    bool quoted = false;
    for (size_t i = 0; i < size; i++) {
        const char c = text[i];
        if (quoted) {
            i += c == '\\';
            quoted = c != '"';
            continue;
        }
        quoted = c == '"';
        weight += c == '{'   ? OBJECT + VALUE
                  : c == '[' ? ARRAY + VALUE
                  : c == ':' ? KEY
                  : c == ',' ? VALUE
                             : 0;
    }
    return weight;
}

/* Text that jansson reads in small chunks, with regular polls for cancellation. */
struct text_source {
    const char *text;
    size_t size, at, polled_at;
    const atomic_bool *cancel;
    bool cancelled;
};

static size_t next_chunk(void *buffer, size_t most, void *data)
{
    enum { POLL_BYTES = 64 << 10 };
    struct text_source *source = data;
    const size_t left = source->size - source->at, n = left < most ? left : most;
    if (source->at == 0 || source->at - source->polled_at >= POLL_BYTES) {
        source->polled_at = source->at;
        source->cancelled = orl_is_cancelled(source->cancel);
    }
    if (source->cancelled)
        return (size_t)-1;
    memcpy(buffer, source->text + source->at, n);
    source->at += n;
    return n;
}

json_t *orl_json_read_until(const char *text, size_t size, size_t flags, const atomic_bool *cancel,
                            json_error_t *ret_where)
{
    struct text_source source = {.text = text, .size = size, .cancel = cancel};
    json_error_t where;
    refused = has_reserve = false;
    reading = true;
    json_t *value = json_load_callback(next_chunk, &source, flags, &where);
    reading = false;
    if (refused || source.cancelled) {
        json_decref(value);
        value = NULL;
    }
    if (ret_where)
        *ret_where = where;
    errno = source.cancelled ? ECANCELED : refused ? ENOMEM : 0;
    return value;
}

json_t *orl_json_read(const char *text, size_t size, size_t flags, json_error_t *ret_where)
{
    return orl_json_read_until(text, size, flags, NULL, ret_where);
}

json_t *orl_json_read_stored(const char *text)
{
    errno = 0;
    return text ? orl_json_read(text, strlen(text), 0, NULL) : NULL;
}
