/* Delaunay triangulation by insertion of points (Bowyer 1981, Watson 1981). */
#include "bsdf/fit/transport/incident_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"
#include "base/sampling/random.h"

struct edge {
    uint32_t a, b;
};

struct plane {
    struct orl_fit_mesh *mesh;
    double (*at)[2]; /* projected places, slightly perturbed, and three distant points */
    struct edge *edges;
    size_t n_edges, capacity;
};

/* Triangles are counter-clockwise. */
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

/* Keeps only triangles of places that have area. */
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

bool orl_fit_triangulate(struct orl_fit_mesh *mesh)
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
