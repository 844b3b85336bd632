/* Mesh of incident directions, and its triangulation. */
#include "bsdf/fit/transport/transport.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "base/sampling/sampling.h"

struct edge {
    uint32_t a, b;
};

/* ---- Delaunay triangulation by insertion of points (Bowyer 1981, Watson 1981) ---------------- */

struct plane {
    struct orl_fit_mesh *mesh;
    double (*at)[2]; /* projected directions, slightly perturbed, and three distant points */
    struct edge *edges;
    size_t n_edges, capacity;
};

/* Returns true if the point is in a triangle's circumcircle. Triangles are counter-clockwise. */
static bool is_in_circle(const struct plane *p, const uint32_t t[ORL_FIT_CORNERS], const double *d)
{
    double m[3][3];
    for (int i = 0; i < 3; i++) {
        m[i][0] = p->at[t[i]][0] - d[0];
        m[i][1] = p->at[t[i]][1] - d[1];
        m[i][2] = m[i][0] * m[i][0] + m[i][1] * m[i][1];
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) >
           0;
}

/* Adds an edge to the outline of the hole. An edge that comes from both sides is inside and
 * removed. */
static bool toggle_edge(struct plane *p, uint32_t a, uint32_t b)
{
    for (size_t i = 0; i < p->n_edges; i++)
        if (p->edges[i].a == b && p->edges[i].b == a) {
            p->edges[i] = p->edges[--p->n_edges];
            return true;
        }
    if (!orl_array_reserve(&p->edges, &p->capacity, p->n_edges, sizeof *p->edges))
        return false;
    p->edges[p->n_edges++] = (struct edge){a, b};
    return true;
}

