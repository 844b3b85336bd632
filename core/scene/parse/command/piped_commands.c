/*
 * '!' lines, without a shell: a generator, "xform ... file", "cat file", "replmarks ... file" or
 * "obj2rad ... file", followed by any number of "| xform ..." or "| replmarks ...". The program's
 * output is read immediately, in the scope that the transforms make.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/generate/generate.h"
#include "scene/generate/solid/solids.h"
#include "scene/parse/command/commands.h"
#include "scene/parse/luminaire/luminaires.h"
#include "scene/parse/mesh/mesh_import.h"

/* A generator; exactly one of the three functions is set, by what it needs. */
struct generator {
    const char *name;
    int (*run)(const char *const *words, size_t count, struct orl_text *text,
               struct orl_error *err);
    int (*run_with)(const char *const *words, size_t count, const struct orl_generator_files *files,
                    struct orl_text *text, struct orl_error *err);
    int (*run_in)(struct orl_parser *parser, const struct orl_scope *scope,
                  const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err);
};

static const struct generator *find_generator(const char *name)
{
    static const struct generator generators[] = {
        {.name = "genbox", .run = orl_genbox},
        {.name = "gensky", .run = orl_gensky},
        {.name = "gendaylit", .run = orl_gendaylit},
        {.name = "genprism", .run_with = orl_genprism},
        {.name = "genblinds", .run = orl_genblinds},
        {.name = "genclock", .run = orl_genclock},
        {.name = "genbranch", .run = orl_genbranch},
        {.name = "genrev", .run_with = orl_genrev},
        {.name = "genworm", .run_with = orl_genworm},
        {.name = "gensurf", .run_with = orl_gensurf},
        {.name = "ies2rad", .run_in = orl_parser_ies2rad},
        {.name = "mgf2rad", .run_in = orl_parser_mgf2rad},
        {.name = "pkgBSDF", .run_in = orl_parser_pkgbsdf},
    };
    for (size_t i = 0; i < sizeof generators / sizeof *generators; i++)
        if (strcmp(generators[i].name, name) == 0)
            return &generators[i];
    return NULL;
}

/* A running command; `stage` is the next one to apply within `scope`. */
struct run {
    struct orl_parser *parser;
    const struct orl_command *command;
    const struct orl_scope *scope;
    size_t stage;
    int line;
    struct orl_text text; /* the generator's output, written once and read again by arrays */
};

static int run_stage(struct run *run, struct orl_error *err);

/* Runs the previous stage within scope. */
static int run_before(struct run *run, const struct orl_scope *scope, struct orl_error *err)
{
    const struct orl_scope *outer = run->scope;
    run->scope = scope;
    run->stage--;
    const int code = run_stage(run, err);
    run->stage++;
    run->scope = outer;
    return code;
}

static const char *const *stage_words(const struct run *run, size_t *ret_count)
{
    const size_t *start = run->command->start + run->stage;
    *ret_count = start[1] - start[0];
    return (const char *const *)run->command->words + start[0];
}

/* ---- Included files -------------------------------------------------------------------------- */

int orl_parser_include(struct orl_parser *parser, const struct orl_scope *inner, const char *name,
                       struct orl_error *err)
{
    struct orl_scope scope = *inner;
    struct orl_file file;
    const int code = orl_parser_enter(parser, &scope, name, &file, err);
    if (code < 0)
        return code;
    if (file.size == 0)
        orl_parser_warn(parser, "%.200s: the file is empty", scope.file);
    return orl_parser_file(parser, &scope, &file, err);
}

/* Includes the files; behind '|', runs the previous stage. */
static int concatenate(struct run *run, const char *const *words, size_t count,
                       struct orl_error *err)
{
    int code = 0;
    for (size_t i = 1; i < count; i++)
        if (words[i][0] == '-')
            return orl_error_set(err, ORL_ERR_UNSUPPORTED, "cat: '%.40s' is not supported",
                                 words[i]);
    if (run->stage == 0 && count < 2)
        return orl_error_set(err, ORL_ERR_SYNTAX, "cat needs a file to read");
    if (run->stage > 0 && count > 1)
        return orl_error_set(err, ORL_ERR_SYNTAX, "cat after '|' takes no files");
    if (run->stage > 0)
        return run_before(run, run->scope, err);
    for (size_t i = 1; i < count && code == 0; i++)
        code = orl_parser_include(run->parser, run->scope, words[i], err);
    return code;
}

/* ---- xform ----------------------------------------------------------------------------------- */

/* Returns the scope inside a use of xform; prefix: room for a joined prefix. */
static struct orl_scope enter_use(const struct orl_scope *outer, const struct orl_xform_use *use,
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
    if (outer->markers)
        inner.since = orl_xform_compose(&outer->since, &use->xform);
    return inner;
}

