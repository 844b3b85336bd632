#include "annual/sun_map/sun_map.h"

#include <stdlib.h>
#include <string.h>

#include "annual/sun_map/sun_beams.h"
#include "annual/year/annual_scene.h"
#include "base/memory/memory.h"

enum { MOST_AT_ONCE = 64, CHANNELS = 3 };
enum {
    TASK_PHOTONS = 1024
}; /* photons of a beam traced in one call; bounds the deposits in memory */
static const double texels_per_window = 12; /* texels along the side of a window of mean area */

/* Light that one batch of one beam brought to a texel. */
struct deposit_sums {
    uint32_t row; /* texel and batch */
    uint32_t beam;
    float light[CHANNELS]; /* irradiance */
};

struct orl_sun_map {
    const struct orl_lit_scene *lit_scene;
    struct orl_sun_texels texels;
    struct orl_sun_beams beams;
    uint32_t channels; /* 1 if no material on the way colours light */
    /* Hash table of texel identifiers, by open addressing: index of the texel, and areas by
     * index. */
    uint64_t *keys;
    uint32_t *texel_indices;
    size_t room, count, areas_room;
    double *areas;
    /* Deposits while photons are traced: one entry for each pair of a beam and a row. */
    struct deposit_sums *deposit_sums;
    uint32_t *latest; /* by row: index of its latest entry, plus one; 0: none */
    size_t n_deposit_sums, deposit_sums_room;
    /* Rows, one for each batch of each texel: the beams that reached it. */
    size_t *first; /* by row, plus one at the end: first index into the next two */
    uint32_t *which;
    float *light; /* [entry][channel]: irradiance */
};

/* ---- Texels --------------------------------------------------------------------------------- */

static size_t slot_of(const struct orl_sun_map *map, uint64_t key)
{
    size_t slot = (size_t)orl_mix64(key) & (map->room - 1);
    while (map->keys[slot] != 0 && map->keys[slot] != key)
        slot = (slot + 1) & (map->room - 1);
    return slot;
}

static int rehash(struct orl_sun_map *map, size_t room)
{
    uint64_t *keys = map->keys;
    uint32_t *texel_indices = map->texel_indices;
    const size_t before = map->room;
    map->keys = calloc(room, sizeof *map->keys);
    map->texel_indices = calloc(room, sizeof *map->texel_indices);
    map->room = room;
    for (size_t i = 0; map->keys && map->texel_indices && i < before; i++) {
        if (keys[i] == 0)
            continue;
        const size_t slot = slot_of(map, keys[i]);
        map->keys[slot] = keys[i];
        map->texel_indices[slot] = texel_indices[i];
    }
    free(keys);
    free(texel_indices);
    return map->keys && map->texel_indices ? 0 : ORL_ERR_NOMEM;
}

static int grow_texels(struct orl_sun_map *map)
{
    const size_t room = map->areas_room > 0 ? 2 * map->areas_room : 1024;
    double *areas = realloc(map->areas, room * sizeof *areas);
    if (!areas)
        return ORL_ERR_NOMEM;
    map->areas = areas;
    uint32_t *latest = realloc(map->latest, room * ORL_SUN_PHOTON_BATCHES * sizeof *latest);
    if (!latest)
        return ORL_ERR_NOMEM;
    memset(latest + map->areas_room * ORL_SUN_PHOTON_BATCHES, 0,
           (room - map->areas_room) * ORL_SUN_PHOTON_BATCHES * sizeof *latest);
    map->latest = latest;
    map->areas_room = room;
    return 0;
}

/* Adds a texel. */
static int add_texel(struct orl_sun_map *map, size_t slot, uint64_t key, const struct orl_hit *hit)
{
    if (map->count == ORL_SUN_MAP_MOST_TEXELS)
        return ORL_ERR_LIMIT;
    const int code = map->count == map->areas_room ? grow_texels(map) : 0;
    if (code < 0)
        return code;
    map->areas[map->count] = orl_sun_texel_area(&map->texels, hit);
    map->keys[slot] = key;
    map->texel_indices[slot] = (uint32_t)map->count++;
    return 2 * map->count > map->room ? rehash(map, 2 * map->room) : 0;
}

