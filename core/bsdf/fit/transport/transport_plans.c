#include "bsdf/fit/transport/transport_plans.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"

/* ---- Plans ----------------------------------------------------------------------------------- */

/* Farthest move of light: this multiple of the turn of the incident direction, at least 10
 * degrees. */
static const double farthest_times = 2.5, farthest_least = 10 * ORL_DEG_TO_RAD;

static bool request_edge(struct orl_fit_plans *plans, uint32_t a, uint32_t b)
{
    if (!orl_array_reserve(&plans->edges, &plans->capacity, plans->n, sizeof *plans->edges))
        return false;
    plans->edges[plans->n++] = (struct orl_fit_edge){.a = a < b ? a : b, .b = a < b ? b : a};
    return true;
}

bool orl_fit_plans_request(struct orl_fit_plans *plans, const struct orl_fit_location *location)
{
    for (unsigned i = 0; i < location->count; i++)
        for (unsigned j = i + 1; j < location->count; j++)
            if (!request_edge(plans, location->corner[i], location->corner[j]))
                return false;
    return true;
}

static int compare_edges(const void *a, const void *b)
{
    const struct orl_fit_edge *x = a, *y = b;
    return x->a != y->a ? (x->a < y->a ? -1 : 1) : (x->b > y->b) - (x->b < y->b);
}

struct options {
    struct orl_fit_plans *plans;
    const struct orl_fit_mesh *mesh;
    const atomic_bool *cancel;
};

static void make_edge(void *arg, size_t index, uint32_t member)
{
    const struct options *m = arg;
    struct orl_fit_edge *edge = &m->plans->edges[index];
    const struct orl_fit_shape *a = m->mesh->shapes[edge->a], *b = m->mesh->shapes[edge->b];
    const double moved = orl_length(orl_sub(a->in, b->in));
    (void)member;
    for (int kind = 0; kind < ORL_FIT_KINDS && edge->code == 0; kind++)
        edge->code = orl_fit_plan_make(&a->parts[kind], &b->parts[kind],
                                       fmax(farthest_least, farthest_times * moved), m->cancel,
                                       &edge->plans[kind], NULL);
}

static void sort_edges(struct orl_fit_plans *plans)
{
    size_t kept = 0;
    if (plans->n > 0)
        qsort(plans->edges, plans->n, sizeof *plans->edges, compare_edges);
    for (size_t i = 0; i < plans->n; i++)
        if (kept == 0 || compare_edges(&plans->edges[kept - 1], &plans->edges[i]) != 0)
            plans->edges[kept++] = plans->edges[i];
    plans->n = kept;
}

/* Requests all edges that have a marked end. */
static bool request_around(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                           const bool *marked)
{
    for (size_t i = 0; i < orl_fit_mesh_edges(mesh); i++) {
        uint32_t ends[2];
        orl_fit_mesh_edge(mesh, i, ends);
        if ((marked[ends[0]] || marked[ends[1]]) && !request_edge(plans, ends[0], ends[1]))
            return false;
    }
    return true;
}

/* Velocities at requested directions need all edges of these. Velocities at the border continue
 * those of inner neighbours, so all edges of these neighbours are needed too. */
static bool request_for_velocities(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh)
{
    bool *marked = calloc(2 * mesh->n + 2, sizeof *marked), *border = marked + mesh->n + 1;
    bool fine = marked != NULL;
    if (fine) {
        orl_fit_mesh_border(mesh, border);
        for (size_t i = 0; i < plans->n; i++)
            marked[plans->edges[i].a] = marked[plans->edges[i].b] = true;
        for (size_t i = 0; i < orl_fit_mesh_edges(mesh); i++) {
            uint32_t e[2];
            orl_fit_mesh_edge(mesh, i, e);
            for (int k = 0; k < 2; k++)
                if (marked[e[k]] && border[e[k]] && !border[e[1 - k]])
                    marked[e[1 - k]] = true;
        }
        fine = request_around(plans, mesh, marked);
    }
    free(marked);
    return fine;
}

int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_thread_pool *pool, const atomic_bool *cancel,
                       struct orl_error *err)
{
    struct options options = {plans, mesh, cancel};
    int code = 0;
    sort_edges(plans);
    if (!request_for_velocities(plans, mesh))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for transport plans");
    sort_edges(plans);
    if (pool)
        code = orl_parallel_try(pool, plans->n, make_edge, &options);
    else
        orl_parallel_for(NULL, plans->n, make_edge, &options);
    for (size_t i = 0; i < plans->n && code == 0; i++)
        code = plans->edges[i].code;
    plans->n_directions = mesh->n;
    if (code == 0 && !orl_fit_velocities_make(plans->edges, plans->n, mesh, &plans->velocities))
        code = ORL_ERR_NOMEM;
    return code == 0 ? 0
                     : orl_error_set(err, code,
                                     code == ORL_ERR_CANCELLED ? "cancelled"
                                                               : "out of memory for transport");
}

void orl_fit_plans_done(struct orl_fit_plans *plans)
{
    if (!plans)
        return;
    for (size_t i = 0; i < plans->n; i++)
        for (int kind = 0; kind < ORL_FIT_KINDS; kind++)
            orl_fit_plan_done(&plans->edges[i].plans[kind]);
    free(plans->edges);
    orl_fit_velocities_done(plans->velocities, plans->n_directions);
    memset(plans, 0, sizeof *plans);
}

const struct orl_fit_moves *orl_fit_plans_moves(const struct orl_fit_plans *plans, uint32_t from,
                                                uint32_t to, int kind)
{
    const struct orl_fit_edge key = {.a = from < to ? from : to, .b = from < to ? to : from};
    const struct orl_fit_edge *edge =
        plans->n > 0 ? bsearch(&key, plans->edges, plans->n, sizeof *plans->edges, compare_edges)
                     : NULL;
    return edge ? &edge->plans[kind].directions[from > to] : NULL;
}
