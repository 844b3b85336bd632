/*
 * Shared by genrev, genworm and gensurf: definitions in the command (-e) and in files (-f), in
 * Radiance's function language (function/function.h), and expressions that use them.
 */
#ifndef ORL_SCENE_GENERATE_CURVED_EXPRESSIONS_H
#define ORL_SCENE_GENERATE_CURVED_EXPRESSIONS_H

#include "function/function.h"
#include "scene/generate/solid/solids.h"

struct orl_generator_expressions {
    struct orl_functions *functions;
    struct orl_function *function; /* all expressions, once compiled; owned */
    struct orl_function_scratch *scratch;
    size_t n;
};

/* Starts with named inputs. Requires orl_expressions_done in every case. */
int orl_expressions_begin(struct orl_generator_expressions *expressions, const char *const *inputs,
                          size_t n_inputs, struct orl_error *err);
void orl_expressions_done(struct orl_generator_expressions *expressions);

/* Handles an option -e or -f, which is the last word read; fails for other options. */
int orl_expressions_define(struct orl_generator_expressions *expressions, const char *option,
                           struct orl_words *words, const struct orl_generator_files *files,
                           struct orl_error *err);

/* Reads a word that is a number or an expression, rounded, 1 to most. what: the counted thing, for
 * messages. */
int orl_expressions_count(struct orl_generator_expressions *expressions, const char *word,
                          const char *what, const char *program, int most, int *ret_count,
                          struct orl_error *err);

/* Compiles expressions for evaluation at up to `places` places, which share the limit of steps of a
 * command. */
int orl_expressions_compile(struct orl_generator_expressions *expressions, const char *const *texts,
                            size_t n, size_t places, struct orl_error *err);

/* Returns the values at one place; ORL_ERR_RANGE unless all are finite. */
int orl_expressions_at(const struct orl_generator_expressions *expressions, const double *inputs,
                       double *ret_values, struct orl_error *err);

#endif
