/* Plans along the edges of the mesh, and the motion of light that follows from them. */
#include "bsdf/fit/transport/transport.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/* Limit on turns, as a multiple of the turn of the incident direction. Equal to farthest_times
 * below. */
static const double steepest = 2.5;
/* Smallest share of a cluster that must move to one place to define a velocity. */
static const float least_whole = 0.7F;
/* Largest share of weight on edges without information for a velocity to be known. */
static const double max_uninformed = 0.3;
/* Smallest share of a move whose clusters must have known velocities. */
static const float least_known = 0.8F;

/* ---- Arcs ------------------------------------------------------------------------------------ */

/* Returns the tangent vector at `from` of the great circle to `to`, as long as the arc between
 * them. Both are unit vectors. */
static struct orl_vec3 arc_between(struct orl_vec3 from, struct orl_vec3 to)
{
    const double cosine = orl_dot(from, to);
    const struct orl_vec3 across = orl_madd(to, from, -cosine);
    const double sine = orl_length(across);
    return orl_scale(across, sine > 1e-9 ? atan2(sine, cosine) / sine : 1);
}

struct orl_vec3 orl_fit_arc_end(struct orl_vec3 from, struct orl_vec3 arc)
{
    const double angle = orl_length(arc);
    return orl_madd(orl_scale(from, cos(angle)), arc, angle > 1e-9 ? sin(angle) / angle : 1);
}

struct orl_fit_turn orl_fit_turn_between(struct orl_vec3 from, struct orl_vec3 to)
{
    const struct orl_frame frame = orl_frame_about(from);
    const struct orl_vec3 arc = arc_between(from, to);
    return (struct orl_fit_turn){orl_dot(arc, frame.u), orl_dot(arc, frame.v)};
}

struct orl_vec3 orl_fit_velocity_arc(const struct orl_fit_velocity *velocity,
                                     struct orl_fit_turn turn)
{
    const struct orl_vec3 arc =
        orl_v3((double)velocity->x[0] * turn.u + (double)velocity->x[1] * turn.v,
               (double)velocity->y[0] * turn.u + (double)velocity->y[1] * turn.v,
               (double)velocity->z[0] * turn.u + (double)velocity->z[1] * turn.v);
    const double most = steepest * hypot(turn.u, turn.v), length = orl_length(arc);
    return length > most ? orl_scale(arc, most / length) : arc;
}

/* Returns a tangent vector carried along the great circle from one place to another. */
static struct orl_vec3 carry_tangent(struct orl_vec3 tangent, struct orl_vec3 from,
                                     struct orl_vec3 to)
{
    const double along = orl_dot(tangent, to) / (1 + orl_dot(from, to));
    return orl_madd(tangent, orl_add(from, to), -along);
}

/* ---- Velocities ------------------------------------------------------------------------------ */

struct velocities {
    struct orl_fit_edge *edges;
    size_t n;
    const struct orl_fit_mesh *mesh;
    struct orl_fit_velocities *velocities;
    bool *border; /* by direction of the mesh */
};

/* Sums of least squares: of turns, and of the clusters' turns and widenings. */
struct least_squares {
    double uu, uv, vv, right[4][2];
    double uninformed, all; /* weight of edges without information, and of all */
};

static const struct orl_fit_move *whole_move(const struct orl_fit_moves *moves, size_t cluster)
{
    const struct orl_fit_move *most = NULL;
    if (!moves->first)
        return NULL;
    for (uint32_t k = moves->first[cluster]; k < moves->first[cluster + 1]; k++)
        if (!most || moves->moves[k].share > most->share)
            most = &moves->moves[k];
    return most && !most->fades && most->share >= least_whole ? most : NULL;
}

static struct orl_vec3 place_of(const struct orl_fit_move *move)
{
    return orl_normalize(orl_v3((double)move->x, (double)move->y, (double)move->z));
}

/* Adds one edge's information on a cluster. continued: as a parabola, if the other end has a
 * velocity. */
