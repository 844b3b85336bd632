#include "annual/sun_map/sun_map.h"

#include <stdlib.h>
#include <string.h>

#include "annual/sun_map/sun_photons.h"
#include "annual/sun_map/sun_squares.h"
#include "annual/year/scope.h"

enum { MOST_AT_ONCE = 64, CHANNELS = 3 };
enum { BATCH = 1024 }; /* photons of a beam traced in one call; bounds the deposits in memory */
static const double widths_a_window = 12; /* squares along the side of a window of mean area */

/* Light that one lot of one beam brought to a square. */
struct brought {
    uint32_t row; /* square and lot */
    uint32_t beam;
    float light[CHANNELS]; /* irradiance */
};

struct orl_sun_map {
    const struct orl_world *world;
    struct orl_sun_squares squares;
    struct orl_sun_beams beams;
    uint32_t channels; /* 1 if no material on the way colours light */
    /* Hash table of square identifiers, by open addressing: index of the square, and areas by
     * index. */
    uint64_t *names;
    uint32_t *places;
    size_t room, count, areas_room;
    double *areas;
    /* Deposits while photons are traced: one entry for each pair of a beam and a row. */
    struct brought *brought;
    uint32_t *latest; /* by row: index of its latest entry, plus one; 0: none */
    size_t n_brought, brought_room;
    /* Rows, one for each lot of each square: the beams that reached it. */
    size_t *first; /* by row, plus one at the end: first index into the next two */
    uint32_t *which;
    float *light; /* [entry][channel]: irradiance */
};

/* ---- Squares --------------------------------------------------------------------------------- */

static size_t slot_of(const struct orl_sun_map *map, uint64_t name)
{
    size_t slot = (size_t)orl_mix64(name) & (map->room - 1);
    while (map->names[slot] != 0 && map->names[slot] != name)
        slot = (slot + 1) & (map->room - 1);
    return slot;
}

static int rehash(struct orl_sun_map *map, size_t room)
{
    uint64_t *names = map->names;
    uint32_t *places = map->places;
    const size_t before = map->room;
    map->names = calloc(room, sizeof *map->names);
    map->places = calloc(room, sizeof *map->places);
    map->room = room;
    for (size_t i = 0; map->names && map->places && i < before; i++) {
        if (names[i] == 0)
            continue;
        const size_t slot = slot_of(map, names[i]);
        map->names[slot] = names[i];
        map->places[slot] = places[i];
    }
    free(names);
    free(places);
    return map->names && map->places ? 0 : ORL_ERR_NOMEM;
}

static int grow_squares(struct orl_sun_map *map)
{
    const size_t room = map->areas_room > 0 ? 2 * map->areas_room : 1024;
    double *areas = realloc(map->areas, room * sizeof *areas);
    if (!areas)
        return ORL_ERR_NOMEM;
    map->areas = areas;
    uint32_t *latest = realloc(map->latest, room * ORL_SUN_MAP_LOTS * sizeof *latest);
    if (!latest)
        return ORL_ERR_NOMEM;
    memset(latest + map->areas_room * ORL_SUN_MAP_LOTS, 0,
           (room - map->areas_room) * ORL_SUN_MAP_LOTS * sizeof *latest);
    map->latest = latest;
    map->areas_room = room;
    return 0;
}

/* Adds a square. */
static int add_square(struct orl_sun_map *map, size_t slot, uint64_t name,
                      const struct orl_hit *hit)
{
    if (map->count == ORL_SUN_MAP_MOST_SQUARES)
        return ORL_ERR_LIMIT;
    const int code = map->count == map->areas_room ? grow_squares(map) : 0;
    if (code < 0)
        return code;
    map->areas[map->count] = orl_sun_square_area(&map->squares, hit);
    map->names[slot] = name;
    map->places[slot] = (uint32_t)map->count++;
    return 2 * map->count > map->room ? rehash(map, 2 * map->room) : 0;
}

/* Finds the square of a hit, and adds it if it is missing. */
static int need_square(struct orl_sun_map *map, const struct orl_hit *hit, uint32_t *ret_place)
{
    const uint64_t name = orl_sun_square_of(&map->squares, hit);
    size_t slot = slot_of(map, name);
    if (map->names[slot] == 0) {
        const int code = add_square(map, slot, name, hit);
        if (code < 0)
            return code;
        slot = slot_of(map, name);
    }
    *ret_place = map->places[slot];
    return 0;
}

