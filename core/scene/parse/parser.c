#include "scene/parse/parser.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"

enum { WARNINGS_MAX = 100, TEXT_MAX = 640 };

static void set_place(const struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    char name[ORL_ERROR_NAME_MAX];
    snprintf(name, sizeof name, "%.60s %.180s", primitive->type, primitive->id);
    orl_error_at(err, scope->file, primitive->line, name);
}

int orl_parser_fail(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err,
                    int code, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    set_place(parser, scope, err);
    return code;
}

int orl_parser_refuse(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_error *err, int code, const char *hint, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    orl_error_vset(err, code, format, args);
    va_end(args);
    set_place(parser, scope, err);
    orl_error_hint(err, "%s", hint);
    return code;
}

int orl_parser_expect(struct orl_parser *parser, const struct orl_scope *scope, size_t n_strings,
                      size_t n_reals, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    if (primitive->n_strings == n_strings && primitive->n_reals == n_reals)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                           "%.60s takes %zu string and %zu number arguments, not %zu and %zu",
                           primitive->type, n_strings, n_reals, primitive->n_strings,
                           primitive->n_reals);
}

static void add_warning(struct orl_parser *parser, const char *text)
{
    struct orl_parsed_scene *out = parser->out;
    char *copy = orl_arena_copy_text(out->arena, text, strlen(text));
    if (copy && orl_array_reserve(&out->warnings, &parser->warnings_room, out->n_warnings,
                                  sizeof *out->warnings))
        out->warnings[out->n_warnings++] = copy;
}

void orl_parser_warn(struct orl_parser *parser, const char *format, ...)
{
    char text[TEXT_MAX];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    if (parser->out->n_warnings < WARNINGS_MAX)
        add_warning(parser, text);
    else if (parser->out->n_warnings == WARNINGS_MAX)
        add_warning(parser, "further warnings are left out");
}

void orl_parser_tally(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_warning_tally *tally)
{
    if (tally->count++ == 0)
        snprintf(tally->first, sizeof tally->first, "%.20s %.80s at %.100s:%d",
                 parser->primitive.type, parser->primitive.id, scope->file, parser->primitive.line);
}

static void report_tally(struct orl_parser *parser, const struct orl_warning_tally *tally,
                         const char *what)
{
    if (tally->count == 1)
        orl_parser_warn(parser, "%s: %s", tally->first, what);
    else if (tally->count > 1)
        orl_parser_warn(parser, "%s, and %llu others: %s", tally->first,
                        (unsigned long long)tally->count - 1, what);
}

static void report_unused(struct orl_parser *parser)
{
    size_t count;
    const struct orl_deferred_error *first = orl_deferred_unused(&parser->deferred, &count);
    char others[48] = "";
    if (!first)
        return;
    if (count > 1)
        snprintf(others, sizeof others, ", and %zu others like it", count - 1);
    orl_parser_warn(parser, "%.120s at %.100s:%d is ignored because nothing uses it%s: %.200s",
                    first->primitive, first->file, first->line, others, first->message);
}

void orl_parser_report(struct orl_parser *parser)
{
    char nonplanar[192];
    report_unused(parser);
    report_tally(parser, &parser->degenerate, "has no area and was dropped");
    snprintf(nonplanar, sizeof nonplanar,
             "its corners are off a plane by up to %.3g: it is cut into triangles, which all have "
             "its mean normal",
             parser->largest_bend);
    report_tally(parser, &parser->nonplanar, nonplanar);
    report_tally(parser, &parser->unmodified,
                 "has no material (its modifier is void), so light passes through it");
    report_tally(parser, &parser->white,
                 "reflects or transmits all incident light, or more: limited to 0.999 so that "
                 "light paths end (mirrors and clear glass to 1)");
    report_tally(parser, &parser->below, "a share of light is slightly below 0: 0 is used");
}

int orl_parser_string_xform(struct orl_parser *parser, const struct orl_scope *scope, size_t first,
                            struct orl_xform *ret_xform, struct orl_error *err)
{
    enum { WORDS_MAX = 256 };
    const char *words[WORDS_MAX] = {NULL};
    const size_t count = parser->primitive.n_strings - first;
    struct orl_xform own;
    size_t used = 0;
    if (count > WORDS_MAX)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                               "it has too many string arguments");
    for (size_t i = 0; i < count; i++)
        words[i] = orl_primitive_string(&parser->primitive, first + i);
    const int code = orl_xform_read(words, count, &own, &used, err);
    if (code < 0)
        return orl_parser_fail(parser, scope, err, code, "its transform is not valid");
    if (used < count)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "'%.60s' in its transform is not a transform", words[used]);
    *ret_xform = orl_xform_compose(&scope->xform, &own);
    return 0;
}

/* ---- Files ----------------------------------------------------------------------------------- */

int orl_parser_count_text(struct orl_parser *parser, const struct orl_scope *scope, size_t size,
                          struct orl_error *err)
{
    enum { READ_COST = 4096 };
    parser->text_bytes += size + READ_COST;
    if (parser->text_bytes <= ORL_LIMIT_SCENE_TEXT)
        return 0;
    orl_error_set(err, ORL_ERR_LIMIT,
                  "the scene's text, including repeats by xform -a, is longer than %lu MiB",
                  ORL_LIMIT_SCENE_TEXT >> 20);
    orl_error_at(err, scope->file, 0, NULL);
    return ORL_ERR_LIMIT;
}

int orl_parser_check_cancel(const struct orl_parser *parser, struct orl_error *err)
{
    const struct orl_bsdf_loader *loader = parser->sources.loader;
    if (loader && orl_is_cancelled(loader->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while reading the scene");
    return 0;
}

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

int orl_parser_enter(struct orl_parser *parser, struct orl_scope *inner, const char *name,
                     struct orl_file *ret_file, struct orl_error *err)
{
    size_t index = 0;
    int code = orl_sources_find(&parser->sources, inner->folder, name, &index, err);
    if (code < 0)
        return code;
    code = check_nesting(inner, parser->sources.items[index].name, err);
    if (code < 0)
        return code;
    inner->file = parser->sources.items[index].name;
    inner->folder = parser->sources.items[index].folder;
    inner->depth++;
    *ret_file = parser->sources.items[index].file;
    return 0;
}
