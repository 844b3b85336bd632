/* The nodes of the sun, and the weights of each sun over nodes and beams. */
#include "annual/sun/sun_weights.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

#include "annual/sun_map/sun_beams.h"

/* The sun in equatorial coordinates. */
struct equatorial {
    double declination, hour_angle; /* radians, hour angle positive towards west */
};

/* Converts horizon coordinates to equatorial ones (Duffett-Smith 1988, section 25). */
static struct equatorial to_equatorial(double latitude, struct orl_vec3 sun)
{
    const double s = sin(latitude), c = cos(latitude);
    const double sine = fmin(fmax(s * sun.z + c * sun.y, -1), 1);
    return (struct equatorial){asin(sine), atan2(-sun.x, c * sun.z - s * sun.y)};
}

static struct orl_vec3 from_equatorial(double latitude, struct equatorial equatorial)
{
    const double s = sin(latitude), c = cos(latitude);
    const double d = cos(equatorial.declination), up = sin(equatorial.declination);
    const double w = cos(equatorial.hour_angle);
    return orl_normalize(
        orl_v3(-d * sin(equatorial.hour_angle), c * up - s * d * w, s * up + c * d * w));
}

/* Hour angle of sunset, rad: 0 if the sun never rises, pi if it never sets. */
static double sunset_angle(double latitude, double declination)
{
    const double x = -tan(latitude) * tan(declination);
    return acos(fmin(fmax(x, -1), 1));
}

static double circle_rad(const struct orl_sun_grid *nodes, uint32_t circle)
{
    return nodes->circles < 2 ? nodes->low_rad
                              : nodes->low_rad + (nodes->high_rad - nodes->low_rad) * circle /
                                                     (nodes->circles - 1);
}

static uint32_t count_steps(double span_deg, double step_deg)
{
    return (uint32_t)ceil(span_deg / step_deg - 1e-9) + 1;
}

static void span_declinations(struct orl_sun_grid *nodes, const struct orl_vec3 *suns, size_t count)
{
    nodes->low_rad = INFINITY;
    nodes->high_rad = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        const double d = to_equatorial(nodes->latitude_rad, suns[i]).declination;
        nodes->low_rad = fmin(nodes->low_rad, d);
        nodes->high_rad = fmax(nodes->high_rad, d);
    }
}

int orl_sun_grid_init(struct orl_sun_grid *nodes, double latitude_deg, const struct orl_vec3 *suns,
                      size_t count, struct orl_sun_spacing steps)
{
    /* At a pole hour angles are undefined, so the latitude is clamped. */
    const double most_rad = 89.999 * ORL_DEG_TO_RAD;
    *nodes = (struct orl_sun_grid){
        .latitude_rad = fmin(fmax(latitude_deg * ORL_DEG_TO_RAD, -most_rad), most_rad)};
    if (count == 0)
        return 0;
    span_declinations(nodes, suns, count);
    const double longest = fmax(sunset_angle(nodes->latitude_rad, nodes->low_rad),
                                sunset_angle(nodes->latitude_rad, nodes->high_rad));
    nodes->circles =
        count_steps((nodes->high_rad - nodes->low_rad) / ORL_DEG_TO_RAD, steps.declination_deg);
    nodes->nodes_per_circle = count_steps(2 * longest / ORL_DEG_TO_RAD, steps.hour_angle_deg) | 1;
    nodes->count = (size_t)nodes->circles * nodes->nodes_per_circle;
    nodes->at = malloc(nodes->count * sizeof *nodes->at);
    if (!nodes->at)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < nodes->count; i++) {
        const double d = circle_rad(nodes, (uint32_t)(i / nodes->nodes_per_circle));
        const double along = nodes->nodes_per_circle < 2 ? 0.5
                                                         : (double)(i % nodes->nodes_per_circle) /
                                                               (nodes->nodes_per_circle - 1);
        const double widest = sunset_angle(nodes->latitude_rad, d);
        nodes->at[i] =
            from_equatorial(nodes->latitude_rad, (struct equatorial){d, widest * (2 * along - 1)});
    }
    return 0;
}

void orl_sun_grid_done(struct orl_sun_grid *nodes)
{
    free(nodes->at);
    *nodes = (struct orl_sun_grid){.at = NULL};
}

enum { TAPS = 4 };