/* Finds the texel of a hit, and adds it if it is missing. */
static int find_or_add_texel(struct orl_sun_map *map, const struct orl_hit *hit,
                             uint32_t *ret_texel)
{
    const uint64_t key = orl_sun_texel_of(&map->texels, hit);
    size_t slot = slot_of(map, key);
    if (map->keys[slot] == 0) {
        const int code = add_texel(map, slot, key, hit);
        if (code < 0)
            return code;
        slot = slot_of(map, key);
    }
    *ret_texel = map->texel_indices[slot];
    return 0;
}

/* ---- Photons --------------------------------------------------------------------------------- */

static void trace_task(void *arg, size_t index, uint32_t member)
{
    struct orl_sun_photon_task *tasks = arg;
    (void)member;
    orl_sun_photon_task_trace(&tasks[index]);
}

/* Finds the entry of a row and a beam, and adds it if it is missing. Beams must come in order. */
static int find_or_add_sum(struct orl_sun_map *map, uint32_t row, uint32_t beam,
                           struct deposit_sums **ret_entry)
{
    const uint32_t latest = map->latest[row];
    if (latest > 0 && map->deposit_sums[latest - 1].beam == beam) {
        *ret_entry = &map->deposit_sums[latest - 1];
        return 0;
    }
    if (map->n_deposit_sums == ORL_SUN_MAP_MOST_ENTRIES)
        return ORL_ERR_LIMIT;
    if (!orl_array_reserve(&map->deposit_sums, &map->deposit_sums_room, map->n_deposit_sums,
                           sizeof *map->deposit_sums))
        return ORL_ERR_NOMEM;
    *ret_entry = &map->deposit_sums[map->n_deposit_sums++];
    **ret_entry = (struct deposit_sums){.row = row, .beam = beam};
    map->latest[row] = (uint32_t)map->n_deposit_sums;
    return 0;
}

static int add_deposits(struct orl_sun_map *map, const struct orl_sun_photon_task *s)
{
    int code = s->code;
    for (size_t i = 0; i < s->n_deposits && code == 0; i++) {
        const struct orl_sun_deposit *d = &s->deposits[i];
        const struct orl_hit hit = {
            .facet = d->facet, .front = d->front, .point = d->point, .normal = d->normal};
        struct deposit_sums *b = NULL;
        uint32_t texel = 0;
        code = find_or_add_texel(map, &hit, &texel);
        const double area = code == 0 ? map->areas[texel] : 0;
        if (!(area > 0))
            continue;
        code =
            find_or_add_sum(map, texel * ORL_SUN_PHOTON_BATCHES + d->batch, (uint32_t)s->beam, &b);
        for (int c = 0; c < CHANNELS && code == 0; c++)
            b->light[c] += (float)((double)d->flux[c] / area);
    }
    return code;
}

/* A node's photons are divided evenly among its beams. */
static uint32_t photons_of_batch(const struct orl_sun_map *map,
                                 const struct orl_sun_map_request *request, size_t beam)
{
    const uint32_t parts = ORL_SUN_PHOTON_BATCHES * orl_sun_beams_of_node(&map->beams, beam);
    const uint32_t least = request->of_beam / ORL_SUN_PHOTON_BATCHES;
    const uint32_t share = (request->photons + parts - 1) / parts;
    return share > least ? share : least;
}

/* Start of the next task. */
struct cursor {
    size_t beam;
    uint32_t photon;
};

/* Lists up to MOST_AT_ONCE tasks from the cursor on, and advances it. Returns their number. */
static size_t list_tasks(const struct orl_sun_map *map, const struct orl_sun_map_request *request,
                         struct cursor *next, struct orl_sun_photon_task ret_tasks[MOST_AT_ONCE])
{
    size_t n = 0;
    while (n < MOST_AT_ONCE && next->beam < map->beams.count) {
        const uint32_t photons = photons_of_batch(map, request, next->beam);
        const uint32_t left = photons * ORL_SUN_PHOTON_BATCHES - next->photon;
        ret_tasks[n++] = (struct orl_sun_photon_task){
            .beams = &map->beams,
            .nodes = request->nodes,
            .sobol = request->sobol,
            .seed = request->seed,
            .beam = next->beam,
            .photons = photons,
            .first = next->photon,
            .end = next->photon + (left < TASK_PHOTONS ? left : TASK_PHOTONS),
            .interreflection = request->interreflection};
        next->photon += TASK_PHOTONS;
        if (left <= TASK_PHOTONS)
            *next = (struct cursor){.beam = next->beam + 1};
    }
    return n;
}