/* ---- Photons --------------------------------------------------------------------------------- */

static void trace_shot(void *arg, size_t index, uint32_t member)
{
    struct orl_sun_shot *shots = arg;
    (void)member;
    orl_sun_shoot(&shots[index]);
}

/* Finds the entry of a row and a beam, and adds it if it is missing. Beams must come in order. */
static int need_entry(struct orl_sun_map *map, uint32_t row, uint32_t beam,
                      struct brought **ret_entry)
{
    const uint32_t latest = map->latest[row];
    if (latest > 0 && map->brought[latest - 1].beam == beam) {
        *ret_entry = &map->brought[latest - 1];
        return 0;
    }
    if (map->n_brought == ORL_SUN_MAP_MOST_ENTRIES)
        return ORL_ERR_LIMIT;
    if (map->n_brought == map->brought_room) {
        const size_t room = map->brought_room + map->brought_room / 2 + 4096;
        struct brought *grown = realloc(map->brought, room * sizeof *grown);
        if (!grown)
            return ORL_ERR_NOMEM;
        map->brought = grown;
        map->brought_room = room;
    }
    *ret_entry = &map->brought[map->n_brought++];
    **ret_entry = (struct brought){.row = row, .beam = beam};
    map->latest[row] = (uint32_t)map->n_brought;
    return 0;
}

static int add_deposits(struct orl_sun_map *map, const struct orl_sun_shot *s)
{
    int code = s->code;
    for (size_t i = 0; i < s->n_deposits && code == 0; i++) {
        const struct orl_sun_deposit *d = &s->deposits[i];
        const struct orl_hit hit = {
            .facet = d->facet, .front = d->front, .point = d->point, .normal = d->normal};
        struct brought *b = NULL;
        uint32_t place = 0;
        code = need_square(map, &hit, &place);
        const double area = code == 0 ? map->areas[place] : 0;
        if (!(area > 0))
            continue;
        code = need_entry(map, place * ORL_SUN_MAP_LOTS + d->lot, (uint32_t)s->beam, &b);
        for (int c = 0; c < CHANNELS && code == 0; c++)
            b->light[c] += (float)((double)d->flux[c] / area);
    }
    return code;
}

/* A node's photons are divided evenly among its beams. */
static uint32_t photons_of_lot(const struct orl_sun_map *map,
                               const struct orl_sun_map_request *request, size_t beam)
{
    const uint32_t parts = ORL_SUN_MAP_LOTS * orl_sun_beams_of_node(&map->beams, beam);
    const uint32_t least = request->of_beam / ORL_SUN_MAP_LOTS;
    const uint32_t share = (request->photons + parts - 1) / parts;
    return share > least ? share : least;
}

/* Start of the next batch. */
struct cursor {
    size_t beam;
    uint32_t photon;
};

/* Lists up to MOST_AT_ONCE batches from the cursor on, and advances it. Returns their number. */
static size_t list_shots(const struct orl_sun_map *map, const struct orl_sun_map_request *request,
                         struct cursor *next, struct orl_sun_shot ret_shots[MOST_AT_ONCE])
{
    size_t n = 0;
    while (n < MOST_AT_ONCE && next->beam < map->beams.count) {
        const uint32_t photons = photons_of_lot(map, request, next->beam);
        const uint32_t left = photons * ORL_SUN_MAP_LOTS - next->photon;
        ret_shots[n++] = (struct orl_sun_shot){.beams = &map->beams,
                                               .nodes = request->nodes,
                                               .sobol = request->sobol,
                                               .seed = request->seed,
                                               .beam = next->beam,
                                               .photons = photons,
                                               .first = next->photon,
                                               .end = next->photon + (left < BATCH ? left : BATCH),
                                               .whole = request->whole};
        next->photon += BATCH;
        if (left <= BATCH)
            *next = (struct cursor){.beam = next->beam + 1};
    }
    return n;
}

