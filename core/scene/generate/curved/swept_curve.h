/*
 * Shared by genrev and genworm: expressions (expressions.h) of t, which goes from 0 to 1 in even
 * steps.
 */
#ifndef ORL_SCENE_GENERATE_CURVED_SWEPT_CURVE_H
#define ORL_SCENE_GENERATE_CURVED_SWEPT_CURVE_H

#include "scene/generate/curved/expressions.h"

enum { ORL_CURVE_EXPRESSIONS_MAX = 4 };

struct orl_generator_curve {
    const char *material, *name;
    int segments;
    bool smooth; /* -s */
    struct orl_generator_expressions expressions;
};

/* Reads all words of the command: material, name, n expressions, segments and options. The caller
 * passes curve->expressions to orl_expressions_done in every case. may_smooth: the option -s is
 * allowed. */
int orl_curve_read(struct orl_generator_curve *curve, struct orl_words *words, size_t n,
                   bool may_smooth, const struct orl_generator_files *files, struct orl_error *err);

/* Returns the expressions' values at t = step / segments; ORL_ERR_RANGE unless all are finite. */
int orl_curve_at(const struct orl_generator_curve *curve, int step,
                 double ret_values[ORL_CURVE_EXPRESSIONS_MAX], struct orl_error *err);

#endif
