#include "fit/blend.h"

#include <stdlib.h>
#include <string.h>

#include "base/grow.h"

/* ---- Plans ----------------------------------------------------------------------------------- */

/* Nothing moves by more than so many times what the light that comes moved by, or 10 degrees. */
static const double farthest_times = 2.5, farthest_least = 10 * ORL_DEG_TO_RAD;
/* Of all light: a corner that has less of a say is left out, a ray that carries less is none. */
static const double least_weight = 1e-6, least_ray = 1e-9;

bool orl_fit_plans_want(struct orl_fit_plans *plans, const struct orl_fit_place *place)
{
    for (unsigned i = 0; i < place->count; i++)
        for (unsigned j = 0; j < place->count; j++) {
            if (place->corner[i] >= place->corner[j])
                continue;
            if (!orl_grow(&plans->edges, &plans->room, plans->n, sizeof *plans->edges))
                return false;
            plans->edges[plans->n++] =
                (struct orl_fit_edge){.a = place->corner[i], .b = place->corner[j]};
        }
    return true;
}

static int compare_edges(const void *a, const void *b)
{
    const struct orl_fit_edge *x = a, *y = b;
    return x->a != y->a ? (x->a < y->a ? -1 : 1) : (x->b > y->b) - (x->b < y->b);
}

struct making {
    struct orl_fit_plans *plans;
    const struct orl_fit_mesh *mesh;
    const atomic_bool *cancel;
};

static void make_edge(void *arg, size_t index, uint32_t member)
{
    const struct making *m = arg;
    struct orl_fit_edge *edge = &m->plans->edges[index];
    const struct orl_fit_shape *a = m->mesh->shapes[edge->a], *b = m->mesh->shapes[edge->b];
    const double moved = orl_length(orl_sub(a->in, b->in));
    (void)member;
    for (int kind = 0; kind < ORL_FIT_KINDS && edge->code == 0; kind++)
        edge->code = orl_fit_plan_make(&a->parts[kind], &b->parts[kind],
                                       fmax(farthest_least, farthest_times * moved), m->cancel,
                                       &edge->plans[kind], NULL);
}

int orl_fit_plans_make(struct orl_fit_plans *plans, const struct orl_fit_mesh *mesh,
                       struct orl_crew *crew, const atomic_bool *cancel, struct orl_error *err)
{
    struct making making = {plans, mesh, cancel};
    size_t kept = 0;
    if (plans->n > 0)
        qsort(plans->edges, plans->n, sizeof *plans->edges, compare_edges);
    for (size_t i = 0; i < plans->n; i++)
        if (kept == 0 || compare_edges(&plans->edges[kept - 1], &plans->edges[i]) != 0)
            plans->edges[kept++] = plans->edges[i];
    plans->n = kept;
    int code = 0;
    if (crew)
        code = orl_crew_try(crew, plans->n, make_edge, &making);
    else
        orl_crew_for(NULL, plans->n, make_edge, &making);
    for (size_t i = 0; i < plans->n && code == 0; i++)
        code = plans->edges[i].code;
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
    memset(plans, 0, sizeof *plans);
}

static const struct orl_fit_moves *moves_of(const struct orl_fit_plans *plans, uint32_t from,
                                            uint32_t to, int kind)
{
    const struct orl_fit_edge key = {.a = from < to ? from : to, .b = from < to ? to : from};
    const struct orl_fit_edge *edge =
        plans->n > 0 ? bsearch(&key, plans->edges, plans->n, sizeof *plans->edges, compare_edges)
                     : NULL;
    return edge ? &edge->plans[kind].ways[from > to] : NULL;
}

/* ---- One corner's lobes ---------------------------------------------------------------------- */

/* What lobes of a corner are moved by: its own place among the corners, and the others'. */
struct mover {
    const struct orl_fit_part *own;
    unsigned others;
    const struct orl_fit_moves *moves[2];
    double lean[3], weight[3]; /* own, others' */
    double scale;              /* of the masses of lobes */
    bool turns;
    double axis[3][3]; /* the turn, by rows */
    struct orl_fit_light *light;
};

struct step {
    struct orl_vec3 middle; /* where the cluster went; not of unit length */
    double lean, stretch, weight;
};

static struct step add_step(struct step s, const struct orl_fit_cluster *from,
                            const struct orl_fit_move *to, double lean, double weight)
{
    s.middle = orl_madd(s.middle, orl_v3((double)to->x, (double)to->y, (double)to->z), lean);
    s.lean += lean;
    s.stretch += weight * (double)to->sigma_rad / (double)from->sigma_rad;
    s.weight += weight;
    return s;
}

static bool add_ray(const struct mover *m, const struct orl_fit_lobe *lobe,
                    const struct orl_fit_cluster *cluster, const struct step *s, double share)
{
    struct orl_fit_light *light = m->light;
    const double mass = share * m->scale * (double)lobe->mass;
    const double stretch = s->stretch / s->weight;
    if (!(mass > least_ray))
        return true;
    if (!orl_grow(&light->rays, &light->room, light->n, sizeof *light->rays))
        return false;
    struct orl_vec3 d = orl_scale(s->middle, 1 / s->lean);
    d.x += stretch * (double)(lobe->x - cluster->x);
    d.y += stretch * (double)(lobe->y - cluster->y);
    d.z += stretch * (double)(lobe->z - cluster->z);
    d = orl_normalize(d);
    if (m->turns)
        d = orl_v3(m->axis[0][0] * d.x + m->axis[0][1] * d.y + m->axis[0][2] * d.z,
                   m->axis[1][0] * d.x + m->axis[1][1] * d.y + m->axis[1][2] * d.z,
                   m->axis[2][0] * d.x + m->axis[2][1] * d.y + m->axis[2][2] * d.z);
    light->rays[light->n++] =
        (struct orl_fit_ray){(float)d.x, (float)d.y, (float)fabs(d.z), (float)mass,
                             (float)(stretch * (double)lobe->sigma_rad)};
    return true;
}

