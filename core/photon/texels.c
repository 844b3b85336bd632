#include "photon/texels.h"

#include <stdatomic.h>
#include <stdlib.h>

#include "photon/flux.h"
#include "photon/pack.h"

enum { MOST_ACROSS = 4096, LEAVES_A_CHUNK = 1024, SLICES = 16, RECENT = 4 };

/* A square of which less than this share is surface is taken together with its fullest neighbour.
 */
static const double least_share = 0.25;

static const uint32_t nowhere = UINT32_MAX;

/* A side of a facet, and its texels. */
struct side {
    uint32_t first, across, down; /* none: across is 0 */
    double width, height;         /* of a texel */
};

/* A facet's plane. */
struct sheet {
    struct orl_frame frame;
    struct orl_vec3 origin; /* the least x and y of the facet */
    double wide, high;
    uint32_t first, triangles;
};

struct corner {
    double x, y;
};
struct flat {
    struct corner corners[3];
};

struct orl_texels {
    const struct orl_world *world;
    const struct orl_geometry *geometry; /* the world's */
    struct sheet *sheets;                /* per facet */
    struct flat *flats;                  /* per triangle, in its facet's plane */
    bool *has;                           /* per facet */
    struct side *sides;                  /* per facet: back, front */
    struct orl_texel *texels;
    uint32_t count;
    double photons; /* a texel's, on average */
};

/* What there is only while texels are made. */
struct making {
    struct orl_texels *texels;
    const struct orl_photon_map *map;
    uint32_t *places;      /* per photon: its side, then its texel */
    atomic_bool *doubtful; /* per facet: another coincides with it */
    float *areas;          /* per texel */
};

/* ---- Planes ---------------------------------------------------------------------------------- */

static struct corner corner_of(const struct sheet *sheet, struct orl_vec3 point)
{
    const struct orl_vec3 way = orl_sub(point, sheet->origin);
    return (struct corner){orl_dot(way, sheet->frame.u), orl_dot(way, sheet->frame.v)};
}

static struct orl_vec3 vertex_of(const struct orl_triangle *t, int i)
{
    return i == 0 ? t->a : i == 1 ? t->b : t->c;
}

static void lay_out(struct orl_texels *texels, uint32_t facet)
{
    const struct orl_geometry *g = texels->geometry;
    const struct orl_facet *f = &g->facets[facet];
    struct sheet *sheet = &texels->sheets[facet];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    *sheet = (struct sheet){.frame = orl_frame_about(f->normal),
                            .first = f->first_triangle,
                            .triangles = f->n_triangles};
    texels->has[facet] = f->n_triangles > 0 && f->area > 0;
    if (!texels->has[facet])
        return;
    for (uint32_t i = 0; i < 3 * f->n_triangles; i++) {
        const struct orl_vec3 a = vertex_of(&g->triangles[f->first_triangle + i / 3], (int)(i % 3));
        const double x = orl_dot(a, sheet->frame.u), y = orl_dot(a, sheet->frame.v);
        low[0] = fmin(low[0], x);
        low[1] = fmin(low[1], y);
        high[0] = fmax(high[0], x);
        high[1] = fmax(high[1], y);
    }
    sheet->wide = high[0] - low[0];
    sheet->high = high[1] - low[1];
    const double level = orl_dot(g->triangles[f->first_triangle].a, f->normal);
    sheet->origin =
        orl_add(orl_scale(f->normal, level),
                orl_add(orl_scale(sheet->frame.u, low[0]), orl_scale(sheet->frame.v, low[1])));
    for (uint32_t i = 0; i < f->n_triangles; i++)
        for (int k = 0; k < 3; k++)
            texels->flats[f->first_triangle + i].corners[k] =
                corner_of(sheet, vertex_of(&g->triangles[f->first_triangle + i], k));
}