/* Text that a copy counts as, for the limit of text read: reading a command's words again takes as
 * long. */
enum { WORD_COST = 64 };

static int apply_use(void *ctx, const struct orl_xform_use *use, struct orl_error *err)
{
    struct run *run = ctx;
    char prefix[ORL_PREFIX_BYTES];
    const struct orl_scope *outer = run->scope;
    int code = 0;
    if ((run->stage == 0) != (use->n_files > 0))
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             run->stage == 0 ? "xform needs a file to read"
                                             : "xform after '|' takes no files");
    if (use->prefix && outer->prefix &&
        strlen(use->prefix) + strlen(outer->prefix) + 2 > ORL_PREFIX_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the prefixes of -n are too long together");
    run->parser->text_bytes += WORD_COST * use->n_words;
    struct orl_scope inner = enter_use(outer, use, prefix);
    if (run->stage > 0)
        return run_before(run, &inner, err);
    for (size_t i = 0; i < use->n_files && code == 0; i++)
        code = orl_parser_include(run->parser, &inner, use->files[i], err);
    return code;
}

/* Reads a file that a command's words name. */
static int read_arguments(void *ctx, const char *name, char **ret_text, struct orl_error *err)
{
    struct run *run = ctx;
    struct orl_sources *sources = &run->parser->sources;
    size_t index = 0;
    const int code = orl_sources_find(sources, run->scope->folder, name, &index, err);
    if (code < 0)
        return code;
    run->parser->text_bytes += sources->items[index].file.size;
    *ret_text = strndup(sources->items[index].file.data, sources->items[index].file.size);
    return *ret_text ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* ---- replmarks ------------------------------------------------------------------------------- */

/* Places an octree or a mesh at a marker, by the primitive that replmarks writes. The marker's name
 * becomes the prefix of names inside an octree, or the name of a mesh. */
static int place_compiled(struct orl_parser *parser, struct orl_scope *inner,
                          const struct orl_marker *marker, int line, struct orl_error *err)
{
    char text[ORL_PREFIX_BYTES + ORL_LIMIT_WORD_BYTES + 64];
    const int size = snprintf(text, sizeof text, "void %s \"%s\" 1 \"%s\" 0 0\n", marker->compiled,
                              inner->prefix, marker->object);
    if ((size_t)size >= sizeof text)
        return orl_error_set(err, ORL_ERR_LIMIT, "the name of its file is too long");
    if (strcmp(marker->compiled, "mesh") == 0)
        inner->prefix = NULL;
    return orl_parser_read(parser, inner, text, (size_t)size, line, err);
}

/* Reads the object of the current marker, in the scope of the replmarks command. The marker's name,
 * with its own prefixes, becomes the prefix of the object's names. */
static int replace_marker(struct orl_parser *parser, const struct orl_scope *scope,
                          const struct orl_marker *marker, struct orl_error *err)
{
    struct orl_xform_use use = {.modifier = marker->replacement, .n_files = 1};
    char name[ORL_PREFIX_BYTES], primitive[ORL_ERROR_NAME_MAX];
    const int line = parser->primitive.line;
    const int length = snprintf(name, sizeof name, "%s%s%s", scope->prefix ? scope->prefix : "",
                                scope->prefix ? "." : "", parser->primitive.id);
    int code = orl_marker_place(parser, scope, marker->scale, &use.xform, err);
    if (code < 0)
        return code;
    if ((size_t)length >= sizeof name)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT, "its name is too long");
    struct orl_scope inner = enter_use(scope->markers->scope, &use, NULL);
    inner.prefix = name;
    code = marker->compiled ? place_compiled(parser, &inner, marker, line, err)
                            : orl_parser_include(parser, &inner, marker->object, err);
    if (code < 0 && err->file[0] == '\0') {
        snprintf(primitive, sizeof primitive, "polygon %.180s", name);
        orl_error_at(err, scope->file, line, primitive);
    }
    return code;
}

/* Reads files, or the output before '|', with markers replaced; objects are read in the command's
 * scope. */
static int replace_markers(struct run *run, const char *const *words, size_t count,
                           struct orl_error *err)
{
    struct orl_markers *markers = calloc(1, sizeof *markers);
    struct orl_scope inner = *run->scope;
    size_t used = 0;
    if (!markers)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    inner.outer = run->scope;
    inner.markers = markers;
    inner.since = orl_xform_identity;
    markers->scope = run->scope;
    markers->replace = replace_marker;
    int code = orl_markers_read(markers, words + 1, count - 1, &used, err);
    if (code == 0 && (run->stage == 0) != (used + 1 < count))
        code = orl_error_set(err, ORL_ERR_SYNTAX,
                             run->stage == 0 ? "replmarks needs a file to read"
                                             : "replmarks after '|' takes no files");
    if (code == 0 && run->stage > 0) {
        markers->expand = true; /* xform has already expanded the commands that it found */
        code = run_before(run, &inner, err);
    }
    for (size_t i = used + 1; i < count && code == 0; i++)
        code = orl_parser_include(run->parser, &inner, words[i], err);
    free(markers);
    return code;
}