/* The TAPS points nearest to a position among n points spaced evenly on [0, 1], and their
 * weights. */
struct taps {
    uint32_t at[TAPS];
    double cubic[TAPS], plain[TAPS], wide[TAPS];
};

/* Adds a point's weight. The weight of a point beyond an end goes to the three points inside it, by
 * extrapolating a parabola. */
static void add_tap(struct taps *taps, uint32_t first, uint32_t n, int tap, double weight)
{
    const int64_t at = (int64_t)first + tap - 1;
    if (at >= 0 && at < n) {
        taps->cubic[tap] += weight;
        return;
    }
    const int in = at < 0 ? 1 : -1;
    taps->cubic[tap + in] += 3 * weight;
    taps->cubic[tap + 2 * in] -= 3 * weight;
    taps->cubic[tap + 3 * in] += weight;
}

static struct taps taps_at(double share, uint32_t n)
{
    const double at = fmin(fmax(share, 0), 1) * (n - 1);
    const uint32_t first = n < 2 ? 0 : (uint32_t)fmin(floor(at), n - 2.0);
    const double t = n < 2 ? 0 : at - first;
    struct taps taps = {.plain = {0, 1 - t, t, 0}};
    for (int i = 0; i < TAPS; i++) {
        const int64_t k = (int64_t)first + i - 1;
        taps.at[i] = (uint32_t)(k < 0 ? 0 : k >= n ? n - 1 : k);
    }
    const bool inner = first > 0 && first + 2 < n;
    for (int i = 0; i < TAPS; i++)
        taps.cubic[i] = taps.wide[i] = taps.plain[i];
    if (n < 3)
        return taps;
    memset(taps.cubic, 0, sizeof taps.cubic);
    if (inner) {
        memset(taps.wide, 0, sizeof taps.wide);
        taps.wide[0] = (2 - t) / 3;
        taps.wide[TAPS - 1] = (1 + t) / 3;
    }
    const double t2 = t * t, t3 = t2 * t;
    const double weights[TAPS] = {0.5 * (-t + 2 * t2 - t3), 0.5 * (2 - 5 * t2 + 3 * t3),
                                  0.5 * (t + 4 * t2 - 3 * t3), 0.5 * (t3 - t2)};
    for (int i = 0; i < TAPS; i++)
        add_tap(&taps, first, n, i, weights[i]);
    return taps;
}

/* Returns true if the sun sets on some of the circles and never on others. Node positions then have
 * a kink that a cubic cannot follow. */
static bool is_kinked(const struct orl_sun_grid *nodes, const struct taps *up)
{
    bool sets = false, never = false;
    for (int i = 0; i < TAPS; i++) {
        const double at = sunset_angle(nodes->latitude_rad, circle_rad(nodes, up->at[i]));
        never = never || at <= 0 || at >= ORL_PI;
        sets = sets || (at > 0 && at < ORL_PI);
    }
    return sets && never;
}

struct orl_sun_interpolation orl_sun_grid_interpolate(const struct orl_sun_grid *nodes,
                                                      struct orl_vec3 sun)
{
    const struct equatorial equatorial = to_equatorial(nodes->latitude_rad, sun);
    const double height = nodes->high_rad - nodes->low_rad;
    const double widest = sunset_angle(nodes->latitude_rad, equatorial.declination);
    struct taps up = taps_at(height > 0 ? (equatorial.declination - nodes->low_rad) / height : 0,
                             nodes->circles);
    const struct taps along = taps_at(widest > 0 ? 0.5 + 0.5 * equatorial.hour_angle / widest : 0.5,
                                      nodes->nodes_per_circle);
    if (is_kinked(nodes, &up))
        memcpy(up.cubic, up.plain, sizeof up.cubic);
    struct orl_sun_interpolation ret;
    for (int i = 0; i < ORL_SUN_CORNERS; i++) {
        const int c = i / TAPS, k = i % TAPS;
        ret.nodes[i] = up.at[c] * nodes->nodes_per_circle + along.at[k];
        ret.weights[i] = (float)(up.cubic[c] * along.cubic[k]);
        ret.plain[i] = (float)(up.plain[c] * along.plain[k]);
        ret.wide[i] = (float)(up.wide[c] * along.wide[k]);
    }
    return ret;
}

enum { CORNERS = ORL_SUN_CORNERS };

