/*
 * Incident directions and what lies between them.
 *
 * Of an isotropic sample they stand in a row by theta; before them stand the first ones' mirror
 * images. Otherwise they are corners of a Delaunay triangulation of the sphere (of its
 * stereographic projection), whose sides are arcs of great circles. Outside of it the nearest place
 * on its border counts.
 *
 * Ownership: the caller's, orl_fit_mesh_done; shapes are borrowed. Immutable once made.
 */
#ifndef ORL_FIT_MESH_H
#define ORL_FIT_MESH_H

#include "fit/shape.h"

enum { ORL_FIT_CORNERS = 3, ORL_FIT_MASSES = ORL_FIT_KINDS + 1 };

struct orl_fit_mesh {
    bool isotropic;
    size_t n;
    const struct orl_fit_shape **shapes; /* owned, what they point to is not */
    double (*places)[2];                 /* theta by azimuth, radians; of a row by the first */
    double (*slopes)[2];                 /* of totals */
    uint32_t (*triangles)[ORL_FIT_CORNERS];
    size_t n_triangles, room;
};

/* 0, ORL_ERR_INVALID (the directions do not surround the normal), ORL_ERR_NOMEM. */
int orl_fit_mesh_make(const struct orl_fit_shape *const *shapes, size_t n, bool isotropic,
                      struct orl_fit_mesh *ret_mesh, struct orl_error *err);
void orl_fit_mesh_done(struct orl_fit_mesh *mesh);

/* Where an incident direction lies. */
struct orl_fit_place {
    struct orl_vec3 in, at; /* as asked, and the nearest place within */
    unsigned count;
    uint32_t corner[ORL_FIT_CORNERS];
    double weight[ORL_FIT_CORNERS]; /* of what corners have; they add up to 1 */
    double lean[ORL_FIT_CORNERS];   /* likewise, such that the corners' directions come to at: so
                                       what moves with them comes out exactly */
    double mass[ORL_FIT_MASSES];    /* of kinds, then of the floor */
};
void orl_fit_mesh_locate(const struct orl_fit_mesh *mesh, struct orl_vec3 in,
                         struct orl_fit_place *ret_place);

/* Pairs of neighbours; of a plane those within come twice. */
size_t orl_fit_mesh_edges(const struct orl_fit_mesh *mesh);
void orl_fit_mesh_edge(const struct orl_fit_mesh *mesh, size_t index, uint32_t ret_ends[2]);
/* By direction: whether it stands on the border, or at an end of the row. */
void orl_fit_mesh_border(const struct orl_fit_mesh *mesh, bool *ret_border);

/* mesh_plane.c: triangles of the places; false: no memory. */
bool orl_fit_triangulate(struct orl_fit_mesh *mesh);

#endif