/* Where a cluster does not move in a plan, one step that says so. */
static const struct orl_fit_move stays = {.share = 1, .fades = true};

static size_t moves_from(const struct orl_fit_moves *moves, uint32_t cluster,
                         const struct orl_fit_move **ret_first)
{
    if (moves && moves->first && moves->first[cluster + 1] > moves->first[cluster]) {
        *ret_first = moves->moves + moves->first[cluster];
        return moves->first[cluster + 1] - moves->first[cluster];
    }
    *ret_first = &stays;
    return 1;
}

static bool move_lobe(const struct mover *m, const struct orl_fit_lobe *lobe)
{
    const struct orl_fit_cluster *cluster = &m->own->clusters[lobe->cluster];
    const struct orl_fit_move *first[2] = {&stays, &stays};
    size_t count[2] = {1, 1};
    bool fine = true;
    for (unsigned k = 0; k < m->others; k++)
        count[k] = moves_from(m->moves[k], lobe->cluster, &first[k]);
    for (size_t i = 0; i < count[0] * count[1] && fine; i++) {
        const struct orl_fit_move *to[2] = {first[0] + i / count[1], first[1] + i % count[1]};
        const struct orl_fit_move own = {cluster->x,         cluster->y, cluster->z,
                                         cluster->sigma_rad, 1,          false};
        struct step s = add_step((struct step){0}, cluster, &own, m->lean[0], m->weight[0]);
        for (unsigned k = 0; k < m->others; k++)
            if (!to[k]->fades)
                s = add_step(s, cluster, to[k], m->lean[1 + k], m->weight[1 + k]);
        fine = add_ray(m, lobe, cluster, &s, (double)to[0]->share * (double)to[1]->share);
    }
    return fine;
}

/* ---- All ------------------------------------------------------------------------------------- */

/* The turn that takes one unit vector to another (Moeller and Hughes 1999). */
static void set_turn(struct mover *m, struct orl_vec3 from, struct orl_vec3 to)
{
    const struct orl_vec3 v = orl_cross(from, to);
    const double c = orl_dot(from, to), h = 1 / (1 + c);
    m->turns = orl_dot(v, v) > 1e-12;
    m->axis[0][0] = c + h * v.x * v.x;
    m->axis[0][1] = h * v.x * v.y - v.z;
    m->axis[0][2] = h * v.x * v.z + v.y;
    m->axis[1][0] = h * v.x * v.y + v.z;
    m->axis[1][1] = c + h * v.y * v.y;
    m->axis[1][2] = h * v.y * v.z - v.x;
    m->axis[2][0] = h * v.x * v.z - v.y;
    m->axis[2][1] = h * v.y * v.z + v.x;
    m->axis[2][2] = c + h * v.z * v.z;
}

static struct orl_vec3 straight(struct orl_vec3 in)
{
    return orl_v3(-in.x, -in.y, in.z);
}

static bool blend_part(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                       const struct orl_fit_place *place, unsigned corner, int kind,
                       struct orl_fit_light *light)
{
    const struct orl_fit_part *part = &mesh->shapes[place->corner[corner]]->parts[kind];
    struct mover m = {.own = part, .light = light};
    bool fine = true;
    m.lean[0] = place->lean[corner];
    m.weight[0] = place->weight[corner];
    if (part->n_lobes == 0)
        return true;
    for (unsigned other = 0; other < place->count; other++) {
        if (other == corner || !(place->weight[other] > least_weight))
            continue;
        m.moves[m.others] = moves_of(plans, place->corner[corner], place->corner[other], kind);
        m.lean[++m.others] = place->lean[other];
        m.weight[m.others] = place->weight[other];
    }
    m.scale = place->weight[corner] * place->mass[kind] / part->mass;
    if (kind == ORL_FIT_NARROW)
        set_turn(&m, straight(place->at), straight(place->in));
    for (size_t i = 0; i < part->n_lobes && fine; i++)
        fine = move_lobe(&m, &part->lobes[i]);
    return fine;
}

/* Corners without any of a part leave it to the others. */
static double held(const struct orl_fit_mesh *mesh, const struct orl_fit_place *place, int kind)
{
    double sum = 0;
    for (unsigned i = 0; i < place->count; i++)
        if (mesh->shapes[place->corner[i]]->parts[kind].n_lobes > 0)
            sum += place->weight[i];
    return sum;
}

bool orl_fit_blend(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                   const struct orl_fit_place *place, struct orl_fit_light *light)
{
    bool fine = true;
    light->n = 0;
    light->floor = place->mass[ORL_FIT_KINDS] / ORL_PI;
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++) {
        const double share = held(mesh, place, kind);
        struct orl_fit_place here = *place;
        here.mass[kind] = share > 0 ? place->mass[kind] / share : 0;
        for (unsigned corner = 0; corner < place->count && fine; corner++)
            if (place->weight[corner] > least_weight)
                fine = blend_part(mesh, plans, &here, corner, kind, light);
    }
    return fine;
}

void orl_fit_light_done(struct orl_fit_light *light)
{
    if (!light)
        return;
    free(light->rays);
    memset(light, 0, sizeof *light);
}
