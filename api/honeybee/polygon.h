/*
 * Planar faces of a model (Face3D: a boundary, and holes in it) as Radiance polygons: one outline
 * that runs from the boundary's first corner to every hole, round it the other way, and back. What
 * is walked twice cancels. Holes are taken strip by strip, so that ways between them are short
 * and cross few others.
 */
#ifndef ORL_API_HONEYBEE_POLYGON_H
#define ORL_API_HONEYBEE_POLYGON_H

#include "honeybee/writing.h"

struct orl_hb_polygon {
    struct orl_vec3 *points; /* of all loops, one behind the other */
    size_t n_points, point_room;
    size_t *ends; /* of each loop, in points; the boundary is the first */
    size_t n_loops, loop_room;
};

void orl_hb_polygon_done(struct orl_hb_polygon *polygon);
/* Forgets what it held, and reads a Face3D: its corners turn as its plane's normal says, if it has
 * one. */
int orl_hb_polygon_read(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                        struct orl_hb_polygon *polygon);
/* One more hole: the boundary of a Face3D that is cut out. */
int orl_hb_polygon_cut(struct orl_hb *hb, const json_t *geometry, const struct orl_hb_at *at,
                       struct orl_hb_polygon *polygon);
/* Of unit length, as the boundary's corners turn; zero when they have no area. */
struct orl_vec3 orl_hb_polygon_normal(const struct orl_hb_polygon *polygon);
/* Turns it so that its normal is not against that one. */
void orl_hb_polygon_turn(struct orl_hb_polygon *polygon, struct orl_vec3 front);
void orl_hb_polygon_move(struct orl_hb_polygon *polygon, struct orl_vec3 by);
/* "MODIFIER polygon NAME ...". name: letters that are no identifier's become '_'. */
int orl_hb_polygon_write(struct orl_hb *hb, const struct orl_hb_polygon *polygon,
                         const char *modifier, const char *name, struct orl_hb_file *file);
/* The same name, where a mesh's faces are written one by one. */
void orl_hb_put_name(const char *name, FILE *stream);
void orl_hb_put_point(struct orl_vec3 point, FILE *stream);

#endif
