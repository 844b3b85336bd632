#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/text/words.h"
#include "scene/generate/generate.h"
#include "scene/generate/xform.h"

/*
 * Expansion of an xform command (-a, -f). Its words are read with successive transforms combined
 * first, so that copies need not read them again.
 */

/* A word of the command, or a combined transform. */
struct xform_word {
    const char *text; /* NULL: a transform */
    struct orl_xform transform;
};

static bool word_is(const struct xform_word *word, const char *text)
{
    return word->text && strcmp(word->text, text) == 0;
}

struct folding {
    struct xform_word *words;
    size_t n;
    bool options;  /* no transform has been read yet */
    bool modified; /* a -m has been read */
    bool turned;   /* the last word is a -I */
};

static void put_word(struct folding *f, const char *text)
{
    f->words[f->n++] = (struct xform_word){.text = text};
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
    struct xform_word run = {.text = NULL};
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

/*
 * Returns the words (owned, free()), or NULL if out of memory. Options without effect are left out:
 * -c, -e, -I twice, -m behind another. Words that are not understood, such as file names, remain
 * with all that follow; the caller handles or refuses them. Texts are borrowed.
 */
static struct xform_word *fold_words(const char *const *words, size_t count, size_t *ret_n)
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

/*
 * Options of the xform command: -a (arrays) and -f (argument files) expand a command to many uses.
 * Each use then has -m, -n, -I, -c, -e, transforms and file names, in that order.
 *
 * Transforms between these are read once, however many copies are made: a copy costs a few steps
 * for each -a and -f, not one for every word.
 */

enum { DEPTH_MAX = 8 };

struct expansion {
    orl_xform_reader reader;
    orl_xform_user user;
    void *ctx;
    size_t copies; /* made so far */
    unsigned depth;
};

static int expand_words(struct expansion *e, const struct xform_word *words, size_t count,
                        struct orl_error *err);

static size_t find_option(const struct xform_word *words, size_t count, const char *option)
{
    size_t i = 0;
    while (i < count && !word_is(&words[i], option))
        i++;
    return i;
}

/* ---- One use --------------------------------------------------------------------------------- */

/* Appends ".word"; a prefix that is too long is filled up, which read_use refuses. */
static size_t join_prefix(char prefix[ORL_PREFIX_BYTES], size_t length, const char *word)
{
    const size_t room = ORL_PREFIX_BYTES - length;
    const size_t more =
        (size_t)snprintf(prefix + length, room, "%s%s", length > 0 ? "." : "", word);
    return more < room ? length + more : ORL_PREFIX_BYTES - 1;
}

/* Reads leading -m, -n and flags. Several -n join with dots; the first -m counts. */
static size_t read_options(const struct xform_word *words, size_t count, struct orl_xform_use *use,
                           bool *inverted, char prefix[ORL_PREFIX_BYTES])
{
    size_t i = 0, length = 0;
    for (; i < count; i++) {
        if (word_is(&words[i], "-I")) {
            *inverted = !*inverted;
        } else if (word_is(&words[i], "-m") && i + 1 < count && words[i + 1].text) {
            i++;
            use->modifier = use->modifier ? use->modifier : words[i].text;
        } else if (word_is(&words[i], "-n") && i + 1 < count && words[i + 1].text) {
            i++;
            use->prefix = prefix;
            length = join_prefix(prefix, length, words[i].text);
        } else if (!word_is(&words[i], "-c") && !word_is(&words[i], "-e")) {
            /* -c leaves commands unexpanded and -e expands them; both have no effect here. */
            break;
        }
    }
    return i;
}

/* Reads a transform that was left as words, up to the next -i. */
static int read_words(const struct xform_word *words, size_t count, const char **texts,
                      struct orl_xform *ret_some, size_t *ret_used, struct orl_error *err)
{
    size_t n = 0;
    for (; n < count && words[n].text && !word_is(&words[n], "-i"); n++)
        texts[n] = words[n].text;
    return orl_xform_read(texts, n, ret_some, ret_used, err);
}

/* Reads leading transforms, where each -i repeats those up to the next; *ret_used: number of
 * words. */
static int read_transforms(const struct xform_word *words, size_t count, const char **texts,
                           struct orl_xform *ret_xform, size_t *ret_used, struct orl_error *err)
{
    struct orl_xform total = orl_xform_identity, block = total, some;
    size_t i = 0, used = 0;
    int times = 1, code = 0;
    for (; i < count; i += used) {
        if (!words[i].text) {
            block = orl_xform_compose(&words[i].transform, &block);
            used = 1;
        } else if (word_is(&words[i], "-i")) {
            orl_xform_repeat(&total, &block, times);
            block = orl_xform_identity;
            code = orl_xform_repeats(i + 1 < count ? words[i + 1].text : NULL, &times, err);
            used = 2;
        } else {
            code = read_words(words + i, count - i, texts, &some, &used, err);
            if (code == 0 && used == 0)
                break;
            block = code < 0 ? block : orl_xform_compose(&some, &block);
        }
        if (code < 0)
            return code;
    }
    orl_xform_repeat(&total, &block, times);
    *ret_xform = total;
    *ret_used = i;
    return orl_xform_check(&total, err);
}

/* Reads the file names behind the transforms. */
static int read_files(const struct xform_word *words, size_t count, const char **files,
                      struct orl_error *err)
{
    for (size_t i = 0; i < count; i++)
        if (!(files[i] = words[i].text))
            return orl_error_set(err, ORL_ERR_SYNTAX,
                                 "xform: a transform follows the file name '%.80s'", words[0].text);
    if (count > 0 && files[0][0] == '-')
        return orl_error_refuse(err, ORL_ERR_SYNTAX,
                                "write -n, -m, -a and -f first, then transforms, then file names",
                                "xform: option '%.40s' is unknown", files[0]);
    return 0;
}

/* Reads the words into *use; texts has room for them all. */
static int read_use(struct expansion *e, const struct xform_word *words, size_t count,
                    const char **texts, char prefix[ORL_PREFIX_BYTES], struct orl_xform_use *use,
                    struct orl_error *err)
{
    bool inverted = false;
    size_t used = 0;
    const size_t options = read_options(words, count, use, &inverted, prefix);
    const int code =
        read_transforms(words + options, count - options, texts, &use->xform, &used, err);
    if (code < 0)
        return code;
    if (++e->copies > ORL_LIMIT_XFORM_ARRAY)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: more than %u copies in one command",
                             ORL_LIMIT_XFORM_ARRAY);
    if (use->prefix && strlen(prefix) == ORL_PREFIX_BYTES - 1)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: the prefix of -n is too long");
    use->files = texts;
    use->n_files = count - options - used;
    use->n_words = count;
    use->xform.inverted = use->xform.inverted != inverted;
    return read_files(words + options + used, use->n_files, texts, err);
}

