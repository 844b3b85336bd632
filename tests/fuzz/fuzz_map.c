/*
 * Photon map files. The first byte chooses what is repaired before the rest is opened as a map,
 * because random input hardly ever passes the checksums:
 *   bit 0  magic, version and byte order are set, header and body are signed
 *   bit 1  the header's offsets and sizes, and the file's length, fit its count (cut to 1023)
 *   bit 2  the body is verified on opening
 * A map that opens is searched throughout: a damaged file may at worst give wrong numbers.
 */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "base/io/checked_file.h"
#include "fuzz/fuzz.h"
#include "photon/density/irradiance_tables.h"
#include "photon/map/map_layout.h"

enum { MEND_SIGN = 1, MEND_FIT = 2, VERIFY = 4, COUNT_MASK = 1023 };

struct bytes {
    unsigned char *data;
    size_t size;
};

static void fit(struct bytes *file)
{
    struct orl_map_header h;
    memcpy(&h, file->data, sizeof h);
    h.count &= COUNT_MASK;
    const struct orl_map_layout l = orl_map_layout_of(h.count);
    unsigned char *grown = realloc(file->data, l.size);
    FUZZ_PROMISE(grown != NULL);
    if (l.size > file->size)
        memset(grown + file->size, 0, l.size - file->size);
    file->data = grown;
    file->size = l.size;
    h.places = l.places;
    h.fluxes = l.fluxes;
    h.normals = l.normals;
    h.tags = l.tags;
    h.boxes = l.boxes;
    h.levels = l.levels;
    h.size = l.size;
    memcpy(file->data, &h, sizeof h);
}

static void sign(struct bytes *file)
{
    struct orl_map_header h;
    memcpy(&h, file->data, sizeof h);
    memcpy(h.magic, "ORIELPM", 8);
    h.version = ORL_MAP_VERSION;
    h.byte_order = 0x01020304U;
    orl_checksum_of(file->data + sizeof h, file->size - sizeof h, h.body_checksum);
    orl_checksum_of(&h, offsetof(struct orl_map_header, header_checksum), h.header_checksum);
    memcpy(file->data, &h, sizeof h);
}

static int open_bytes(const struct bytes *file, bool verify, struct orl_photon_map **ret_map)
{
    struct orl_error err = {0};
    char path[64];
    const int fd = memfd_create("map", MFD_CLOEXEC);
    FUZZ_PROMISE(fd >= 0);
    FUZZ_PROMISE(write(fd, file->data, file->size) == (ssize_t)file->size);
    snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
    const int code = orl_photon_map_open(path, verify, ret_map, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    close(fd);
    return code;
}

static void search_map(const struct orl_photon_map *map)
{
    static const struct orl_vec3 normals[] = {{0, 0, 1}, {0.6, 0, -0.8}, {-1, 0, 0}};
    const struct orl_map_header *h = orl_photon_map_header(map);
    struct orl_search *search = calloc(1, sizeof *search);
    struct orl_leaf_irradiance *leaf_irradiance = orl_leaf_irradiance_new(map, NULL, 8, 0.5, NULL);
    FUZZ_PROMISE(search != NULL && leaf_irradiance != NULL);
    FUZZ_PROMISE(memchr(h->kind, '\0', sizeof h->kind) != NULL);
    for (size_t i = 0; i < 12; i++) {
        struct orl_photon photon = {.normal = 0};
        if (h->count > 0)
            photon = orl_photon_map_get(map, i * 7919 % h->count);
        const struct orl_density_query query = {
            .point = orl_v3(photon.position[0], photon.position[1], photon.position[2]),
            .normal = h->count && i % 2 ? orl_normal_decode(photon.normal) : normals[i / 2 % 3],
            .k = i == 0   ? 1
                 : i == 1 ? ORL_SEARCH_MOST
                          : (uint32_t)(i * 5),
            .max_radius = i % 3 ? 0.3 : 100,
            .at_photon = i % 4 == 1,
            .skip = (uint32_t)i};
        const struct orl_density density = orl_density_estimate(map, &query, search);
        FUZZ_PROMISE(density.found <= h->count && density.found <= 2 * ORL_SEARCH_MOST);
        orl_leaf_irradiance_estimate(leaf_irradiance, query.point, query.normal, NULL, search, NULL,
                                     NULL);
    }
    orl_leaf_irradiance_free(leaf_irradiance);
    free(search);
}

bool fuzz_map(const uint8_t *data, size_t size)
{
    struct orl_photon_map *map = NULL;
    struct bytes file;
    const int mend = size > 0 ? data[0] : 0;
    if (size < 2)
        return false;
    file.size = size - 1;
    file.data = malloc(file.size);
    FUZZ_PROMISE(file.data != NULL);
    memcpy(file.data, data + 1, file.size);
    if (file.size >= sizeof(struct orl_map_header)) {
        if (mend & MEND_FIT)
            fit(&file);
        if (mend & MEND_SIGN)
            sign(&file);
    }
    const bool accepted = open_bytes(&file, mend & VERIFY, &map) == 0;
    if (accepted)
        search_map(map);
    orl_photon_map_free(map);
    free(file.data);
    return accepted;
}
