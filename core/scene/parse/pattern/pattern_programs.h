/*
 * Compiles the functions of patterns from the current primitive. Internal to this folder.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_PATTERN_PROGRAMS_H
#define ORL_SCENE_PARSE_PATTERN_PATTERN_PROGRAMS_H

#include "scene/material/patterns/pattern.h"
#include "scene/parse/parser.h"

#define ORL_SCENE_GRID_VALUES (64UL << 20) /* limit of all pictures and data files of a scene */

/* Positions of the primitive's strings. */
struct orl_pattern_strings {
    size_t functions; /* index of the first function, or without grids of the first expression */
    size_t file;      /* index of the function file; with grids the coordinates follow it */
    size_t n;         /* number of expressions or coordinates */
    bool spectral;    /* the function takes the wavelength: orl_pattern.bands */
};

/* Sets the pattern's frame, functions and inputs. */
int orl_pattern_compile(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_xform *to_world,
                        const struct orl_pattern_strings *strings, struct orl_error *err);

/* Returns the grid of a file, which is read at first use. The description owns it. */
int orl_pattern_grid(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                     bool picture, const struct orl_grid **ret_grid, struct orl_error *err);

#endif