/* Twice the signed area of a triangle of three corners. */
static double turn(struct corner a, struct corner b, struct corner c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool is_in_flat(const struct flat *t, struct corner p)
{
    const double a = turn(t->corners[0], t->corners[1], p);
    const double b = turn(t->corners[1], t->corners[2], p);
    const double c = turn(t->corners[2], t->corners[0], p);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/* ---- Photons back to their facets ------------------------------------------------------------ */

struct landed {
    struct orl_vec3 point, normal;
    uint16_t code; /* of the normal */
};

/* The facets that photons landed on last, and the codes of their two normals. */
struct recent {
    uint32_t facets[RECENT];
    uint16_t codes[RECENT]; /* of the side that was lit */
    uint32_t count;
};

static bool is_on(const struct orl_texels *texels, uint32_t facet, const struct landed *photon,
                  double rounding)
{
    const struct sheet *sheet = &texels->sheets[facet];
    const struct orl_vec3 way = orl_sub(photon->point, sheet->origin);
    if (fabs(orl_dot(way, sheet->frame.n)) > rounding)
        return false;
    const struct corner at = corner_of(sheet, photon->point);
    for (uint32_t i = 0; i < sheet->triangles; i++)
        if (is_in_flat(&texels->flats[sheet->first + i], at))
            return true;
    return false;
}

/* A recent facet that the photon lies on; or nowhere. */
static uint32_t recall(const struct orl_texels *texels, struct recent *recent,
                       const struct landed *photon, double rounding)
{
    for (uint32_t i = 0; i < recent->count; i++)
        if (recent->codes[i] == photon->code && is_on(texels, recent->facets[i], photon, rounding))
            return recent->facets[i];
    return nowhere;
}

static void remember(struct recent *recent, uint32_t facet, uint16_t code)
{
    if (recent->count < RECENT)
        recent->count++;
    for (uint32_t i = recent->count; --i > 0;) {
        recent->facets[i] = recent->facets[i - 1];
        recent->codes[i] = recent->codes[i - 1];
    }
    recent->facets[0] = facet;
    recent->codes[0] = code;
}

/* What a ray from above the photon meets; or nowhere. */
static uint32_t ask(const struct orl_geometry *g, const struct landed *photon, double rounding)
{
    const struct orl_vec3 start = orl_madd(photon->point, photon->normal, 4 * rounding);
    struct orl_hit hit;
    return orl_geometry_intersect(g, start, orl_neg(photon->normal), 8 * rounding, &hit) ? hit.facet
                                                                                         : nowhere;
}

static struct landed landed_of(const struct orl_photon_map *map, uint64_t index)
{
    const struct orl_map_header *h = map->header;
    const uint32_t *words = map->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    const uint32_t at = (uint32_t)(index % ORL_MAP_LEAF);
    uint32_t cell[3];
    orl_place_unpack(words[at], words[at + ORL_MAP_LEAF], cell);
    const uint16_t code = map->normals[index];
    return (struct landed){orl_v3(h->low[0] + (cell[0] + 0.5) * h->cell,
                                  h->low[1] + (cell[1] + 0.5) * h->cell,
                                  h->low[2] + (cell[2] + 0.5) * h->cell),
                           orl_normal_decode(code), code};
}

/*
 * The facet of a photon. Every leaf's first is asked by a ray; should a recent facet hold it and
 * the ray meet another, the two coincide, and neither is to be had by texels.
 */
static uint32_t facet_of(const struct making *m, const struct landed *photon, bool sure,
                         struct recent *recent)
{
    const struct orl_texels *texels = m->texels;
    const double rounding = 2 * m->map->header->cell + texels->geometry->radius * 0x1p-20;
    const uint32_t known = recall(texels, recent, photon, rounding);
    if (known != nowhere && !sure)
        return known;
    const uint32_t met = ask(texels->geometry, photon, rounding);
    if (met == nowhere)
        return known;
    if (known != nowhere && met != known) {
        atomic_store_explicit(&m->doubtful[known], true, memory_order_relaxed);
        atomic_store_explicit(&m->doubtful[met], true, memory_order_relaxed);
    }
    if (met != known && texels->has[met])
        remember(recent, met, photon->code);
    return met;
}

static void find_facets(void *arg, size_t chunk, uint32_t member)
{
    const struct making *m = arg;
    const uint64_t photons = m->map->header->count, first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + LEAVES_A_CHUNK * ORL_MAP_LEAF;
    struct recent recent = {.count = 0};
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const struct landed photon = landed_of(m->map, i);
        const uint32_t facet = facet_of(m, &photon, i % ORL_MAP_LEAF == 0, &recent);
        m->places[i] = nowhere;
        if (facet == nowhere || !m->texels->has[facet])
            continue;
        const bool front = orl_dot(photon.normal, m->texels->sheets[facet].frame.n) > 0;
        m->places[i] = 2 * facet + front;
    }
}

/* ---- Texels ---------------------------------------------------------------------------------- */

static uint32_t index_in(const struct orl_texels *texels, uint32_t side, struct orl_vec3 point)
{
    const struct side *s = &texels->sides[side];
    const struct corner at = corner_of(&texels->sheets[side / 2], point);
    const double x = fmin(fmax(at.x / s->width, 0), s->across - 1);
    const double y = fmin(fmax(at.y / s->height, 0), s->down - 1);
    return s->first + (uint32_t)y * s->across + (uint32_t)x;
}

static uint32_t steps(double length, double width)
{
    return (uint32_t)fmin(fmax(round(length / width), 1), MOST_ACROSS);
}

/* As many texels on every side as its photons are worth. */
static void share_out(struct making *m)
{
    struct orl_texels *texels = m->texels;
    const size_t n = texels->geometry->n_facets;
    for (size_t i = 0; i < 2 * n; i++)
        texels->sides[i] = (struct side){.first = 0};
    for (uint64_t i = 0; i < m->map->header->count; i++)
        if (m->places[i] != nowhere)
            texels->sides[m->places[i]].first++;
    uint64_t count = 0;
    for (size_t i = 0; i < 2 * n; i++) {
        struct side *side = &texels->sides[i];
        const struct sheet *sheet = &texels->sheets[i / 2];
        const double landed = side->first;
        texels->has[i / 2] = texels->has[i / 2] && !atomic_load(&m->doubtful[i / 2]);
        *side = (struct side){.first = (uint32_t)count};
        if (!texels->has[i / 2] || !(landed > 0))
            continue;
        const double width = sqrt(texels->geometry->facets[i / 2].area * texels->photons / landed);
        side->across = steps(sheet->wide, width);
        side->down = steps(sheet->high, width);
        side->width = sheet->wide / side->across;
        side->height = sheet->high / side->down;
        count += (uint64_t)side->across * side->down;
    }
    texels->count = count < nowhere ? (uint32_t)count : 0;
}

static void find_texels(void *arg, size_t chunk, uint32_t member)
{
    const struct making *m = arg;
    const uint64_t photons = m->map->header->count, first = chunk * LEAVES_A_CHUNK * ORL_MAP_LEAF;
    const uint64_t end = first + LEAVES_A_CHUNK * ORL_MAP_LEAF;
    (void)member;
    for (uint64_t i = first; i < end && i < photons; i++) {
        const uint32_t side = m->places[i];
        if (side == nowhere)
            continue;
        m->places[i] = m->texels->sides[side].across == 0
                           ? nowhere
                           : index_in(m->texels, side, landed_of(m->map, i).point);
    }
}

/* Flux into a slice of the texels. */
static void add_up(void *arg, size_t slice, uint32_t member)
{
    const struct making *m = arg;
    const struct orl_photon_map *map = m->map;
    const uint64_t count = m->texels->count;
    const uint32_t from = (uint32_t)(count * slice / SLICES);
    const uint32_t room = (uint32_t)(count * (slice + 1) / SLICES) - from;
    (void)member;
    for (uint64_t i = 0; i < map->header->count; i++) {
        if (m->places[i] - from >= room) /* before it, too: numbers wrap */
            continue;
        const struct orl_rgb flux =
            orl_rgb_scale(orl_flux_unpack(map->fluxes[i]), map->header->flux_unit);
        struct orl_texel *texel = &m->texels->texels[m->places[i]];
        texel->irradiance[0] += (float)flux.r;
        texel->irradiance[1] += (float)flux.g;
        texel->irradiance[2] += (float)flux.b;
        texel->parts[orl_photon_batch(map, (uint32_t)i)] += (float)orl_luma(flux);
    }
}

/* ---- Areas ----------------------------------------------------------------------------------- */

struct outline {
    struct corner corners[8]; /* a triangle cut four times */
    uint32_t count;
};

/* The part where a x + b y <= c (Sutherland and Hodgman 1974). */
static void cut(struct outline *outline, double a, double b, double c)
{
    struct outline kept = {.count = 0};
    for (uint32_t i = 0; i < outline->count; i++) {
        const struct corner p = outline->corners[i];
        const struct corner q = outline->corners[(i + 1) % outline->count];
        const double at_p = a * p.x + b * p.y - c, at_q = a * q.x + b * q.y - c;
        if (at_p <= 0 && kept.count < 8)
            kept.corners[kept.count++] = p;
        if ((at_p < 0) != (at_q < 0) && at_p != at_q && kept.count < 8) {
            const double share = at_p / (at_p - at_q);
            kept.corners[kept.count++] =
                (struct corner){p.x + share * (q.x - p.x), p.y + share * (q.y - p.y)};
        }
    }
    *outline = kept;
}

static double area_of(const struct outline *outline)
{
    double sum = 0;
    for (uint32_t i = 2; i < outline->count; i++)
        sum += turn(outline->corners[0], outline->corners[i - 1], outline->corners[i]);
    return 0.5 * fabs(sum);
}

static uint32_t step_at(double at, double width, uint32_t most)
{
    return (uint32_t)fmin(fmax(at / width, 0), most - 1);
}

/* A triangle's area into the texels of one row. */
static void add_row(const struct side *side, const struct outline *row, uint32_t y, float *areas)
{
    double low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < row->count; i++) {
        low = fmin(low, row->corners[i].x);
        high = fmax(high, row->corners[i].x);
    }
    for (uint32_t x = step_at(low, side->width, side->across);
         row->count > 2 && x <= step_at(high, side->width, side->across); x++) {
        struct outline square = *row;
        cut(&square, -1, 0, -(x * side->width));
        cut(&square, 1, 0, (x + 1) * side->width);
        areas[side->first + y * side->across + x] += (float)area_of(&square);
    }
}

