#include "photon/map.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/random.h"
#include "base/sum.h"
#include "photon/flux.h"
#include "photon/pack.h"

struct sort_item {
    uint64_t code; /* bin of the normal, then Morton */
    uint32_t index;
};

struct writer {
    const struct orl_photon *photons;
    size_t count;
    const struct orl_map_build *build;
    struct sort_item *items, *spare;
    struct orl_map_layout layout;
    uint64_t size; /* of the file */
    struct orl_map_header header;
    char *file; /* being filled, mapped */
};

enum { CHUNK = 1 << 15, MORTON_BITS = 57 };

/* Spreads 20 bits to every third. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    return (x | x << 2) & 0x1249249249249249ULL;
}

static void cell_of(const struct writer *w, const struct orl_photon *photon, uint32_t ret_cell[3])
{
    for (int i = 0; i < 3; i++) {
        const double at = (photon->position[i] - w->header.low[i]) / w->header.cell;
        ret_cell[i] = at <= 0 ? 0 : at >= ORL_PLACE_CELLS - 1 ? ORL_PLACE_CELLS - 1 : (uint32_t)at;
    }
}

static size_t chunk_end(const struct writer *w, size_t chunk)
{
    const size_t end = (chunk + 1) * CHUNK;
    return end < w->count ? end : w->count;
}

static void make_codes(void *arg, size_t chunk, uint32_t member)
{
    struct writer *w = arg;
    (void)member;
    for (size_t i = chunk * CHUNK; i < chunk_end(w, chunk); i++) {
        uint32_t cell[3];
        cell_of(w, &w->photons[i], cell);
        const uint64_t bin = orl_facing_bin(w->photons[i].normal);
        /* 19 of the 20 bits an axis leave room for the bin above. */
        const uint64_t morton =
            spread(cell[0] >> 1) | spread(cell[1] >> 1) << 1 | spread(cell[2] >> 1) << 2;
        w->items[i] = (struct sort_item){bin << MORTON_BITS | morton, (uint32_t)i};
    }
}

/* Stable least-digit radix sort: equal places stay in order of emission. */
static void sort_items(struct writer *w)
{
    enum { DIGIT = 13, BUCKETS = 1 << DIGIT, PASSES = 5 };
    static const size_t mask = BUCKETS - 1;
    for (int pass = 0; pass < PASSES; pass++) {
        const int shift = pass * DIGIT;
        size_t start[BUCKETS] = {0}, sum = 0;
        for (size_t i = 0; i < w->count; i++)
            start[w->items[i].code >> shift & mask]++;
        for (size_t b = 0; b < BUCKETS; b++) {
            const size_t n = start[b];
            start[b] = sum;
            sum += n;
        }
        for (size_t i = 0; i < w->count; i++)
            w->spare[start[w->items[i].code >> shift & mask]++] = w->items[i];
        struct sort_item *swap = w->items;
        w->items = w->spare;
        w->spare = swap;
    }
}

