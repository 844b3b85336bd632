/*
 * The words of an xform command with its transforms read: successive ones are combined, so that
 * copies made by -a and -f need not read them again. Internal to xform_expand.c.
 */
#ifndef ORL_SCENE_GENERATE_XFORM_FOLD_H
#define ORL_SCENE_GENERATE_XFORM_FOLD_H

#include <string.h>

#include "scene/generate/xform.h"

/* A word of the command, or a combined transform. */
struct orl_xform_word {
    const char *text; /* NULL: a transform */
    struct orl_xform transform;
};

static inline bool orl_xform_is(const struct orl_xform_word *word, const char *text)
{
    return word->text && strcmp(word->text, text) == 0;
}

/*
 * Returns the words (owned, free()), or NULL if out of memory. Options without effect are left out:
 * -c, -e, -I twice, -m behind another. Words that are not understood, file names among them, are
 * kept with all that follow; the caller handles or refuses them. Texts are borrowed.
 */
struct orl_xform_word *orl_xform_fold(const char *const *words, size_t count, size_t *ret_n);

#endif
