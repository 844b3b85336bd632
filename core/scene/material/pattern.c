#include "scene/material/pattern.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/units.h>

#include "function/ray_names.h"
#include "scene/material/hemisphere.h"
#include "scene/material/text.h"

enum { LANES = ORL_FUNCTION_LANES, PLACES = 1024, FEWEST = 64, ALL_PLACES = 1 << 22 };

void orl_pattern_free(struct orl_pattern *pattern)
{
    if (!pattern)
        return;
    orl_function_free(pattern->function);
    orl_function_free(pattern->values);
    free(pattern);
}

size_t orl_patterns_of(const struct orl_material *material,
                       struct orl_pattern *ret_patterns[ORL_MATERIAL_PATTERNS])
{
    struct orl_pattern *const own[] = {material->pattern, material->texture, material->mix};
    size_t n = 0;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++)
        if (own[i])
            ret_patterns[n++] = own[i];
    for (int i = 0; material->mixed && i < 2; i++)
        n += orl_patterns_of(&material->mixed[i], ret_patterns + n);
    return n;
}

static struct orl_vec3 turned(const struct orl_pattern *pattern, struct orl_vec3 v)
{
    return orl_v3(orl_dot(pattern->row[0], v), orl_dot(pattern->row[1], v),
                  orl_dot(pattern->row[2], v));
}

/* Whether all of the function has a value at the hit; where it has none the colour stays. */
enum worth { HAS_VALUE, HAS_NONE, TAKES_TOO_LONG };

static void take(double *inputs, enum orl_ray_input first, struct orl_vec3 v)
{
    inputs[first] = v.x;
    inputs[first + 1] = v.y;
    inputs[first + 2] = v.z;
}

static enum worth run(const struct orl_function *function, const double *inputs, double *ret)
{
    const struct orl_function_outcome outcome =
        orl_function_at(function, orl_function_scratch_of_thread(), inputs, ret);
    return outcome.exceeded ? TAKES_TOO_LONG : outcome.undefined ? HAS_NONE : HAS_VALUE;
}

/* What the grids hold at a place. */
static void look_up(const struct orl_pattern *pattern, const double *place, double *ret_held)
{
    orl_grid_at(pattern->grids[0], place, ret_held);
    for (uint32_t i = 1; i < pattern->n_grids; i++) {
        double own[ORL_GRID_CHANNELS] = {ret_held[0]};
        if (pattern->grids[i] != pattern->grids[0])
            orl_grid_at(pattern->grids[i], place, own);
        ret_held[i] = own[0];
    }
}

static const uint32_t no_facet = UINT32_MAX; /* of distant light */

void orl_pattern_corners(const struct orl_pattern *pattern, const struct orl_hit *hit,
                         double *ret_b, double *ret_c)
{
    const struct orl_surface *s = &pattern->surfaces[pattern->facets[hit->facet].surface];
    const struct orl_vec3 ab = orl_sub(s->vertices[1], s->vertices[0]);
    const struct orl_vec3 ac = orl_sub(s->vertices[2], s->vertices[0]), n = orl_cross(ab, ac);
    const struct orl_vec3 ap = orl_sub(orl_add(hit->point, pattern->center), s->vertices[0]);
    const double n2 = orl_dot(n, n);
    *ret_b = orl_dot(orl_cross(ap, ac), n) / n2;
    *ret_c = orl_dot(orl_cross(ab, ap), n) / n2;
}

/* What a mesh says of the place; nothing else does, and has 0 there. */
static void find_place(const struct orl_pattern *pattern, const struct orl_hit *hit,
                       double ret_place[2])
{
    ret_place[0] = ret_place[1] = 0;
    if (hit->facet == no_facet || !pattern->facets)
        return;
    const struct orl_surface *s = &pattern->surfaces[pattern->facets[hit->facet].surface];
    const double *const at = orl_surface_places(s);
    if (!at)
        return;
    double b, c;
    orl_pattern_corners(pattern, hit, &b, &c);
    for (int k = 0; k < 2; k++)
        ret_place[k] = (1 - b - c) * at[k] + b * at[2 + k] + c * at[4 + k];
}

static enum worth factor_at(const struct orl_pattern *pattern, const struct orl_hit *hit,
                            struct orl_vec3 towards, struct orl_rgb *ret_factor);

