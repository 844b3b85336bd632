#include "photon/map/write_map.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "photon/map/map_layout.h"

enum { CODE_BITS = ORL_ZORDER_POSITION_BITS + 5 }; /* there are fewer than 32 bins */
enum { DIGIT = 8, BUCKETS = 1 << DIGIT, FEW = 32, AHEAD = 8, CHUNK = 1 << 15 };

struct photon_sort {
    struct orl_sort_item *items;
    size_t count;
    const struct orl_photon_words *words;
    size_t starts[BUCKETS + 1]; /* first index of each bucket of the first digit */
    int shift;                  /* bit offset of the first digit */
    size_t *ends;               /* ends of chunks; codes of one chunk occur in no other */
    atomic_bool out_of_memory;
};

/* ---- Sorting by code ------------------------------------------------------------------------- */

/* Insertion sort for few items. */
static void insert_items(struct orl_sort_item *items, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        const struct orl_sort_item item = items[i];
        size_t at = i;
        for (; at > 0 && items[at - 1].code > item.code; at--)
            items[at] = items[at - 1];
        items[at] = item;
    }
}

/* Returns the offset of the digit that begins with the highest bit in which codes differ; -1:
 * all codes are equal. */
static int first_digit(const struct orl_sort_item *items, size_t n)
{
    const uint64_t highest = UINT64_C(1) << (CODE_BITS - 1);
    uint64_t differ = 0;
    for (size_t i = 1; i < n && differ < highest; i++)
        differ |= items[i].code ^ items[0].code;
    if (differ == 0)
        return -1;
    const int shift = 64 - DIGIT - __builtin_clzll(differ);
    return shift > 0 ? shift : 0;
}

static inline size_t digit_of(const struct orl_sort_item *item, int shift)
{
    return item->code >> shift & (BUCKETS - 1);
}

/*
 * Sorts items by one digit, in place (McIlroy, Bostic and McIlroy 1993, Computing Systems 6:
 * American flag sort): each item that is not in its bucket is swapped into it.
 */
static void split_by_digit(struct orl_sort_item *items, size_t n, int shift,
                           size_t ret_starts[BUCKETS + 1])
{
    size_t next[BUCKETS] = {0}, sum = 0;
    for (size_t i = 0; i < n; i++)
        next[digit_of(&items[i], shift)]++;
    for (size_t b = 0; b < BUCKETS; b++) {
        const size_t count = next[b];
        ret_starts[b] = next[b] = sum;
        sum += count;
    }
    ret_starts[BUCKETS] = sum;
    for (size_t b = 0; b < BUCKETS; b++) {
        while (next[b] < ret_starts[b + 1]) {
            struct orl_sort_item item = items[next[b]];
            for (size_t own = digit_of(&item, shift); own != b; own = digit_of(&item, shift)) {
                struct orl_sort_item *place = &items[next[own]++];
                const struct orl_sort_item there = *place;
                /* Hardware cannot predict the next write in so many buckets. */
                __builtin_prefetch(place + AHEAD, 1);
                *place = item;
                item = there;
            }
            items[next[b]++] = item;
        }
    }
}

/* Sorts digit by digit; the recursion is at most as deep as a code has digits. */
static void sort_items(struct orl_sort_item *items, size_t n) // NOLINT(misc-no-recursion)
{
    size_t starts[BUCKETS + 1];
    if (n <= FEW) {
        insert_items(items, n);
        return;
    }
    const int shift = first_digit(items, n);
    if (shift < 0)
        return;
    split_by_digit(items, n, shift, starts);
    for (size_t b = 0; b < BUCKETS && shift > 0; b++)
        sort_items(items + starts[b], starts[b + 1] - starts[b]);
}

static void sort_bucket(void *arg, size_t bucket, uint32_t member)
{
    const struct photon_sort *s = arg;
    (void)member;
    sort_items(s->items + s->starts[bucket], s->starts[bucket + 1] - s->starts[bucket]);
}

