#include "annual/terms.h"

#include <stdlib.h>

enum { CORNERS = 4 };

struct maker {
    struct orl_sun_terms *terms;
    const struct orl_hours *hours;
    const struct orl_sun_nodes *nodes;
    const struct orl_frame *frames;    /* of nodes */
    const struct orl_sun_beams *beams; /* or NULL */
    size_t n_kinds;
    double *of_nodes;  /* [node][kind]: what ports let in */
    uint32_t *beam_of; /* [node][kind], or UINT32_MAX */
    float *weights;    /* [column][corner][1 + kind], 0: none */
};

static float *weights_of(const struct maker *m, size_t column)
{
    return m->weights + column * CORNERS * (1 + m->n_kinds);
}

static void weigh(void *arg, size_t column, uint32_t member)
{
    const struct maker *m = arg;
    const struct orl_hour_sun *sun = &m->hours->suns[column];
    float *weights = weights_of(m, column);
    (void)member;
    if (!(sun->normal_lx > 0))
        return;
    const struct orl_sun_between at = orl_sun_nodes_between(m->nodes, m->hours->sky_suns[column]);
    struct orl_vec3 chord = {0, 0, 0};
    for (int i = 0; i < CORNERS; i++)
        chord = orl_madd(chord, m->frames[at.nodes[i]].n, (double)at.weights[i]);
    for (int i = 0; i < CORNERS; i++)
        weights[(size_t)i * (1 + m->n_kinds)] = (float)((double)at.weights[i] / orl_length(chord));
    for (uint32_t kind = 0; kind < m->n_kinds; kind++) {
        double of_corners = 0;
        for (int i = 0; i < CORNERS; i++)
            of_corners += (double)at.weights[i] * m->of_nodes[at.nodes[i] * m->n_kinds + kind];
        if (!(of_corners > 0))
            continue;
        const double ratio = orl_sun_beams_let_in(m->beams, kind, sun->towards) / of_corners;
        for (int i = 0; i < CORNERS; i++)
            weights[(size_t)i * (1 + m->n_kinds) + 1 + kind] =
                (float)((double)at.weights[i] * ratio);
    }
}

static int measure_nodes(struct maker *m)
{
    const size_t n = m->nodes->count * m->n_kinds;
    m->of_nodes = malloc((n + 1) * sizeof *m->of_nodes);
    m->beam_of = malloc((n + 1) * sizeof *m->beam_of);
    if (!m->of_nodes || !m->beam_of)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n; i++) {
        m->of_nodes[i] =
            orl_sun_beams_let_in(m->beams, (uint32_t)(i % m->n_kinds), m->frames[i / m->n_kinds].n);
        m->beam_of[i] = UINT32_MAX;
    }
    for (size_t i = 0; m->beams && i < m->beams->count; i++)
        m->beam_of[m->beams->at[i].node * m->n_kinds + m->beams->at[i].kind] = (uint32_t)i;
    return 0;
}

/* Those of a column that weigh anything; returns how many, and writes them where there is room. */
static uint32_t list_column(const struct maker *m, size_t column, uint32_t *which, float *weights)
{
    const float *all = weights_of(m, column);
    uint32_t n = 0;
    if (!(m->hours->suns[column].normal_lx > 0))
        return 0;
    const struct orl_sun_between at = orl_sun_nodes_between(m->nodes, m->hours->sky_suns[column]);
    for (int i = 0; i < CORNERS; i++)
        for (size_t k = 0; k < 1 + m->n_kinds; k++) {
            const float weight = all[(size_t)i * (1 + m->n_kinds) + k];
            const uint32_t beam = k == 0 ? 0 : m->beam_of[at.nodes[i] * m->n_kinds + k - 1];
            if (weight == 0 || beam == UINT32_MAX)
                continue;
            if (which) {
                which[n] = k == 0 ? at.nodes[i] : (uint32_t)m->nodes->count + beam;
                weights[n] = weight;
            }
            n++;
        }
    return n;
}

static int list_all(const struct maker *m)
{
    struct orl_sun_terms *terms = m->terms;
    const size_t columns = m->hours->n_columns;
    terms->first = calloc(columns + 1, sizeof *terms->first);
    if (!terms->first)
        return ORL_ERR_NOMEM;
    for (size_t c = 0; c < columns; c++)
        terms->first[c + 1] = terms->first[c] + list_column(m, c, NULL, NULL);
    terms->which = malloc((terms->first[columns] + 1) * sizeof *terms->which);
    terms->weights = malloc((terms->first[columns] + 1) * sizeof *terms->weights);
    if (!terms->which || !terms->weights)
        return ORL_ERR_NOMEM;
    for (size_t c = 0; c < columns; c++)
        list_column(m, c, terms->which + terms->first[c], terms->weights + terms->first[c]);
    return 0;
}

int orl_sun_terms_init(struct orl_sun_terms *terms, const struct orl_hours *hours,
                       const struct orl_sun_nodes *nodes, const struct orl_frame *node_frames,
                       const struct orl_sun_map *map, struct orl_crew *crew)
{
    struct maker m = {.terms = terms, .hours = hours, .nodes = nodes, .frames = node_frames};
    *terms = (struct orl_sun_terms){.first = NULL};
    if (map) {
        m.beams = orl_sun_map_beams(map);
        m.n_kinds = m.beams->n_kinds;
    }
    m.weights = calloc(hours->n_columns * CORNERS * (1 + m.n_kinds) + 1, sizeof *m.weights);
    int code = m.weights ? measure_nodes(&m) : ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_crew_try(crew, hours->n_columns, weigh, &m);
    if (code == 0)
        code = list_all(&m);
    free(m.of_nodes);
    free(m.beam_of);
    free(m.weights);
    return code;
}

void orl_sun_terms_done(struct orl_sun_terms *terms)
{
    free(terms->first);
    free(terms->which);
    free(terms->weights);
    *terms = (struct orl_sun_terms){.first = NULL};
}
