#include "photon/map/map.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "base/io/checked_file.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"

static uint64_t aligned(uint64_t offset)
{
    return (offset + 63) & ~(uint64_t)63;
}

struct orl_map_layout orl_map_layout_of(uint64_t count)
{
    struct orl_map_layout l = {.leaves = (count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF};
    uint64_t groups = 0, nodes = l.leaves;
    l.places = aligned(sizeof(struct orl_map_header));
    l.fluxes = l.places + l.leaves * ORL_LEAF_WORDS * sizeof(uint32_t);
    l.normals = aligned(l.fluxes + count * sizeof(uint32_t));
    l.tags = aligned(l.normals + count * sizeof(uint16_t));
    l.boxes = aligned(l.tags + count * sizeof(uint16_t));
    while (nodes > 0 && l.levels < ORL_MAP_LEVELS) {
        nodes = (nodes + ORL_MAP_FANOUT - 1) / ORL_MAP_FANOUT;
        l.groups[l.levels++] = nodes;
        groups += nodes;
        if (nodes == 1)
            break;
    }
    l.size = l.boxes + groups * sizeof(struct orl_map_group);
    return l;
}

uint64_t orl_map_notes_at(const struct orl_map_layout *layout)
{
    return aligned(layout->size);
}

uint64_t orl_map_size(const struct orl_map_layout *layout, uint64_t count, uint32_t note_bytes)
{
    return note_bytes > 0 ? orl_map_notes_at(layout) + count * note_bytes : layout->size;
}

static bool header_matches(const struct orl_map_header *h)
{
    unsigned char sum[ORL_MAP_CHECKSUM];
    orl_checksum_of(h, offsetof(struct orl_map_header, header_checksum), sum);
    return memcmp(sum, h->header_checksum, sizeof sum) == 0;
}

enum { VERIFY_STEP = 16 << 20, KEPT_WHOLE = 256 << 20 };

/* Pages of a large map are dropped after they are read; a search loads those it needs again. */
static bool body_matches(const struct orl_photon_map *map, const atomic_bool *cancel)
{
    unsigned char result[ORL_CHECKSUM_BYTES];
    struct orl_checksum sum;
    char *file = map->file;
    size_t at = sizeof *map->header;
    orl_checksum_init(&sum);
    while (at < map->size && !orl_is_cancelled(cancel)) {
        const size_t end = map->size - at < VERIFY_STEP ? map->size : at + VERIFY_STEP;
        orl_checksum_add(&sum, file + at, end - at);
        if (map->size > KEPT_WHOLE)
            madvise(file, end / VERIFY_STEP * VERIFY_STEP, MADV_DONTNEED);
        at = end;
    }
    orl_checksum_finish(&sum, result);
    return memcmp(result, map->header->body_checksum, sizeof result) == 0;
}

static int check_header(const struct orl_map_header *h, size_t size, const char *path,
                        struct orl_error *err)
{
    if (size < sizeof *h || memcmp(h->magic, "ORIELPM", 8) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "'%s' is not a photon map", path);
    if (h->version != ORL_MAP_VERSION || h->byte_order != 0x01020304U)
        return orl_error_set(err, ORL_ERR_VERSION, "'%s' is a photon map of version %u, not %d",
                             path, h->version, ORL_MAP_VERSION);
    if (!header_matches(h))
        return orl_error_set(err, ORL_ERR_CORRUPT, "the header of photon map '%s' is damaged",
                             path);
    /* A count above the writer's limit could make the sizes below wrap around and look right. */
    const struct orl_map_layout l = orl_map_layout_of(h->count);
    if (h->count > UINT32_MAX || h->note_bytes > ORL_MAP_MOST_NOTE_BYTES || h->size != size ||
        orl_map_size(&l, h->count, h->note_bytes) != size || l.places != h->places ||
        l.fluxes != h->fluxes || l.normals != h->normals || l.tags != h->tags ||
        l.boxes != h->boxes || l.levels != h->levels || h->emitted == 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "photon map '%s' is truncated or damaged", path);
    return 0;
}

/* Checks numbers that searches divide by or add to, and text that is printed. */
static int check_values(const struct orl_map_header *h, const char *path, struct orl_error *err)
{
    if (!isnormal(h->cell) || !(h->cell > 0) || !isfinite(h->flux_unit) || h->flux_unit < 0 ||
        !isfinite(h->low[0]) || !isfinite(h->low[1]) || !isfinite(h->low[2]) ||
        !isfinite(h->flux_mean) || h->flux_mean < 0 || abs(h->flux_exponent) > 2000 ||
        h->kind[sizeof h->kind - 1] != '\0' || h->family[sizeof h->family - 1] != '\0')
        return orl_error_set(err, ORL_ERR_CORRUPT, "photon map '%s' has impossible values", path);
    return 0;
}

/*
 * Checks the absent children in the last group of each level. Searches follow any child with a
 * non-empty mask, so damage there would lead beyond the file. All other children exist.
 */
static int check_absent(const struct orl_photon_map *map, const char *path, struct orl_error *err)
{
    const struct orl_map_layout l = orl_map_layout_of(map->header->count);
    uint64_t nodes = l.leaves;
    for (uint32_t i = 0; i < l.levels; i++) {
        const uint64_t last = l.groups[i] - 1;
        for (uint64_t c = nodes - last * ORL_MAP_FANOUT; c < ORL_MAP_FANOUT; c++)
            if (map->levels[i][last].normal_bins[c] != 0)
                return orl_error_set(err, ORL_ERR_CORRUPT,
                                     "the bounding boxes of photon map '%s' are damaged", path);
        nodes = l.groups[i];
    }
    return 0;
}

static void set_block_pointers(struct orl_photon_map *map)
{
    const char *base = map->file;
    const struct orl_map_layout l = orl_map_layout_of(map->header->count);
    const struct orl_map_group *group = (const void *)(base + l.boxes);
    orl_normal_bins_init(&map->normal_bins);
    map->places = (const void *)(base + l.places);
    map->fluxes = (const void *)(base + l.fluxes);
    map->normals = (const void *)(base + l.normals);
    map->tags = (const void *)(base + l.tags);
    map->notes = map->header->note_bytes > 0 ? (const void *)(base + orl_map_notes_at(&l)) : NULL;
    for (uint32_t i = 0; i < l.levels; i++) {
        map->levels[i] = group;
        group += l.groups[i];
    }
}

static int map_file(const char *path, struct orl_photon_map *map, struct orl_error *err)
{
    struct stat st;
    int code = 0;
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0)
        return orl_error_set(err, orl_open_err_of_stored(errno), "cannot open photon map '%s': %s",
                             path, orl_open_reason(errno));
    if (fstat(fd, &st) != 0 || st.st_size < (off_t)sizeof(struct orl_map_header)) {
        code = orl_error_set(err, ORL_ERR_CORRUPT, "photon map '%s' is truncated", path);
    } else {
        void *file = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_SHARED, fd, 0);
        if (file == MAP_FAILED) {
            code = orl_error_set(err, ORL_ERR_IO, "cannot map photon map '%s': %s", path,
                                 strerror(errno));
        } else {
            map->file = file;
            map->size = (size_t)st.st_size;
            map->header = file;
        }
    }
    close(fd);
    return code;
}

