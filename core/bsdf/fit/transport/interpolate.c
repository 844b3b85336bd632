/* Interpolation between incident directions: moves the lobes of each corner and adds them. */
#include "bsdf/fit/transport/transport.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/* Shares of all light: corners of less weight are skipped, and lobes of less mass are dropped. */
static const double least_weight = 1e-6, least_gaussian = 1e-9;

/* ---- One corner's lobes ---------------------------------------------------------------------- */

/* Parameters for moving the lobes of one corner: its own first, then those of the other corners. */
struct cluster_mover {
    const struct orl_fit_part *own;
    const struct orl_fit_velocity *velocities; /* by own cluster; may be NULL */
    unsigned others;
    const struct orl_fit_moves *moves[2];
    double lean[3], weight[3];   /* own value, then the others' */
    struct orl_fit_turn turn[3]; /* turn from each corner to the location */
    double scale;                /* factor of the lobes' masses */
    bool turns;
    double axis[3][3]; /* rotation matrix, by rows */
    struct orl_fit_light *light;
};

/* Sums for the place of a cluster: the mean of its places at the corners that it moves to, and of
 * the places that its velocities there predict. */
struct place_sums {
    struct orl_vec3 middle, ahead; /* sums; ahead: over corners with a known velocity */
    double lean, sigma, weight;
    double ahead_weight, ahead_sigma;
};

static struct place_sums add_step(struct place_sums s, const struct cluster_mover *m,
                                  unsigned corner, const struct orl_fit_move *at)
{
    const struct orl_vec3 location = orl_v3((double)at->x, (double)at->y, (double)at->z);
    const double weight = m->weight[corner];
    s.middle = orl_madd(s.middle, location, m->lean[corner]);
    s.lean += m->lean[corner];
    s.sigma += weight * (double)at->sigma_rad;
    s.weight += weight;
    if (!at->velocity.known)
        return s;
    const struct orl_fit_turn turn = m->turn[corner];
    const struct orl_vec3 arc = orl_fit_velocity_arc(&at->velocity, turn);
    s.ahead = orl_madd(s.ahead, orl_fit_arc_end(orl_normalize(location), arc), weight);
    s.ahead_sigma += weight * ((double)at->sigma_rad + (double)at->velocity.sigma[0] * turn.u +
                               (double)at->velocity.sigma[1] * turn.v);
    s.ahead_weight += weight;
    return s;
}

/* Returns the cluster's place: halfway from the mean of places to the mean of predicted places,
 * which is exact for a parabola. */
static struct orl_vec3 end_step(const struct place_sums *s, double own_sigma, double *ret_stretch)
{
    const struct orl_vec3 middle = orl_normalize(s->middle);
    const double sigma = s->sigma / s->weight, half = 0.5 * s->ahead_weight / s->weight;
    const struct orl_vec3 bent =
        orl_add(orl_scale(middle, 1 - half), orl_scale(s->ahead, 0.5 / s->weight));
    const double wide = (1 - half) * sigma + 0.5 * s->ahead_sigma / s->weight;
    *ret_stretch = fmin(1.5 * sigma, fmax(0.5 * sigma, wide)) / own_sigma;
    return orl_normalize(bent);
}

static bool add_gaussian(const struct cluster_mover *m, const struct orl_fit_lobe *lobe,
                         const struct orl_fit_cluster *cluster, struct orl_vec3 middle,
                         double stretch, double share)
{
    struct orl_fit_light *light = m->light;
    const double mass = share * m->scale * (double)lobe->mass;
    if (!(mass > least_gaussian))
        return true;
    if (!orl_array_reserve(&light->gaussians, &light->capacity, light->n, sizeof *light->gaussians))
        return false;
    struct orl_vec3 d = middle;
    d.x += stretch * (double)(lobe->x - cluster->x);
    d.y += stretch * (double)(lobe->y - cluster->y);
    d.z += stretch * (double)(lobe->z - cluster->z);
    d = orl_normalize(d);
    if (m->turns)
        d = orl_v3(m->axis[0][0] * d.x + m->axis[0][1] * d.y + m->axis[0][2] * d.z,
                   m->axis[1][0] * d.x + m->axis[1][1] * d.y + m->axis[1][2] * d.z,
                   m->axis[2][0] * d.x + m->axis[2][1] * d.y + m->axis[2][2] * d.z);
    light->gaussians[light->n++] =
        (struct orl_fit_gaussian){(float)d.x, (float)d.y, (float)fabs(d.z), (float)mass,
                                  (float)(stretch * (double)lobe->sigma_rad)};
    return true;
}

/* The only move of a cluster that a plan does not move. */
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