/* Handles a command without -a and -f: one use. */
static int use_once(struct expansion *e, const struct xform_word *words, size_t count,
                    struct orl_error *err)
{
    struct orl_xform_use use = {.xform = orl_xform_identity};
    char prefix[ORL_PREFIX_BYTES];
    const char **texts = malloc((count + 1) * sizeof *texts);
    if (!texts)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    int code = read_use(e, words, count, texts, prefix, &use, err);
    if (code == 0)
        code = e->user(e->ctx, &use, err);
    free(texts);
    return code;
}

/* ---- Copies ---------------------------------------------------------------------------------- */

/*
 * Appends the copy's number to the names that -n gives, as the command does: an argument file
 * extends the first, an array sets all of them to the last one. Returns false if there is none.
 */
static bool number_names(struct xform_word *words, size_t count, char letter, size_t number,
                         char name[ORL_PREFIX_BYTES])
{
    const char *old = NULL;
    bool done = false;
    for (size_t i = 1; i < count && !(old && letter == 'i'); i++)
        if (word_is(&words[i - 1], "-n") && words[i].text)
            old = words[i].text;
    if (!old)
        return false;
    snprintf(name, ORL_PREFIX_BYTES, "%.*s.%zu", ORL_PREFIX_BYTES - 24, old, number);
    for (size_t i = 1; i < count && !(done && letter == 'i'); i++) {
        if (word_is(&words[i - 1], "-n") && words[i].text) {
            words[i].text = name;
            done = true;
        }
    }
    return true;
}

/*
 * Expands a copy of the words in which middle replaces item and its value. The copy's number is
 * appended to its names, or "-n <letter><number>" is put in front.
 */