/* Colours by the first's share. Patterns are as deep as they were defined, ORL_PATTERN_STEPS. */
static enum worth mix(const struct orl_pattern *pattern, const struct orl_hit *hit,
                      struct orl_vec3 towards, double share, struct orl_rgb *ret_color)
{
    enum worth worth = HAS_VALUE;
    const double shares[2] = {share, 1 - share};
    *ret_color = orl_gray(0);
    for (int i = 0; i < 2; i++) {
        struct orl_rgb factor = orl_gray(1);
        if (pattern->mixed[i].pattern && shares[i] > 0) {
            const enum worth own = factor_at(pattern->mixed[i].pattern, hit, towards, &factor);
            worth = own > worth ? own : worth;
        }
        const struct orl_rgb color = orl_rgb_mul(pattern->mixed[i].color, factor);
        *ret_color = orl_rgb_add(*ret_color, orl_rgb_scale(color, shares[i]));
    }
    return worth;
}

static void find_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double inputs[ORL_RAY_INPUTS])
{
    take(inputs, ORL_RAY_PX,
         orl_add(turned(pattern, orl_add(hit->point, pattern->center)), pattern->offset));
    take(inputs, ORL_RAY_NX, orl_scale(turned(pattern, hit->normal), pattern->scale));
    take(inputs, ORL_RAY_DX, orl_scale(turned(pattern, towards), -pattern->scale));
    inputs[ORL_RAY_RDOT] = orl_dot(towards, hit->normal);
    if (pattern->meshed)
        find_place(pattern, hit, inputs + ORL_RAY_LU);
}

/* What its function, and what its grids hold, come to. */
static enum worth values_at(const struct orl_pattern *pattern, const struct orl_hit *hit,
                            struct orl_vec3 towards, double values[ORL_GRID_AXES])
{
    double inputs[ORL_RAY_INPUTS];
    find_inputs(pattern, hit, towards, inputs);
    enum worth worth = run(pattern->function, inputs, values);
    if (worth == HAS_VALUE && pattern->values) {
        look_up(pattern, values, inputs + ORL_RAY_DATA);
        worth = run(pattern->values, inputs, values);
    }
    return worth;
}

bool orl_pattern_values(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double ret_values[3])
{
    double values[ORL_GRID_AXES];
    if (values_at(pattern, hit, towards, values) != HAS_VALUE)
        return false;
    for (int i = 0; i < (pattern->three ? 3 : 1); i++)
        ret_values[i] = values[i];
    return true;
}

/* Eight bands at once: what the grid holds of each, and the wavelength, are what values take. */
static enum worth see_bands(const struct orl_pattern *pattern, const double *inputs, double *place,
                            uint32_t first, struct orl_tristimulus *seen)
{
    struct orl_function_lanes columns[ORL_RAY_INPUTS], values;
    double held[ORL_GRID_CHANNELS];
    const uint32_t left = pattern->n_bands - first, n = left < LANES ? left : LANES;
    for (uint32_t l = 0; l < n; l++) {
        const struct orl_band *const band = &pattern->bands[first + l];
        for (int i = 0; i < ORL_RAY_DATA; i++)
            columns[i].at[l] = inputs[i];
        columns[ORL_RAY_DATA].at[l] = band->nm;
        if (pattern->n_grids > 0) {
            place[pattern->grids[0]->n_axes - 1] = band->nm;
            orl_grid_at(pattern->grids[0], place, held);
            columns[ORL_RAY_DATA_2].at[l] = held[0];
        }
    }
    const struct orl_function_outcome outcome = orl_function_evaluate(
        pattern->values, orl_function_scratch_of_thread(), columns, (1U << n) - 1, &values);
    for (uint32_t l = 0; l < n; l++) {
        const struct orl_tristimulus w = pattern->bands[first + l].weight;
        seen->x += w.x * values.at[l];
        seen->y += w.y * values.at[l];
        seen->z += w.z * values.at[l];
    }
    return outcome.exceeded ? TAKES_TOO_LONG : outcome.undefined ? HAS_NONE : HAS_VALUE;
}

/* A spectrum's factor. Of a grid all axes but the last are the function's coordinates. */
static enum worth see(const struct orl_pattern *pattern, const struct orl_hit *hit,
                      struct orl_vec3 towards, struct orl_rgb *ret_factor)
{
    double inputs[ORL_RAY_INPUTS], place[ORL_GRID_AXES];
    struct orl_tristimulus seen = {0, 0, 0};
    find_inputs(pattern, hit, towards, inputs);
    enum worth worth = pattern->function ? run(pattern->function, inputs, place) : HAS_VALUE;
    for (uint32_t i = 0; i < pattern->n_bands && worth == HAS_VALUE; i += LANES)
        worth = see_bands(pattern, inputs, place, i, &seen);
    if (worth != HAS_VALUE)
        return worth;
    if (!isfinite(seen.x) || !isfinite(seen.y) || !isfinite(seen.z))
        return HAS_NONE;
    *ret_factor = orl_observed_rgb(seen);
    return HAS_VALUE;
}