/* Adds the lobes of one cluster, from begin to end. */
static bool move_cluster(const struct cluster_mover *m, size_t begin, size_t end)
{
    const uint32_t number = m->own->lobes[begin].cluster;
    const struct orl_fit_cluster *cluster = &m->own->clusters[number];
    const struct orl_fit_move *first[2] = {&stays, &stays};
    size_t count[2] = {1, 1};
    struct orl_fit_move own = {
        .x = cluster->x, .y = cluster->y, .z = cluster->z, .sigma_rad = cluster->sigma_rad};
    bool fine = true;
    if (m->velocities)
        own.velocity = m->velocities[number];
    for (unsigned k = 0; k < m->others; k++)
        count[k] = moves_from(m->moves[k], number, &first[k]);
    for (size_t i = 0; i < count[0] * count[1]; i++) {
        const struct orl_fit_move *to[2] = {first[0] + i / count[1], first[1] + i % count[1]};
        struct place_sums s = add_step((struct place_sums){0}, m, 0, &own);
        for (unsigned k = 0; k < m->others; k++)
            if (!to[k]->fades)
                s = add_step(s, m, 1 + k, to[k]);
        double stretch;
        const struct orl_vec3 middle = end_step(&s, (double)cluster->sigma_rad, &stretch);
        const double share = (double)to[0]->share * (double)to[1]->share;
        for (size_t l = begin; l < end && fine; l++)
            fine = add_gaussian(m, &m->own->lobes[l], cluster, middle, stretch, share);
    }
    return fine;
}

static bool move_all(const struct cluster_mover *m)
{
    bool fine = true;
    for (size_t begin = 0, end; begin < m->own->n_lobes && fine; begin = end) {
        end = begin + 1;
        while (end < m->own->n_lobes && m->own->lobes[end].cluster == m->own->lobes[begin].cluster)
            end++;
        fine = move_cluster(m, begin, end);
    }
    return fine;
}

/* ---- All ------------------------------------------------------------------------------------- */

/* Sets the rotation from one unit vector to another (Moeller and Hughes 1999). */
static void set_turn(struct cluster_mover *m, struct orl_vec3 from, struct orl_vec3 to)
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

static struct orl_vec3 straight_of(struct orl_vec3 in)
{
    return orl_v3(-in.x, -in.y, in.z);
}

static bool interpolate_part(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                             const struct orl_fit_location *location, unsigned corner, int kind,
                             struct orl_fit_light *light)
{
    const struct orl_fit_part *part = &mesh->shapes[location->corner[corner]]->parts[kind];
    struct cluster_mover m = {.own = part, .light = light};
    m.lean[0] = location->lean[corner];
    m.weight[0] = location->weight[corner];
    m.turn[0] = orl_fit_turn_between(mesh->shapes[location->corner[corner]]->in, location->at);
    if (plans->velocities)
        m.velocities = plans->velocities[location->corner[corner]].of[kind];
    if (part->n_lobes == 0)
        return true;
    for (unsigned other = 0; other < location->count; other++) {
        if (other == corner || !(location->weight[other] > least_weight))
            continue;
        m.moves[m.others] =
            orl_fit_plans_moves(plans, location->corner[corner], location->corner[other], kind);
        m.lean[++m.others] = location->lean[other];
        m.weight[m.others] = location->weight[other];
        m.turn[m.others] =
            orl_fit_turn_between(mesh->shapes[location->corner[other]]->in, location->at);
    }
    m.scale = location->weight[corner] * location->mass[kind] / part->mass;
    if (kind == ORL_FIT_NARROW)
        set_turn(&m, straight_of(location->at), straight_of(location->in));
    return move_all(&m);
}

/* Returns the weight of the corners that have lobes of this kind; the others have no part in it. */
static double weight_with_lobes(const struct orl_fit_mesh *mesh,
                                const struct orl_fit_location *location, int kind)
{
    double sum = 0;
    for (unsigned i = 0; i < location->count; i++)
        if (mesh->shapes[location->corner[i]]->parts[kind].n_lobes > 0)
            sum += location->weight[i];
    return sum;
}

bool orl_fit_interpolate(const struct orl_fit_mesh *mesh, const struct orl_fit_plans *plans,
                         const struct orl_fit_location *location, struct orl_fit_light *light)
{
    bool fine = true;
    light->n = 0;
    light->floor = location->mass[ORL_FIT_KINDS] / ORL_PI;
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++) {
        const double share = weight_with_lobes(mesh, location, kind);
        struct orl_fit_location here = *location;
        here.mass[kind] = share > 0 ? location->mass[kind] / share : 0;
        for (unsigned corner = 0; corner < location->count && fine; corner++)
            if (location->weight[corner] > least_weight)
                fine = interpolate_part(mesh, plans, &here, corner, kind, light);
    }
    return fine;
}

void orl_fit_light_done(struct orl_fit_light *light)
{
    free(light->gaussians);
    memset(light, 0, sizeof *light);
}
