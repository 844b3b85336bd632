/*
 * Writes planar faces of a model (Face3D: a boundary, and holes in it) as Radiance polygons. One
 * outline runs from the boundary's first corner to every hole, around it in the opposite
 * direction, and back. Edges passed twice cancel. Holes are visited strip by strip, so that edges
 * between them are short and cross few others.
 */
#ifndef ORL_API_HONEYBEE_POLYGON_H
#define ORL_API_HONEYBEE_POLYGON_H

#include "honeybee/hb_writer.h"

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

#endif
