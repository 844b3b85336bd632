#include "annual/sun/sun_weights.h"

#include <stdlib.h>

#include "annual/panes/port_shadows.h"

enum { CORNERS = ORL_SUN_CORNERS };

/* Corners are used for a kind if they let in at least this share of what the sun lets in. */
static const double least_lit = 0.05;

struct maker {
    struct orl_sun_terms *terms;
    const struct orl_year_suns *suns;
    const struct orl_sun_nodes *nodes;
    const struct orl_frame *frames;    /* frames of nodes */
    const struct orl_sun_beams *beams; /* or NULL */
    size_t n_kinds;
    struct orl_port_shadows shadows; /* for beams; unset without them */
    double *of_nodes;                /* [node][kind]: flux that the ports let in */
    uint32_t *beam_of;               /* [node][kind]: beam, or UINT32_MAX */
    struct weight *weights;          /* [sun][corner][1 + kind] */
    struct stand_in *stand_ins;      /* [sun][kind] */
};

/* Weights of a corner in the cubic and in the wide interpolation; both 0: none. */
struct weight {
    float fine, wide;
};

/* Stand-in for the corners: if a sun lights ports of a kind and the corners do not, the nearest
 * node that does replaces them. */
struct stand_in {
    uint32_t beam; /* beam of that node */
    float weight;  /* 0: no stand-in */
    bool missing;  /* true if a stand-in is needed, but no node lights those ports */
};

static struct weight *weights_of(const struct maker *m, size_t which)
{
    return m->weights + which * CORNERS * (1 + m->n_kinds);
}

/* Length of the interpolated direction. Weights are divided by it, so that irradiance of a plane
 * has the correct cosine. */
static double shortening(const struct maker *m, const struct orl_sun_between *at,
                         const float *weights)
{
    struct orl_vec3 chord = {0, 0, 0};
    for (int i = 0; i < CORNERS; i++)
        chord = orl_madd(chord, m->frames[at->nodes[i]].n, (double)weights[i]);
    return orl_length(chord);
}

static double let_in_by_corners(const struct maker *m, const struct orl_sun_between *at,
                                const float *weights, uint32_t kind)
{
    double sum = 0;
    for (int i = 0; i < CORNERS; i++)
        sum += (double)weights[i] * m->of_nodes[at->nodes[i] * m->n_kinds + kind];
    return sum;
}

/* Returns true if all corners light ports of a kind, so that their flux is smooth in between. */
static bool is_lit_all_round(const struct maker *m, const struct orl_sun_between *at, uint32_t kind)
{
    for (int i = 0; i < CORNERS; i++)
        if (at->weights[i] != 0 && !(m->of_nodes[at->nodes[i] * m->n_kinds + kind] > 0))
            return false;
    return true;
}

/* Returns the flux that a sun sends through ports of a kind, less what obstacles outside block. */
static double let_in_of(const struct maker *m, uint32_t kind, struct orl_vec3 sun)
{
    const double let_in = orl_sun_beams_let_in(m->beams, kind, sun);
    return let_in > 0 ? let_in * orl_port_shadows_lit(&m->shadows, kind, sun) : 0;
}

static struct stand_in find_stand_in(const struct maker *m, uint32_t kind, struct orl_vec3 sun,
                                     double let_in)
{
    struct stand_in ret = {.weight = 0};
    double nearest = -1;
    for (uint32_t i = 0; i < m->nodes->count; i++) {
        const double of_node = m->of_nodes[i * m->n_kinds + kind];
        const uint32_t beam = m->beam_of[i * m->n_kinds + kind];
        const double cosine = orl_dot(m->frames[i].n, sun);
        if (!(of_node > least_lit * let_in) || beam == UINT32_MAX || cosine <= nearest)
            continue;
        nearest = cosine;
        ret = (struct stand_in){.beam = beam, .weight = (float)(let_in / of_node)};
    }
    ret.missing = nearest < 0;
    return ret;
}

/* Computes weights of a kind. If a sun sends more than twice as much through the ports as the
 * corners, or less than half, its light falls elsewhere indoors. The wide interpolation then gets
 * less than its full weight. This increases the difference of both interpolations, and hence the
 * error. */