bool orl_pattern_of_angle(const struct orl_pattern *pattern, double cosine,
                          double ret_values[ORL_PATTERN_ANGLES])
{
    double inputs[ORL_RAY_INPUTS];
    inputs[ORL_RAY_RDOT] = cosine;
    inputs[ORL_RAY_RDOTP] = fabs(cosine);
    bool valued = run(pattern->function, inputs, ret_values) == HAS_VALUE;
    for (int i = 0; i < ORL_PATTERN_ANGLES; i++)
        valued = valued && isfinite(ret_values[i]);
    return valued;
}

void orl_pattern_fix(struct orl_pattern *pattern)
{
    const uint64_t own = ((uint64_t)1 << ORL_RAY_DATA) - 1;
    const struct orl_hit hit = {.normal = {0, 0, 1}, .front = true};
    if ((pattern->function && orl_function_inputs(pattern->function) & own) ||
        orl_function_inputs(pattern->values) & own)
        return;
    pattern->fixed = see(pattern, &hit, hit.normal, &pattern->factor) == HAS_VALUE;
}

static bool covers(const struct orl_pattern *pattern, const struct orl_hit *hit)
{
    return orl_text_covers(pattern->text, orl_add(hit->point, pattern->center));
}

/* Its own factor, without those under it. */
static enum worth own_factor(const struct orl_pattern *pattern, const struct orl_hit *hit,
                             struct orl_vec3 towards, struct orl_rgb *ret_factor)
{
    double values[ORL_GRID_AXES];
    *ret_factor = pattern->fixed ? pattern->factor : orl_gray(1);
    if (pattern->smooth || pattern->fixed)
        return HAS_VALUE;
    if (pattern->bands)
        return see(pattern, hit, towards, ret_factor);
    const bool covered = pattern->text && covers(pattern, hit);
    enum worth worth = pattern->text ? HAS_VALUE : values_at(pattern, hit, towards, values);
    if (pattern->texture)
        return worth;
    if (pattern->text && !pattern->mixture) {
        *ret_factor = covered ? pattern->factor : pattern->around;
        return HAS_VALUE;
    }
    if (pattern->text)
        values[0] = covered ? 1 : 0;
    if (pattern->mixture) {
        const bool valued = worth == HAS_VALUE && isfinite(values[0]);
        const double share = valued ? fmin(fmax(values[0], 0), 1) : 1;
        const enum worth other = mix(pattern, hit, towards, share, ret_factor);
        worth = valued ? HAS_VALUE : worth > HAS_NONE ? worth : HAS_NONE;
        return other > worth ? other : worth;
    }
    if (worth != HAS_VALUE)
        return worth;
    if (!pattern->three)
        values[1] = values[2] = values[0];
    if (!isfinite(values[0]) || !isfinite(values[1]) || !isfinite(values[2]))
        return HAS_NONE;
    *ret_factor = (struct orl_rgb){fmax(values[0], 0), fmax(values[1], 0), fmax(values[2], 0)};
    return HAS_VALUE;
}

static enum worth factor_at(const struct orl_pattern *pattern, const struct orl_hit *hit,
                            struct orl_vec3 towards, struct orl_rgb *ret_factor)
{
    enum worth worth = own_factor(pattern, hit, towards, ret_factor);
    for (const struct orl_pattern *p = pattern->under; p; p = p->under) {
        struct orl_rgb factor;
        const enum worth other = own_factor(p, hit, towards, &factor);
        *ret_factor = orl_rgb_mul(*ret_factor, factor);
        worth = other > worth ? other : worth;
    }
    return worth;
}

struct orl_rgb orl_pattern_towards(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                   struct orl_vec3 towards)
{
    struct orl_rgb factor = pattern->mean;
    if (!orl_hit_is_anywhere(hit))
        factor_at(pattern, hit, towards, &factor);
    return factor;
}

static struct orl_hit hit_of_sky(struct orl_vec3 direction)
{
    const double far = 1e10;
    return (struct orl_hit){.point = orl_scale(direction, far),
                            .normal = orl_neg(direction),
                            .facet = no_facet,
                            .front = true};
}

