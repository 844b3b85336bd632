/*
 * '!' lines, without a shell: a generator or "xform ... file", and any number of "| xform ..."
 * behind. What the program would print is read right away, in the scope that its transforms make.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "scene/generate/command.h"
#include "scene/generate/generate.h"
#include "scene/parse/parser.h"

typedef int (*generator)(const char *const *words, size_t count, struct orl_text *text,
                         struct orl_error *err);

static generator find_generator(const char *name)
{
    static const struct {
        const char *name;
        generator run;
    } generators[] = {{"genbox", orl_genbox}, {"gensky", orl_gensky}, {"gendaylit", orl_gendaylit}};
    for (size_t i = 0; i < sizeof generators / sizeof *generators; i++)
        if (strcmp(generators[i].name, name) == 0)
            return generators[i].run;
    return NULL;
}

/* A command under way: stage stage is about to be applied within scope. */
struct run {
    struct orl_parser *parser;
    const struct orl_command *command;
    const struct orl_scope *scope;
    size_t stage;
    int line;
    struct orl_text text; /* what its generator wrote, once: arrays read it again */
};

static int run_stage(struct run *run, struct orl_error *err);

static const char *const *stage_words(const struct run *run, size_t *ret_count)
{
    const size_t *start = run->command->start + run->stage;
    *ret_count = start[1] - start[0];
    return (const char *const *)run->command->words + start[0];
}

/* ---- Included files -------------------------------------------------------------------------- */

static int check_nesting(const struct orl_scope *scope, const char *name, struct orl_error *err)
{
    for (const struct orl_scope *s = scope; s; s = s->outer)
        if (strcmp(s->file, name) == 0)
            return orl_error_set(err, ORL_ERR_LIMIT, "'%.200s' includes itself", name);
    if (scope->depth >= ORL_LIMIT_INCLUDE_DEPTH)
        return orl_error_set(err, ORL_ERR_LIMIT, "files include each other more than %u deep",
                             ORL_LIMIT_INCLUDE_DEPTH);
    return 0;
}

/* Reads one file of an "xform ... file" within the scope already made for it. */
static int include(struct run *run, const struct orl_scope *inner, const char *name,
                   struct orl_error *err)
{
    struct orl_parser *parser = run->parser;
    struct orl_scope scope = *inner;
    struct orl_file file;
    size_t index = 0;
    int code = orl_sources_find(&parser->sources, inner->folder, name, &index, err);
    if (code < 0)
        return code;
    scope.file = parser->sources.items[index].name;
    scope.folder = parser->sources.items[index].folder;
    code = check_nesting(inner, scope.file, err);
    if (code < 0)
        return code;
    scope.depth++;
    file = parser->sources.items[index].file;
    if (file.size == 0)
        orl_parser_warn(parser, "%.200s: the file is empty", scope.file);
    return orl_parser_read(parser, &scope, file.data, file.size, 0, err);
}

/* ---- xform ----------------------------------------------------------------------------------- */

/* The scope inside a use of xform; prefix is where a joined prefix may be written. */
static struct orl_scope enter(const struct orl_scope *outer, const struct orl_xform_use *use,
                              char prefix[ORL_PREFIX_BYTES])
{
    struct orl_scope inner = *outer;
    inner.outer = outer;
    inner.xform = orl_xform_compose(&outer->xform, &use->xform);
    inner.modifier = outer->modifier ? outer->modifier : use->modifier;
    if (use->prefix && outer->prefix) {
        snprintf(prefix, ORL_PREFIX_BYTES, "%s.%s", outer->prefix, use->prefix);
        inner.prefix = prefix;
    } else if (use->prefix) {
        inner.prefix = use->prefix;
    }
    return inner;
}

/* A copy costs what its command's words cost to read again: as much text, for the bound on that. */
enum { WORD_COST = 64 };

static int apply_use(void *ctx, const struct orl_xform_use *use, struct orl_error *err)
{
    struct run *run = ctx;
    char prefix[ORL_PREFIX_BYTES];
    const struct orl_scope *outer = run->scope;
    struct orl_scope inner;
    int code = 0;
    if ((run->stage == 0) != (use->n_files > 0))
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             run->stage == 0 ? "xform has no file to read"
                                             : "xform behind '|' takes no files");
    if (use->prefix && outer->prefix &&
        strlen(use->prefix) + strlen(outer->prefix) + 2 > ORL_PREFIX_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the prefixes of -n are too long together");
    run->parser->text_bytes += WORD_COST * use->n_words;
    inner = enter(outer, use, prefix);
    if (run->stage > 0) {
        run->scope = &inner;
        run->stage--;
        code = run_stage(run, err);
        run->stage++;
        run->scope = outer;
        return code;
    }
    for (size_t i = 0; i < use->n_files && code == 0; i++)
        code = include(run, &inner, use->files[i], err);
    return code;
}

/* An argument file (-f). */
static int read_arguments(void *ctx, const char *name, char **ret_text, struct orl_error *err)
{
    struct run *run = ctx;
    struct orl_sources *sources = &run->parser->sources;
    size_t index = 0;
    const int code = orl_sources_find(sources, run->scope->folder, name, &index, err);
    if (code < 0)
        return code;
    *ret_text = strndup(sources->items[index].file.data, sources->items[index].file.size);
    return *ret_text ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* ---- Generators ------------------------------------------------------------------------------ */

static int generate(struct run *run, generator make, struct orl_error *err)
{
    struct orl_text *text = &run->text;
    if (!text->data) {
        size_t count;
        const char *const *words = stage_words(run, &count);
        const int code = make(words, count, text, err);
        if (code < 0)
            return code;
        if (text->failed)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        if (text->warnings[0])
            orl_parser_warn(run->parser, "%s:%d: %s", run->scope->file, run->line, text->warnings);
    }
    return orl_parser_read(run->parser, run->scope, text->data, text->size, run->line, err);
}

static int refuse(const char *name, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_UNSUPPORTED, "the command '%.80s' is not run", name);
    orl_error_hint(err, "xform, genbox, gensky and gendaylit are read here; run others beforehand "
                        "and include their output");
    return ORL_ERR_UNSUPPORTED;
}

static int run_stage(struct run *run, struct orl_error *err)
{
    size_t count;
    const char *const *words = stage_words(run, &count);
    const generator make = find_generator(words[0]);
    if (strcmp(words[0], "xform") == 0)
        return orl_xform_expand(words + 1, count - 1, read_arguments, apply_use, run, err);
    if (!make)
        return refuse(words[0], err);
    if (run->stage > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "%s reads nothing: it cannot stand behind '|'", words[0]);
    return generate(run, make, err);
}

int orl_parser_command(struct orl_parser *parser, const struct orl_scope *scope, const char *line,
                       int number, struct orl_error *err)
{
    struct orl_command command = {0};
    struct run run = {.parser = parser, .command = &command, .scope = scope, .line = number};
    char name[ORL_ERROR_NAME_MAX];
    int code = orl_command_split(&command, line, err);
    if (code == 0) {
        run.stage = command.n_stages - 1;
        code = run_stage(&run, err);
    }
    orl_text_done(&run.text);
    orl_command_done(&command);
    /* Errors inside what was read have their place already. */
    if (code < 0 && err->file[0] == '\0') {
        snprintf(name, sizeof name, "!%.200s", line);
        orl_error_at(err, scope->file, number, name);
    }
    return code;
}
