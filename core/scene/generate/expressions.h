/*
 * What genrev, genworm and gensurf share: definitions of the command (-e) and of files (-f), in
 * Radiance's function language (function/function.h), and expressions over them.
 */
#ifndef ORL_SCENE_GENERATE_EXPRESSIONS_H
#define ORL_SCENE_GENERATE_EXPRESSIONS_H

#include "function/function.h"
#include "scene/generate/solids.h"

struct orl_generator_expressions {
    struct orl_functions *functions;
    struct orl_function *function; /* all expressions, once compiled; owned */
    struct orl_function_scratch *scratch;
    size_t n;
};

/* Inputs by name. Pass it to orl_expressions_done, whatever comes of it. */
int orl_expressions_begin(struct orl_generator_expressions *expressions, const char *const *inputs,
                          size_t n_inputs, struct orl_error *err);
void orl_expressions_done(struct orl_generator_expressions *expressions);

/* What follows an option -e or -f, which is the last word that was read; other options are no
 * options. */
int orl_expressions_define(struct orl_generator_expressions *expressions, const char *option,
                           struct orl_words *words, const struct orl_generator_files *files,
                           struct orl_error *err);

/* A word that is a number, or an expression of one: rounded, 1 to most. what: what it counts. */
int orl_expressions_count(struct orl_generator_expressions *expressions, const char *word,
                          const char *what, const char *program, int most, int *ret_count,
                          struct orl_error *err);

/* To be evaluated at no more than so many places, which share the steps that a command may take. */
int orl_expressions_compile(struct orl_generator_expressions *expressions, const char *const *texts,
                            size_t n, size_t places, struct orl_error *err);

/* Their values at one place; ORL_ERR_RANGE unless all are finite. */
int orl_expressions_at(const struct orl_generator_expressions *expressions, const double *inputs,
                       double *ret_values, struct orl_error *err);

#endif
