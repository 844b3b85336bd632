/*
 * What genrev and genworm share: expressions of t, which runs from 0 to 1 in even steps, over
 * definitions of the command (-e) and of files (-f), in Radiance's function language
 * (function/function.h).
 */
#ifndef ORL_SCENE_GENERATE_CURVE_H
#define ORL_SCENE_GENERATE_CURVE_H

#include "function/function.h"
#include "scene/generate/solids.h"

enum { ORL_CURVE_MOST = 4 };

struct orl_generator_curve {
    const char *material, *name;
    int segments;
    struct orl_functions *functions;
    struct orl_function *function;
    struct orl_function_scratch *scratch;
    size_t n; /* expressions */
};

/* Reads all words of the command: material, name, n expressions, segments and options. Pass the
 * curve to orl_curve_done, whatever comes of it. */
int orl_curve_read(struct orl_generator_curve *curve, struct orl_words *words, size_t n,
                   const struct orl_generator_files *files, struct orl_error *err);
void orl_curve_done(struct orl_generator_curve *curve);

/* The expressions' values at t = step / segments; ORL_ERR_RANGE unless all are finite. */
int orl_curve_at(const struct orl_generator_curve *curve, int step,
                 double ret_values[ORL_CURVE_MOST], struct orl_error *err);

#endif
