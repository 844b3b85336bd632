/*
 * One primitive of a scene file as read: modifier, type, identifier and counted arguments. What
 * they mean is for materials.c and surfaces.c.
 *
 * Ownership: a primitive owns its buffers and is meant to be read into again and again. Strings are
 * good until the next read.
 */
#ifndef ORL_SCENE_PARSE_PRIMITIVE_H
#define ORL_SCENE_PARSE_PRIMITIVE_H

#include "scene/parse/lexer.h"

struct orl_primitive {
    const char *modifier, *type, *id;
    size_t n_strings, n_reals;
    double *reals;
    int line; /* where it starts */
    /* The strings lie in text one after the other; at[i] is where the i-th starts. */
    char *text;
    size_t *at;
    size_t text_size, text_room, at_room, reals_room;
};

void orl_primitive_done(struct orl_primitive *primitive);

/* The i-th string argument. */
const char *orl_primitive_string(const struct orl_primitive *primitive, size_t i);

/* Reads modifier, type and identifier. Fails with file and line in err. */
int orl_primitive_read_head(struct orl_primitive *primitive, struct orl_lexer *lexer,
                            struct orl_error *err);
/* Reads the counted arguments that follow the head of every type but alias. */
int orl_primitive_read_arguments(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err);
/* Makes it a surface with these numbers, as if read; names are borrowed, and good for as long as
 * they are. False without memory. */
bool orl_primitive_set(struct orl_primitive *primitive, const char *const head[3],
                       const double *reals, size_t n_reals);
/* Reads the one word that follows the head of an alias, as string 0. */
int orl_primitive_read_reference(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err);

#endif
