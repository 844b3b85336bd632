/*
 * The options of the xform command: -a (arrays) and -f (argument files) make many uses of one; what
 * is left of each is -m, -n, -I, -c, -e, transforms and file names, in that order.
 */
#include "scene/xform.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "scene/command.h"
#include "scene/number.h"

enum { DEPTH_MAX = 8 };

struct expansion {
    orl_xform_reader reader;
    orl_xform_user user;
    void *ctx;
    size_t copies; /* made so far */
    unsigned depth;
};

static int expand(struct expansion *e, const char *const *words, size_t count,
                  struct orl_error *err);

static size_t find(const char *const *words, size_t count, const char *option)
{
    size_t i = 0;
    while (i < count && strcmp(words[i], option) != 0)
        i++;
    return i;
}

/* Appends ".word"; what does not fit fills the prefix up, which use_once refuses. */
static size_t join_prefix(char prefix[ORL_PREFIX_BYTES], size_t length, const char *word)
{
    const size_t room = ORL_PREFIX_BYTES - length;
    const size_t more =
        (size_t)snprintf(prefix + length, room, "%s%s", length > 0 ? "." : "", word);
    return more < room ? length + more : ORL_PREFIX_BYTES - 1;
}

/* -m, -n and the flags, as far as they go. Several -n join with dots; the first -m counts. */
static size_t read_options(const char *const *words, size_t count, struct orl_xform_use *use,
                           bool *inverted, char prefix[ORL_PREFIX_BYTES])
{
    size_t i = 0, length = 0;
    for (; i < count; i++) {
        if (strcmp(words[i], "-I") == 0) {
            *inverted = !*inverted;
        } else if (strcmp(words[i], "-m") == 0 && i + 1 < count) {
            i++;
            use->modifier = use->modifier ? use->modifier : words[i];
        } else if (strcmp(words[i], "-n") == 0 && i + 1 < count) {
            i++;
            use->prefix = prefix;
            length = join_prefix(prefix, length, words[i]);
        } else if (strcmp(words[i], "-c") != 0 && strcmp(words[i], "-e") != 0) {
            /* -c leaves commands for the reader to expand and -e expands them: the same here. */
            break;
        }
    }
    return i;
}

/* No -a and no -f is left: one use. */
static int use_once(struct expansion *e, const char *const *words, size_t count,
                    struct orl_error *err)
{
    struct orl_xform_use use = {.xform = orl_xform_identity};
    char prefix[ORL_PREFIX_BYTES];
    bool inverted = false;
    size_t used = 0;
    const size_t options = read_options(words, count, &use, &inverted, prefix);
    const int code = orl_xform_read(words + options, count - options, &use.xform, &used, err);
    if (code < 0)
        return code;
    if (++e->copies > ORL_LIMIT_XFORM_ARRAY)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: more than %u copies in one command",
                             ORL_LIMIT_XFORM_ARRAY);
    if (use.prefix && strlen(prefix) == ORL_PREFIX_BYTES - 1)
        return orl_error_set(err, ORL_ERR_LIMIT, "xform: the prefix of -n is too long");
    use.files = words + options + used;
    use.n_files = count - options - used;
    use.n_words = count;
    use.xform.inverted = use.xform.inverted != inverted;
    if (use.n_files > 0 && use.files[0][0] == '-') {
        orl_error_set(err, ORL_ERR_SYNTAX, "xform: option '%.40s' is not known here", use.files[0]);
        orl_error_hint(err, "-n, -m, -a and -f come first, then transforms, then file names");
        return ORL_ERR_SYNTAX;
    }
    return e->user(e->ctx, &use, err);
}

/*
 * Puts the copy's number behind the names that -n gives, as the command does: an argument file
 * extends the first, an array sets them all to the last one. Returns false when there is none.
 */
static bool number_names(const char **words, size_t count, char letter, size_t number,
                         char name[ORL_PREFIX_BYTES])
{
    const char *old = NULL;
    bool done = false;
    for (size_t i = 1; i < count && !(old && letter == 'i'); i++)
        if (words[i - 1] && strcmp(words[i - 1], "-n") == 0)
            old = words[i];
    if (!old)
        return false;
    snprintf(name, ORL_PREFIX_BYTES, "%.*s.%zu", ORL_PREFIX_BYTES - 24, old, number);
    for (size_t i = 1; i < count && !(done && letter == 'i'); i++) {
        if (words[i - 1] && strcmp(words[i - 1], "-n") == 0) {
            words[i] = name;
            done = true;
        }
    }
    return true;
}

/*
 * The words with item and its value replaced by middle, and the copy's number added to its names,
 * or "-n <letter><number>" put in front.
 */
static int expand_copy(struct expansion *e, const char *const *words, size_t count, size_t item,
                       const char *const *middle, size_t n_middle, char letter, size_t number,
                       struct orl_error *err)
{
    char name[ORL_PREFIX_BYTES];
    const char **copy = calloc(count + n_middle + 2, sizeof *copy);
    size_t n = 2, from = 2;
    int code;
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
        copy[0] = "-n";
        copy[1] = name;
        from = 0;
    }
    code = expand(e, copy + from, n - from, err);
    free(copy);
    return code;
}

static int expand_array(struct expansion *e, const char *const *words, size_t count, size_t item,
                        struct orl_error *err)
{
    int copies = 0, code = 0;
    char number[16];
    const char *const middle[2] = {"-i", number};
    if (item + 1 >= count ||
        orl_number_read_int(words[item + 1], strlen(words[item + 1]), &copies) != ORL_NUMBER_OK ||
        copies <= 0)
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

/* One line of an argument file; blank lines and comments make no copy. */
static int expand_line(struct expansion *e, const char *const *words, size_t count, size_t item,
                       const char *line, size_t *number, struct orl_error *err)
{
    struct orl_command command = {0};
    size_t first = 0;
    int code;
    line += strspn(line, " \t\r!");
    if (*line == '\0' || *line == '#')
        return 0;
    code = orl_command_split(&command, line, err);
    if (code == 0 && command.n_stages != 1)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "xform: an argument file holds arguments only");
    if (code == 0 && command.n_words > 0 && strcmp(command.words[0], "xform") == 0)
        first = 1;
    if (code == 0)
        code = expand_copy(e, words, count, item, (const char *const *)command.words + first,
                           command.n_words - first, 'i', (*number)++, err);
    orl_command_done(&command);
    return code;
}

static int expand_file(struct expansion *e, const char *const *words, size_t count, size_t item,
                       struct orl_error *err)
{
    char *text = NULL, *rest, *line;
    size_t number = 0;
    int code;
    if (item + 1 >= count || words[item + 1][0] == '-')
        return orl_error_set(err, ORL_ERR_SYNTAX, "xform: -f needs a file name after it");
    code = e->reader(e->ctx, words[item + 1], &text, err);
    for (rest = text; code == 0 && (line = strsep(&rest, "\n")) != NULL;)
        code = expand_line(e, words, count, item, line, &number, err);
    if (code == 0 && number == 0)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "xform: the argument file '%.80s' has no lines",
                             words[item + 1]);
    free(text);
    return code;
}

static int expand(struct expansion *e, const char *const *words, size_t count,
                  struct orl_error *err)
{
    const size_t file = find(words, count, "-f"), array = find(words, count, "-a");
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
    return expand(&e, words, count, err);
}