static bool add_triangle(struct orl_fit_mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    if (!orl_array_reserve(&mesh->triangles, &mesh->capacity, mesh->n_triangles,
                           sizeof *mesh->triangles))
        return false;
    uint32_t *t = mesh->triangles[mesh->n_triangles++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return true;
}

/* Replaces the triangles whose circumcircle contains the point by those from their outline to
 * it. */
static bool insert_point(struct plane *p, uint32_t point)
{
    struct orl_fit_mesh *m = p->mesh;
    bool fine = true;
    p->n_edges = 0;
    for (size_t i = 0; i < m->n_triangles && fine;) {
        const uint32_t *t = m->triangles[i];
        if (!is_in_circle(p, t, p->at[point])) {
            i++;
            continue;
        }
        fine =
            toggle_edge(p, t[0], t[1]) && toggle_edge(p, t[1], t[2]) && toggle_edge(p, t[2], t[0]);
        memcpy(m->triangles[i], m->triangles[--m->n_triangles], sizeof *m->triangles);
    }
    for (size_t i = 0; i < p->n_edges && fine; i++)
        fine = add_triangle(m, p->edges[i].a, p->edges[i].b, point);
    return fine;
}

/* Returns a perturbation too small to matter, so that no four points lie on a circle. */
static double nudge(uint64_t index)
{
    return 1e-6 * ((double)(orl_mix64(index + 1) >> 11) * 0x1p-53 - 0.5);
}

static double area_of(const struct orl_fit_mesh *m, const uint32_t t[ORL_FIT_CORNERS])
{
    return orl_dot(m->shapes[t[0]]->in, orl_cross(m->shapes[t[1]]->in, m->shapes[t[2]]->in));
}

/* Removes triangles without area and those with distant points. */
static void keep_inner(struct plane *p)
{
    struct orl_fit_mesh *m = p->mesh;
    size_t kept = 0;
    for (size_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *t = m->triangles[i];
        const bool inner = t[0] < m->n && t[1] < m->n && t[2] < m->n;
        if (inner && area_of(m, t) > 1e-5)
            memmove(m->triangles[kept++], t, sizeof *m->triangles);
    }
    m->n_triangles = kept;
}

/* Triangulates the mesh's directions. Returns false if out of memory. */
static bool triangulate_mesh(struct orl_fit_mesh *mesh)
{
    static const double far[3][2] = {{-1000, -1000}, {1000, -1000}, {0, 1000}};
    struct plane p = {.mesh = mesh, .at = malloc((mesh->n + 3) * sizeof *p.at)};
    const uint32_t n = (uint32_t)mesh->n;
    bool fine = p.at != NULL && add_triangle(mesh, n, n + 1, n + 2);
    for (uint32_t i = 0; i < n && fine; i++) {
        const struct orl_vec3 in = mesh->shapes[i]->in;
        p.at[i][0] = in.x / (1 + in.z) + nudge(2 * (uint64_t)i);
        p.at[i][1] = in.y / (1 + in.z) + nudge(2 * (uint64_t)i + 1);
    }
    if (fine)
        memcpy(p.at[n], far, sizeof far);
    for (uint32_t i = 0; i < n && fine; i++)
        fine = insert_point(&p, i);
    if (fine)
        keep_inner(&p);
    free(p.at);
    free(p.edges);
    return fine;
}

void orl_fit_mesh_done(struct orl_fit_mesh *mesh)
{
    free(mesh->shapes);
    free(mesh->positions);
    free(mesh->gradients);
    free(mesh->triangles);
    memset(mesh, 0, sizeof *mesh);
}

/* ---- Positions ------------------------------------------------------------------------------- */

/* Sets the mesh coordinates of a direction. In a row only theta is used, signed by the side of the
 * normal; light comes from -x. */
static void set_position(const struct orl_fit_mesh *mesh, struct orl_vec3 in,
                         double ret_location[2])
{
    const double sine = hypot(in.x, in.y), theta = atan2(sine, in.z);
    ret_location[0] = mesh->isotropic ? copysign(theta, -in.x) : sine > 0 ? theta * in.x / sine : 0;
    ret_location[1] = mesh->isotropic || !(sine > 0) ? 0 : theta * in.y / sine;
}

static double mass_of(const struct orl_fit_shape *shape, int which)
{
    return which < ORL_FIT_KINDS ? shape->parts[which].mass : ORL_PI * shape->floor;
}

static double total_of(const struct orl_fit_shape *shape)
{
    double sum = 0;
    for (int k = 0; k < ORL_FIT_MASSES; k++)
        sum += mass_of(shape, k);
    return sum;
}

/* ---- Gradients ----------------------------------------------------------------------------------
 */

/* Sets each gradient from the parabola through three neighbours in the row: at the middle one, or
 * at an end of the first or last three. Two directions give a line. */
static void set_row_gradients(struct orl_fit_mesh *m)
{
    for (size_t i = 0; i < m->n && m->n > 1; i++) {
        const size_t last = m->n - 1;
        const size_t b = m->n == 2 ? 0 : i == 0 ? 1 : i == last ? last - 1 : i;
        const size_t a = m->n == 2 ? 0 : b - 1, c = b + 1;
        const double x0 = m->positions[a][0], x1 = m->positions[b][0], x2 = m->positions[c][0];
        const double y0 = total_of(m->shapes[a]), y1 = total_of(m->shapes[b]);
        const double right = (total_of(m->shapes[c]) - y1) / (x2 - x1);
        const double left = m->n == 2 ? right : (y1 - y0) / (x1 - x0);
        const double bend = m->n == 2 ? 0 : (right - left) / (x2 - x0);
        m->gradients[i][0] = left + bend * ((m->positions[i][0] - x0) + (m->positions[i][0] - x1));
    }
}

/* Sets a gradient by least squares over the corners that share a triangle with the direction. */
static void set_plane_gradient(struct orl_fit_mesh *m, uint32_t i)
{
    double xx = 0, xy = 0, yy = 0, right[2] = {0};
    for (size_t t = 0; t < m->n_triangles; t++) {
        const uint32_t *corner = m->triangles[t];
        if (corner[0] != i && corner[1] != i && corner[2] != i)
            continue;
        for (int c = 0; c < ORL_FIT_CORNERS; c++) {
            const double x = m->positions[corner[c]][0] - m->positions[i][0];
            const double y = m->positions[corner[c]][1] - m->positions[i][1];
            const double near = x * x + y * y, weight = near > 0 ? 1 / near : 0;
            xx += weight * x * x;
            xy += weight * x * y;
            yy += weight * y * y;
            const double up = total_of(m->shapes[corner[c]]) - total_of(m->shapes[i]);
            right[0] += weight * x * up;
            right[1] += weight * y * up;
        }
    }
    const double determinant = xx * yy - xy * xy;
    if (determinant > 1e-6 * xx * yy) {
        m->gradients[i][0] = (right[0] * yy - right[1] * xy) / determinant;
        m->gradients[i][1] = (right[1] * xx - right[0] * xy) / determinant;
    }
}

/* ---- Making it ------------------------------------------------------------------------------- */

static int compare_thetas(const void *a, const void *b)
{
    const struct orl_fit_shape *x = *(const struct orl_fit_shape *const *)a,
                               *y = *(const struct orl_fit_shape *const *)b;
    return (y->in.x > x->in.x) - (y->in.x < x->in.x);
}

static bool surrounds_normal(const struct orl_fit_mesh *m)
{
    struct orl_fit_location location;
    orl_fit_mesh_locate(m, orl_v3(0, 0, 1), &location);
    return location.at.z > cos(0.5 * ORL_DEG_TO_RAD);
}

int orl_fit_mesh_make(const struct orl_fit_shape *const *shapes, size_t n, bool isotropic,
                      struct orl_fit_mesh *ret_mesh, struct orl_error *err)
{
    struct orl_fit_mesh m = {.isotropic = isotropic, .n = n};
    m.shapes = malloc(n * sizeof(void *));
    m.positions = calloc(n, sizeof *m.positions);
    m.gradients = calloc(n, sizeof *m.gradients);
    bool fine = m.shapes && m.positions && m.gradients;
    if (fine) {
        memcpy(m.shapes, shapes, n * sizeof(void *));
        if (isotropic)
            qsort(m.shapes, n, sizeof(void *), compare_thetas);
        for (size_t i = 0; i < n; i++)
            set_position(&m, m.shapes[i]->in, m.positions[i]);
        fine = isotropic || triangulate_mesh(&m);
    }
    if (!fine) {
        orl_fit_mesh_done(&m);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for incident directions");
    }
    if (isotropic)
        set_row_gradients(&m);
    for (uint32_t i = 0; i < n && !isotropic; i++)
        set_plane_gradient(&m, i);
    if (!isotropic && !surrounds_normal(&m)) {
        orl_fit_mesh_done(&m);
        orl_error_set(err, ORL_ERR_INVALID,
                      "the incident directions do not cover all azimuths around the normal");
        orl_error_hint(
            err,
            "measure the missing azimuths, or give a symmetry of the sample that fills them in");
        return ORL_ERR_INVALID;
    }
    *ret_mesh = m;
    return 0;
}

/* ---- Neighbours ------------------------------------------------------------------------------ */

size_t orl_fit_mesh_edges(const struct orl_fit_mesh *mesh)
{
    return mesh->isotropic ? mesh->n - 1 : ORL_FIT_CORNERS * mesh->n_triangles;
}

void orl_fit_mesh_edge(const struct orl_fit_mesh *mesh, size_t index, uint32_t ret_ends[2])
{
    const size_t side = index % ORL_FIT_CORNERS;
    const uint32_t *t = mesh->isotropic ? NULL : mesh->triangles[index / ORL_FIT_CORNERS];
    ret_ends[0] = t ? t[side] : (uint32_t)index;
    ret_ends[1] = t ? t[(side + 1) % ORL_FIT_CORNERS] : (uint32_t)index + 1;
}

/* Returns true for an edge of the border. Triangles are counter-clockwise, so an inner edge comes
 * once in each direction. */
static bool is_outer(const struct orl_fit_mesh *mesh, const uint32_t ends[2])
{
    for (size_t i = 0; i < orl_fit_mesh_edges(mesh); i++) {
        uint32_t other[2];
        orl_fit_mesh_edge(mesh, i, other);
        if (other[0] == ends[1] && other[1] == ends[0])
            return false;
    }
    return true;
}

void orl_fit_mesh_border(const struct orl_fit_mesh *mesh, bool *ret_border)
{
    for (size_t i = 0; i < mesh->n; i++)
        ret_border[i] = mesh->isotropic && (i == 0 || i + 1 == mesh->n);
    for (size_t i = 0; i < orl_fit_mesh_edges(mesh) && !mesh->isotropic; i++) {
        uint32_t ends[2];
        orl_fit_mesh_edge(mesh, i, ends);
        if (is_outer(mesh, ends))
            ret_border[ends[0]] = ret_border[ends[1]] = true;
    }
}

/* ---- Looking up ------------------------------------------------------------------------------ */

static void locate_in_row(const struct orl_fit_mesh *m, struct orl_fit_location *location)
{
    size_t i = 0;
    double at[2];
    set_position(m, location->in, at);
    const double x = at[0];
    while (i + 2 < m->n && m->positions[i + 1][0] < x)
        i++;
    location->count = m->n > 1 ? 2 : 1;
    location->corner[0] = (uint32_t)i;
    location->weight[0] = 1;
    location->at = m->shapes[i]->in;
    if (m->n < 2)
        return;
    const double t = (x - m->positions[i][0]) / (m->positions[i + 1][0] - m->positions[i][0]);
    location->corner[1] = (uint32_t)i + 1;
    location->weight[1] = t < 0 ? 0 : t > 1 ? 1 : t;
    location->weight[0] = 1 - location->weight[1];
    const double theta =
        location->weight[0] * m->positions[i][0] + location->weight[1] * m->positions[i + 1][0];
    location->at = orl_v3(-sin(theta), 0, cos(theta));
}

/* Returns true if in is inside a triangle, and sets its weights: the weighted sum of the corners'
 * directions points to in. */
static bool is_within(const struct orl_fit_mesh *m, const uint32_t *t, struct orl_vec3 in,
                      struct orl_fit_location *location)
{
    const struct orl_vec3 a = m->shapes[t[0]]->in, b = m->shapes[t[1]]->in, c = m->shapes[t[2]]->in;
    const double raw[3] = {orl_dot(in, orl_cross(b, c)), orl_dot(in, orl_cross(c, a)),
                           orl_dot(in, orl_cross(a, b))};
    for (int i = 0; i < 3; i++)
        if (raw[i] < -1e-9)
            return false;
    const double sum = raw[0] + raw[1] + raw[2];
    location->count = 3;
    for (int i = 0; i < 3; i++) {
        location->corner[i] = t[i];
        location->weight[i] = orl_larger(0, raw[i]) / sum;
    }
    return sum > 0;
}

/* Finds the nearest direction on a triangle's side, an arc of a great circle. It is used if nearer
 * than *nearest, the largest cosine so far. */
static void try_side(const struct orl_fit_mesh *m, uint32_t a, uint32_t b, double *nearest,
                     struct orl_fit_location *location)
{
    const struct orl_vec3 from = m->shapes[a]->in, to = m->shapes[b]->in;
    const struct orl_vec3 ahead = orl_normalize(orl_madd(to, from, -orl_dot(from, to)));
    const double whole = atan2(orl_dot(to, ahead), orl_dot(to, from));
    const double along = atan2(orl_dot(location->in, ahead), orl_dot(location->in, from)) / whole;
    const double t = along < 0 ? 0 : along > 1 ? 1 : along;
    const struct orl_vec3 at = orl_madd(orl_scale(from, cos(t * whole)), ahead, sin(t * whole));
    if (!(orl_dot(at, location->in) > *nearest))
        return;
    *nearest = orl_dot(at, location->in);
    location->at = at;
    location->count = 2;
    location->corner[0] = a;
    location->corner[1] = b;
    location->weight[0] = 1 - t;
    location->weight[1] = t;
}

static void locate_in_plane(const struct orl_fit_mesh *m, struct orl_fit_location *location)
{
    double nearest = -2;
    location->count = 1;
    location->corner[0] = 0;
    location->weight[0] = 1;
    location->at = m->shapes[0]->in;
    for (size_t i = 0; i < m->n_triangles; i++)
        if (is_within(m, m->triangles[i], location->in, location)) {
            location->at = location->in;
            return;
        }
    for (size_t i = 0; i < m->n_triangles; i++)
        for (int k = 0; k < 3; k++)
            try_side(m, m->triangles[i][k], m->triangles[i][(k + 1) % 3], &nearest, location);
}

/* Sets lean, the weights by which the corners' directions add up to a vector along at. If they are
 * far from the other weights, those are used. */
static void set_lean(const struct orl_fit_mesh *m, struct orl_fit_location *p)
{
    const struct orl_vec3 a = m->shapes[p->corner[0]]->in, b = m->shapes[p->corner[1]]->in;
    double raw[ORL_FIT_CORNERS] = {1, 0, 0}, sum = 0;
    if (p->count == 2) {
        const double ab = orl_dot(a, b), ax = orl_dot(a, p->at), bx = orl_dot(b, p->at);
        raw[0] = ax - ab * bx;
        raw[1] = bx - ab * ax;
    } else if (p->count == 3) {
        const struct orl_vec3 c = m->shapes[p->corner[2]]->in;
        raw[0] = orl_dot(p->at, orl_cross(b, c));
        raw[1] = orl_dot(p->at, orl_cross(c, a));
        raw[2] = orl_dot(p->at, orl_cross(a, b));
    }
    for (unsigned i = 0; i < ORL_FIT_CORNERS; i++)
        sum += raw[i];
    bool sound = sum != 0;
    for (unsigned i = 0; i < ORL_FIT_CORNERS; i++)
        sound = sound && fabs(raw[i] / sum - p->weight[i]) < 0.25;
    for (unsigned i = 0; i < ORL_FIT_CORNERS; i++)
        p->lean[i] = sound ? raw[i] / sum : p->weight[i];
}

/* Returns the total at a location: the corners' mean plus half of what gradients predict, which is
 * exact for a parabola. The result is limited to the corners' range, extended by half of it. */
static double total_at(const struct orl_fit_mesh *m, const struct orl_fit_location *p,
                       const double *x)
{
    double mean = 0, bend = 0, least = INFINITY, most = 0;
    for (unsigned i = 0; i < p->count; i++) {
        const uint32_t v = p->corner[i];
        const double total = total_of(m->shapes[v]);
        mean += p->weight[i] * total;
        bend += 0.5 * p->weight[i] *
                (m->gradients[v][0] * (x[0] - m->positions[v][0]) +
                 m->gradients[v][1] * (x[1] - m->positions[v][1]));
        least = fmin(least, total);
        most = fmax(most, total);
    }
    const double room = 0.5 * (most - least);
    return fmax(0, fmin(most + room, fmax(least - room, mean + bend)));
}

/* Sets masses to the corners' means, scaled to the total. */
static void set_masses(const struct orl_fit_mesh *m, struct orl_fit_location *p, const double *x)
{
    const double total = total_at(m, p, x);
    double sum = 0;
    for (int k = 0; k < ORL_FIT_MASSES; k++) {
        for (unsigned i = 0; i < p->count; i++)
            p->mass[k] += p->weight[i] * mass_of(m->shapes[p->corner[i]], k);
        sum += p->mass[k];
    }
    for (int k = 0; k < ORL_FIT_MASSES && sum > 0; k++)
        p->mass[k] *= total / sum;
}

void orl_fit_mesh_locate(const struct orl_fit_mesh *mesh, struct orl_vec3 in,
                         struct orl_fit_location *ret_location)
{
    struct orl_fit_location *p = ret_location;
    double x[2];
    *p = (struct orl_fit_location){.in = in};
    if (mesh->isotropic)
        locate_in_row(mesh, p);
    else
        locate_in_plane(mesh, p);
    set_position(mesh, p->at, x);
    set_lean(mesh, p);
    set_masses(mesh, p, x);
}
