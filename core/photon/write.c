#include "photon/map.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/checksum.h"
#include "base/memory.h"
#include "base/random.h"
#include "base/sum.h"
#include "photon/flux.h"
#include "photon/packing.h"
#include "photon/zorder.h"

struct sort_item {
    uint64_t code; /* zorder.h */
    uint32_t index;
};

struct writer {
    struct orl_packing packing;
    const struct orl_map_build *build;
    struct orl_photon_words *words; /* in the order of emission */
    struct sort_item *items, *spare;
    struct orl_map_layout layout;
    uint64_t size; /* of the file */
    struct orl_map_header header;
    char *file; /* being filled, mapped */
};

enum { CHUNK = 1 << 15, AHEAD = 24 };

/* Of the codes, for which the radix sort has no digits: the rest of 62 bits is three of 13. */
enum { LOW_BITS = 23 };

static size_t chunk_end(const struct writer *w, size_t chunk)
{
    const size_t end = (chunk + 1) * CHUNK, count = w->packing.count;
    return end < count ? end : count;
}

/* Of the photons that are new. */
static void let_go(const struct writer *w, size_t first, size_t end)
{
    const struct orl_packing *p = &w->packing;
    if (end > p->n_earlier)
        orl_memory_let_go(p->photons + (first > p->n_earlier ? first - p->n_earlier : 0),
                          p->photons + (end - p->n_earlier));
}

/* Photons are packed in the order they lie in memory; it is packed that they are moved about. */
static void make_codes(void *arg, size_t chunk, uint32_t member)
{
    struct writer *w = arg;
    (void)member;
    for (size_t i = chunk * CHUNK; i < chunk_end(w, chunk); i++) {
        const struct orl_photon_words p = orl_packing_words(&w->packing, i);
        uint32_t cell[3];
        w->words[i] = p;
        orl_place_unpack(p.a, p.b, cell);
        w->items[i] = (struct sort_item){orl_zorder_code(cell, p.normal), (uint32_t)i};
    }
    if (w->build->spend)
        let_go(w, chunk * CHUNK, chunk_end(w, chunk));
}

static int by_code(const void *a, const void *b)
{
    const struct sort_item *x = a, *y = b;
    if (x->code != y->code)
        return x->code < y->code ? -1 : 1;
    return x->index < y->index ? -1 : 1;
}

/* Few items, and stable. */
static void insert_items(struct sort_item *items, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        const struct sort_item item = items[i];
        size_t at = i;
        for (; at > 0 && items[at - 1].code > item.code; at--)
            items[at] = items[at - 1];
        items[at] = item;
    }
}

/* Orders those that the upper bits of their codes leave equal: few, unless all is in one place. */
static void sort_low_bits(struct sort_item *items, size_t count)
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

