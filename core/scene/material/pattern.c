#include "scene/material/pattern.h"

#include <math.h>
#include <stdlib.h>

#include "function/ray_names.h"

enum { LANES = ORL_FUNCTION_LANES, PLACES = 1024, FEWEST = 64, ALL_PLACES = 1 << 22 };

void orl_pattern_free(struct orl_pattern *pattern)
{
    if (!pattern)
        return;
    orl_function_free(pattern->function);
    free(pattern);
}

static struct orl_vec3 turned(const struct orl_pattern *pattern, struct orl_vec3 v)
{
    return orl_v3(orl_dot(pattern->row[0], v), orl_dot(pattern->row[1], v),
                  orl_dot(pattern->row[2], v));
}

static double not_below_zero(double value)
{
    return value > 0 && isfinite(value) ? value : 0; /* also of what is no number */
}

static struct orl_rgb factor_at(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                bool *ret_exceeded)
{
    double inputs[ORL_RAY_INPUTS], values[3];
    const struct orl_vec3 p =
        orl_add(turned(pattern, orl_add(hit->point, pattern->center)), pattern->offset);
    const struct orl_vec3 n = orl_scale(turned(pattern, orl_hit_facing(hit)), pattern->scale);
    inputs[ORL_RAY_PX] = p.x;
    inputs[ORL_RAY_PY] = p.y;
    inputs[ORL_RAY_PZ] = p.z;
    inputs[ORL_RAY_NX] = n.x;
    inputs[ORL_RAY_NY] = n.y;
    inputs[ORL_RAY_NZ] = n.z;
    *ret_exceeded =
        orl_function_at(pattern->function, orl_function_scratch_of_thread(), inputs, values)
            .exceeded;
    const double red = not_below_zero(values[0]);
    return pattern->coloured
               ? (struct orl_rgb){red, not_below_zero(values[1]), not_below_zero(values[2])}
               : orl_gray(red);
}

struct orl_rgb orl_pattern_at(const struct orl_pattern *pattern, const struct orl_hit *hit)
{
    bool exceeded;
    return orl_hit_is_anywhere(hit) ? pattern->mean : factor_at(pattern, hit, &exceeded);
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

/* Facets by patterns: those of pattern i are from first[i] on. */
static void sort_facets(const struct orl_description *d, const struct orl_geometry *g,
                        size_t *first, uint32_t *sorted)
{
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < g->n_facets; i++) {
            const struct orl_pattern *const p = d->materials[g->facets[i].material].pattern;
            if (p && pass == 0)
                first[p->index + 2]++;
            else if (p)
                sorted[first[p->index + 1]++] = (uint32_t)i;
        }
        for (size_t i = 0; pass == 0 && i < d->n_patterns; i++)
            first[i + 2] += first[i + 1];
    }
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

/* n places of even area, within a facet by a sequence of low discrepancy (Roberts'). */
static int evaluate(struct orl_pattern *pattern, const struct spread *spread, size_t n,
                    struct orl_error *err)
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
        bool exceeded;
        while (at + 1 < spread->n && passed + g->facets[spread->facets[at]].area < wanted)
            passed += g->facets[spread->facets[at++]].area;
        hit.facet = spread->facets[at];
        orl_facet_sample(g, hit.facet, u, &hit.point, &hit.normal);
        const struct orl_rgb value = factor_at(pattern, &hit, &exceeded);
        if (exceeded)
            return too_long(pattern, err);
        sum = orl_rgb_add(sum, value);
        most =
            (struct orl_rgb){fmax(most.r, value.r), fmax(most.g, value.g), fmax(most.b, value.b)};
    }
    pattern->mean = orl_rgb_scale(sum, 1 / (double)n);
    pattern->most = most;
    return 0;
}

int orl_patterns_settle(const struct orl_description *description,
                        const struct orl_geometry *geometry, struct orl_error *err)
{
    const size_t n = description->n_patterns;
    const size_t places = n > ALL_PLACES / PLACES ? FEWEST + ALL_PLACES / n : PLACES;
    size_t *const first = calloc(n + 3, sizeof *first);
    uint32_t *const sorted = malloc((geometry->n_facets + 1) * sizeof *sorted);
    int code = first && sorted ? 0 : ORL_ERR_NOMEM;
    if (code == 0)
        sort_facets(description, geometry, first, sorted);
    for (size_t i = 0; code == 0 && i < n; i++) {
        struct orl_pattern *const pattern = description->patterns[i];
        struct spread spread = {geometry, sorted + first[i], first[i + 1] - first[i], 0};
        for (size_t k = 0; k < spread.n; k++)
            spread.area += geometry->facets[spread.facets[k]].area;
        pattern->center = geometry->center;
        pattern->mean = pattern->most = orl_gray(1);
        if (spread.area > 0)
            code = evaluate(pattern, &spread, places, err);
    }
    free(first);
    free(sorted);
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory for patterns") : code;
}
