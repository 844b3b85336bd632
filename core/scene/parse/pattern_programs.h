/*
 * What patterns compute, compiled from the primitive at hand. Internal to this folder.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_PROGRAMS_H
#define ORL_SCENE_PARSE_PATTERN_PROGRAMS_H

#include "scene/material/pattern.h"
#include "scene/parse/parser.h"

#define ORL_SCENE_GRID_VALUES (64UL << 20) /* of all pictures and data files of a scene */

/*
 * Fills in place, functions and what they ask for. n: expressions, which of a pattern without grids
 * are the primitive's first strings; of one with grids, coordinates, behind the function file;
 * file: which string names that.
 */
int orl_pattern_compile(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_xform *to_world, size_t n,
                        size_t file, struct orl_error *err);

/* The grid that a file holds, read when it is asked for first. The description's. */
int orl_pattern_grid(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                     bool picture, const struct orl_grid **ret_grid, struct orl_error *err);

#endif
