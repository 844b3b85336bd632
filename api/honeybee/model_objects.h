/*
 * Writes the objects of a model: polygons, meshes, groups of apertures, surfaces, grids and views,
 * and luminaires; also finds faces that face inwards. Each has a source file of its own.
 */
#ifndef ORL_API_HONEYBEE_MODEL_OBJECTS_H
#define ORL_API_HONEYBEE_MODEL_OBJECTS_H

#include "honeybee/hb_writer.h"

/*
 * Writes planar faces of a model (Face3D: a boundary, and holes in it) as Radiance polygons. One
 * outline runs from the boundary's first corner to every hole, around it in the opposite
 * direction, and back. Edges passed twice cancel. Holes are visited strip by strip, so that edges
 * between them are short and cross few others.
 */

struct orl_hb_polygon {
    struct orl_vec3 *points; /* all loops, one after the other */
    size_t n_points, point_room;
    size_t *ends; /* end of each loop, as an index in points; the boundary is the first */
    size_t n_loops, loop_room;
};

void orl_hb_polygon_done(struct orl_hb_polygon *polygon);
/* Clears the polygon and reads a Face3D. If its plane has a normal, the corners are ordered by
 * it. */
int orl_hb_polygon_read(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                        struct orl_hb_polygon *polygon);
/* Adds a hole: the boundary of a Face3D that is cut out. */
int orl_hb_polygon_add_hole(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                            struct orl_hb_polygon *polygon);
/* Returns the unit normal by the order of the boundary's corners; zero if their area is zero. */
struct orl_vec3 orl_hb_polygon_normal(const struct orl_hb_polygon *polygon);
/* Reverses the polygon if its normal is opposite to front. */
void orl_hb_polygon_orient(struct orl_hb_polygon *polygon, struct orl_vec3 front);
void orl_hb_polygon_offset(struct orl_hb_polygon *polygon, struct orl_vec3 by);
/* Writes "MODIFIER polygon NAME ...". Characters of name that identifiers may not have become
 * '_'. */
int orl_hb_polygon_write(struct orl_hb *hb, const struct orl_hb_polygon *polygon,
                         const char *modifier, const char *name, struct orl_hb_file *file);
/* Writes a name likewise, for faces of meshes. */
void orl_hb_put_name(const char *name, FILE *stream);
void orl_hb_put_point(struct orl_vec3 point, FILE *stream);

/*
 * Finds the faces of a room that face inwards. Honeybee turns the faces of a closed room outwards
 * when it reads a model, and so does this code. The orientation matters because the second of two
 * adjacent faces is offset inwards, and because BSDFs have a front.
 *
 * The test follows the line through a face along its normal. The face is inward if the line meets
 * an odd number of the room's other faces in front of it, and an even number behind. If both are
 * odd or both even, the room has a gap there and the face is left as it is. Rooms with more than
 * 256 faces are left as they are, because time is proportional to faces times corners.
 */

/* *ret_inward: owned, one flag per face of the room; NULL if no face is to be turned. */
int orl_hb_inward_faces(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                        bool **ret_inward);

/* Writes shade meshes, one polygon per mesh face. */

int orl_hb_meshes_write(struct orl_hb *hb);

/* Reads a mesh's corners (Mesh3D), which the caller owns. at: place of the mesh in the document. */
int orl_hb_mesh_corners(struct orl_hb *hb, const json_t *mesh, const struct orl_hb_at *at,
                        struct orl_vec3 **ret_corners, size_t *ret_count);
/* Reads the three or four corners of one mesh face. */
int orl_hb_mesh_face(struct orl_hb *hb, const json_t *face, const struct orl_hb_at *at,
                     const struct orl_vec3 *corners, size_t count, struct orl_vec3 ret_face[4],
                     size_t *ret_n);

/*
 * Groups of apertures, doors and shades that change together. They are collected while surfaces
 * are written; then each group is written in all of its states.
 */

struct orl_hb_member {
    const json_t *json;
    size_t modifier;       /* used if a state has none of its own */
    struct orl_vec3 front; /* direction of the front; zero: given by the corners' order */
};

struct orl_hb_group {
    const char *identifier;
    bool shades, inside; /* inside: true if all of its shades are indoors */
    struct orl_hb_member *members;
    size_t count, room;
};

struct orl_hb_groups {
    struct orl_hb_group *items;
    size_t count, room;
    json_t *group_index; /* index in items by "shade IDENTIFIER" or "window IDENTIFIER" */
};

void orl_hb_groups_done(struct orl_hb_groups *groups);
/* Adds an object to its group. *ret_is_dynamic is true if it has one. */
int orl_hb_groups_add(struct orl_hb *hb, struct orl_hb_groups *groups,
                      const struct orl_hb_member *member, bool shade, bool inside,
                      const struct orl_hb_at *at, bool *ret_is_dynamic);
/* Writes the files of all states, and states.json of each folder. */
int orl_hb_groups_write(struct orl_hb *hb, const struct orl_hb_groups *groups);

/*
 * Writes a model's rooms, faces, apertures, doors and shades to its scene and aperture files,
 * and collects dynamic ones in groups.
 */

int orl_hb_surfaces_write(struct orl_hb *hb, struct orl_hb_groups *groups);

/* Writes a model's sensor grids and views, each to a file with its name. */

int orl_hb_grids_write(struct orl_hb *hb);
int orl_hb_views_write(struct orl_hb *hb);

/*
 * Writes a model's luminaires: IES files and their placements, by ies2rad and xform as in
 * Honeybee. All are in model/ies/luminaires.rad.
 */

int orl_hb_luminaires_write(struct orl_hb *hb);

#endif