static int expand_copy(struct expansion *e, const struct xform_word *words, size_t count,
                       size_t item, const struct xform_word *middle, size_t n_middle, char letter,
                       size_t number, struct orl_error *err)
{
    char name[ORL_PREFIX_BYTES];
    struct xform_word *copy = malloc((count + n_middle + 2) * sizeof *copy);
    size_t n = 2, from = 2;
    if (!copy)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < item; i++)
        copy[n++] = words[i];
    for (size_t i = 0; i < n_middle; i++)
        copy[n++] = middle[i];
    for (size_t i = item + 2; i < count; i++)
        copy[n++] = words[i];
    if (!number_names(copy + 2, n - 2, letter, number, name)) {
        snprintf(name, sizeof name, "%c%zu", letter, number);
        copy[0] = (struct xform_word){.text = "-n"};
        copy[1] = (struct xform_word){.text = name};
        from = 0;
    }
    const int code = expand_words(e, copy + from, n - from, err);
    free(copy);
    return code;
}

static int expand_array(struct expansion *e, const struct xform_word *words, size_t count,
                        size_t item, struct orl_error *err)
{
    int copies = 0, code = 0;
    char number[16];
    const struct xform_word middle[2] = {{.text = "-i"}, {.text = number}};
    const char *word = item + 1 < count ? words[item + 1].text : NULL;
    if (!word || orl_number_read_int(word, strlen(word), &copies) != ORL_NUMBER_OK || copies <= 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "xform: -a needs a positive count after it");
    if (copies > (int)ORL_LIMIT_XFORM_ARRAY)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: -a %d is more than %u copies", copies,
                             ORL_LIMIT_XFORM_ARRAY);
    for (int i = 0; i < copies && code == 0; i++) {
        snprintf(number, sizeof number, "%d", i);
        code = expand_copy(e, words, count, item, middle, 2, 'a', (size_t)i, err);
    }
    return code;
}

/* Expands one line of an argument file; blank lines and comments make no copy. */
static int expand_line(struct expansion *e, const struct xform_word *words, size_t count,
                       size_t item, const char *line, size_t *number, struct orl_error *err)
{
    struct orl_command command = {0};
    size_t first = 0;
    line += strspn(line, " \t\r!");
    if (*line == '\0' || *line == '#')
        return 0;
    int code = orl_command_split(&command, line, err);
    if (code == 0 && command.n_stages != 1)
        code = orl_error_set(err, ORL_ERR_SYNTAX,
                             "xform: an argument file may contain only arguments");
    if (code == 0 && command.n_words > 0 && strcmp(command.words[0], "xform") == 0)
        first = 1;
    size_t n = 0;
    struct xform_word *middle = code < 0 ? NULL
                                         : fold_words((const char *const *)command.words + first,
                                                      command.n_words - first, &n);
    if (code == 0 && !middle)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (code == 0)
        code = expand_copy(e, words, count, item, middle, n, 'i', (*number)++, err);
    free(middle);
    orl_command_done(&command);
    return code;
}

static int expand_file(struct expansion *e, const struct xform_word *words, size_t count,
                       size_t item, struct orl_error *err)
{
    char *text = NULL, *rest, *line;
    size_t number = 0;
    const char *name = item + 1 < count ? words[item + 1].text : NULL;
    if (!name || name[0] == '-')
        return orl_error_set(err, ORL_ERR_SYNTAX, "xform: -f needs a file name after it");
    int code = e->reader(e->ctx, name, &text, err);
    for (rest = text; code == 0 && (line = strsep(&rest, "\n")) != NULL;)
        code = expand_line(e, words, count, item, line, &number, err);
    if (code == 0 && number == 0)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "xform: the argument file '%.80s' has no lines",
                             name);
    free(text);
    return code;
}

static int expand_words(struct expansion *e, const struct xform_word *words, size_t count,
                        struct orl_error *err)
{
    const size_t file = find_option(words, count, "-f"), array = find_option(words, count, "-a");
    int code;
    if (e->depth >= DEPTH_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: more than %d of -a and -f", DEPTH_MAX - 1);
    e->depth++;
    if (file < count)
        code = expand_file(e, words, count, file, err);
    else if (array < count)
        code = expand_array(e, words, count, array, err);
    else
        code = use_once(e, words, count, err);
    e->depth--;
    return code;
}

int orl_xform_expand(const char *const *words, size_t count, orl_xform_reader reader,
                     orl_xform_user user, void *ctx, struct orl_error *err)
{
    struct expansion e = {reader, user, ctx, 0, 0};
    size_t n = 0;
    struct xform_word *folded = fold_words(words, count, &n);
    const int code = folded ? expand_words(&e, folded, n, err)
                            : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    free(folded);
    return code;
}