static int trace_photons(struct orl_sun_map *map, const struct orl_sun_map_request *request,
                         struct orl_crew *crew)
{
    struct orl_sun_shot shots[MOST_AT_ONCE];
    struct cursor next = {.beam = 0};
    int code = rehash(map, 4096);
    while (next.beam < map->beams.count && code == 0) {
        const size_t n = list_shots(map, request, &next, shots);
        code = orl_crew_try(crew, n, trace_shot, shots);
        for (size_t i = 0; i < n; i++) {
            if (code == 0)
                code = add_deposits(map, &shots[i]);
            orl_sun_shot_done(&shots[i]);
        }
    }
    free(map->latest);
    map->latest = NULL;
    return code;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Sorts the entries by row; entries of a row stay in the order of beams. */
static struct brought *sort_by_row(const struct orl_sun_map *map, size_t n_rows)
{
    struct brought *sorted = calloc(map->n_brought + 1, sizeof *sorted);
    size_t *next = calloc(n_rows + 1, sizeof *next);
    for (size_t i = 0; sorted && next && i < map->n_brought; i++)
        next[map->brought[i].row + 1]++;
    for (size_t r = 0; sorted && next && r < n_rows; r++)
        next[r + 1] += next[r];
    for (size_t i = 0; sorted && next && i < map->n_brought; i++)
        sorted[next[map->brought[i].row]++] = map->brought[i];
    if (!next) {
        free(sorted);
        sorted = NULL;
    }
    free(next);
    return sorted;
}

static void fill_rows(struct orl_sun_map *map, const struct brought *sorted, size_t n_rows)
{
    size_t row = 0;
    for (size_t i = 0; i < map->n_brought; i++) {
        for (; row <= sorted[i].row; row++)
            map->first[row] = i;
        map->which[i] = sorted[i].beam;
        for (uint32_t c = 0; c < map->channels; c++)
            map->light[i * map->channels + c] = sorted[i].light[c];
    }
    for (; row <= n_rows; row++)
        map->first[row] = map->n_brought;
}

static int make_rows(struct orl_sun_map *map)
{
    const size_t n_rows = map->count * ORL_SUN_MAP_LOTS, n = map->n_brought;
    struct brought *sorted = sort_by_row(map, n_rows);
    free(map->brought);
    map->brought = NULL;
    map->first = malloc((n_rows + 1) * sizeof *map->first);
    map->which = malloc((n + 1) * sizeof *map->which);
    map->light = malloc((n + 1) * map->channels * sizeof *map->light);
    const bool room = sorted && map->first && map->which && map->light;
    if (room)
        fill_rows(map, sorted, n_rows);
    free(sorted);
    return room ? 0 : ORL_ERR_NOMEM;
}

/* ---- All of it ------------------------------------------------------------------------------- */

const struct orl_sun_beams *orl_sun_map_beams(const struct orl_sun_map *map)
{
    return &map->beams;
}

/* Creates a map that has everything except photons. */
static int init_map(const struct orl_sun_map_request *request, struct orl_sun_map **ret_map)
{
    const struct orl_world *world = request->world;
    double area = 0;
    struct orl_sun_map *map = *ret_map = calloc(1, sizeof *map);
    if (!map)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < world->n_ports; i++)
        area += world->ports[i].area / (double)world->n_ports;
    *map = (struct orl_sun_map){.world = world,
                                .channels = orl_annual_is_colourless(world) ? 1 : CHANNELS};
    const int code =
        orl_sun_squares_init(&map->squares, world->geometry, sqrt(area) / widths_a_window);
    return code < 0 ? code
                    : orl_sun_beams_init(&map->beams, world, request->nodes, request->n_nodes,
                                         request->part_of_port);
}

static int return_map(int code, struct orl_sun_map *map, struct orl_sun_map **ret_map)
{
    if (code < 0)
        orl_sun_map_free(map);
    *ret_map = code < 0 ? NULL : map;
    return code;
}

int orl_sun_map_new(const struct orl_sun_map_request *request, struct orl_crew *crew,
                    struct orl_sun_map **ret_map)
{
    const struct orl_world *world = request->world;
    struct orl_sun_map *map = NULL;
    *ret_map = NULL;
    if (world->open || world->n_ports == 0 || request->n_nodes == 0)
        return 0; /* there are no beams */
    int code = init_map(request, &map);
    if (code == 0)
        code = trace_photons(map, request, crew);
    if (code == 0)
        code = make_rows(map);
    return return_map(code, map, ret_map);
}