/* Rounds up or down by chance, so that sums keep their means; the chance is the photon's own. */
static uint32_t pack_flux(const struct writer *w, const struct orl_photon *photon, uint32_t index)
{
    const struct orl_rgb flux = {photon->flux[0], photon->flux[1], photon->flux[2]};
    struct orl_random random = orl_random_stream(w->build->seed, ORL_PURPOSE_DITHER, index);
    return orl_flux_pack(orl_rgb_scale(flux, 1 / ((double)w->build->emitted * w->header.flux_unit)),
                         orl_random_uniform(&random));
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
    for (size_t i = chunk * CHUNK; i < chunk_end(w, chunk); i++) {
        const uint32_t index = w->items[i].index;
        const struct orl_photon *photon = &w->photons[index];
        uint32_t *leaf = places + i / ORL_MAP_LEAF * ORL_LEAF_WORDS + i % ORL_MAP_LEAF;
        uint32_t cell[3];
        cell_of(w, photon, cell);
        leaf[0] = cell[0] | (uint32_t)(photon->batch & 15) << 20 | (cell[2] >> 12) << 24;
        leaf[ORL_MAP_LEAF] = cell[1] | (cell[2] & 0xfffU) << 20;
        fluxes[i] = pack_flux(w, photon, index);
        normals[i] = photon->normal;
        tags[i] = photon->tag;
        if (noted > 0)
            memcpy(notes + i * noted, (const char *)w->build->notes + (size_t)index * noted, noted);
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

/* Bounds, cell size and flux unit; all from the photons alone. */
static void measure(struct writer *w)
{
    struct orl_map_header *h = &w->header;
    double high[3] = {-INFINITY, -INFINITY, -INFINITY}, brightest = 0;
    struct orl_sum flux = {0, 0};
    for (int k = 0; k < 3; k++)
        h->low[k] = INFINITY;
    for (size_t i = 0; i < w->count; i++) {
        const struct orl_photon *p = &w->photons[i];
        for (int k = 0; k < 3; k++) {
            h->low[k] = fmin(h->low[k], p->position[k]);
            high[k] = fmax(high[k], p->position[k]);
        }
        const double most = fmaxf(p->flux[0], fmaxf(p->flux[1], p->flux[2]));
        orl_sum_add(&flux, most);
        brightest = fmax(brightest, most);
    }
    for (int k = 0; k < 3; k++) {
        if (w->count == 0)
            h->low[k] = high[k] = 0;
        h->cell = fmax(h->cell, (high[k] - h->low[k]) / (ORL_PLACE_CELLS - 1));
    }
    if (!(h->cell > 0))
        h->cell = 1e-6;
    /* The mean; or more, lest a photon that outshines all others together be cut (flux.h). */
    const double unit =
        fmax(orl_sum_value(&flux) / fmax((double)w->count, 1), brightest / ORL_FLUX_MOST);
    h->flux_unit = unit > 0 ? unit / (double)w->build->emitted : 1;
}

static void fill_header(struct writer *w)
{
    struct orl_map_header *h = &w->header;
    memcpy(h->magic, "ORIELPM", 8);
    h->version = ORL_MAP_VERSION;
    h->byte_order = 0x01020304U;
    h->count = w->count;
    h->emitted = w->build->emitted;
    h->places = w->layout.places;
    h->fluxes = w->layout.fluxes;
    h->normals = w->layout.normals;
    h->tags = w->layout.tags;
    h->boxes = w->layout.boxes;
    h->size = w->size;
    h->levels = w->layout.levels;
    h->note_bytes = w->build->note_bytes;
    strncpy(h->kind, w->build->kind, sizeof h->kind - 1);
    crypto_generichash(h->body_checksum, sizeof h->body_checksum,
                       (unsigned char *)w->file + sizeof *h, w->size - sizeof *h, NULL, 0);
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

int orl_photon_map_write(const char *path, struct orl_photon *photons, size_t count,
                         const struct orl_map_build *build, struct orl_crew *crew,
                         struct orl_error *err)
{
    struct writer w = {.photons = photons, .count = count, .build = build};
    const size_t chunks = (count + CHUNK - 1) / CHUNK;
    int fd = -1, code = ORL_ERR_NOMEM;
    if (count > UINT32_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "%zu photons do not fit one map", count);
    w.layout = orl_map_layout_of(count);
    w.size = orl_map_size(&w.layout, count, build->note_bytes);
    w.items = malloc((count + 1) * sizeof *w.items);
    w.spare = malloc((count + 1) * sizeof *w.spare);
    if (!w.items || !w.spare) {
        orl_error_set(err, code, "out of memory sorting %zu photons", count);
        goto done;
    }
    measure(&w);
    code = create_file(&w, path, &fd, err);
    if (code < 0)
        goto done;
    orl_crew_for(crew, chunks, make_codes, &w);
    sort_items(&w);
    orl_crew_for(crew, chunks, pack_chunk, &w);
    build_boxes(&w.layout, count, w.file);
    fill_header(&w);
    if (msync(w.file, w.size, MS_SYNC) != 0 || fsync(fd) != 0)
        code = orl_error_set(err, ORL_ERR_IO, "cannot write photon map '%s': %s", path,
                             strerror(errno));
done:
    if (w.file)
        munmap(w.file, w.size);
    if (fd >= 0)
        close(fd);
    if (code < 0 && fd >= 0)
        unlink(path);
    free(w.items);
    free(w.spare);
    return code;
}
