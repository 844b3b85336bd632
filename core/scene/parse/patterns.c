/*
 * Patterns of functions: brightfunc and colorfunc. Strings: one expression, or three, the function
 * file or '.', and the transform from the function's coordinates; numbers are arg(1) and on.
 * Reference: "The RADIANCE Synthetic Imaging System", section 2.1.4.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "function/ray_names.h"
#include "scene/material/pattern.h"
#include "scene/parse/parser.h"

/* ---- Function files ---------------------------------------------------------------------------
 */

/* The scene's files as a provider of function files: names are resolved, the source is known. */
static int open_source(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    struct orl_parser *const parser = ctx;
    size_t index = 0;
    const int code = orl_sources_find(&parser->sources, "", name, &index, err);
    if (code == 0)
        *ret_file = parser->sources.items[index].file;
    return code;
}

/* The context of the file that the primitive names. */
static int load(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                int *ret_context, struct orl_error *err)
{
    const struct orl_files files = {.ctx = parser, .open = open_source};
    size_t index = 0;
    *ret_context = ORL_FUNCTION_GLOBAL;
    if (strcmp(name, ".") == 0)
        return 0;
    int code = orl_sources_find(&parser->sources, scope->folder, name, &index, err);
    if (code == 0)
        code = orl_functions_load(parser->functions, &files, parser->sources.items[index].name,
                                  false, ret_context, err);
    else if (code == ORL_ERR_NOT_FOUND)
        code = orl_functions_load(parser->functions, NULL, name, false, ret_context, err);
    return code;
}

/* ---- Programs ---------------------------------------------------------------------------------
 */

/* The place of a pattern, from the transform to the world. */
static void place_pattern(struct orl_pattern *pattern, const struct orl_xform *to_world)
{
    const struct orl_vec3 *const r = to_world->row;
    const double square = to_world->scale * to_world->scale;
    pattern->row[0] = orl_scale(orl_v3(r[0].x, r[1].x, r[2].x), 1 / square);
    pattern->row[1] = orl_scale(orl_v3(r[0].y, r[1].y, r[2].y), 1 / square);
    pattern->row[2] = orl_scale(orl_v3(r[0].z, r[1].z, r[2].z), 1 / square);
    for (int i = 0; i < 3; i++)
        (&pattern->offset.x)[i] = -orl_dot(pattern->row[i], to_world->offset);
    pattern->scale = to_world->scale;
}

/* The world as the function sees it: the same everywhere. */
static void fix_inputs(const struct orl_pattern *pattern, double ret_fixed[ORL_RAY_INPUTS])
{
    for (int i = 0; i < ORL_RAY_INPUTS; i++)
        ret_fixed[i] = NAN;
    ret_fixed[ORL_RAY_S] = 1 / pattern->scale;
    ret_fixed[ORL_RAY_TX] = pattern->offset.x;
    ret_fixed[ORL_RAY_TY] = pattern->offset.y;
    ret_fixed[ORL_RAY_TZ] = pattern->offset.z;
    for (int i = 0; i < 3; i++) {
        ret_fixed[ORL_RAY_IX + i] = pattern->row[i].x * pattern->scale;
        ret_fixed[ORL_RAY_JX + i] = pattern->row[i].y * pattern->scale;
        ret_fixed[ORL_RAY_KX + i] = pattern->row[i].z * pattern->scale;
    }
}

/* Patterns of the place and the normal are simulated; those of the ray are not. */
static int check_inputs(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_function *function, struct orl_error *err)
{
    const uint64_t inputs = orl_function_inputs(function);
    for (int i = 0; i < ORL_RAY_INPUTS; i++) {
        if (!(inputs >> i & 1) || (i >= ORL_RAY_NX && i <= ORL_RAY_PZ))
            continue;
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        "its function asks for %s: patterns of the place (Px Py Pz) and the normal "
                        "(Nx Ny Nz) alone are simulated",
                        orl_function_ray_names[i]);
        orl_error_hint(err, "leave what depends on the ray out of it");
        return ORL_ERR_UNSUPPORTED;
    }
    return 0;
}

static int compile(struct orl_parser *parser, const struct orl_scope *scope,
                   struct orl_pattern *pattern, size_t n, struct orl_error *err)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    double fixed[ORL_RAY_INPUTS];
    const char *expressions[3];
    struct orl_function_request request = {.expressions = expressions,
                                           .n_expressions = n,
                                           .arguments = primitive->reals,
                                           .n_arguments = primitive->n_reals,
                                           .fixed = fixed,
                                           .file = scope->file,
                                           .line = primitive->line};
    for (size_t i = 0; i < n; i++)
        expressions[i] = orl_primitive_string(primitive, i);
    fix_inputs(pattern, fixed);
    int code = load(parser, scope, orl_primitive_string(primitive, n), &request.context, err);
    if (code == 0)
        code = orl_function_compile(parser->functions, &request, &pattern->function, err);
    if (code == 0)
        return check_inputs(parser, scope, pattern->function, err);
    const bool has_place = err->file[0] != '\0';
    orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : primitive->line,
                 pattern->name);
    return code;
}