static void add_areas(void *arg, size_t index, uint32_t member)
{
    const struct making *m = arg;
    const struct side *side = &m->texels->sides[index];
    const struct sheet *sheet = &m->texels->sheets[index / 2];
    (void)member;
    for (uint32_t i = 0; i < sheet->triangles && side->across > 0; i++) {
        const struct flat *t = &m->texels->flats[sheet->first + i];
        const double low = fmin(fmin(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        const double high = fmax(fmax(t->corners[0].y, t->corners[1].y), t->corners[2].y);
        for (uint32_t y = step_at(low, side->height, side->down);
             y <= step_at(high, side->height, side->down); y++) {
            struct outline row = {.count = 3};
            for (int k = 0; k < 3; k++)
                row.corners[k] = t->corners[k];
            cut(&row, 0, -1, -(y * side->height));
            cut(&row, 0, 1, (y + 1) * side->height);
            add_row(side, &row, y, m->areas);
        }
    }
}

/* Of four neighbours the one that is most surface; or itself. */
static uint32_t fullest(const struct side *side, const float *areas, uint32_t x, uint32_t y)
{
    const int dx[4] = {-1, 1, 0, 0}, dy[4] = {0, 0, -1, 1};
    uint32_t best = side->first + y * side->across + x;
    for (int i = 0; i < 4; i++) {
        const int64_t to_x = (int64_t)x + dx[i], to_y = (int64_t)y + dy[i];
        if (to_x < 0 || to_y < 0 || to_x >= side->across || to_y >= side->down)
            continue;
        const uint32_t other = side->first + (uint32_t)to_y * side->across + (uint32_t)to_x;
        if (areas[other] > areas[best])
            best = other;
    }
    return best;
}

static void add_texel(struct orl_texel *sum, const struct orl_texel *more)
{
    for (int c = 0; c < 3; c++)
        sum->irradiance[c] += more->irradiance[c];
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        sum->parts[b] += more->parts[b];
}

static void divide(struct orl_texel *texel, float area)
{
    for (int c = 0; c < 3; c++)
        texel->irradiance[c] = area > 0 ? texel->irradiance[c] / area : 0;
    for (int b = 0; b < ORL_MAP_BATCHES; b++)
        texel->parts[b] = area > 0 ? texel->parts[b] / area : 0;
}

/*
 * Flux to irradiance, of one side. What lands in a square that is hardly surface goes to its
 * fullest neighbour, and comes back as that one's irradiance.
 */
static void settle(void *arg, size_t index, uint32_t member)
{
    const struct making *m = arg;
    const struct side *side = &m->texels->sides[index];
    struct orl_texel *texels = m->texels->texels;
    const double enough = least_share * side->width * side->height;
    (void)member;
    for (int pass = 0; pass < 3; pass++)
        for (uint32_t y = 0; y < side->down; y++)
            for (uint32_t x = 0; x < side->across; x++) {
                const uint32_t here = side->first + y * side->across + x;
                const bool small = (double)m->areas[here] < enough;
                const uint32_t there = small ? fullest(side, m->areas, x, y) : here;
                if (pass == 0 && there != here && (double)m->areas[there] >= enough) {
                    add_texel(&texels[there], &texels[here]);
                    m->areas[there] += m->areas[here];
                } else if (pass == 1 &&
                           (!small || there == here || !((double)m->areas[there] >= enough))) {
                    divide(&texels[here], m->areas[here]);
                } else if (pass == 2 && there != here && (double)m->areas[there] >= enough) {
                    texels[here] = texels[there];
                }
            }
}

/* Looks for what stands on whole squares, along both diagonals: no long wall passes between them.
 */
static void find_cuts(void *arg, size_t index, uint32_t member)
{
    static const double corners[2][2] = {{0.001, 0.001}, {0.999, 0.001}};
    const struct making *m = arg;
    const struct side *side = &m->texels->sides[index];
    const struct sheet *sheet = &m->texels->sheets[index / 2];
    const struct orl_vec3 normal = index % 2 == 1 ? sheet->frame.n : orl_neg(sheet->frame.n);
    const double whole = 0.999 * side->width * side->height;
    (void)member;
    for (uint32_t i = 0; i < side->across * side->down; i++) {
        struct orl_texel *texel = &m->texels->texels[side->first + i];
        const struct orl_vec3 corner =
            orl_madd(orl_madd(sheet->origin, sheet->frame.u, i % side->across * side->width),
                     sheet->frame.v, i / side->across * side->height);
        for (int k = 0; k < 2 && (double)m->areas[side->first + i] >= whole && !texel->cut; k++) {
            const double x = corners[k][0] * side->width, y = corners[k][1] * side->height;
            const struct orl_footing footing = {
                m->texels->world, orl_madd(orl_madd(corner, sheet->frame.u, x), sheet->frame.v, y),
                normal, (uint32_t)(index / 2)};
            texel->cut = !orl_footing_joins(
                &footing, orl_madd(orl_madd(corner, sheet->frame.u, side->width - x),
                                   sheet->frame.v, side->height - y));
        }
    }
}

/* ---- All of it ------------------------------------------------------------------------------- */

static bool make(struct making *m, struct orl_crew *crew)
{
    struct orl_texels *texels = m->texels;
    const struct orl_geometry *g = texels->geometry;
    const uint64_t leaves = (m->map->header->count + ORL_MAP_LEAF - 1) / ORL_MAP_LEAF;
    const size_t chunks = (leaves + LEAVES_A_CHUNK - 1) / LEAVES_A_CHUNK;
    texels->sheets = malloc((g->n_facets + 1) * sizeof *texels->sheets);
    texels->flats = malloc((g->n_triangles + 1) * sizeof *texels->flats);
    texels->has = calloc(g->n_facets + 1, sizeof *texels->has);
    texels->sides = calloc(2 * g->n_facets + 1, sizeof *texels->sides);
    m->places = malloc((m->map->header->count + 1) * sizeof *m->places);
    m->doubtful = calloc(g->n_facets + 1, sizeof *m->doubtful);
    if (!texels->sheets || !texels->flats || !texels->has || !texels->sides || !m->places ||
        !m->doubtful)
        return false;
    for (size_t i = 0; i < g->n_facets; i++)
        lay_out(texels, (uint32_t)i);
    orl_crew_for(crew, chunks, find_facets, m);
    share_out(m);
    texels->texels = calloc((size_t)texels->count + 1, sizeof *texels->texels);
    m->areas = calloc((size_t)texels->count + 1, sizeof *m->areas);
    if (!texels->texels || !m->areas)
        return false;
    orl_crew_for(crew, chunks, find_texels, m);
    orl_crew_for(crew, SLICES, add_up, m);
    orl_crew_for(crew, 2 * g->n_facets, add_areas, m);
    orl_crew_for(crew, 2 * g->n_facets, settle, m);
    orl_crew_for(crew, 2 * g->n_facets, find_cuts, m);
    return true;
}

struct orl_texels *orl_texels_new(const struct orl_photon_map *map, const struct orl_world *world,
                                  double photons, struct orl_crew *crew)
{
    struct orl_texels *texels = calloc(1, sizeof *texels);
    struct making m = {.texels = texels, .map = map};
    if (!texels)
        return NULL;
    texels->world = world;
    texels->geometry = world->geometry;
    texels->photons = photons;
    const bool made = make(&m, crew);
    free(m.places);
    free(m.doubtful);
    free(m.areas);
    if (made)
        return texels;
    orl_texels_free(texels);
    return NULL;
}

void orl_texels_free(struct orl_texels *texels)
{
    if (!texels)
        return;
    free(texels->sheets);
    free(texels->flats);
    free(texels->has);
    free(texels->sides);
    free(texels->texels);
    free(texels);
}

bool orl_texels_has(const struct orl_texels *texels, uint32_t facet)
{
    return texels->has[facet];
}

double orl_texels_width(const struct orl_texels *texels, uint32_t facet, bool front)
{
    const struct side *side = &texels->sides[2 * facet + front];
    return fmax(side->width, side->height);
}

const struct orl_texel *orl_texels_at(const struct orl_texels *texels, uint32_t facet, bool front,
                                      struct orl_vec3 point)
{
    const uint32_t side = 2 * facet + front;
    return texels->sides[side].across > 0 ? &texels->texels[index_in(texels, side, point)] : NULL;
}
