/*
 * One primitive of a scene file as read: modifier, type, identifier and counted arguments.
 * materials.c and surfaces.c interpret them.
 *
 * Ownership: a primitive owns its buffers, which are reused by the next read. Strings are valid
 * until then.
 */
#ifndef ORL_SCENE_PARSE_PRIMITIVE_H
#define ORL_SCENE_PARSE_PRIMITIVE_H

#include "scene/parse/lexer.h"

struct orl_primitive {
    const char *modifier, *type, *id;
    size_t n_strings, n_reals;
    double *reals;
    int line; /* line of its start */
    /* The strings lie in text one after the other; at[i] is the offset of the i-th. */
    char *text;
    size_t *at;
    size_t text_size, text_room, at_room, reals_room;
};

void orl_primitive_done(struct orl_primitive *primitive);

/* Returns the i-th string argument. */
const char *orl_primitive_string(const struct orl_primitive *primitive, size_t i);

/* Reads modifier, type and identifier. Fails with file and line in err. */
int orl_primitive_read_head(struct orl_primitive *primitive, struct orl_lexer *lexer,
                            struct orl_error *err);
/* Reads the counted arguments that follow the head of every type but alias. */
int orl_primitive_read_arguments(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err);
/* Makes it a surface with these numbers, as if read. Names are borrowed. Returns false if out of
 * memory. */
bool orl_primitive_set(struct orl_primitive *primitive, const char *const head[3],
                       const double *reals, size_t n_reals);
/* Reads the single word that follows the head of an alias, as string 0. */
int orl_primitive_read_reference(struct orl_primitive *primitive, struct orl_lexer *lexer,
                                 struct orl_error *err);

#endif