static int trace_photons(struct orl_sun_map *map, const struct orl_sun_map_request *request,
                         struct orl_thread_pool *pool)
{
    struct orl_sun_photon_task tasks[MOST_AT_ONCE];
    struct cursor next = {.beam = 0};
    int code = rehash(map, 4096);
    while (next.beam < map->beams.count && code == 0) {
        const size_t n = list_tasks(map, request, &next, tasks);
        code = orl_parallel_try(pool, n, trace_task, tasks);
        for (size_t i = 0; i < n; i++) {
            if (code == 0)
                code = add_deposits(map, &tasks[i]);
            orl_sun_photon_task_done(&tasks[i]);
        }
    }
    free(map->latest);
    map->latest = NULL;
    return code;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Sorts the entries by row; entries of a row stay in the order of beams. */
static struct deposit_sums *sort_by_row(const struct orl_sun_map *map, size_t n_rows)
{
    size_t *next = calloc(n_rows + 1, sizeof *next);
    struct deposit_sums *sorted = next ? calloc(map->n_deposit_sums + 1, sizeof *sorted) : NULL;
    for (size_t i = 0; sorted && i < map->n_deposit_sums; i++)
        next[map->deposit_sums[i].row + 1]++;
    for (size_t r = 0; sorted && r < n_rows; r++)
        next[r + 1] += next[r];
    for (size_t i = 0; sorted && i < map->n_deposit_sums; i++)
        sorted[next[map->deposit_sums[i].row]++] = map->deposit_sums[i];
    free(next);
    return sorted;
}

static void fill_rows(struct orl_sun_map *map, const struct deposit_sums *sorted, size_t n_rows)
{
    size_t row = 0;
    for (size_t i = 0; i < map->n_deposit_sums; i++) {
        for (; row <= sorted[i].row; row++)
            map->first[row] = i;
        map->which[i] = sorted[i].beam;
        for (uint32_t c = 0; c < map->channels; c++)
            map->light[i * map->channels + c] = sorted[i].light[c];
    }
    for (; row <= n_rows; row++)
        map->first[row] = map->n_deposit_sums;
}

static int allocate_rows(struct orl_sun_map *map, size_t entries)
{
    map->first = malloc((map->count * ORL_SUN_PHOTON_BATCHES + 1) * sizeof *map->first);
    map->which = malloc((entries + 1) * sizeof *map->which);
    map->light = malloc((entries + 1) * map->channels * sizeof *map->light);
    return map->first && map->which && map->light ? 0 : ORL_ERR_NOMEM;
}

static int make_rows(struct orl_sun_map *map)
{
    const size_t n_rows = map->count * ORL_SUN_PHOTON_BATCHES;
    struct deposit_sums *sorted = sort_by_row(map, n_rows);
    free(map->deposit_sums);
    map->deposit_sums = NULL;
    const int code = allocate_rows(map, map->n_deposit_sums);
    if (sorted && code == 0)
        fill_rows(map, sorted, n_rows);
    free(sorted);
    return sorted ? code : ORL_ERR_NOMEM;
}

/* ---- All of it ------------------------------------------------------------------------------- */

const struct orl_sun_beams *orl_sun_map_beams(const struct orl_sun_map *map)
{
    return &map->beams;
}

/* Creates a map that has everything except photons. */
static int init_map(const struct orl_sun_map_request *request, struct orl_sun_map **ret_map)
{
    const struct orl_lit_scene *lit_scene = request->lit_scene;
    double area = 0;
    struct orl_sun_map *map = *ret_map = calloc(1, sizeof *map);
    if (!map)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        area += lit_scene->ports[i].area / (double)lit_scene->n_ports;
    *map = (struct orl_sun_map){.lit_scene = lit_scene,
                                .channels = orl_annual_is_colourless(lit_scene) ? 1 : CHANNELS};
    const int code =
        orl_sun_texels_init(&map->texels, lit_scene->geometry, sqrt(area) / texels_per_window);
    return code < 0 ? code
                    : orl_sun_beams_init(&map->beams, lit_scene, request->nodes, request->n_nodes,
                                         request->window_group_of_port);
}

static int return_map(int code, struct orl_sun_map *map, struct orl_sun_map **ret_map)
{
    if (code < 0)
        orl_sun_map_free(map);
    *ret_map = code < 0 ? NULL : map;
    return code;
}

int orl_sun_map_new(const struct orl_sun_map_request *request, struct orl_thread_pool *pool,
                    struct orl_sun_map **ret_map)
{
    const struct orl_lit_scene *lit_scene = request->lit_scene;
    struct orl_sun_map *map = NULL;
    *ret_map = NULL;
    if (lit_scene->open || lit_scene->n_ports == 0 || request->n_nodes == 0)
        return 0; /* there are no beams */
    int code = init_map(request, &map);
    if (code == 0)
        code = trace_photons(map, request, pool);
    if (code == 0)
        code = make_rows(map);
    return return_map(code, map, ret_map);
}

/* ---- Storage --------------------------------------------------------------------------------- */

enum { PARTS = 6 };

/* Counts of a stored map: slots, texels, and entries. */
struct stored_map {
    uint64_t room, count, entries;
};

/* Lists the parts of a stored map. */
static void list_parts(struct stored_map *stored, const struct orl_sun_map *map,
                       struct orl_span ret[PARTS])
{
    const size_t rows = stored->count * ORL_SUN_PHOTON_BATCHES, entries = stored->entries;
    ret[0] = (struct orl_span){stored, sizeof *stored};
    ret[1] = (struct orl_span){map->keys, stored->room * sizeof *map->keys};
    ret[2] = (struct orl_span){map->first, (rows + 1) * sizeof *map->first};
    ret[3] = (struct orl_span){map->texel_indices, stored->room * sizeof *map->texel_indices};
    ret[4] = (struct orl_span){map->which, entries * sizeof *map->which};
    ret[5] = (struct orl_span){map->light, entries * map->channels * sizeof *map->light};
}

void *orl_sun_map_save(const struct orl_sun_map *map, size_t *ret_size)
{
    struct stored_map stored = {map->room, map->count,
                                map->first[map->count * ORL_SUN_PHOTON_BATCHES]};
    struct orl_span parts[PARTS];
    list_parts(&stored, map, parts);
    return orl_spans_join(parts, PARTS, ret_size);
}

int orl_sun_map_load(const struct orl_sun_map_request *request, const void *data, size_t size,
                     struct orl_sun_map **ret_map)
{
    struct stored_map stored;
    struct orl_span parts[PARTS];
    struct orl_sun_map *map = NULL;
    int code = init_map(request, &map);
    memcpy(&stored, data, sizeof stored);
    if (code == 0) {
        map->room = stored.room;
        map->count = stored.count;
        map->keys = malloc((map->room + 1) * sizeof *map->keys);
        map->texel_indices = malloc((map->room + 1) * sizeof *map->texel_indices);
        code = allocate_rows(map, stored.entries);
    }
    if (code == 0 && (!map->keys || !map->texel_indices))
        code = ORL_ERR_NOMEM;
    if (code == 0) {
        list_parts(&stored, map, parts);
        orl_spans_fill(parts, PARTS, data, size);
    }
    return return_map(code, map, ret_map);
}

void orl_sun_map_free(struct orl_sun_map *map)
{
    if (!map)
        return;
    orl_sun_texels_done(&map->texels);
    orl_sun_beams_done(&map->beams);
    free(map->keys);
    free(map->texel_indices);
    free(map->areas);
    free(map->deposit_sums);
    free(map->latest);
    free(map->first);
    free(map->which);
    free(map->light);
    free(map);
}

void orl_sun_map_add(const struct orl_sun_map *map, const struct orl_hit *hit,
                     struct orl_rgb weight, double *beams, float *photon_batches)
{
    const size_t slot = slot_of(map, orl_sun_texel_of(&map->texels, hit));
    if (map->keys[slot] == 0)
        return;
    const double r = ORL_LUMA_R * weight.r, g = ORL_LUMA_G * weight.g, b = ORL_LUMA_B * weight.b;
    const size_t first = (size_t)map->texel_indices[slot] * ORL_SUN_PHOTON_BATCHES;
    for (size_t batch = 0; batch < ORL_SUN_PHOTON_BATCHES; batch++)
        for (size_t i = map->first[first + batch]; i < map->first[first + batch + 1]; i++) {
            const float *light = map->light + i * map->channels;
            const double here = map->channels == 1 ? (r + g + b) * (double)light[0]
                                                   : r * (double)light[0] + g * (double)light[1] +
                                                         b * (double)light[2];
            beams[map->which[i]] += here / ORL_SUN_PHOTON_BATCHES;
            photon_batches[(size_t)map->which[i] * ORL_SUN_PHOTON_BATCHES + batch] += (float)here;
        }
}