/* Corners are used for a kind if they let in at least this share of what the sun lets in. */
static const double least_lit = 0.05;

struct builder {
    struct orl_sun_weights *sun_weights;
    const struct orl_year_suns *suns;
    const struct orl_sun_grid *nodes;
    const struct orl_frame *frames;    /* frames of nodes */
    const struct orl_sun_beams *beams; /* or NULL */
    size_t n_kinds;
    struct orl_port_shadows shadows; /* for beams; unset without them */
    double *of_nodes;                /* [node][kind]: flux that the ports let in */
    uint32_t *beam_of;               /* [node][kind]: beam, or UINT32_MAX */
    struct weight *weights;          /* [sun][corner][1 + kind] */
    struct fallback *fallbacks;      /* [sun][kind] */
};

/* Weights of a corner in the cubic and in the wide interpolation; both 0: none. */
struct weight {
    float fine, wide;
};

/* Fallback for the corners: if a sun lights ports of a kind and the corners do not, the nearest
 * node that does replaces them. */
struct fallback {
    uint32_t beam; /* beam of that node */
    float weight;  /* 0: no fallback */
    bool missing;  /* true if a fallback is needed, but no node lights those ports */
};

static struct weight *weights_of(const struct builder *m, size_t which)
{
    return m->weights + which * CORNERS * (1 + m->n_kinds);
}

/* Length of the interpolated direction. Weights are divided by it, so that irradiance of a plane
 * has the correct cosine. */
static double chord_length(const struct builder *m, const struct orl_sun_interpolation *at,
                           const float *weights)
{
    struct orl_vec3 chord = {0, 0, 0};
    for (int i = 0; i < CORNERS; i++)
        chord = orl_madd(chord, m->frames[at->nodes[i]].n, (double)weights[i]);
    return orl_length(chord);
}

static double flux_of_corners(const struct builder *m, const struct orl_sun_interpolation *at,
                              const float *weights, uint32_t kind)
{
    double sum = 0;
    for (int i = 0; i < CORNERS; i++)
        sum += (double)weights[i] * m->of_nodes[at->nodes[i] * m->n_kinds + kind];
    return sum;
}

/* Returns true if all corners light ports of a kind, so that their flux is smooth in between. */
static bool is_lit_by_all_corners(const struct builder *m, const struct orl_sun_interpolation *at,
                                  uint32_t kind)
{
    for (int i = 0; i < CORNERS; i++)
        if (at->weights[i] != 0 && !(m->of_nodes[at->nodes[i] * m->n_kinds + kind] > 0))
            return false;
    return true;
}

/* Returns the flux that a sun sends through ports of a kind, less what obstacles outside block. */
static double flux_of_sun(const struct builder *m, uint32_t kind, struct orl_vec3 sun)
{
    const double flux = orl_sun_beams_flux(m->beams, kind, sun);
    return flux > 0 ? flux * orl_port_shadows_lit(&m->shadows, kind, sun) : 0;
}

static struct fallback find_fallback(const struct builder *m, uint32_t kind, struct orl_vec3 sun,
                                     double flux)
{
    struct fallback ret = {.weight = 0};
    double nearest = -1;
    for (uint32_t i = 0; i < m->nodes->count; i++) {
        const double of_node = m->of_nodes[i * m->n_kinds + kind];
        const uint32_t beam = m->beam_of[i * m->n_kinds + kind];
        const double cosine = orl_dot(m->frames[i].n, sun);
        if (!(of_node > least_lit * flux) || beam == UINT32_MAX || cosine <= nearest)
            continue;
        nearest = cosine;
        ret = (struct fallback){.beam = beam, .weight = (float)(flux / of_node)};
    }
    ret.missing = nearest < 0;
    return ret;
}

/* Computes weights of a kind. If a sun sends more than twice as much through the ports as the
 * corners, or less than half, its light falls elsewhere indoors. The wide interpolation then gets
 * less than its full weight. This increases the difference of both interpolations, and hence the
 * error. */