struct orl_rgb orl_pattern_of_sky(const struct orl_pattern *pattern, struct orl_vec3 direction)
{
    const struct orl_hit hit = hit_of_sky(direction);
    return orl_pattern_towards(pattern, &hit, hit.normal);
}

/* ---- Mean and most ----------------------------------------------------------------------------
 */

/* The facets of one pattern, and where among them an even sequence of places has come to. */
struct spread {
    const struct orl_geometry *geometry;
    const uint32_t *facets;
    size_t n;
    double area;
};

/* Facets by patterns: those of pattern i are from first[i] on. NULL without memory. */
static uint32_t *sort_facets(const struct orl_description *d, const struct orl_geometry *g,
                             size_t *first)
{
    uint32_t *sorted = NULL;
    for (int pass = 0; pass < 2 && (pass == 0 || sorted); pass++) {
        for (size_t i = 0; i < g->n_facets; i++) {
            struct orl_pattern *all[ORL_MATERIAL_PATTERNS];
            const size_t n = orl_patterns_of(&d->materials[g->facets[i].material], all);
            for (size_t k = 0; k < n; k++)
                if (pass == 0)
                    first[all[k]->index + 2]++;
                else
                    sorted[first[all[k]->index + 1]++] = (uint32_t)i;
        }
        for (size_t i = 0; pass == 0 && i < d->n_patterns; i++)
            first[i + 2] += first[i + 1];
        if (pass == 0)
            sorted = calloc(first[d->n_patterns + 1] + 1, sizeof *sorted);
    }
    return sorted;
}

static int too_long(const struct orl_pattern *pattern, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_LIMIT,
                  "its function takes more than %d operations, or calls itself too deeply",
                  ORL_FUNCTION_OPERATIONS);
    orl_error_at(err, pattern->file, pattern->line, pattern->name);
    orl_error_hint(err, "bound its recursion");
    return ORL_ERR_LIMIT;
}

static struct orl_rgb larger(struct orl_rgb a, struct orl_rgb b)
{
    return (struct orl_rgb){fmax(a.r, b.r), fmax(a.g, b.g), fmax(a.b, b.b)};
}

/* n places of even area, within a facet by a sequence of low discrepancy (Roberts'). */
static int evaluate(struct orl_pattern *pattern, const struct spread *spread, size_t n,
                    size_t *ret_without, struct orl_error *err)
{
    const struct orl_geometry *const g = spread->geometry;
    struct orl_rgb sum = orl_gray(0), most = orl_gray(0);
    size_t at = 0;
    double passed = 0;
    for (size_t k = 0; k < n; k++) {
        const double wanted = ((double)k + 0.5) / (double)n * spread->area;
        const double x = 0.7548776662466927 * (double)k, y = 0.5698402909980532 * (double)k;
        const double u[2] = {x - floor(x), y - floor(y)};
        struct orl_hit hit = {.front = true};
        struct orl_rgb value;
        while (at + 1 < spread->n && passed + g->facets[spread->facets[at]].area < wanted)
            passed += g->facets[spread->facets[at++]].area;
        hit.facet = spread->facets[at];
        orl_facet_sample(g, hit.facet, u, &hit.point, &hit.normal);
        const double round = 0.8191725133961645 * ((double)k + 1),
                     down = 0.6710436067037893 * ((double)k + 1);
        const struct orl_vec3 towards =
            orl_hemisphere_about(hit.normal, down - floor(down), round - floor(round));
        const enum worth worth = factor_at(pattern, &hit, towards, &value);
        if (worth == TAKES_TOO_LONG)
            return too_long(pattern, err);
        *ret_without += worth == HAS_NONE;
        sum = orl_rgb_add(sum, value);
        most = larger(most, value);
    }
    pattern->mean = orl_rgb_scale(sum, 1 / (double)n);
    pattern->most = most;
    return 0;
}

/* The first few patterns that have no value everywhere; the others are not told of. */
static void warn(struct orl_description *description, const struct orl_pattern *pattern,
                 size_t without, size_t n)
{
    enum { TOLD = 8 };
    char text[512];
    if (without == 0 || ++description->n_undefined > TOLD)
        return;
    snprintf(text, sizeof text,
             "%.200s:%d: the function of %.100s has no value at %zu of %zu places on what it lies "
             "on: colours are left as they are there",
             pattern->file, pattern->line, pattern->name, without, n);
    orl_description_warn(description, text);
}