/* Stable least-digit radix sort of the upper bits, then the rest. */
static void sort_items(struct writer *w)
{
    enum { DIGIT = 13, BUCKETS = 1 << DIGIT, PASSES = 3 };
    static const size_t mask = BUCKETS - 1;
    for (int pass = 0; pass < PASSES; pass++) {
        const int shift = LOW_BITS + pass * DIGIT;
        size_t start[BUCKETS] = {0}, sum = 0;
        for (size_t i = 0; i < w->packing.count; i++)
            start[w->items[i].code >> shift & mask]++;
        for (size_t b = 0; b < BUCKETS; b++) {
            const size_t n = start[b];
            start[b] = sum;
            sum += n;
        }
        for (size_t i = 0; i < w->packing.count; i++)
            w->spare[start[w->items[i].code >> shift & mask]++] = w->items[i];
        struct sort_item *swap = w->items;
        w->items = w->spare;
        w->spare = swap;
    }
    sort_low_bits(w->items, w->packing.count);
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

static struct tie tie_of(const struct writer *w, uint32_t index)
{
    const struct orl_photon_words p = w->words[index];
    struct tie tie = {.words = {(uint64_t)p.a << 32 | p.b,
                                (uint64_t)p.flux << 32 | (uint32_t)p.normal << 16 | p.tag},
                      .index = index};
    tie.hash = orl_mix64(orl_mix64(tie.words[0]) ^ tie.words[1]);
    return tie;
}

static void sort_ties(const struct writer *w, struct sort_item *items, size_t n, struct tie *ties)
{
    for (size_t i = 0; i < n; i++)
        ties[i] = tie_of(w, items[i].index);
    qsort(ties, n, sizeof *ties, by_hash);
    for (size_t i = 0; i < n; i++)
        items[i].index = ties[i].index;
}

/* Photons of one code by hash. Left to their former order are only those that are the same. */
static int settle_ties(struct writer *w)
{
    struct tie *ties = NULL;
    size_t room = 0, end;
    for (size_t first = 0; first < w->packing.count; first = end) {
        for (end = first + 1; end < w->packing.count; end++)
            if (w->items[end].code != w->items[first].code)
                break;
        if (end - first > room) {
            room = 2 * (end - first);
            struct tie *grown = realloc(ties, room * sizeof *ties);
            if (!grown) {
                free(ties);
                return ORL_ERR_NOMEM;
            }
            ties = grown;
        }
        if (end - first > 1)
            sort_ties(w, w->items + first, end - first, ties);
    }
    free(ties);
    return 0;
}

static void pack_chunk(void *arg, size_t chunk, uint32_t member)
{
    const struct writer *w = arg;
    uint32_t *places = (void *)(w->file + w->layout.places);
    uint32_t *fluxes = (void *)(w->file + w->layout.fluxes);
    uint16_t *normals = (void *)(w->file + w->layout.normals);
    uint16_t *tags = (void *)(w->file + w->layout.tags);
    char *notes = w->file + orl_map_notes_at(&w->layout);
    const uint32_t noted = w->build->note_bytes;
    (void)member;
    const size_t end = chunk_end(w, chunk);
    for (size_t i = chunk * CHUNK; i < end; i++) {
        const struct orl_photon_words p = w->words[w->items[i].index];
        /* They lie all over the array: asked for some way ahead, they are there when wanted. */
        if (i + AHEAD < end)
            __builtin_prefetch(&w->words[w->items[i + AHEAD].index]);
        uint32_t *leaf = places + i / ORL_MAP_LEAF * ORL_LEAF_WORDS + i % ORL_MAP_LEAF;
        leaf[0] = p.a;
        leaf[ORL_MAP_LEAF] = p.b;
        fluxes[i] = p.flux;
        normals[i] = p.normal;
        tags[i] = p.tag;
        if (noted > 0)
            memcpy(notes + i * noted,
                   (const char *)w->build->notes + (size_t)w->items[i].index * noted, noted);
    }
}

static void include_box(struct orl_map_group *group, uint64_t child, const float low[3],
                        const float high[3], uint32_t facing)
{
    group->facing[child] |= facing;
    for (int k = 0; k < 3; k++) {
        group->low[k][child] = fminf(group->low[k][child], low[k]);
        group->high[k][child] = fmaxf(group->high[k][child], high[k]);
    }
}

static void clear_groups(struct orl_map_group *groups, uint64_t count)
{
    for (uint64_t g = 0; g < count; g++) {
        for (int k = 0; k < 3; k++) {
            for (int c = 0; c < ORL_MAP_FANOUT; c++) {
                groups[g].facing[c] = 0;
                groups[g].low[k][c] = INFINITY;
                groups[g].high[k][c] = -INFINITY;
            }
        }
    }
}

static void build_boxes(const struct orl_map_layout *layout, uint64_t count, char *file)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    const uint32_t *places = (const void *)(file + layout->places);
    const uint16_t *normals = (const void *)(file + layout->normals);
    uint64_t total = 0;
    for (uint32_t level = 0; level < layout->levels; level++)
        total += layout->groups[level];
    clear_groups(groups, total);
    for (uint64_t i = 0; i < count; i++) {
        const uint64_t leaf = i / ORL_MAP_LEAF;
        const uint32_t *words = places + leaf * ORL_LEAF_WORDS + i % ORL_MAP_LEAF;
        uint32_t cell[3];
        orl_place_unpack(words[0], words[ORL_MAP_LEAF], cell);
        const float at[3] = {(float)cell[0], (float)cell[1], (float)cell[2]};
        include_box(&groups[leaf / ORL_MAP_FANOUT], leaf % ORL_MAP_FANOUT, at, at,
                    1U << orl_facing_bin(normals[i]));
    }
    for (uint32_t level = 1; level < layout->levels; level++) {
        const struct orl_map_group *below = groups;
        groups += layout->groups[level - 1];
        for (uint64_t node = 0; node < layout->groups[level - 1]; node++) {
            for (int c = 0; c < ORL_MAP_FANOUT; c++) {
                const float low[3] = {below[node].low[0][c], below[node].low[1][c],
                                      below[node].low[2][c]};
                const float high[3] = {below[node].high[0][c], below[node].high[1][c],
                                       below[node].high[2][c]};
                include_box(&groups[node / ORL_MAP_FANOUT], node % ORL_MAP_FANOUT, low, high,
                            below[node].facing[c]);
            }
        }
    }
}

/* The mean of the brightest channels, in the units of the map's words. */
static double mean_flux(const struct writer *w)
{
    const uint32_t *fluxes = (const void *)(w->file + w->layout.fluxes);
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < w->packing.count; i++)
        orl_sum_add(&sum, orl_rgb_max(orl_flux_unpack(fluxes[i])));
    return orl_sum_value(&sum) / fmax((double)w->packing.count, 1);
}

