#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/mman.h>

#include "base/io/checked_file.h"
#include "base/memory/memory.h"
#include "base/multiversion.h"
#include "base/sampling/sampling.h"
#include "base/statistics/numeric.h"
#include "photon/map/map.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"
#include "photon/map/write_map.h"

/* ---- Boxes of the hierarchy: those of leaves, then level by level above ---------------------- */

enum { BOXED_AT_ONCE = ORL_MAP_LEAF * ORL_MAP_FANOUT };

static void clear_group(struct orl_map_group *group)
{
    for (int c = 0; c < ORL_MAP_FANOUT; c++) {
        group->normal_bins[c] = 0;
        for (int k = 0; k < 3; k++) {
            group->low[k][c] = INFINITY;
            group->high[k][c] = -INFINITY;
        }
    }
}

static inline void include_box(struct orl_map_group *group, uint64_t child, const float low[3],
                               const float high[3], uint32_t normal_bins)
{
    group->normal_bins[child] |= normal_bins;
    for (int k = 0; k < 3; k++) {
        if (low[k] < group->low[k][child])
            group->low[k][child] = low[k];
        if (high[k] > group->high[k][child])
            group->high[k][child] = high[k];
    }
}

/* Computes a leaf's box, which is that of its photons' cells, in integers for sixteen photons at
 * once. */
static inline void box_leaf(const uint32_t *words, const uint16_t *normals, uint32_t n,
                            struct orl_map_group *group, uint64_t child)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};
    uint32_t normal_bins = 0;
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t a = words[i], b = words[i + ORL_MAP_LEAF];
        const int32_t x = (int32_t)(a & 0xfffffU), y = (int32_t)(b & 0xfffffU);
        const int32_t z = (int32_t)((a >> 24) << 12 | b >> 20);
        low[0] = x < low[0] ? x : low[0];
        low[1] = y < low[1] ? y : low[1];
        low[2] = z < low[2] ? z : low[2];
        high[0] = x > high[0] ? x : high[0];
        high[1] = y > high[1] ? y : high[1];
        high[2] = z > high[2] ? z : high[2];
    }
    for (uint32_t i = 0; i < n; i++)
        normal_bins |= 1U << orl_normal_bin(normals[i]);
    for (int k = 0; k < 3; k++) {
        group->low[k][child] = (float)low[k];
        group->high[k][child] = (float)high[k];
    }
    group->normal_bins[child] = normal_bins;
}

/*
 * Computes the boxes of the leaves of photons first to end. Both are multiples of BOXED_AT_ONCE,
 * except for the last end. `file` is the map's, with places and normals filled in.
 */
ORL_FOR_WIDE_VECTORS static void box_leaves(const struct orl_map_layout *layout, char *file,
                                            uint64_t first, uint64_t end)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    const uint32_t *places = (const void *)(file + layout->places);
    const uint16_t *normals = (const void *)(file + layout->normals);
    for (uint64_t i = first; i < end; i += ORL_MAP_LEAF) {
        const uint64_t leaf = i / ORL_MAP_LEAF, child = leaf % ORL_MAP_FANOUT;
        struct orl_map_group *group = &groups[leaf / ORL_MAP_FANOUT];
        const uint32_t *words = places + leaf * ORL_LEAF_WORDS;
        if (child == 0)
            clear_group(group);
        if (end - i >= ORL_MAP_LEAF)
            box_leaf(words, normals + i, ORL_MAP_LEAF, group, child);
        else
            box_leaf(words, normals + i, (uint32_t)(end - i), group, child);
    }
}

/* Computes the boxes of all levels above the leaves, whose boxes must exist. */
static void box_nodes(const struct orl_map_layout *layout, char *file)
{
    struct orl_map_group *groups = (void *)(file + layout->boxes);
    for (uint32_t level = 1; level < layout->levels; level++) {
        const struct orl_map_group *below = groups;
        groups += layout->groups[level - 1];
        for (uint64_t g = 0; g < layout->groups[level]; g++)
            clear_group(&groups[g]);
        for (uint64_t node = 0; node < layout->groups[level - 1]; node++) {
            for (int c = 0; c < ORL_MAP_FANOUT; c++) {
                const float low[3] = {below[node].low[0][c], below[node].low[1][c],
                                      below[node].low[2][c]};
                const float high[3] = {below[node].high[0][c], below[node].high[1][c],
                                       below[node].high[2][c]};
                include_box(&groups[node / ORL_MAP_FANOUT], node % ORL_MAP_FANOUT, low, high,
                            below[node].normal_bins[c]);
            }
        }
    }
}

