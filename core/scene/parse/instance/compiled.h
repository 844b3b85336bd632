/*
 * The primitives instance and mesh: scenes that oconv has compiled into an octree, and triangles
 * that obj2mesh has compiled. Their octrees are skipped; for an octree that is not frozen, the
 * files it names are read.
 *
 * Names inside are separate: a file sees no modifiers from outside, and its own are not visible
 * there. A modifier of the primitive itself, other than void, replaces all modifiers inside.
 *
 * Normals and (u, v) of a mesh's corners are kept (smoothing.c). Files that occur several times may
 * be stored once (instanced_files.h).
 */
#ifndef ORL_SCENE_PARSE_INSTANCE_COMPILED_H
#define ORL_SCENE_PARSE_INSTANCE_COMPILED_H

#include "scene/parse/parser.h"

bool orl_parser_is_compiled(const char *type);
/* Reads the file that the current primitive names. */
int orl_parser_compiled(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err);

#endif