static void add_edge(struct least_squares *s, const struct orl_fit_cluster *cluster,
                     const struct orl_fit_move *move, const struct orl_vec3 in[2], bool continued)
{
    const struct orl_fit_turn turn = orl_fit_turn_between(in[0], in[1]);
    const double size2 = turn.u * turn.u + turn.v * turn.v, weight = 1 / (size2 * sqrt(size2));
    s->all += weight;
    if (!move) {
        s->uninformed += weight;
        return;
    }
    const struct orl_vec3 from = orl_v3((double)cluster->x, (double)cluster->y, (double)cluster->z);
    const struct orl_vec3 to = place_of(move);
    struct orl_vec3 arc = arc_between(from, to);
    double wider = (double)move->sigma_rad - (double)cluster->sigma_rad;
    if (continued && move->velocity.known) {
        const struct orl_fit_turn back = orl_fit_turn_between(in[1], in[0]);
        const struct orl_vec3 end =
            carry_tangent(orl_fit_velocity_arc(&move->velocity, back), to, from);
        arc = orl_add(orl_scale(arc, 2), end);
        wider = 2 * wider + ((double)move->velocity.sigma[0] * back.u +
                             (double)move->velocity.sigma[1] * back.v);
    }
    const double by[4] = {arc.x, arc.y, arc.z, wider};
    s->uu += weight * turn.u * turn.u;
    s->uv += weight * turn.u * turn.v;
    s->vv += weight * turn.v * turn.v;
    for (int k = 0; k < 4; k++) {
        s->right[k][0] += weight * turn.u * by[k];
        s->right[k][1] += weight * turn.v * by[k];
    }
}

/* Solves the sums. A small regularisation makes velocities 0 across a row of directions. */
static struct orl_fit_velocity solve_least_squares(const struct least_squares *s)
{
    const double more = 1e-6 * (s->uu + s->vv), uu = s->uu + more, vv = s->vv + more;
    const double determinant = uu * vv - s->uv * s->uv;
    struct orl_fit_velocity velocity = {.known = s->uninformed <= max_uninformed * s->all &&
                                                 s->uu + s->vv > 0};
    float *const to[4] = {velocity.x, velocity.y, velocity.z, velocity.sigma};
    for (int k = 0; k < 4 && velocity.known; k++) {
        to[k][0] = (float)((s->right[k][0] * vv - s->right[k][1] * s->uv) / determinant);
        to[k][1] = (float)((s->right[k][1] * uu - s->right[k][0] * s->uv) / determinant);
    }
    return velocity;
}

/* Sets the edges of one direction, in their order; returns their number. */
static size_t edges_of(const struct velocities *s, uint32_t v,
                       const struct orl_fit_edge **ret_edges)
{
    size_t n = 0;
    for (size_t i = 0; i < s->n; i++)
        if (s->edges[i].a == v || s->edges[i].b == v)
            ret_edges[n++] = &s->edges[i];
    return n;
}

static struct orl_fit_velocity velocity_of(const struct velocities *s, uint32_t v, int kind,
                                           size_t cluster, const struct orl_fit_edge **edges,
                                           size_t n)
{
    const struct orl_fit_cluster *from = &s->mesh->shapes[v]->parts[kind].clusters[cluster];
    struct least_squares least_squares = {0};
    for (size_t i = 0; i < n; i++) {
        const struct orl_fit_edge *edge = edges[i];
        const uint32_t other = edge->a == v ? edge->b : edge->a;
        const struct orl_vec3 in[2] = {s->mesh->shapes[v]->in, s->mesh->shapes[other]->in};
        add_edge(&least_squares, from,
                 whole_move(&edge->plans[kind].directions[edge->b == v], cluster), in,
                 s->border[v] && !s->border[other]);
    }
    return solve_least_squares(&least_squares);
}

/* Makes the velocities of directions on the border, or of the others. */
static bool make_velocities(struct velocities *s, bool border)
{
    const struct orl_fit_edge **edges = malloc((s->n + 1) * sizeof(void *));
    bool fine = edges != NULL;
    for (uint32_t v = 0; v < s->mesh->n && fine; v++) {
        if (s->border[v] != border)
            continue;
        const size_t n = edges_of(s, v, edges);
        for (int kind = 0; kind < ORL_FIT_KINDS && fine; kind++) {
            const size_t clusters = s->mesh->shapes[v]->parts[kind].n_clusters;
            struct orl_fit_velocity *velocities = calloc(clusters + 1, sizeof *velocities);
            s->velocities[v].of[kind] = velocities;
            fine = velocities != NULL;
            for (size_t i = 0; i < clusters && fine; i++)
                velocities[i] = velocity_of(s, v, kind, i, edges, n);
        }
    }
    free(edges);
    return fine;
}