/* ---- Storage --------------------------------------------------------------------------------- */

struct array {
    void **at;
    size_t bytes;
};

enum { ARRAYS = 5 };

/* Lists the arrays of a map whose room, count and number of entries are set. */
static void list_arrays(struct orl_sun_map *map, size_t entries, struct array ret[ARRAYS])
{
    ret[0] = (struct array){(void **)&map->names, map->room * sizeof *map->names};
    ret[1] = (struct array){(void **)&map->first,
                            (map->count * ORL_SUN_MAP_LOTS + 1) * sizeof *map->first};
    ret[2] = (struct array){(void **)&map->places, map->room * sizeof *map->places};
    ret[3] = (struct array){(void **)&map->which, entries * sizeof *map->which};
    ret[4] = (struct array){(void **)&map->light, entries * map->channels * sizeof *map->light};
}

int orl_sun_map_save(const struct orl_sun_map *map, void **ret_data, size_t *ret_size)
{
    struct orl_sun_map copy = *map;
    const uint64_t numbers[] = {map->room, map->count, map->first[map->count * ORL_SUN_MAP_LOTS]};
    struct array arrays[ARRAYS];
    size_t size = sizeof numbers;
    list_arrays(&copy, numbers[2], arrays);
    for (int i = 0; i < ARRAYS; i++)
        size += arrays[i].bytes;
    char *at = *ret_data = malloc(size);
    if (!at)
        return ORL_ERR_NOMEM;
    memcpy(at, numbers, sizeof numbers);
    at += sizeof numbers;
    for (int i = 0; i < ARRAYS; at += arrays[i++].bytes)
        memcpy(at, *arrays[i].at, arrays[i].bytes);
    *ret_size = size;
    return 0;
}

int orl_sun_map_load(const struct orl_sun_map_request *request, const void *data,
                     struct orl_sun_map **ret_map)
{
    uint64_t numbers[3];
    struct array arrays[ARRAYS];
    struct orl_sun_map *map = NULL;
    const char *at = data;
    int code = init_map(request, &map);
    memcpy(numbers, at, sizeof numbers);
    at += sizeof numbers;
    if (code == 0) {
        map->room = numbers[0];
        map->count = numbers[1];
        list_arrays(map, numbers[2], arrays);
    }
    for (int i = 0; i < ARRAYS && code == 0; at += arrays[i++].bytes) {
        *arrays[i].at = malloc(arrays[i].bytes + 1);
        if (*arrays[i].at)
            memcpy(*arrays[i].at, at, arrays[i].bytes);
        else
            code = ORL_ERR_NOMEM;
    }
    return return_map(code, map, ret_map);
}

void orl_sun_map_free(struct orl_sun_map *map)
{
    if (!map)
        return;
    orl_sun_squares_done(&map->squares);
    orl_sun_beams_done(&map->beams);
    free(map->names);
    free(map->places);
    free(map->areas);
    free(map->brought);
    free(map->latest);
    free(map->first);
    free(map->which);
    free(map->light);
    free(map);
}

void orl_sun_map_add(const struct orl_sun_map *map, const struct orl_hit *hit,
                     struct orl_rgb weight, double *beams, float *lots)
{
    const size_t slot = slot_of(map, orl_sun_square_of(&map->squares, hit));
    if (map->names[slot] == 0)
        return;
    const double r = ORL_LUMA_R * weight.r, g = ORL_LUMA_G * weight.g, b = ORL_LUMA_B * weight.b;
    const size_t first = (size_t)map->places[slot] * ORL_SUN_MAP_LOTS;
    for (size_t lot = 0; lot < ORL_SUN_MAP_LOTS; lot++)
        for (size_t i = map->first[first + lot]; i < map->first[first + lot + 1]; i++) {
            const float *light = map->light + i * map->channels;
            const double here = map->channels == 1 ? (r + g + b) * (double)light[0]
                                                   : r * (double)light[0] + g * (double)light[1] +
                                                         b * (double)light[2];
            beams[map->which[i]] += here / ORL_SUN_MAP_LOTS;
            lots[(size_t)map->which[i] * ORL_SUN_MAP_LOTS + lot] += (float)here;
        }
}