/* ---- Photons of equal code ------------------------------------------------------------------- */

/* A photon among others of the same code. */
struct tie {
    uint64_t hash, words[2];
    uint32_t index;
};

static int by_hash(const void *a, const void *b)
{
    const struct tie *x = a, *y = b;
    if (x->hash != y->hash)
        return x->hash < y->hash ? -1 : 1;
    if (x->words[0] != y->words[0])
        return x->words[0] < y->words[0] ? -1 : 1;
    if (x->words[1] != y->words[1])
        return x->words[1] < y->words[1] ? -1 : 1;
    return x->index < y->index ? -1 : 1;
}

static struct tie tie_of(const struct photon_sort *s, uint32_t index)
{
    const struct orl_photon_words p = s->words[index];
    struct tie tie = {.words = {(uint64_t)p.a << 32 | p.b,
                                (uint64_t)p.flux << 32 | (uint32_t)p.normal << 16 | p.tag},
                      .index = index};
    tie.hash = orl_mix64(orl_mix64(tie.words[0]) ^ tie.words[1]);
    return tie;
}

static void sort_ties(const struct photon_sort *s, struct orl_sort_item *items, size_t n,
                      struct tie *ties)
{
    for (size_t i = 0; i < n; i++)
        ties[i] = tie_of(s, items[i].index);
    qsort(ties, n, sizeof *ties, by_hash);
    for (size_t i = 0; i < n; i++)
        items[i].index = ties[i].index;
}

/* Sorts photons of equal code by hash. Only identical photons keep their former order. Returns
 * false if out of memory. */
static bool find_ties(const struct photon_sort *s, struct orl_sort_item *items, size_t count)
{
    struct tie *ties = NULL;
    size_t room = 0, end;
    for (size_t first = 0; first < count; first = end) {
        for (end = first + 1; end < count; end++)
            if (items[end].code != items[first].code)
                break;
        if (end - first > room) {
            room = 2 * (end - first);
            struct tie *grown = realloc(ties, room * sizeof *ties);
            if (!grown) {
                free(ties);
                return false;
            }
            ties = grown;
        }
        if (end - first > 1)
            sort_ties(s, items + first, end - first, ties);
    }
    free(ties);
    return true;
}

static void sort_chunk_ties(void *arg, size_t chunk, uint32_t member)
{
    struct photon_sort *s = arg;
    const size_t first = chunk > 0 ? s->ends[chunk - 1] : 0, end = s->ends[chunk];
    (void)member;
    if (!find_ties(s, s->items + first, end - first))
        atomic_store(&s->out_of_memory, true);
}

static size_t find_chunks(const struct photon_sort *s)
{
    size_t n = 0;
    for (size_t end = 0; end < s->count;) {
        end = end + CHUNK < s->count ? end + CHUNK : s->count;
        while (end < s->count && s->items[end].code == s->items[end - 1].code)
            end++;
        s->ends[n++] = end;
    }
    return n;
}

/* ---- Entry point ----------------------------------------------------------------------------- */

int orl_sort_photons(struct orl_sort_item *items, size_t count,
                     const struct orl_photon_words *words, struct orl_thread_pool *pool)
{
    struct photon_sort s = {.items = items, .count = count, .words = words};
    atomic_init(&s.out_of_memory, false);
    s.ends = malloc((count / CHUNK + 1) * sizeof *s.ends);
    if (!s.ends)
        return ORL_ERR_NOMEM;
    s.shift = count > 0 ? first_digit(items, count) : -1;
    int code = 0;
    if (s.shift >= 0) {
        split_by_digit(items, count, s.shift, s.starts);
        code = orl_parallel_try(pool, BUCKETS, sort_bucket, &s);
    }
    if (code == 0)
        code = orl_parallel_try(pool, find_chunks(&s), sort_chunk_ties, &s);
    free(s.ends);
    return code == 0 && atomic_load(&s.out_of_memory) ? ORL_ERR_NOMEM : code;
}
