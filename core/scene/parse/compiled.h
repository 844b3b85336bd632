/*
 * The primitives instance and mesh: scenes that oconv has compiled into an octree, and triangles
 * that obj2mesh has compiled. Their octrees are passed over; of an octree that is not frozen the
 * files it names are read.
 *
 * What is inside has names of its own: it sees no modifier from outside, and none of its is seen
 * there; a modifier of the primitive itself, other than void, takes the place of all inside.
 *
 * Triangles are flat here: normals of their corners, which Radiance interpolates, are passed over
 * with a warning. Instances are copied, a surface for each inside.
 */
#ifndef ORL_SCENE_PARSE_COMPILED_H
#define ORL_SCENE_PARSE_COMPILED_H

#include "scene/parse/parser.h"

bool orl_parser_is_compiled(const char *type);
/* Reads what the primitive at hand names. */
int orl_parser_compiled(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err);

#endif