/* ---- Definitions ------------------------------------------------------------------------------
 */

/* All that makes the pattern what it is: two definitions of the same are one. */
static int make_key(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct orl_xform *to_world, struct orl_pattern *pattern)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    const size_t reals = primitive->n_reals * sizeof *primitive->reals;
    const size_t folder = strlen(scope->folder) + 1;
    const double numbers[12] = {to_world->row[0].x, to_world->row[0].y, to_world->row[0].z,
                                to_world->row[1].x, to_world->row[1].y, to_world->row[1].z,
                                to_world->row[2].x, to_world->row[2].y, to_world->row[2].z,
                                to_world->offset.x, to_world->offset.y, to_world->offset.z};
    size_t strings = 0;
    for (size_t i = 0; i < primitive->n_strings; i++)
        strings += strlen(orl_primitive_string(primitive, i)) + 1;
    unsigned char *at =
        orl_arena_take(parser->out->arena, sizeof numbers + reals + folder + strings + 1);
    if (!at)
        return ORL_ERR_NOMEM;
    pattern->key = at;
    pattern->key_size = sizeof numbers + reals + folder + strings + 1;
    memcpy(at, numbers, sizeof numbers);
    at += sizeof numbers;
    if (reals)
        memcpy(at, primitive->reals, reals);
    at += reals;
    memcpy(at, scope->folder, folder);
    at += folder;
    for (size_t i = 0; i < primitive->n_strings; i++) {
        const size_t length = strlen(orl_primitive_string(primitive, i)) + 1;
        memcpy(at, orl_primitive_string(primitive, i), length);
        at += length;
    }
    *at = pattern->coloured;
    return 0;
}

static bool same_pattern(const struct orl_pattern *a, const struct orl_pattern *b)
{
    return a->key_size == b->key_size && memcmp(a->key, b->key, a->key_size) == 0;
}

/* Takes the pattern, whatever happens. */
static int define(struct orl_parser *parser, struct orl_pattern *pattern, const char *id)
{
    struct orl_description *const out = parser->out;
    struct orl_symbol symbol = {.kind = ORL_SYMBOL_PATTERN, .index = (uint32_t)out->n_patterns};
    symbol.name = orl_arena_text(out->arena, id, strlen(id));
    if (!symbol.name || out->n_patterns >= UINT32_MAX ||
        !orl_grow(&out->patterns, &parser->patterns_room, out->n_patterns,
                  sizeof(struct orl_pattern *))) {
        orl_pattern_free(pattern);
        return ORL_ERR_NOMEM;
    }
    pattern->index = symbol.index;
    out->patterns[out->n_patterns++] = pattern;
    return orl_symbols_set(&parser->symbols, symbol);
}

static int begin(struct orl_parser *parser, const struct orl_scope *scope,
                 struct orl_pattern *pattern)
{
    char name[ORL_ERROR_NAME_MAX];
    snprintf(name, sizeof name, "%.40s %.200s", parser->primitive.type, parser->primitive.id);
    if (!parser->functions)
        parser->functions = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    pattern->name = orl_arena_text(parser->out->arena, name, strlen(name));
    pattern->file = scope->file;
    pattern->line = parser->primitive.line;
    return parser->functions && pattern->name ? 0 : ORL_ERR_NOMEM;
}

int orl_parser_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    const struct orl_symbol *const old = orl_symbols_find(&parser->symbols, primitive->id);
    const bool coloured = strcmp(primitive->type, "colorfunc") == 0;
    const size_t n = coloured ? 3 : 1;
    struct orl_xform to_world = orl_xform_identity;
    if (primitive->n_strings < n + 1)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "%s takes %s and a function file ('.': none), and perhaps a "
                               "transform; here are %zu string arguments",
                               primitive->type, coloured ? "three expressions" : "an expression",
                               primitive->n_strings);
    int code = orl_parser_string_xform(parser, scope, n + 1, &to_world, err);
    struct orl_pattern *const pattern = code == 0 ? calloc(1, sizeof *pattern) : NULL;
    if (code < 0)
        return code;
    if (!pattern)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    pattern->coloured = coloured;
    place_pattern(pattern, &to_world);
    code = begin(parser, scope, pattern);
    if (code == 0)
        code = make_key(parser, scope, &to_world, pattern);
    if (code == 0 && old && old->kind == ORL_SYMBOL_PATTERN &&
        same_pattern(parser->out->patterns[old->index], pattern)) {
        orl_pattern_free(pattern);
        code = orl_symbols_set(&parser->symbols, *old);
    } else {
        if (code == 0)
            code = compile(parser, scope, pattern, n, err);
        if (code < 0)
            orl_pattern_free(pattern);
        else
            code = define(parser, pattern, primitive->id);
    }
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory") : code;
}