static void weigh_kind(const struct maker *m, const struct orl_sun_between *at, uint32_t kind,
                       size_t which, struct weight *weights)
{
    const struct orl_vec3 sun = m->suns->at[which].towards;
    const double let_in = let_in_of(m, kind, sun);
    const double of_plain = let_in_by_corners(m, at, at->plain, kind);
    if (let_in > 0 && !(of_plain > least_lit * let_in))
        m->stand_ins[which * m->n_kinds + kind] = find_stand_in(m, kind, sun, let_in);
    if (!(let_in > 0) || !(of_plain > least_lit * let_in))
        return;
    const bool fine = is_lit_all_round(m, at, kind);
    const double of_fine = fine ? let_in_by_corners(m, at, at->weights, kind) : of_plain;
    const double of_wide = let_in_by_corners(m, at, at->wide, kind);
    const float *rough = of_wide > 0.2 * of_plain ? at->wide : at->plain;
    const float *by = fine && of_fine > 0.5 * of_plain ? at->weights : at->plain;
    const double ratio = let_in / (by == at->plain ? of_plain : of_fine);
    const double alike = fmin(2 * fmin(ratio, 1 / ratio), 1);
    const double of_rough = rough == at->plain ? of_plain : of_wide;
    for (int i = 0; i < CORNERS; i++)
        weights[(size_t)i * (1 + m->n_kinds) + 1 + kind] = (struct weight){
            (float)((double)by[i] * ratio), (float)((double)rough[i] * alike * let_in / of_rough)};
}

static void weigh_sun(void *arg, size_t which, uint32_t member)
{
    const struct maker *m = arg;
    const struct orl_hour_sun *sun = &m->suns->at[which];
    struct weight *weights = weights_of(m, which);
    (void)member;
    if (!sun->wanted)
        return;
    const struct orl_sun_between at = orl_sun_nodes_between(m->nodes, m->suns->in_sky[which]);
    const double fine = shortening(m, &at, at.weights), wide = shortening(m, &at, at.wide);
    for (int i = 0; i < CORNERS; i++)
        weights[(size_t)i * (1 + m->n_kinds)] = (struct weight){
            (float)((double)at.weights[i] / fine), (float)((double)at.wide[i] / wide)};
    for (uint32_t kind = 0; kind < m->n_kinds; kind++)
        weigh_kind(m, &at, kind, which, weights);
}

static int measure_nodes(struct maker *m)
{
    const size_t n = m->nodes->count * m->n_kinds;
    m->of_nodes = malloc((n + 1) * sizeof *m->of_nodes);
    m->beam_of = malloc((n + 1) * sizeof *m->beam_of);
    if (!m->of_nodes || !m->beam_of)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++) {
        m->of_nodes[i] = let_in_of(m, (uint32_t)(i % m->n_kinds), m->frames[i / m->n_kinds].n);
        m->beam_of[i] = UINT32_MAX;
    }
    for (size_t i = 0; m->beams && i < m->beams->count; i++)
        m->beam_of[m->beams->at[i].node * m->n_kinds + m->beams->at[i].kind] = (uint32_t)i;
    return 0;
}

/* Lists the terms of a sun for nodes (of: 0) or a kind (of: kind plus 1). Stores them at `to` if
 * write is true. Returns their number. */
static uint32_t list_kind(const struct maker *m, size_t sun, const struct orl_sun_between *at,
                          size_t of, uint32_t to, bool write)
{
    struct orl_sun_terms *terms = m->terms;
    const struct weight *all = weights_of(m, sun);
    uint32_t n = 0;
    for (int i = 0; i < CORNERS; i++) {
        const struct weight weight = all[(size_t)i * (1 + m->n_kinds) + of];
        const uint32_t which =
            of == 0 ? at->nodes[i] : m->beam_of[at->nodes[i] * m->n_kinds + of - 1];
        if ((weight.fine == 0 && weight.wide == 0) || which == UINT32_MAX)
            continue;
        if (write) {
            terms->which[to + n] = which;
            terms->weights[to + n] = weight.fine;
            terms->apart[to + n] = weight.fine - weight.wide;
        }
        n++;
    }
    const struct stand_in *other = of > 0 ? &m->stand_ins[sun * m->n_kinds + of - 1] : NULL;
    if (!other || !(other->weight > 0))
        return n;
    if (write) {
        terms->which[to + n] = other->beam;
        terms->weights[to + n] = terms->apart[to + n] = other->weight;
    }
    return n + 1;
}