struct writer {
    struct orl_map_encoder encoder;
    const struct orl_map_build *build;
    struct orl_photon_words *words; /* in the order of emission */
    struct orl_sort_item *items;
    struct orl_map_layout layout;
    uint64_t size; /* size of the file */
    struct orl_map_header header;
    char *file; /* the mapped file, being filled */
    /* per chunk: sum of the brightest channels, in the units of the words */
    struct orl_sum *flux_sums;
};

enum { CHUNK = 1 << 15, AHEAD = 24 };
_Static_assert((int)CHUNK % (int)BOXED_AT_ONCE == 0, "a chunk has its groups for itself");

static size_t chunks_of(const struct writer *w)
{
    return (w->encoder.count + CHUNK - 1) / CHUNK;
}

static size_t chunk_end(const struct writer *w, size_t chunk)
{
    const size_t end = (chunk + 1) * CHUNK, count = w->encoder.count;
    return end < count ? end : count;
}

/* Frees the pages of the new photons in the range. */
static void free_photon_pages(const struct writer *w, size_t first, size_t end)
{
    const struct orl_map_encoder *p = &w->encoder;
    if (end > p->n_earlier)
        orl_memory_release_pages(p->photons + (first > p->n_earlier ? first - p->n_earlier : 0),
                                 p->photons + (end - p->n_earlier));
}

/* Computes the sort items (codes and indices) of encoded photons. */
ORL_FOR_WIDE_VECTORS
static void make_items(const struct orl_photon_words *words, size_t first, size_t n,
                       struct orl_sort_item *ret_items)
{
    for (size_t i = 0; i < n; i++) {
        uint32_t cell[3];
        orl_position_unpack(words[i].a, words[i].b, cell);
        ret_items[i] =
            (struct orl_sort_item){orl_zorder_code(cell, words[i].normal), (uint32_t)(first + i)};
    }
}

/* Encodes the photons of a chunk in their order in memory; the sort then moves only the encoded
 * words. */
static void make_codes(void *arg, size_t chunk, uint32_t member)
{
    struct writer *w = arg;
    const size_t first = chunk * CHUNK, end = chunk_end(w, chunk);
    const bool near = orl_map_encode_is_near(&w->encoder);
    size_t i = first;
    (void)member;
    while (i < end) {
        const size_t begun = i;
        if (near && i >= w->encoder.n_earlier && end - i >= ORL_ENCODED_AT_ONCE) {
            orl_map_encode_words_many(&w->encoder, i, w->words + i);
            i += ORL_ENCODED_AT_ONCE;
        } else {
            w->words[i] = orl_map_encode_words(&w->encoder, i);
            i++;
        }
        make_items(w->words + begun, begun, i - begun, w->items + begun);
    }
    if (w->build->free_photons)
        free_photon_pages(w, first, end);
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
    struct orl_sum sum = {0, 0};
    for (size_t i = chunk * CHUNK; i < end; i++) {
        const struct orl_photon_words p = w->words[w->items[i].index];
        /* The words are scattered over the array, so they are prefetched some iterations ahead. */
        if (i + AHEAD < end)
            __builtin_prefetch(&w->words[w->items[i + AHEAD].index]);
        uint32_t *leaf = places + i / ORL_MAP_LEAF * ORL_LEAF_WORDS + i % ORL_MAP_LEAF;
        leaf[0] = p.a;
        leaf[ORL_MAP_LEAF] = p.b;
        fluxes[i] = p.flux;
        normals[i] = p.normal;
        tags[i] = p.tag;
        orl_sum_add(&sum, orl_rgb_max(orl_flux_unpack(p.flux)));
        if (noted > 0)
            memcpy(notes + i * noted,
                   (const char *)w->build->notes + (size_t)w->items[i].index * noted, noted);
    }
    w->flux_sums[chunk] = sum;
    box_leaves(&w->layout, w->file, chunk * CHUNK, end);
}

/* Returns the mean of the brightest channels, in the units of the map's words. */
static double mean_flux(const struct writer *w)
{
    struct orl_sum sum = {0, 0};
    for (size_t i = 0; i < chunks_of(w); i++) {
        orl_sum_add(&sum, w->flux_sums[i].high);
        orl_sum_add(&sum, w->flux_sums[i].low);
    }
    return orl_sum_value(&sum) / fmax((double)w->encoder.count, 1);
}

