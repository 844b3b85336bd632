#include "photon/sorting.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"

/* Of the codes, for which the radix sort has no digits: the rest of 62 bits is three of 13. */
enum { LOW_BITS = 23, DIGIT = 13, BUCKETS = 1 << DIGIT, PASSES = 3 };
enum { MOST_PARTS = 16, STRETCH = 1 << 15 };

struct sorting {
    struct orl_sort_item *from, *to;
    size_t count;
    const struct orl_photon_words *words;
    size_t parts; /* of the radix sort: stable, so that their number does not matter */
    size_t (*starts)[BUCKETS];
    int shift;
    size_t *ends; /* of stretches that share no upper bits */
    atomic_bool out_of_memory;
};

/* ---- By upper bits --------------------------------------------------------------------------- */

static inline size_t digit_of(const struct sorting *s, const struct orl_sort_item *item)
{
    return item->code >> s->shift & (BUCKETS - 1);
}

static void count_part(void *arg, size_t part, uint32_t member)
{
    const struct sorting *s = arg;
    size_t *start = s->starts[part];
    (void)member;
    memset(start, 0, sizeof *s->starts);
    for (size_t i = s->count * part / s->parts; i < s->count * (part + 1) / s->parts; i++)
        start[digit_of(s, &s->from[i])]++;
}

static void move_part(void *arg, size_t part, uint32_t member)
{
    const struct sorting *s = arg;
    size_t *start = s->starts[part];
    (void)member;
    for (size_t i = s->count * part / s->parts; i < s->count * (part + 1) / s->parts; i++)
        s->to[start[digit_of(s, &s->from[i])]++] = s->from[i];
}

/* Stable least-digit radix sort, each part of the items by itself. */
static void sort_upper_bits(struct sorting *s, struct orl_crew *crew)
{
    for (int pass = 0; pass < PASSES; pass++) {
        size_t sum = 0;
        s->shift = LOW_BITS + pass * DIGIT;
        orl_crew_for(crew, s->parts, count_part, s);
        for (size_t bucket = 0; bucket < BUCKETS; bucket++) {
            for (size_t part = 0; part < s->parts; part++) {
                const size_t n = s->starts[part][bucket];
                s->starts[part][bucket] = sum;
                sum += n;
            }
        }
        orl_crew_for(crew, s->parts, move_part, s);
        struct orl_sort_item *swap = s->from;
        s->from = s->to;
        s->to = swap;
    }
}

/* ---- What these leave equal ------------------------------------------------------------------ */

static int by_code(const void *a, const void *b)
{
    const struct orl_sort_item *x = a, *y = b;
    if (x->code != y->code)
        return x->code < y->code ? -1 : 1;
    return x->index < y->index ? -1 : 1;
}

/* Few items, and stable. */
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

/* Orders those that the upper bits of their codes leave equal: few, unless all is in one place. */
static void sort_low_bits(struct orl_sort_item *items, size_t count)
{
    enum { FEW = 24 };
    size_t end;
    for (size_t first = 0; first < count; first = end) {
        for (end = first + 1; end < count; end++)
            if (items[end].code >> LOW_BITS != items[first].code >> LOW_BITS)
                break;
        if (end - first > FEW)
            qsort(items + first, end - first, sizeof *items, by_code);
        else
            insert_items(items + first, end - first);
    }
}

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

static struct tie tie_of(const struct sorting *s, uint32_t index)
{
    const struct orl_photon_words p = s->words[index];
    struct tie tie = {.words = {(uint64_t)p.a << 32 | p.b,
                                (uint64_t)p.flux << 32 | (uint32_t)p.normal << 16 | p.tag},
                      .index = index};
    tie.hash = orl_mix64(orl_mix64(tie.words[0]) ^ tie.words[1]);
    return tie;
}

static void sort_ties(const struct sorting *s, struct orl_sort_item *items, size_t n,
                      struct tie *ties)
{
    for (size_t i = 0; i < n; i++)
        ties[i] = tie_of(s, items[i].index);
    qsort(ties, n, sizeof *ties, by_hash);
    for (size_t i = 0; i < n; i++)
        items[i].index = ties[i].index;
}

/* Photons of one code by hash. Left to their former order are only those that are the same. */
static bool settle_ties(const struct sorting *s, struct orl_sort_item *items, size_t count)
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

static void finish_stretch(void *arg, size_t stretch, uint32_t member)
{
    struct sorting *s = arg;
    const size_t first = stretch > 0 ? s->ends[stretch - 1] : 0, end = s->ends[stretch];
    (void)member;
    sort_low_bits(s->from + first, end - first);
    if (!settle_ties(s, s->from + first, end - first))
        atomic_store(&s->out_of_memory, true);
}

static size_t find_stretches(const struct sorting *s)
{
    size_t n = 0;
    for (size_t end = 0; end < s->count;) {
        end = end + STRETCH < s->count ? end + STRETCH : s->count;
        while (end < s->count && s->from[end].code >> LOW_BITS == s->from[end - 1].code >> LOW_BITS)
            end++;
        s->ends[n++] = end;
    }
    return n;
}

/* ---- All of it ------------------------------------------------------------------------------- */

int orl_sort_photons(struct orl_sort_item *items, struct orl_sort_item *spare, size_t count,
                     const struct orl_photon_words *words, struct orl_crew *crew,
                     struct orl_sort_item **ret_sorted)
{
    const uint32_t members = orl_crew_size(crew);
    struct sorting s = {.from = items,
                        .to = spare,
                        .count = count,
                        .words = words,
                        .parts = members < MOST_PARTS ? members : MOST_PARTS};
    int code = ORL_ERR_NOMEM;
    atomic_init(&s.out_of_memory, false);
    s.starts = malloc(s.parts * sizeof *s.starts);
    s.ends = malloc((count / STRETCH + 1) * sizeof *s.ends);
    if (s.starts && s.ends) {
        sort_upper_bits(&s, crew);
        orl_crew_for(crew, find_stretches(&s), finish_stretch, &s);
        code = atomic_load(&s.out_of_memory) ? ORL_ERR_NOMEM : 0;
    }
    *ret_sorted = s.from;
    free(s.starts);
    free(s.ends);
    return code;
}
