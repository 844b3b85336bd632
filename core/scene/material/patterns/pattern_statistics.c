/* Means and bounds of patterns over their surfaces, before rendering. */
#include "scene/material/patterns/pattern.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <oriel/base/vec.h>

#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

enum { PLACES = 1024, FEWEST = 64, ALL_PLACES = 1 << 22 };

/* ---- Mean and maximum ------------------------------------------------------------------------ */

/* The facets of one pattern, over which places are spread by area. */
struct spread {
    const struct orl_geometry *geometry;
    const uint32_t *facets;
    size_t n;
    double area;
};

/* Sorts facets by pattern, prototypes in their first place: those of pattern i start at first[i].
 * Returns NULL if out of memory. */
static uint32_t *sort_facets(const struct orl_parsed_scene *d, const struct orl_geometry *g,
                             size_t *first)
{
    uint32_t *sorted = NULL;
    for (int pass = 0; pass < 2 && (pass == 0 || sorted); pass++) {
        for (struct orl_facet_iterator walk = orl_facet_iterator(g);
             orl_facet_iterator_next(&walk);) {
            struct orl_pattern *all[ORL_MATERIAL_PATTERNS];
            const uint32_t material = orl_facet_material(g, walk.facet);
            const size_t n = orl_patterns_of(&d->materials[material], all);
            for (size_t k = 0; k < n; k++)
                if (pass == 0)
                    first[all[k]->index + 2]++;
                else
                    sorted[first[all[k]->index + 1]++] = walk.facet;
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
                  "its function takes more than %d operations, or recurses too deeply",
                  ORL_FUNCTION_OPERATIONS);
    orl_error_at(err, pattern->file, pattern->line, pattern->name);
    orl_error_hint(err, "limit its recursion");
    return ORL_ERR_LIMIT;
}

static struct orl_rgb larger(struct orl_rgb a, struct orl_rgb b)
{
    return (struct orl_rgb){fmax(a.r, b.r), fmax(a.g, b.g), fmax(a.b, b.b)};
}

/* Area over all instances. */
static double area_of(const struct orl_geometry *g, uint32_t facet)
{
    struct orl_quadric room;
    const double area = orl_instance_facet(g, facet, &room).area;
    return orl_facet_is_instanced(g, facet)
               ? area * (double)orl_instance_of(g, facet)->prototype->n_uses
               : area;
}

/* Evaluates n places of equal area; within a facet they follow a low-discrepancy sequence
 * (Roberts'). */
static int evaluate_places(struct orl_pattern *pattern, const struct spread *spread, size_t n,
                           size_t *ret_without, struct orl_error *err)
{
    const struct orl_geometry *const g = spread->geometry;
    struct orl_rgb sum = orl_gray(0), maximum = orl_gray(0);
    size_t at = 0;
    double passed = 0;
    for (size_t k = 0; k < n; k++) {
        const double wanted = ((double)k + 0.5) / (double)n * spread->area;
        const double x = 0.7548776662466927 * (double)k, y = 0.5698402909980532 * (double)k;
        const double u[2] = {x - floor(x), y - floor(y)};
        struct orl_hit hit = {.front = true};
        struct orl_rgb value;
        while (at + 1 < spread->n && passed + area_of(g, spread->facets[at]) < wanted)
            passed += area_of(g, spread->facets[at++]);
        hit.facet = spread->facets[at];
        hit.instance = orl_facet_is_instanced(g, hit.facet)
                           ? (uint32_t)(orl_instance_of(g, hit.facet) - g->instance) + 1
                           : 0;
        orl_facet_sample(g, hit.facet, u, &hit.point, &hit.normal);
        const double round = 0.8191725133961645 * ((double)k + 1),
                     down = 0.6710436067037893 * ((double)k + 1);
        const struct orl_vec3 towards =
            orl_hemisphere_about(hit.normal, down - floor(down), round - floor(round));
        const enum orl_pattern_validity validity =
            orl_pattern_factor(pattern, &hit, towards, &value);
        if (validity == ORL_PATTERN_TOO_LONG)
            return too_long(pattern, err);
        *ret_without += validity == ORL_PATTERN_UNDEFINED;
        sum = orl_rgb_add(sum, value);
        maximum = larger(maximum, value);
    }
    pattern->mean = orl_rgb_scale(sum, 1 / (double)n);
    pattern->maximum = maximum;
    return 0;
}

/* Warns of patterns without a value somewhere, but only of the first few. */
static void warn(struct orl_parsed_scene *parsed_scene, const struct orl_pattern *pattern,
                 size_t without, size_t n)
{
    enum { TOLD = 8 };
    char text[512];
    if (without == 0 || ++parsed_scene->n_undefined > TOLD)
        return;
    snprintf(text, sizeof text,
             "%.200s:%d: the function of %.100s has no value at %zu of %zu points of its surfaces: "
             "colours are not modified there",
             pattern->file, pattern->line, pattern->name, without, n);
    orl_parsed_scene_warn(parsed_scene, "%s", text);
}

/* ---- Distant light ----------------------------------------------------------------------------
 */

enum { DIRECTIONS = 1 << 16, FEW = DIRECTIONS / 1000 };

static int brighter(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

/* Warns if much of the light comes from few directions. */
static void warn_of_concentration(struct orl_parsed_scene *parsed_scene,
                                  const struct orl_distant_source *distant,
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
    snprintf(
        text, sizeof text,
        "%.200s:%d: %.100s puts %.0f %% of the light of source %.100s into a thousandth of all "
        "directions, which rays find only by chance: define that light as a separate source",
        pattern->file, pattern->line, pattern->name, 100 * few / all, distant->name);
    orl_parsed_scene_warn(parsed_scene, "%s", text);
}

/* Evaluates a pattern over the directions of a source, in equal solid angles. */
static int measure_distant_pattern(struct orl_parsed_scene *parsed_scene,
                                   const struct orl_distant_source *distant,
                                   struct orl_pattern *pattern, bool alone, struct orl_error *err)
{
    const double least = cos(0.5 * distant->angle_deg * ORL_DEG_TO_RAD);
    double *const lumas = malloc(sizeof *lumas * DIRECTIONS);
    struct orl_rgb sum = orl_gray(0), maximum = sum;
    size_t n = 0, without = 0;
    enum orl_pattern_validity validity = lumas ? ORL_PATTERN_VALID : ORL_PATTERN_TOO_LONG;
    for (int i = 0; i < DIRECTIONS && validity != ORL_PATTERN_TOO_LONG; i++) {
        /* A spiral of directions with equal solid angles. */
        const double z = 1 - (2 * i + 1.0) / DIRECTIONS, s = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * fmod(i * 0.6180339887498949, 1);
        const struct orl_vec3 d = orl_v3(s * cos(phi), s * sin(phi), z);
        struct orl_rgb value;
        if (orl_dot(d, distant->direction) < least)
            continue;
        const struct orl_hit hit = orl_pattern_hit_of_sky(d);
        validity = orl_pattern_factor(pattern, &hit, hit.normal, &value);
        without += validity == ORL_PATTERN_UNDEFINED;
        lumas[n++] = orl_luma(value);
        sum = orl_rgb_add(sum, value);
        maximum = larger(maximum, value);
    }
    if (validity != ORL_PATTERN_TOO_LONG) {
        warn_of_concentration(parsed_scene, distant, pattern, lumas, n);
        warn(parsed_scene, pattern, without, n);
    }
    if (alone && n > 0) {
        pattern->mean = orl_rgb_scale(sum, 1 / (double)n);
        pattern->maximum = maximum;
    }
    const int code = !lumas                             ? ORL_ERR_NOMEM
                     : validity == ORL_PATTERN_TOO_LONG ? too_long(pattern, err)
                                                        : 0;
    free(lumas);
    return code;
}

static int measure_distant_patterns(struct orl_parsed_scene *parsed_scene, const size_t *first,
                                    struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < parsed_scene->n_distant_sources && code == 0; i++) {
        const struct orl_distant_source *const distant = &parsed_scene->distant_sources[i];
        struct orl_pattern *const p = parsed_scene->materials[distant->material].pattern;
        if (p)
            code = measure_distant_pattern(parsed_scene, distant, p,
                                           first[p->index + 1] == first[p->index], err);
    }
    return code;
}

int orl_patterns_measure(struct orl_parsed_scene *parsed_scene, const struct orl_geometry *geometry,
                         struct orl_error *err)
{
    const size_t n = parsed_scene->n_patterns;
    const size_t places = n > ALL_PLACES / PLACES ? FEWEST + ALL_PLACES / n : PLACES;
    size_t *const first = calloc(n + 3, sizeof *first);
    uint32_t *const sorted = first ? sort_facets(parsed_scene, geometry, first) : NULL;
    int code = sorted ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; code == 0 && i < n; i++) {
        struct orl_pattern *const pattern = parsed_scene->patterns[i];
        struct spread spread = {geometry, sorted + first[i], first[i + 1] - first[i], 0};
        for (size_t k = 0; k < spread.n; k++)
            spread.area += area_of(geometry, spread.facets[k]);
        pattern->center = geometry->center;
        pattern->geometry = geometry;
        pattern->parsed_scene = parsed_scene;
        pattern->mean = pattern->maximum = orl_gray(1);
        size_t without = 0;
        if (spread.area > 0)
            code = evaluate_places(pattern, &spread, places, &without, err);
        warn(parsed_scene, pattern, without, places);
    }
    if (code == 0)
        code = measure_distant_patterns(parsed_scene, first, err);
    free(first);
    free(sorted);
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory for patterns") : code;
}