static void fill_measures(struct writer *w)
{
    struct orl_map_header *h = &w->header;
    const struct orl_map_encoder *p = &w->encoder;
    memcpy(h->low, p->low, sizeof h->low);
    h->cell = p->cell;
    h->flux_exponent = p->flux_exponent;
    /* Without any light the value has no effect, but must not be zero: it is divided by. */
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
    h->count = w->encoder.count;
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
    orl_checksum_of(h, offsetof(struct orl_map_header, header_checksum), h->header_checksum);
    memcpy(w->file, h, sizeof *h);
}

/* Creates the file at its full size, so that a full disk is reported here and not as a fault
 * later. */
static int create_file(struct writer *w, const char *path, int *ret_fd, struct orl_error *err)
{
    const int fd = orl_open_regular(path, O_RDWR | O_CREAT | O_TRUNC);
    if (fd < 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot create photon map '%s': %s",
                             path, orl_open_reason(errno));
    const int why = posix_fallocate(fd, 0, (off_t)w->size);
    void *file =
        why == 0 ? mmap(NULL, w->size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0) : MAP_FAILED;
    if (file == MAP_FAILED) {
        const int cause = why ? why : errno;
        const int code = orl_error_set(err, orl_err_of_errno(cause),
                                       "no disk space for a photon map of %zu bytes: %s",
                                       (size_t)w->size, strerror(cause));
        close(fd);
        return code;
    }
    w->file = file;
    *ret_fd = fd;
    return 0;
}

/* Encodes the photons and sorts them into the order of the file. */
static int sort_photons(struct writer *w, struct orl_thread_pool *pool)
{
    const size_t count = w->encoder.count;
    w->words = orl_memory_new((count + 1) * sizeof *w->words);
    w->items = orl_memory_new((count + 1) * sizeof *w->items);
    w->flux_sums = malloc((chunks_of(w) + 1) * sizeof *w->flux_sums);
    if (!w->words || !w->items || !w->flux_sums)
        return ORL_ERR_NOMEM;
    const int code = orl_parallel_try(pool, chunks_of(w), make_codes, w);
    if (code < 0)
        return code;
    return orl_sort_photons(w->items, count, w->words, pool);
}

static int fill_file(struct writer *w, struct orl_thread_pool *pool, struct orl_error *err)
{
    const int code = orl_parallel_try(pool, chunks_of(w), pack_chunk, w);
    if (code < 0)
        return orl_error_set(err, code, "cancelled while writing a photon map");
    box_nodes(&w->layout, w->file);
    fill_header(w);
    return 0;
}

static int create_in_memory(struct writer *w, struct orl_error *err)
{
    void *file = mmap(NULL, w->size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (file == MAP_FAILED)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a photon map of %zu bytes",
                             (size_t)w->size);
    w->file = file;
    return 0;
}

/* Builds the map. path: file to create, whose descriptor is returned in *ret_fd; NULL: in
 * memory. */
static int build_map(struct writer *w, const char *path, const struct orl_photon *photons,
                     size_t count, struct orl_thread_pool *pool, int *ret_fd, struct orl_error *err)
{
    const struct orl_map_build *build = w->build;
    const size_t all = count + (build->earlier ? build->earlier->header->count : 0);
    if (all > UINT32_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu photons do not fit one map", all);
    w->layout = orl_map_layout_of(all);
    w->size = orl_map_size(&w->layout, all, build->note_bytes);
    int code = orl_map_encode_init(&w->encoder, build->earlier, photons, count, build->seed,
                                   build->extent, pool);
    if (code == 0)
        code = sort_photons(w, pool);
    if (code < 0)
        orl_error_set(err, code, "%s sorting %zu photons",
                      code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory", all);
    if (code == 0)
        code = path ? create_file(w, path, ret_fd, err) : create_in_memory(w, err);
    if (code == 0)
        code = fill_file(w, pool, err);
    free(w->words);
    free(w->items);
    free(w->flux_sums);
    return code;
}

int orl_photon_map_write(const char *path, const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_thread_pool *pool,
                         struct orl_error *err)
{
    struct writer w = {.build = build};
    int fd = -1;
    const int code = build_map(&w, path, photons, count, pool, &fd, err);
    if (w.file)
        munmap(w.file, w.size);
    if (fd >= 0)
        close(fd);
    if (code < 0 && fd >= 0)
        unlink(path);
    return code;
}

int orl_photon_map_build(const struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_thread_pool *pool,
                         struct orl_photon_map **ret_map, struct orl_error *err)
{
    struct writer w = {.build = build};
    int fd = -1, code = build_map(&w, NULL, photons, count, pool, &fd, err);
    if (code == 0)
        return orl_photon_map_adopt(w.file, w.size, ret_map, err);
    if (w.file)
        munmap(w.file, w.size);
    return code;
}
