#include "annual/sun_map.h"

#include <stdlib.h>
#include <string.h>

#include "annual/sun_squares.h"
#include "light/direct.h"
#include "light/path.h"

enum { MOST_BOUNCES = 64, MOST_AT_ONCE = 64, CHANNELS = 3 };
static const double widths_a_window = 12; /* squares along the side of a window, on average */
static const double dimmest = 0.05;       /* of a photon's first flux: dimmer ones live by lot */

struct orl_sun_map {
    const struct orl_world *world;
    struct orl_sun_squares squares;
    struct orl_sun_beams beams;
    uint32_t channels; /* 1 where nothing on the way colours light */
    /* Names of squares, by open addressing: where they stand in the rows, plus one. */
    uint64_t *names;
    uint32_t *places;
    size_t room, count, rows_room;
    double *areas;
    float *rows; /* [square][lot][beam][channel]: irradiance */
};

/* ---- Squares --------------------------------------------------------------------------------- */

static size_t slot_of(const struct orl_sun_map *map, uint64_t name)
{
    size_t slot = (size_t)orl_mix64(name) & (map->room - 1);
    while (map->names[slot] != 0 && map->names[slot] != name)
        slot = (slot + 1) & (map->room - 1);
    return slot;
}

static size_t row_floats(const struct orl_sun_map *map)
{
    const size_t floats = ORL_SUN_MAP_LOTS * map->beams.count * map->channels;
    return floats > 0 ? floats : 1;
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

/* One more square. */
static int add_square(struct orl_sun_map *map, size_t slot, uint64_t name,
                      const struct orl_hit *hit)
{
    if (map->count == map->rows_room) {
        const size_t room = map->rows_room > 0 ? 2 * map->rows_room : 1024;
        float *rows = realloc(map->rows, room * row_floats(map) * sizeof *rows);
        if (rows)
            map->rows = rows;
        double *areas = realloc(map->areas, room * sizeof *areas);
        if (areas)
            map->areas = areas;
        if (!rows || !areas)
            return ORL_ERR_NOMEM;
        map->rows_room = room;
    }
    memset(map->rows + map->count * row_floats(map), 0, row_floats(map) * sizeof *map->rows);
    map->areas[map->count] = orl_sun_square_area(&map->squares, hit);
    map->names[slot] = name;
    map->places[slot] = (uint32_t)map->count++;
    return 2 * map->count > map->room ? rehash(map, 2 * map->room) : 0;
}

/* ---- Photons --------------------------------------------------------------------------------- */

struct deposit {
    uint32_t facet;
    uint32_t lot;
    bool front;
    struct orl_vec3 point, normal;
    float flux[CHANNELS];
};

/* A beam's photons under way. */
struct shooter {
    const struct orl_sun_map_request *request;
    const struct orl_sun_map *map;
    size_t beam;
    uint32_t photons; /* of each lot */
    double *shares;   /* by port: of its light in all, summed up */
    double flux;      /* of all ports */
    struct deposit *deposits;
    size_t n_deposits, room;
    int code;
};

static void deposit(struct shooter *s, const struct orl_hit *hit, uint32_t lot, struct orl_rgb flux)
{
    if (!orl_rgb_is_finite(flux))
        return;
    if (s->n_deposits == s->room) {
        const size_t room = s->room > 0 ? 2 * s->room : 1024;
        struct deposit *grown = realloc(s->deposits, room * sizeof *grown);
        if (!grown) {
            s->code = ORL_ERR_NOMEM;
            return;
        }
        s->deposits = grown;
        s->room = room;
    }
    s->deposits[s->n_deposits++] =
        (struct deposit){.facet = hit->facet,
                         .lot = lot,
                         .front = hit->front,
                         .point = hit->point,
                         .normal = hit->normal,
                         .flux = {(float)flux.r, (float)flux.g, (float)flux.b}};
}

/* From inside a port to where no lobe sends it on. */
static void fly(struct shooter *s, struct orl_path path, uint32_t lot, struct orl_random *random)
{
    const struct orl_world *world = s->map->world;
    const double first = orl_rgb_max(path.weight);
    bool outside = false;
    for (int bounce = 0; bounce < MOST_BOUNCES; bounce++) {
        struct orl_hit hit;
        if (!orl_path_meet(world, &path, &hit))
            return;
        const struct orl_material *m = orl_world_material(world, &hit);
        orl_path_arrive(&path, m, &hit);
        if (!outside && orl_rgb_max(orl_material_diffuse(m, &hit)) > 0)
            deposit(s, &hit, lot, path.weight);
        if (orl_material_is_matt(m))
            return;
        const struct orl_scatter scatter =
            orl_scatter_sample(m, &hit, orl_path_back(&path), ORL_TRANSPORT_LIGHT,
                               (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED), random);
        if (scatter.event == ORL_EVENT_ABSORBED)
            return;
        path.weight = orl_rgb_mul(path.weight, scatter.weight);
        const double chance = fmin(orl_rgb_max(path.weight) / (first * dimmest), 1);
        if (!(chance > 0) || (chance < 1 && !orl_path_survives(&path, chance, random)))
            return;
        outside = orl_world_outside_after(world, &hit, scatter.transmitted, outside);
        orl_path_leave(&path, world, &hit, &scatter);
    }
}

static size_t port_at(const struct shooter *s, double share)
{
    const size_t n = s->map->world->n_ports;
    size_t low = 0, high = n - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (share < s->shares[middle])
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* One photon from the sun's disc onto a port, and through it. */
static void shoot_one(struct shooter *s, uint32_t index, uint32_t lot, double flux)
{
    const struct orl_world *world = s->map->world;
    const struct orl_frame *sun = &s->request->nodes[s->map->beams.at[s->beam].node];
    const uint64_t name = (uint64_t)s->beam * ORL_SUN_MAP_LOTS + lot;
    struct orl_random random =
        orl_random_stream(s->request->seed, ORL_PURPOSE_SUN_MAP, (name << 32) + index);
    double u[ORL_SOBOL_DIMENSIONS];
    orl_sobol_point(s->request->sobol, index,
                    (uint32_t)orl_mix64(s->request->seed + orl_mix64(name + 1)),
                    ORL_SOBOL_DIMENSIONS, u);
    const struct orl_port *port = &world->ports[port_at(s, u[2] * s->flux)];
    const double disc = 0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD;
    const struct orl_sun there = {.frame = *sun, .cos_half_angle = cos(disc)};
    const double on_disc[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
    const struct orl_vec3 towards = orl_sun_sample(&there, on_disc);
    struct orl_hit hit = {.facet = port->facet};
    orl_facet_sample(world->geometry, port->facet, u, &hit.point, &hit.normal);
    hit.front = orl_dot(towards, hit.normal) > 0;
    if (!(orl_dot(towards, port->outward) > 0) || !orl_port_owns(world->geometry, port, hit.point))
        return;
    const struct orl_rgb share = orl_transmittance(
        world, orl_hit_leave(world->geometry, &hit, towards), towards, INFINITY, false);
    if (!(orl_rgb_max(share) > 0))
        return;
    const struct orl_material *m = orl_world_material(world, &hit);
    const struct orl_scatter scatter =
        orl_scatter_sample_at(m, &hit, towards, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED, u + 3);
    if (scatter.event == ORL_EVENT_ABSORBED)
        return;
    struct orl_path path = orl_path_from(hit.point, scatter.direction);
    path.weight = orl_rgb_scale(orl_rgb_mul(share, scatter.weight), flux);
    orl_path_leave(&path, world, &hit, &scatter);
    fly(s, path, lot, &random);
}

/* All of a beam's; the flux that comes to ports is what they would have with nothing before them.
 */
static void shoot_beam(struct shooter *s)
{
    const struct orl_world *world = s->map->world;
    const struct orl_sun_beam *beam = &s->map->beams.at[s->beam];
    const struct orl_vec3 sun = s->request->nodes[beam->node].n;
    s->shares = malloc(world->n_ports * sizeof *s->shares);
    if (!s->shares) {
        s->code = ORL_ERR_NOMEM;
        return;
    }
    for (size_t i = 0; i < world->n_ports; i++) {
        if (s->map->beams.kind_of_port[i] == beam->kind)
            s->flux += world->ports[i].area * fmax(orl_dot(sun, world->ports[i].outward), 0);
        s->shares[i] = s->flux;
    }
    for (uint32_t i = 0; s->flux > 0 && i < s->photons * ORL_SUN_MAP_LOTS && s->code == 0; i++)
        shoot_one(s, i / ORL_SUN_MAP_LOTS, i % ORL_SUN_MAP_LOTS, s->flux / s->photons);
}

static void shoot(void *arg, size_t index, uint32_t member)
{
    struct shooter *shooters = arg;
    (void)member;
    shoot_beam(&shooters[index]);
}

/* ---- The map --------------------------------------------------------------------------------- */

static int take(struct orl_sun_map *map, const struct shooter *s)
{
    for (size_t i = 0; i < s->n_deposits; i++) {
        const struct deposit *d = &s->deposits[i];
        const struct orl_hit hit = {
            .facet = d->facet, .front = d->front, .point = d->point, .normal = d->normal};
        const uint64_t name = orl_sun_square_of(&map->squares, &hit);
        size_t slot = slot_of(map, name);
        if (map->names[slot] == 0) {
            const int code = add_square(map, slot, name, &hit);
            if (code < 0)
                return code;
            slot = slot_of(map, name);
        }
        const size_t place = map->places[slot];
        float *at = map->rows + place * row_floats(map) +
                    ((size_t)d->lot * map->beams.count + s->beam) * map->channels;
        const double area = map->areas[place];
        for (uint32_t c = 0; c < map->channels && area > 0; c++)
            at[c] += (float)((double)d->flux[c] / area);
    }
    return 0;
}

/* A node's are shared out evenly among its beams. */
static uint32_t photons_of_lot(const struct orl_sun_map *map,
                               const struct orl_sun_map_request *request, size_t beam)
{
    const uint32_t parts = ORL_SUN_MAP_LOTS * orl_sun_beams_of_node(&map->beams, beam);
    return (request->photons + parts - 1) / parts;
}

static int fill(struct orl_sun_map *map, const struct orl_sun_map_request *request,
                struct orl_crew *crew)
{
    struct shooter shooters[MOST_AT_ONCE];
    int code = rehash(map, 4096);
    for (size_t first = 0; first < map->beams.count && code == 0; first += MOST_AT_ONCE) {
        const size_t left = map->beams.count - first;
        const size_t n = left < MOST_AT_ONCE ? left : MOST_AT_ONCE;
        for (size_t i = 0; i < n; i++)
            shooters[i] = (struct shooter){.request = request,
                                           .map = map,
                                           .beam = first + i,
                                           .photons = photons_of_lot(map, request, first + i)};
        code = orl_crew_try(crew, n, shoot, shooters);
        for (size_t i = 0; i < n; i++) {
            if (code == 0)
                code = shooters[i].code < 0 ? shooters[i].code : take(map, &shooters[i]);
            free(shooters[i].deposits);
            free(shooters[i].shares);
        }
    }
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static bool is_gray(struct orl_rgb color)
{
    return color.r == color.g && color.g == color.b;
}

static bool is_gray_panel(const struct orl_material *m)
{
    struct orl_bsdf_info info;
    orl_bsdf_describe(m->bsdf, &info);
    return !info.colored && is_gray(m->front) && is_gray(m->back) && is_gray(m->through);
}

/* Whether a material sends light on, but diffusely, without colour. */
static bool is_colourless(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_BSDF:
        return is_gray_panel(m);
    case ORL_MATERIAL_GLASS:
        return is_gray(m->transmissivity);
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_MIRROR:
        return is_gray(m->color) || orl_material_is_matt(m);
    default: /* plastic's gloss is white */
        return true;
    }
}

static bool are_colourless(const struct orl_world *world)
{
    for (size_t i = 0; i < world->n_materials; i++)
        if (!is_colourless(&world->materials[i]))
            return false;
    return true;
}

const struct orl_sun_beams *orl_sun_map_beams(const struct orl_sun_map *map)
{
    return &map->beams;
}

int orl_sun_map_new(const struct orl_sun_map_request *request, struct orl_crew *crew,
                    struct orl_sun_map **ret_map)
{
    const struct orl_world *world = request->world;
    double area = 0;
    *ret_map = NULL;
    if (world->open || world->n_ports == 0 || request->n_nodes == 0)
        return 0; /* no beams either */
    for (size_t i = 0; i < world->n_ports; i++)
        area += world->ports[i].area / (double)world->n_ports;
    struct orl_sun_map *map = calloc(1, sizeof *map);
    if (!map)
        return ORL_ERR_NOMEM;
    *map = (struct orl_sun_map){.world = world, .channels = are_colourless(world) ? 1 : CHANNELS};
    int code = orl_sun_squares_init(&map->squares, world->geometry, sqrt(area) / widths_a_window);
    if (code == 0)
        code = orl_sun_beams_init(&map->beams, world, request->nodes, request->n_nodes);
    if (code == 0)
        code = fill(map, request, crew);
    if (code < 0) {
        orl_sun_map_free(map);
        return code;
    }
    *ret_map = map;
    return 0;
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
    free(map->rows);
    free(map);
}

void orl_sun_map_add(const struct orl_sun_map *map, const struct orl_hit *hit, uint32_t lot,
                     struct orl_rgb weight, double *beams)
{
    const size_t slot = slot_of(map, orl_sun_square_of(&map->squares, hit));
    if (map->names[slot] == 0)
        return;
    const size_t n = map->beams.count;
    const float *row = map->rows + map->places[slot] * row_floats(map) +
                       (size_t)(lot % ORL_SUN_MAP_LOTS) * n * map->channels;
    if (map->channels == 1) {
        const double by = orl_luma(weight);
        for (size_t k = 0; k < n; k++)
            beams[k] += by * (double)row[k];
        return;
    }
    const double r = ORL_LUMA_R * weight.r, g = ORL_LUMA_G * weight.g, b = ORL_LUMA_B * weight.b;
    for (size_t k = 0; k < n; k++)
        beams[k] +=
            r * (double)row[3 * k] + g * (double)row[3 * k + 1] + b * (double)row[3 * k + 2];
}