/* Counts the suns that lose some light. */
static size_t count_lost(const struct maker *m)
{
    size_t n = 0;
    for (size_t sun = 0; sun < m->suns->count; sun++) {
        bool missing = false;
        for (size_t kind = 0; kind < m->n_kinds; kind++)
            missing = missing || m->stand_ins[sun * m->n_kinds + kind].missing;
        n += missing;
    }
    return n;
}

/* Lists a sun's terms of nodes, then those of beams by part, and sets where each begins. */
static uint32_t list_sun(const struct maker *m, size_t sun, uint32_t to, bool write)
{
    uint32_t *first = m->terms->first + sun * (1 + m->terms->n_parts);
    const bool wanted = m->suns->at[sun].wanted;
    struct orl_sun_between at = {.nodes = {0}};
    if (wanted)
        at = orl_sun_nodes_between(m->nodes, m->suns->in_sky[sun]);
    first[0] = to;
    if (wanted)
        to += list_kind(m, sun, &at, 0, to, write);
    for (uint32_t part = 0; part < m->terms->n_parts; part++) {
        first[1 + part] = to;
        for (size_t k = 0; wanted && k < m->n_kinds; k++)
            if (m->beams->kinds[k].part == part)
                to += list_kind(m, sun, &at, k + 1, to, write);
    }
    return to;
}

static uint32_t list_suns(const struct maker *m, bool write)
{
    uint32_t n = 0;
    for (size_t sun = 0; sun < m->suns->count; sun++)
        n = list_sun(m, sun, n, write);
    m->terms->first[m->suns->count * (1 + m->terms->n_parts)] = n;
    return n;
}

static int list_all(const struct maker *m)
{
    struct orl_sun_terms *terms = m->terms;
    terms->first = calloc(m->suns->count * (1 + terms->n_parts) + 1, sizeof *terms->first);
    if (!terms->first)
        return ORL_ERR_NOMEM;
    const size_t n = list_suns(m, false);
    terms->which = malloc((n + 1) * sizeof *terms->which);
    terms->weights = malloc((n + 1) * sizeof *terms->weights);
    terms->apart = malloc((n + 1) * sizeof *terms->apart);
    if (!terms->which || !terms->weights || !terms->apart)
        return ORL_ERR_NOMEM;
    list_suns(m, true);
    return 0;
}

int orl_sun_terms_init(struct orl_sun_terms *terms, const struct orl_year_suns *suns,
                       const struct orl_sun_nodes *nodes, const struct orl_frame *node_frames,
                       const struct orl_sun_map *map, const struct orl_sobol *sobol,
                       uint32_t n_parts, struct orl_crew *crew)
{
    struct maker m = {.terms = terms, .suns = suns, .nodes = nodes, .frames = node_frames};
    *terms = (struct orl_sun_terms){.n_parts = n_parts};
    if (map) {
        m.beams = orl_sun_map_beams(map);
        m.n_kinds = m.beams->n_kinds;
    }
    m.weights = calloc(suns->count * CORNERS * (1 + m.n_kinds) + 1, sizeof *m.weights);
    m.stand_ins = calloc(suns->count * m.n_kinds + 1, sizeof *m.stand_ins);
    int code = m.weights && m.stand_ins ? 0 : ORL_ERR_NOMEM;
    if (code == 0 && map)
        code = orl_port_shadows_init(&m.shadows, m.beams, sobol, suns->count + nodes->count);
    if (code == 0)
        code = measure_nodes(&m);
    if (code == 0)
        code = orl_crew_try(crew, suns->count, weigh_sun, &m);
    if (code == 0)
        code = list_all(&m);
    if (code == 0)
        terms->n_lost = count_lost(&m);
    free(m.of_nodes);
    free(m.beam_of);
    free(m.weights);
    free(m.stand_ins);
    orl_port_shadows_done(&m.shadows);
    return code;
}

void orl_sun_terms_done(struct orl_sun_terms *terms)
{
    free(terms->first);
    free(terms->which);
    free(terms->weights);
    free(terms->apart);
    *terms = (struct orl_sun_terms){.first = NULL};
}
