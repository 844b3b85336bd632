/*
 * What patterns compute, compiled from the primitive at hand. Internal to this folder.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_PROGRAMS_H
#define ORL_SCENE_PARSE_PATTERN_PROGRAMS_H

#include "scene/material/pattern.h"
#include "scene/parse/parser.h"

#define ORL_SCENE_GRID_VALUES (64UL << 20) /* of all pictures and data files of a scene */

/* Which of the primitive's strings are what. */
struct orl_pattern_strings {
    size_t functions; /* the first of its functions, or, without grids, its expressions */
    size_t file;      /* the function file; of grids the coordinates follow */
    size_t n;         /* expressions or coordinates */
    bool spectral;    /* its function is one of the wavelength: orl_pattern.bands */
};

/* Fills in place, functions and what they ask for. */
int orl_pattern_compile(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_xform *to_world,
                        const struct orl_pattern_strings *strings, struct orl_error *err);

/* The grid that a file holds, read when it is asked for first. The description's. */
int orl_pattern_grid(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                     bool picture, const struct orl_grid **ret_grid, struct orl_error *err);

#endif