static int open_map(const char *path, bool verify, const atomic_bool *cancel,
                    struct orl_photon_map **ret_map, struct orl_error *err)
{
    struct orl_photon_map *map = calloc(1, sizeof *map);
    if (!map)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory opening a photon map");
    int code = map_file(path, map, err);
    if (code == 0 && map->header)
        code = check_header(map->header, map->size, path, err);
    if (code == 0 && verify && map->header && !body_matches(map, cancel))
        code =
            orl_is_cancelled(cancel)
                ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading a photon map")
                : orl_error_set(err, ORL_ERR_CORRUPT, "photon map '%s' fails its checksum", path);
    if (code == 0 && map->header)
        code = check_values(map->header, path, err);
    if (code == 0 && map->header) {
        set_block_pointers(map);
        code = check_absent(map, path, err);
    }
    if (code < 0 || !map->header)
        orl_photon_map_free(map);
    else
        *ret_map = map;
    return code;
}

int orl_photon_map_open(const char *path, bool verify, struct orl_photon_map **ret_map,
                        struct orl_error *err)
{
    return open_map(path, verify, NULL, ret_map, err);
}

int orl_photon_map_read(const char *path, const atomic_bool *cancel,
                        struct orl_photon_map **ret_map, struct orl_error *err)
{
    return open_map(path, true, cancel, ret_map, err);
}

int orl_photon_map_adopt(void *file, size_t size, struct orl_photon_map **ret_map,
                         struct orl_error *err)
{
    struct orl_photon_map *map = calloc(1, sizeof *map);
    if (!map) {
        munmap(file, size);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a photon map");
    }
    map->file = file;
    map->size = size;
    map->header = file;
    set_block_pointers(map);
    *ret_map = map;
    return 0;
}

void orl_photon_map_free(struct orl_photon_map *map)
{
    if (!map)
        return;
    if (map->file)
        munmap(map->file, map->size);
    free(map);
}

const struct orl_map_header *orl_photon_map_header(const struct orl_photon_map *map)
{
    return map->header;
}

const void *orl_photon_map_note(const struct orl_photon_map *map, size_t index)
{
    return map->notes ? map->notes + index * map->header->note_bytes : NULL;
}

