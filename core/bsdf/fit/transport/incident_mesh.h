/*
 * Mesh of incident directions, for interpolation between them.
 *
 * Isotropic samples: directions form a row by theta, preceded by the mirror images of the first
 * ones. Other samples: directions are corners of a Delaunay triangulation of the sphere (of its
 * stereographic projection), whose sides are arcs of great circles. Outside the mesh the nearest
 * place on its border is used.
 *
 * Ownership: the caller's, freed by orl_fit_mesh_done; shapes are borrowed. Immutable once made.
 */
#ifndef ORL_BSDF_FIT_TRANSPORT_INCIDENT_MESH_H
#define ORL_BSDF_FIT_TRANSPORT_INCIDENT_MESH_H

#include "bsdf/fit/scan/lobe_shape.h"

enum { ORL_FIT_CORNERS = 3, ORL_FIT_MASSES = ORL_FIT_KINDS + 1 };

struct orl_fit_mesh {
    bool isotropic;
    size_t n;
    const struct orl_fit_shape **shapes; /* owned array of borrowed shapes */
    double (*positions)[2]; /* theta by azimuth, radians; in a row only the first is used */
    double (*gradients)[2]; /* gradients of totals along places, 1/radian */
    uint32_t (*triangles)[ORL_FIT_CORNERS];
    size_t n_triangles, capacity;
};

/* Returns 0, ORL_ERR_INVALID (the directions do not surround the normal) or ORL_ERR_NOMEM. */
int orl_fit_mesh_make(const struct orl_fit_shape *const *shapes, size_t n, bool isotropic,
                      struct orl_fit_mesh *ret_mesh, struct orl_error *err);
void orl_fit_mesh_done(struct orl_fit_mesh *mesh);

/* Place of an incident direction in the mesh. */
struct orl_fit_location {
    struct orl_vec3 in, at; /* in: the query; at: the nearest place within the mesh */
    unsigned count;
    uint32_t corner[ORL_FIT_CORNERS];
    double weight[ORL_FIT_CORNERS]; /* weights of the corners; they add up to 1 */
    double lean[ORL_FIT_CORNERS];   /* such that the weighted corner directions point to at */
    double mass[ORL_FIT_MASSES];    /* mass of each kind, then of the floor */
};
void orl_fit_mesh_locate(const struct orl_fit_mesh *mesh, struct orl_vec3 in,
                         struct orl_fit_location *ret_location);

/* Returns the number of pairs of neighbours; inner edges of a triangulation come twice. */
size_t orl_fit_mesh_edges(const struct orl_fit_mesh *mesh);
void orl_fit_mesh_edge(const struct orl_fit_mesh *mesh, size_t index, uint32_t ret_ends[2]);
/* Sets for each direction: true on the border of the mesh, or at an end of the row. */
void orl_fit_mesh_border(const struct orl_fit_mesh *mesh, bool *ret_border);

/* Triangulates the places (triangulate_incident.c). Returns false if out of memory. */
bool orl_fit_triangulate(struct orl_fit_mesh *mesh);

#endif