static void weigh_kind(const struct builder *m, const struct orl_sun_interpolation *at,
                       uint32_t kind, size_t which, struct weight *weights)
{
    const struct orl_vec3 sun = m->suns->at[which].towards;
    const double flux = flux_of_sun(m, kind, sun);
    const double of_plain = flux_of_corners(m, at, at->plain, kind);
    if (flux > 0 && !(of_plain > least_lit * flux))
        m->fallbacks[which * m->n_kinds + kind] = find_fallback(m, kind, sun, flux);
    if (!(flux > 0) || !(of_plain > least_lit * flux))
        return;
    const bool fine = is_lit_by_all_corners(m, at, kind);
    const double of_fine = fine ? flux_of_corners(m, at, at->weights, kind) : of_plain;
    const double of_wide = flux_of_corners(m, at, at->wide, kind);
    const float *rough = of_wide > 0.2 * of_plain ? at->wide : at->plain;
    const float *by = fine && of_fine > 0.5 * of_plain ? at->weights : at->plain;
    const double ratio = flux / (by == at->plain ? of_plain : of_fine);
    const double alike = fmin(2 * fmin(ratio, 1 / ratio), 1);
    const double of_rough = rough == at->plain ? of_plain : of_wide;
    for (int i = 0; i < CORNERS; i++)
        weights[(size_t)i * (1 + m->n_kinds) + 1 + kind] = (struct weight){
            (float)((double)by[i] * ratio), (float)((double)rough[i] * alike * flux / of_rough)};
}

static void weigh_sun(void *arg, size_t which, uint32_t member)
{
    const struct builder *m = arg;
    const struct orl_hour_sun *sun = &m->suns->at[which];
    struct weight *weights = weights_of(m, which);
    (void)member;
    if (!sun->wanted)
        return;
    const struct orl_sun_interpolation at =
        orl_sun_grid_interpolate(m->nodes, m->suns->in_sky[which]);
    const double fine = chord_length(m, &at, at.weights), wide = chord_length(m, &at, at.wide);
    for (int i = 0; i < CORNERS; i++)
        weights[(size_t)i * (1 + m->n_kinds)] = (struct weight){
            (float)((double)at.weights[i] / fine), (float)((double)at.wide[i] / wide)};
    for (uint32_t kind = 0; kind < m->n_kinds; kind++)
        weigh_kind(m, &at, kind, which, weights);
}

static void measure_nodes(struct builder *m)
{
    for (size_t i = 0; i < m->nodes->count * m->n_kinds; i++) {
        m->of_nodes[i] = flux_of_sun(m, (uint32_t)(i % m->n_kinds), m->frames[i / m->n_kinds].n);
        m->beam_of[i] = UINT32_MAX;
    }
    for (size_t i = 0; m->beams && i < m->beams->count; i++)
        m->beam_of[m->beams->at[i].node * m->n_kinds + m->beams->at[i].kind] = (uint32_t)i;
}

/* Lists the weights of a sun for nodes (of: 0) or a kind (of: kind plus 1). Stores them at `to` if
 * write is true. Returns their number. */
static uint32_t list_kind(const struct builder *m, size_t sun,
                          const struct orl_sun_interpolation *at, size_t of, uint32_t to,
                          bool write)
{
    struct orl_sun_weights *sun_weights = m->sun_weights;
    const struct weight *all = weights_of(m, sun);
    uint32_t n = 0;
    for (int i = 0; i < CORNERS; i++) {
        const struct weight weight = all[(size_t)i * (1 + m->n_kinds) + of];
        const uint32_t which =
            of == 0 ? at->nodes[i] : m->beam_of[at->nodes[i] * m->n_kinds + of - 1];
        if ((weight.fine == 0 && weight.wide == 0) || which == UINT32_MAX)
            continue;
        if (write) {
            sun_weights->which[to + n] = which;
            sun_weights->weights[to + n] = weight.fine;
            sun_weights->difference[to + n] = weight.fine - weight.wide;
        }
        n++;
    }
    const struct fallback *other = of > 0 ? &m->fallbacks[sun * m->n_kinds + of - 1] : NULL;
    if (!other || !(other->weight > 0))
        return n;
    if (write) {
        sun_weights->which[to + n] = other->beam;
        sun_weights->weights[to + n] = sun_weights->difference[to + n] = other->weight;
    }
    return n + 1;
}

/* Counts the suns that lose some light. */
static size_t count_lost(const struct builder *m)
{
    size_t n = 0;
    for (size_t sun = 0; sun < m->suns->count; sun++) {
        bool missing = false;
        for (size_t kind = 0; kind < m->n_kinds; kind++)
            missing = missing || m->fallbacks[sun * m->n_kinds + kind].missing;
        n += missing;
    }
    return n;
}