struct orl_photon orl_photon_map_get(const struct orl_photon_map *map, size_t index)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *leaf = map->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    const uint32_t a = leaf[index % ORL_MAP_LEAF], b = leaf[index % ORL_MAP_LEAF + ORL_MAP_LEAF];
    const struct orl_rgb flux = orl_rgb_scale(orl_flux_unpack(map->fluxes[index]), h->flux_unit);
    struct orl_photon photon = {.flux = {(float)flux.r, (float)flux.g, (float)flux.b},
                                .normal = map->normals[index],
                                .batch = (uint8_t)(a >> 20 & 15U),
                                .tag = (uint8_t)map->tags[index]};
    uint32_t cell[3];
    orl_position_unpack(a, b, cell);
    for (int i = 0; i < 3; i++)
        photon.position[i] = (float)(h->low[i] + (cell[i] + 0.5) * h->cell);
    return photon;
}

static uint64_t first_code(const struct orl_photon_map *map, uint64_t leaf)
{
    const uint32_t *words = map->places + leaf * ORL_LEAF_WORDS;
    uint32_t cell[3];
    orl_position_unpack(words[0], words[ORL_MAP_LEAF], cell);
    return orl_zorder_code(cell, map->normals[leaf * ORL_MAP_LEAF]);
}

/* Allocates codes for whole groups of eight. Entries past the end are greater than any code. */
static uint64_t *new_codes(uint64_t count)
{
    const uint64_t padded = (count + ORL_ZORDER_FANOUT - 1) / ORL_ZORDER_FANOUT * ORL_ZORDER_FANOUT;
    uint64_t *codes = malloc(padded * sizeof *codes);
    if (codes)
        memset(codes + count, 0xff, (padded - count) * sizeof *codes);
    return codes;
}

int orl_zorder_init(struct orl_zorder *order, const struct orl_photon_map *map)
{
    uint64_t count = (map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    *order = (struct orl_zorder){.levels = 0};
    while (count > 0) {
        const uint32_t level = order->levels;
        uint64_t *codes = new_codes(count);
        if (!codes) {
            orl_zorder_done(order);
            return ORL_ERR_NOMEM;
        }
        for (uint64_t i = 0; i < count; i++)
            codes[i] =
                level == 0 ? first_code(map, i) : order->codes[level - 1][i * ORL_ZORDER_FANOUT];
        order->codes[level] = codes;
        order->counts[level] = count;
        order->levels++;
        if (count <= ORL_ZORDER_FANOUT)
            break;
        count = (count + ORL_ZORDER_FANOUT - 1) / ORL_ZORDER_FANOUT;
    }
    return 0;
}

void orl_zorder_done(struct orl_zorder *order)
{
    for (uint32_t level = 0; level < order->levels; level++)
        free(order->codes[level]);
    *order = (struct orl_zorder){.levels = 0};
}

uint64_t orl_zorder_find(const struct orl_zorder *order, uint64_t code)
{
    uint64_t at = 0;
    for (uint32_t level = order->levels; level-- > 0;) {
        const uint64_t *group = order->codes[level] + at * ORL_ZORDER_FANOUT;
        uint64_t begun = 0;
        for (int i = 0; i < ORL_ZORDER_FANOUT; i++)
            begun += group[i] <= code;
        at = at * ORL_ZORDER_FANOUT + (begun > 0 ? begun - 1 : 0);
    }
    return at;
}

double orl_batches_third_cumulant(const struct orl_batches *batches)
{
    static const double n = ORL_MAP_BATCHES;
    double mean = 0, cube = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        mean += batches->luma[i] / n;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        cube += pow(batches->luma[i] - mean, 3);
    return cube * n * n / ((n - 1) * (n - 2));
}

double orl_batches_shrink(const struct orl_batches *difference)
{
    const double scatter2 = orl_batches_variance(difference);
    double sum = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum += difference->luma[i];
    return sum * sum > scatter2 ? sum - scatter2 / sum : 0;
}

void orl_batches_pack(const struct orl_batches *batches, uint8_t ret_shares[ORL_MAP_BATCHES])
{
    double most = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        most = fmax(most, batches->luma[i]);
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        ret_shares[i] = most > 0 ? (uint8_t)lround(255 * fmax(batches->luma[i], 0) / most) : 0;
}

struct orl_batches orl_batches_unpack(const uint8_t shares[ORL_MAP_BATCHES], double luma)
{
    struct orl_batches batches = {{0}};
    uint32_t sum = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum += shares[i];
    for (int i = 0; i < ORL_MAP_BATCHES && sum > 0; i++)
        batches.luma[i] = shares[i] * (luma / sum);
    return batches;
}
