#include "scene/generate/xform_fold.h"

#include <stdlib.h>

struct folding {
    struct orl_xform_word *words;
    size_t n;
    bool options;  /* no transform has been read yet */
    bool modified; /* a -m has been read */
    bool turned;   /* the last word is a -I */
};

static void put_word(struct folding *f, const char *text)
{
    f->words[f->n++] = (struct orl_xform_word){.text = text};
    f->turned = false;
}

static bool begins_copies(const char *word)
{
    return strcmp(word, "-a") == 0 || strcmp(word, "-f") == 0;
}

/* Returns the number of words of a run of transforms: up to the next -a or -f, or -i unless the run
 * begins with one. */
static size_t run_length(const char *const *words, size_t count)
{
    const bool repeats = strcmp(words[0], "-i") == 0;
    size_t n = 1;
    while (n < count && !begins_copies(words[n]) && (repeats || strcmp(words[n], "-i") != 0))
        n++;
    return n;
}

/* Returns the number of words of an option and its value, 0 if there is none. */
static size_t fold_option(struct folding *f, const char *const *words, size_t count)
{
    if (strcmp(words[0], "-c") == 0 || strcmp(words[0], "-e") == 0)
        return 1;
    if (strcmp(words[0], "-I") == 0) {
        if (f->turned)
            f->n--;
        else
            put_word(f, words[0]);
        f->turned = !f->turned;
        return 1;
    }
    const bool modifier = strcmp(words[0], "-m") == 0;
    if ((!modifier && strcmp(words[0], "-n") != 0) || count < 2)
        return 0;
    if (!modifier || !f->modified) {
        put_word(f, words[0]);
        put_word(f, words[1]);
    }
    f->modified = f->modified || modifier;
    return 2;
}

/* Folds -a or -f with its value, or a run of transforms into one; returns the number of words, 0 if
 * none. */
static size_t fold_next(struct folding *f, const char *const *words, size_t count)
{
    struct orl_xform_word run = {.text = NULL};
    size_t used = 0;
    if (begins_copies(words[0])) {
        if (count < 2)
            return 0;
        f->options = f->options && strcmp(words[0], "-f") == 0;
        put_word(f, words[0]);
        put_word(f, words[1]);
        return 2;
    }
    if (orl_xform_read(words, run_length(words, count), &run.transform, &used, NULL) < 0)
        return 0;
    if (used > 0 && strcmp(words[0], "-i") == 0) {
        put_word(f, "-i"); /* ends the range that an array repeats */
        put_word(f, "1");
    }
    if (used > 0)
        f->words[f->n++] = run;
    f->options = false;
    return used;
}

struct orl_xform_word *orl_xform_fold(const char *const *words, size_t count, size_t *ret_n)
{
    /* a single "-i N" may become "-i 1" and a transform */
    struct folding f = {.words = malloc((2 * count + 1) * sizeof *f.words), .options = true};
    size_t i = 0, taken = 1;
    if (!f.words)
        return NULL;
    while (i < count && taken > 0) {
        taken = f.options ? fold_option(&f, words + i, count - i) : 0;
        if (taken == 0)
            taken = fold_next(&f, words + i, count - i);
        i += taken;
    }
    while (i < count)
        put_word(&f, words[i++]);
    *ret_n = f.n;
    return f.words;
}