/* ---- Distant light ----------------------------------------------------------------------------
 */

enum { DIRECTIONS = 1 << 16, FEW = DIRECTIONS / 1000 };

static int brighter(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Warns when most of the light comes from few directions. */
static void weigh(struct orl_description *description, const struct orl_distant *distant,
                  const struct orl_pattern *pattern, double *lumas, size_t n)
{
    const double most_share = 0.25;
    double all = 0, few = 0;
    char text[1024];
    qsort(lumas, n, sizeof *lumas, brighter);
    for (size_t i = 0; i < n; i++) {
        all += lumas[i];
        few += i < FEW ? lumas[i] : 0;
    }
    if (n / 10 < FEW || !(few > most_share * all))
        return;
    snprintf(text, sizeof text,
             "%.200s:%d: %.100s has %.0f %% of the light of source %.100s in a thousandth of all "
             "directions, which rays find by chance: give that light as a source of its own",
             pattern->file, pattern->line, pattern->name, 100 * few / all, distant->name);
    orl_description_warn(description, text);
}

/* A pattern over the directions of a source, of equal solid angles. */
static int settle_distant(struct orl_description *description, const struct orl_distant *distant,
                          struct orl_pattern *pattern, bool alone, struct orl_error *err)
{
    const double least = cos(0.5 * distant->angle_deg * ORL_DEG_TO_RAD);
    double *const lumas = malloc(sizeof *lumas * DIRECTIONS);
    struct orl_rgb sum = orl_gray(0), most = sum;
    size_t n = 0, without = 0;
    enum worth worth = lumas ? HAS_VALUE : TAKES_TOO_LONG;
    for (int i = 0; i < DIRECTIONS && worth != TAKES_TOO_LONG; i++) {
        /* A spiral: each direction stands for as much. */
        const double z = 1 - (2 * i + 1.0) / DIRECTIONS, s = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * fmod(i * 0.6180339887498949, 1);
        const struct orl_vec3 d = orl_v3(s * cos(phi), s * sin(phi), z);
        struct orl_rgb value;
        if (orl_dot(d, distant->direction) < least)
            continue;
        const struct orl_hit hit = hit_of_sky(d);
        worth = factor_at(pattern, &hit, hit.normal, &value);
        without += worth == HAS_NONE;
        lumas[n++] = orl_luma(value);
        sum = orl_rgb_add(sum, value);
        most = larger(most, value);
    }
    if (worth != TAKES_TOO_LONG) {
        weigh(description, distant, pattern, lumas, n);
        warn(description, pattern, without, n);
    }
    if (alone && n > 0) {
        pattern->mean = orl_rgb_scale(sum, 1 / (double)n);
        pattern->most = most;
    }
    const int code = !lumas ? ORL_ERR_NOMEM : worth == TAKES_TOO_LONG ? too_long(pattern, err) : 0;
    free(lumas);
    return code;
}

static int settle_distants(struct orl_description *description, const size_t *first,
                           struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < description->n_distants && code == 0; i++) {
        const struct orl_distant *const distant = &description->distants[i];
        struct orl_pattern *const p = description->materials[distant->material].pattern;
        if (p)
            code = settle_distant(description, distant, p, first[p->index + 1] == first[p->index],
                                  err);
    }
    return code;
}

int orl_patterns_settle(struct orl_description *description, const struct orl_geometry *geometry,
                        struct orl_error *err)
{
    const size_t n = description->n_patterns;
    const size_t places = n > ALL_PLACES / PLACES ? FEWEST + ALL_PLACES / n : PLACES;
    size_t *const first = calloc(n + 3, sizeof *first);
    uint32_t *const sorted = first ? sort_facets(description, geometry, first) : NULL;
    int code = sorted ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < n; i++) {
        struct orl_pattern *const pattern = description->patterns[i];
        struct spread spread = {geometry, sorted + first[i], first[i + 1] - first[i], 0};
        for (size_t k = 0; k < spread.n; k++)
            spread.area += geometry->facets[spread.facets[k]].area;
        pattern->center = geometry->center;
        pattern->facets = geometry->facets;
        pattern->surfaces = description->surfaces;
        pattern->mean = pattern->most = orl_gray(1);
        size_t without = 0;
        if (spread.area > 0)
            code = evaluate(pattern, &spread, places, &without, err);
        warn(description, pattern, without, places);
    }
    if (code == 0)
        code = settle_distants(description, first, err);
    free(first);
    free(sorted);
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory for patterns") : code;
}