static void fill_measures(struct writer *w)
{
    struct orl_map_header *h = &w->header;
    const struct orl_packing *p = &w->packing;
    memcpy(h->low, p->low, sizeof h->low);
    h->cell = p->cell;
    h->flux_exponent = p->flux_exponent;
    /* Without any light: of no matter, but a number to divide by. */
    h->flux_unit = p->flux_exponent > ORL_FLUX_LEAST
                       ? orl_flux_unit(p->flux_exponent) / (double)w->build->emitted
                       : 1;
    h->flux_mean = mean_flux(w) * h->flux_unit;
}

static void fill_header(struct writer *w)
{
    struct orl_map_header *h = &w->header;
    memcpy(h->magic, "ORIELPM", 8);
    h->version = ORL_MAP_VERSION;
    h->byte_order = 0x01020304U;
    h->count = w->packing.count;
    h->emitted = w->build->emitted;
    h->target = w->build->target;
    fill_measures(w);
    h->places = w->layout.places;
    h->fluxes = w->layout.fluxes;
    h->normals = w->layout.normals;
    h->tags = w->layout.tags;
    h->boxes = w->layout.boxes;
    h->size = w->size;
    h->levels = w->layout.levels;
    h->note_bytes = w->build->note_bytes;
    strncpy(h->kind, w->build->kind, sizeof h->kind - 1);
    if (w->build->family)
        strncpy(h->family, w->build->family, sizeof h->family - 1);
    orl_checksum_of(w->file + sizeof *h, w->size - sizeof *h, h->body_checksum);
    crypto_generichash(h->header_checksum, sizeof h->header_checksum, (unsigned char *)h,
                       offsetof(struct orl_map_header, header_checksum), NULL, 0);
    memcpy(w->file, h, sizeof *h);
}

/* Makes the file at its full size: running out of disk shows here, not as a fault later. */
static int create_file(struct writer *w, const char *path, int *ret_fd, struct orl_error *err)
{
    const int fd = open(path, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0)
        return orl_error_set(err, ORL_ERR_IO, "cannot create photon map '%s': %s", path,
                             strerror(errno));
    const int why = posix_fallocate(fd, 0, (off_t)w->size);
    void *file =
        why == 0 ? mmap(NULL, w->size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
    if (file == MAP_FAILED) {
        const int code = orl_error_set(err, ORL_ERR_IO, "no room for a photon map of %zu bytes: %s",
                                       (size_t)w->size, strerror(why ? why : errno));
        close(fd);
        return code;
    }
    w->file = file;
    *ret_fd = fd;
    return 0;
}

/* Into the order of the file. */
static int sort_photons(struct writer *w, struct orl_crew *crew)
{
    const size_t count = w->packing.count;
    w->words = malloc((count + 1) * sizeof *w->words);
    w->items = malloc((count + 1) * sizeof *w->items);
    if (!w->words || !w->items)
        return ORL_ERR_NOMEM;
    orl_crew_for(crew, (count + CHUNK - 1) / CHUNK, make_codes, w);
    w->spare = malloc((count + 1) * sizeof *w->spare);
    if (!w->spare)
        return ORL_ERR_NOMEM;
    sort_items(w);
    free(w->spare);
    w->spare = NULL;
    return settle_ties(w);
}

static void fill_file(struct writer *w, struct orl_crew *crew)
{
    const size_t count = w->packing.count;
    orl_crew_for(crew, (count + CHUNK - 1) / CHUNK, pack_chunk, w);
    build_boxes(&w->layout, count, w->file);
    fill_header(w);
}

int orl_photon_map_write(const char *path, const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_crew *crew,
                         struct orl_error *err)
{
    struct writer w = {.build = build};
    int fd = -1, code = ORL_ERR_NOMEM;
    const size_t all = count + (build->earlier ? build->earlier->header->count : 0);
    if (all > UINT32_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu photons do not fit one map", all);
    orl_packing_init(&w.packing, build->earlier, photons, count, build->seed, build->extent);
    w.layout = orl_map_layout_of(all);
    w.size = orl_map_size(&w.layout, all, build->note_bytes);
    if (sort_photons(&w, crew) < 0) {
        orl_error_set(err, code, "out of memory sorting %zu photons", all);
        goto done;
    }
    code = create_file(&w, path, &fd, err);
    if (code == 0)
        fill_file(&w, crew);
done:
    if (w.file)
        munmap(w.file, w.size);
    if (fd >= 0)
        close(fd);
    if (code < 0 && fd >= 0)
        unlink(path);
    free(w.words);
    free(w.items);
    free(w.spare);
    return code;
}