/* Lists a sun's weights of nodes, then those of beams by window group, and sets where each begins.
 */
static uint32_t list_sun(const struct builder *m, size_t sun, uint32_t to, bool write)
{
    uint32_t *first = m->sun_weights->first + sun * (1 + m->sun_weights->n_window_groups);
    const bool wanted = m->suns->at[sun].wanted;
    struct orl_sun_interpolation at = {.nodes = {0}};
    if (wanted)
        at = orl_sun_grid_interpolate(m->nodes, m->suns->in_sky[sun]);
    first[0] = to;
    if (wanted)
        to += list_kind(m, sun, &at, 0, to, write);
    for (uint32_t window_group = 0; window_group < m->sun_weights->n_window_groups;
         window_group++) {
        first[1 + window_group] = to;
        for (size_t k = 0; wanted && k < m->n_kinds; k++)
            if (m->beams->kinds[k].window_group == window_group)
                to += list_kind(m, sun, &at, k + 1, to, write);
    }
    return to;
}

static uint32_t list_suns(const struct builder *m, bool write)
{
    uint32_t n = 0;
    for (size_t sun = 0; sun < m->suns->count; sun++)
        n = list_sun(m, sun, n, write);
    m->sun_weights->first[m->suns->count * (1 + m->sun_weights->n_window_groups)] = n;
    return n;
}

void orl_sun_weights_allocate(struct orl_sun_weights *w, size_t n_firsts, size_t n_weights)
{
    if (!w->first)
        w->first = orl_arrays_new(&w->arrays, n_firsts, sizeof *w->first);
    w->which = orl_arrays_new(&w->arrays, n_weights, sizeof *w->which);
    w->weights = orl_arrays_new(&w->arrays, n_weights, sizeof *w->weights);
    w->difference = orl_arrays_new(&w->arrays, n_weights, sizeof *w->difference);
}

static int list_all(const struct builder *m)
{
    struct orl_sun_weights *w = m->sun_weights;
    const size_t n_firsts = m->suns->count * (1 + w->n_window_groups) + 1;
    w->first = orl_arrays_new(&w->arrays, n_firsts, sizeof *w->first);
    if (!w->first)
        return ORL_ERR_NOMEM;
    orl_sun_weights_allocate(w, n_firsts, list_suns(m, false));
    if (w->arrays.failed)
        return ORL_ERR_NOMEM;
    list_suns(m, true);
    return 0;
}

int orl_sun_weights_init(struct orl_sun_weights *sun_weights, const struct orl_year_suns *suns,
                         const struct orl_sun_grid *nodes, const struct orl_frame *node_frames,
                         const struct orl_sun_map *map, const struct orl_sobol *sobol,
                         uint32_t n_window_groups, struct orl_thread_pool *pool)
{
    struct orl_arrays arrays = {.failed = false};
    struct builder m = {
        .sun_weights = sun_weights, .suns = suns, .nodes = nodes, .frames = node_frames};
    *sun_weights = (struct orl_sun_weights){.n_window_groups = n_window_groups};
    if (map) {
        m.beams = orl_sun_map_beams(map);
        m.n_kinds = m.beams->n_kinds;
    }
    const size_t n = nodes->count * m.n_kinds, n_suns = suns->count;
    m.weights = orl_arrays_new(&arrays, n_suns * CORNERS * (1 + m.n_kinds), sizeof *m.weights);
    m.fallbacks = orl_arrays_new(&arrays, n_suns * m.n_kinds, sizeof *m.fallbacks);
    m.of_nodes = orl_arrays_new(&arrays, n, sizeof *m.of_nodes);
    m.beam_of = orl_arrays_new(&arrays, n, sizeof *m.beam_of);
    int code = arrays.failed ? ORL_ERR_NOMEM : 0;
    if (code == 0 && map)
        code = orl_port_shadows_init(&m.shadows, m.beams, sobol, n_suns + nodes->count);
    if (code == 0) {
        measure_nodes(&m);
        code = orl_parallel_try(pool, n_suns, weigh_sun, &m);
    }
    if (code == 0)
        code = list_all(&m);
    if (code == 0)
        sun_weights->n_lost = count_lost(&m);
    orl_arrays_free(&arrays);
    orl_port_shadows_done(&m.shadows);
    return code;
}
