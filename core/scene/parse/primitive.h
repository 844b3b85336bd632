/*
 * Scene text split into words (lexer.c) and read as primitives (primitive.c).
 */
#ifndef ORL_SCENE_PARSE_PRIMITIVE_H
#define ORL_SCENE_PARSE_PRIMITIVE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/limits.h>

/*
 * Splits Radiance scene text into words: blanks separate, quotes (' or ") join, '#' starts a
 * comment and '!' a command where a primitive could start. The text is a buffer with a size, need
 * not end in NUL, and is not changed. Line numbers are 1-based.
 *
 * Ownership: a word points into the text, or into the lexer's scratch if it was quoted; it is valid
 * until the next word is read. Errors have file and line set.
 * Reference: "The RADIANCE 6.0 Synthetic Imaging System", section 2, Scene Description.
 */

struct orl_lexer {
    const char *at, *end;
    const char *file; /* for messages; borrowed */
    int line;         /* line of the next word */
    bool frozen;      /* text from a command: every word has the command's line */
    char scratch[ORL_LIMIT_WORD_BYTES + 1];
};

struct orl_word {
    const char *text;
    size_t length;
    int line;
};

enum orl_next { ORL_NEXT_END, ORL_NEXT_COMMAND, ORL_NEXT_PRIMITIVE };

void orl_lexer_init(struct orl_lexer *lexer, const char *file, const char *text, size_t size);

/* Skips blanks and comments between primitives and returns what follows. */
enum orl_next orl_lexer_next(struct orl_lexer *lexer);

/*
 * After ORL_NEXT_COMMAND: returns the command without its '!', to the end of the line, with lines
 * that end in a backslash joined. Returns an owned string, or NULL with err filled.
 */
char *orl_lexer_command(struct orl_lexer *lexer, struct orl_error *err);

/* Reads the next word. Returns 1, 0 at the end of the text, or a negative orl_err. */
int orl_lexer_word(struct orl_lexer *lexer, struct orl_word *ret_word, struct orl_error *err);

/*
 * One primitive of a scene file as read: modifier, type, identifier and counted arguments.
 * materials.c and surfaces.c interpret them.
 *
 * Ownership: a primitive owns its buffers, which are reused by the next read. Strings are valid
 * until then.
 */

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