/* Sets each move's velocity to the mean over its clusters; known if nearly all of these are. */
static bool set_velocities(struct orl_fit_moves *moves, size_t n_moves,
                           const struct orl_fit_velocity *velocities)
{
    float *known = calloc(n_moves + 1, sizeof *known);
    if (!known)
        return false;
    for (size_t k = 0; k < n_moves; k++)
        moves->moves[k].velocity = (struct orl_fit_velocity){0};
    for (size_t k = 0; k < moves->n_submoves; k++)
        if (velocities[moves->submoves[k].to].known)
            known[moves->submoves[k].move] += moves->submoves[k].share;
    for (size_t k = 0; k < moves->n_submoves; k++) {
        const struct orl_fit_submove *submove = &moves->submoves[k];
        struct orl_fit_move *move = &moves->moves[submove->move];
        if (!(known[submove->move] > least_known * move->share) || !velocities[submove->to].known)
            continue;
        const float share = submove->share / known[submove->move];
        const struct orl_fit_velocity *of = &velocities[submove->to];
        for (int axis = 0; axis < 2; axis++) {
            move->velocity.x[axis] += share * of->x[axis];
            move->velocity.y[axis] += share * of->y[axis];
            move->velocity.z[axis] += share * of->z[axis];
            move->velocity.sigma[axis] += share * of->sigma[axis];
        }
        move->velocity.known = true;
    }
    free(known);
    return true;
}

static bool set_all_velocities(const struct velocities *s)
{
    for (size_t i = 0; i < s->n; i++) {
        const struct orl_fit_edge *edge = &s->edges[i];
        for (int kind = 0; kind < ORL_FIT_KINDS; kind++)
            for (int direction = 0; direction < 2; direction++) {
                const uint32_t of = direction ? edge->b : edge->a,
                               to = direction ? edge->a : edge->b;
                struct orl_fit_moves *moves = &s->edges[i].plans[kind].directions[direction];
                const size_t clusters = s->mesh->shapes[of]->parts[kind].n_clusters;
                if (moves->first && s->velocities[to].of[kind] &&
                    !set_velocities(moves, moves->first[clusters], s->velocities[to].of[kind]))
                    return false;
            }
    }
    return true;
}

static void velocities_done(struct orl_fit_velocities *velocities, size_t n)
{
    for (size_t i = 0; velocities && i < n; i++)
        for (int kind = 0; kind < ORL_FIT_KINDS; kind++)
            free(velocities[i].of[kind]);
    free(velocities);
}

/* Sets the velocities of all directions, and of the moves in the edges' plans. edges: sorted by a,
 * then b. *ret_velocities: by direction of the mesh, owned by the caller, freed with
 * velocities_done. Returns false if out of memory. */
static bool derive_velocities(struct orl_fit_edge *edges, size_t n, const struct orl_fit_mesh *mesh,
                              struct orl_fit_velocities **ret_velocities)
{
    struct velocities s = {edges, n, mesh, calloc(mesh->n + 1, sizeof *s.velocities),
                           calloc(mesh->n + 1, sizeof *s.border)};
    bool fine = s.velocities && s.border;
    if (fine) {
        orl_fit_mesh_border(mesh, s.border);
        fine = make_velocities(&s, false) && set_all_velocities(&s) && make_velocities(&s, true) &&
               set_all_velocities(&s);
    }
    free(s.border);
    if (fine)
        *ret_velocities = s.velocities;
    else
        velocities_done(s.velocities, mesh->n);
    return fine;
}

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
    if (code == 0 && !derive_velocities(plans->edges, plans->n, mesh, &plans->velocities))
        code = ORL_ERR_NOMEM;
    return code == 0 ? 0
                     : orl_error_set(err, code,
                                     code == ORL_ERR_CANCELLED ? "cancelled"
                                                               : "out of memory for transport");
}

void orl_fit_plans_done(struct orl_fit_plans *plans)
{
    for (size_t i = 0; i < plans->n; i++)
        for (int kind = 0; kind < ORL_FIT_KINDS; kind++)
            orl_fit_plan_done(&plans->edges[i].plans[kind]);
    free(plans->edges);
    velocities_done(plans->velocities, plans->n_directions);
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