/* ---- Generators ------------------------------------------------------------------------------ */

/* Runs the generator that the words name; stores its output in run->text. */
static int write_text(struct run *run, const struct generator *generator, const char *const *words,
                      size_t count, struct orl_error *err)
{
    struct orl_text *text = &run->text;
    const struct orl_generator_files files = {run, read_arguments};
    if (text->data)
        return 0;
    const struct orl_bsdf_loader *loader = run->parser->sources.loader;
    text->cancel = loader ? loader->cancel : NULL;
    const int code = generator->run ? generator->run(words, count, text, err)
                     : generator->run_with
                         ? generator->run_with(words, count, &files, text, err)
                         : generator->run_in(run->parser, run->scope, words, count, text, err);
    if (code < 0)
        return code;
    if (text->failed)
        return orl_parser_check_cancel(run->parser, err) < 0
                   ? ORL_ERR_CANCELLED
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (text->warnings[0])
        orl_parser_warn(run->parser, "%s:%d: %s", run->scope->file, run->line, text->warnings);
    return 0;
}

static int read_generated(struct run *run, const struct generator *generator, struct orl_error *err)
{
    size_t count;
    const char *const *words = stage_words(run, &count);
    const int code = write_text(run, generator, words, count, err);
    if (code < 0)
        return code;
    if (run->text.object)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "%s writes an OBJ file with -o: pipe it into obj2rad, or remove -o",
                             words[0]);
    return orl_parser_read(run->parser, run->scope, run->text.data, run->text.size, run->line, err);
}

/* Runs obj2rad on a file, or on the output of a generator. */
static int read_object(struct run *run, const char *const *words, size_t count,
                       struct orl_error *err)
{
    const size_t *start = run->command->start;
    const char *const *before = (const char *const *)run->command->words + start[0];
    const struct generator *generator = run->stage == 1 ? find_generator(before[0]) : NULL;
    if (run->stage == 0)
        return orl_parser_obj2rad(run->parser, run->scope, words, count, NULL, 0, err);
    int code = generator ? write_text(run, generator, before, start[1] - start[0], err) : 0;
    if (code == 0 && !run->text.object)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the input of obj2rad is not an OBJ file");
    if (code < 0)
        return code;
    const struct orl_file piped = {.data = run->text.data, .size = run->text.size};
    return orl_parser_obj2rad(run->parser, run->scope, words, count, &piped, run->line, err);
}

static int refuse_command(const char *name, struct orl_error *err)
{
    return orl_error_refuse(
        err, ORL_ERR_UNSUPPORTED,
        "xform, cat, replmarks, obj2rad, genbox, genprism, genblinds, genclock, "
        "genbranch, genrev, genworm, gensurf, gensky, gendaylit, ies2rad, mgf2rad and "
        "pkgBSDF are supported; run others beforehand and include their output",
        "the command '%.80s' is not supported", name);
}

static int run_stage(struct run *run, struct orl_error *err)
{
    size_t count;
    const char *const *words = stage_words(run, &count);
    const struct generator *generator = find_generator(words[0]);
    if (strcmp(words[0], "xform") == 0)
        return orl_xform_expand(words + 1, count - 1, read_arguments, apply_use, run, err);
    if (strcmp(words[0], "cat") == 0)
        return concatenate(run, words, count, err);
    if (strcmp(words[0], "replmarks") == 0)
        return replace_markers(run, words, count, err);
    if (strcmp(words[0], "obj2rad") == 0)
        return read_object(run, words, count, err);
    if (!generator)
        return refuse_command(words[0], err);
    if (run->stage > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED, "%s reads no input: it cannot follow '|'",
                             words[0]);
    return read_generated(run, generator, err);
}

int orl_parser_command(struct orl_parser *parser, const struct orl_scope *scope, const char *line,
                       int number, struct orl_error *err)
{
    struct orl_command command = {0};
    struct orl_scope own = *scope;
    struct run run = {.parser = parser, .command = &command, .scope = &own, .line = number};
    char name[ORL_ERROR_NAME_MAX];
    int code = orl_command_split(&command, line, err);
    if (scope->markers && !scope->markers->expand)
        own.markers = NULL;
    if (code == 0) {
        run.stage = command.n_stages - 1;
        code = run_stage(&run, err);
    }
    orl_text_done(&run.text);
    orl_command_done(&command);
    /* Errors inside the text have their place already. */
    if (code < 0 && err->file[0] == '\0') {
        snprintf(name, sizeof name, "!%.200s", line);
        orl_error_at(err, scope->file, number, name);
    }
    return code;
}
