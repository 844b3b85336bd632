/*
 * Programs of patterns: their function files, the compiled expressions, and the grids that they
 * interpolate.
 */
#include "scene/parse/pattern/pattern_readers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "function/function.h"
#include "scene/surfaces.h"

enum { MOST_EXPRESSIONS = 8 }; /* largest number of any type: prism2's */

/* ---- Function files -------------------------------------------------------------------------- */

/* Finds a function file. The standard ones that nearly all scenes use are built in, but the scene's
 * own files come first; the user's library is not searched for them, so that scenes render the same
 * everywhere. */
static int find_functions(struct orl_parser *parser, const char *folder, const char *name,
                          size_t *ret_index, struct orl_error *err)
{
    return orl_standard_text(name)
               ? orl_sources_find_own(&parser->sources, folder, name, ret_index, err)
               : orl_sources_find(&parser->sources, folder, name, ret_index, err);
}

/* Provider of function files from the scene's sources, for names that are already resolved. */
static int open_source(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    struct orl_parser *const parser = ctx;
    size_t index = 0;
    const int code = find_functions(parser, "", name, &index, err);
    if (code == 0)
        *ret_file = parser->sources.items[index].file;
    return code;
}

/* Loads the function file that the primitive names; *ret_context: its context. */
static int load_context(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                        int *ret_context, struct orl_error *err)
{
    const struct orl_files files = {.ctx = parser, .open = open_source};
    struct orl_error missing = {0};
    size_t index = 0;
    *ret_context = ORL_FUNCTION_GLOBAL;
    if (strcmp(name, ".") == 0)
        return 0;
    const int code = find_functions(parser, scope->folder, name, &index, &missing);
    if (code == 0)
        return orl_functions_load(parser->functions, &files, parser->sources.items[index].name,
                                  false, ret_context, err);
    if (code == ORL_ERR_NOT_FOUND)
        return orl_functions_load(parser->functions, NULL, name, false, ret_context, err);
    *err = missing;
    return code;
}

/* ---- Programs -------------------------------------------------------------------------------- */

/* Sets the pattern's frame by inverting its transform to the scene. */
static void place_pattern(struct orl_pattern *pattern, const struct orl_xform *to_world)
{
    const struct orl_xform back = orl_xform_inverse(to_world);
    memcpy(pattern->row, back.row, sizeof back.row);
    pattern->offset = back.offset;
    pattern->scale = to_world->scale;
}

/* Sets the inputs that depend only on the pattern's frame, which are constant; others are NaN. */
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

/* Returns true for inputs that only functions of materials have: those oriented to the front, the
 * colour, the light. */
static bool is_function_brdf_input(enum orl_pattern_role role, int i)
{
    if (role == ORL_PATTERN_LOBES)
        return (i >= ORL_RAY_NXP && i <= ORL_RAY_CBP) ||
               (i >= ORL_RAY_LIGHT_X && i <= ORL_RAY_LIGHT_Z);
    return role == ORL_PATTERN_GLAZING && i == ORL_RAY_RDOTP;
}

/* Refuses inputs other than the place, the normal and the direction. */
static int check_inputs(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_function *function,
                        struct orl_error *err)
{
    const uint64_t inputs = orl_function_inputs(function);
    for (int i = 0; i < ORL_RAY_INPUTS; i++) {
        const bool directed = i == ORL_RAY_RDOT || (i >= ORL_RAY_DX && i <= ORL_RAY_DZ);
        const bool uses_mesh_uv = i == ORL_RAY_LU || i == ORL_RAY_LV;
        const bool oriented = is_function_brdf_input(pattern->role, i);
        const bool placed = oriented || uses_mesh_uv || (i >= ORL_RAY_NX && i <= ORL_RAY_PZ);
        const bool data =
            i >= ORL_RAY_DATA && i <= ORL_RAY_DATA_3 && function == pattern->program.values;
        if (inputs >> i & 1)
            pattern->uses_mesh_uv = pattern->uses_mesh_uv || uses_mesh_uv;
        if (!(inputs >> i & 1) || placed || data)
            continue;
        pattern->directed = pattern->directed || directed;
        if (directed)
            continue;
        return orl_parser_refuse(
            parser, scope, err, ORL_ERR_UNSUPPORTED,
            "remove terms that depend on the ray's length or similar values",
            "its function uses %s: patterns may use only the point (Px Py Pz, Lu Lv), "
            "the normal (Nx Ny Nz), and on light sources the direction",
            orl_function_ray_names[i]);
    }
    return 0;
}

/* Glazing may depend on the angle only. */
static int check_angles(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_pattern *pattern, struct orl_error *err)
{
    const uint64_t inputs = orl_function_inputs(pattern->program.function);
    for (int i = 0; i < ORL_RAY_INPUTS; i++) {
        if (!(inputs >> i & 1) || i == ORL_RAY_RDOT || i == ORL_RAY_RDOTP)
            continue;
        return orl_parser_refuse(
            parser, scope, err, ORL_ERR_UNSUPPORTED, "describe it as a BSDF",
            "its function uses %s: glazing may depend only on the angle (Rdot, RdotP)",
            orl_function_ray_names[i]);
    }
    return 0;
}

/* Compiles a program of n expressions. */
static int compile_program(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_pattern *pattern, int context, const char *const *expressions,
                           size_t n, struct orl_function **ret_function, struct orl_error *err)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    double fixed[ORL_RAY_INPUTS];
    const struct orl_function_request request = {.context = context,
                                                 .expressions = expressions,
                                                 .n_expressions = n,
                                                 .arguments = primitive->reals,
                                                 .n_arguments = primitive->n_reals,
                                                 .fixed = fixed,
                                                 .file = scope->file,
                                                 .line = primitive->line};
    fix_inputs(pattern, fixed);
    const int code = orl_function_compile(parser->functions, &request, ret_function, err);
    return code < 0 ? code : check_inputs(parser, scope, pattern, *ret_function, err);
}

/*
 * Compiles the functions that map grid values to factors. The first function, and those of three
 * arguments, take all channels; the others take their own.
 */
static int compile_values(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_pattern *pattern, int context, size_t first,
                          struct orl_error *err)
{
    const bool texture = pattern->role == ORL_PATTERN_TEXTURE;
    const bool channels = pattern->is_rgb || pattern->program.grids[0]->channels > 1;
    const size_t n = pattern->is_rgb ? ORL_GRID_CHANNELS : 1;
    char *texts[ORL_GRID_CHANNELS] = {NULL};
    int code = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        const char *const name = orl_primitive_string(&parser->primitive, first + i);
        const char *const *const data = orl_function_ray_names + ORL_RAY_DATA;
        const size_t room = strlen(name) + 64;
        texts[i] = malloc(room);
        if (!texts[i])
            code = ORL_ERR_NOMEM;
        else if (!channels ||
                 ((i > 0 || texture) && orl_functions_arity(parser->functions, context, name) < n))
            snprintf(texts[i], room, "%s(%s)", name, data[texture ? 0 : i]);
        else
            snprintf(texts[i], room, "%s(%s,%s,%s)", name, data[0], data[1], data[2]);
    }
    if (code == 0)
        code = compile_program(parser, scope, pattern, context, (const char *const *)texts, n,
                               &pattern->program.values, err);
    for (size_t i = 0; i < n; i++)
        free(texts[i]);
    return code;
}

/* Compiles a function of the wavelength; with a grid, of the grid's value and the wavelength. */
static int compile_spectral(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_pattern *pattern, int context, const char *name,
                            struct orl_error *err)
{
    const char *const *const data = orl_function_ray_names + ORL_RAY_DATA;
    const size_t room = strlen(name) + 64;
    char *const text = malloc(room);
    if (!text)
        return ORL_ERR_NOMEM;
    if (pattern->program.n_grids > 0)
        snprintf(text, room, "%s(%s,%s)", name, data[1], data[0]);
    else
        snprintf(text, room, "%s(%s)", name, data[0]);
    const char *const expression = text;
    const int code = compile_program(parser, scope, pattern, context, &expression, 1,
                                     &pattern->program.values, err);
    free(text);
    return code;
}

/* Returns a call of a function or variable with as many of the arguments as it takes; the caller
 * frees it. */
static char *call_text(const struct orl_parser *parser, int context, const char *name,
                       const char *const *arguments, size_t n)
{
    const uint32_t takes = orl_functions_arity(parser->functions, context, name);
    const size_t length = strlen(name), most = takes < n ? takes : n;
    size_t room = length + 3;
    for (size_t i = 0; i < most; i++)
        room += strlen(arguments[i]) + 1;
    char *const text = malloc(room);
    if (!text)
        return NULL;
    size_t at = (size_t)snprintf(text, room, "%s", name);
    for (size_t i = 0; i < most; i++)
        at += (size_t)snprintf(text + at, room - at, "%c%s", i ? ',' : '(', arguments[i]);
    snprintf(text + at, room - at, "%s", most > 0 ? ")" : "");
    return text;
}

/*
 * Compiles functions of the light's direction and of its solid angle, which is passed as 0. With
 * data these are the coordinates, and the function takes the data's value as first argument.
 */
static int compile_lobes(struct orl_parser *parser, const struct orl_scope *scope,
                         struct orl_pattern *pattern, int context,
                         const struct orl_pattern_strings *strings, struct orl_error *err)
{
    const char *const *const light = orl_function_ray_names + ORL_RAY_LIGHT_X;
    const char *const arguments[] = {orl_function_ray_names[ORL_RAY_DATA], light[0], light[1],
                                     light[2], "0"};
    const bool data = pattern->program.n_grids > 0;
    const size_t first = data ? strings->file + 1 : strings->functions;
    char *texts[MOST_EXPRESSIONS + 1] = {NULL};
    int code = 0;
    for (size_t i = 0; i < strings->n; i++)
        texts[i] = call_text(parser, context, orl_primitive_string(&parser->primitive, first + i),
                             arguments + 1, 4);
    if (data)
        texts[strings->n] =
            call_text(parser, context, orl_primitive_string(&parser->primitive, strings->functions),
                      arguments, 5);
    for (size_t i = 0; i < strings->n + data; i++)
        if (!texts[i])
            code = ORL_ERR_NOMEM;
    if (code == 0)
        code = compile_program(parser, scope, pattern, context, (const char *const *)texts,
                               strings->n, &pattern->program.function, err);
    if (code == 0 && data)
        code = compile_program(parser, scope, pattern, context,
                               (const char *const *)texts + strings->n, 1, &pattern->program.values,
                               err);
    for (size_t i = 0; i < strings->n + data; i++)
        free(texts[i]);
    return code;
}

int orl_pattern_compile(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_xform *to_world,
                        const struct orl_pattern_strings *strings, struct orl_error *err)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    const size_t first = pattern->program.n_grids > 0 ? strings->file + 1 : strings->functions;
    const size_t n = strings->n;
    const char *expressions[MOST_EXPRESSIONS];
    int context = ORL_FUNCTION_GLOBAL;
    place_pattern(pattern, to_world);
    /* A picture's first coordinate points right, which is the grid's second axis. */
    const bool picture = pattern->program.n_grids > 0 && pattern->program.grids[0]->channels > 1;
    for (size_t i = 0; i < n; i++)
        expressions[i] = orl_primitive_string(primitive, first + (picture ? n - 1 - i : i));
    int code =
        load_context(parser, scope, orl_primitive_string(primitive, strings->file), &context, err);
    if (code == 0 && pattern->role == ORL_PATTERN_LOBES)
        code = compile_lobes(parser, scope, pattern, context, strings, err);
    else if (code == 0 && (!strings->spectral || pattern->program.n_grids > 0))
        code = compile_program(parser, scope, pattern, context, expressions, n,
                               &pattern->program.function, err);
    if (code == 0 && pattern->role == ORL_PATTERN_GLAZING)
        code = check_angles(parser, scope, pattern, err);
    if (code == 0 && strings->spectral)
        code = compile_spectral(parser, scope, pattern, context,
                                orl_primitive_string(primitive, strings->functions), err);
    else if (code == 0 && pattern->program.n_grids > 0 && pattern->role != ORL_PATTERN_LOBES)
        code = compile_values(parser, scope, pattern, context, strings->functions, err);
    if (code == 0 || code == ORL_ERR_NOMEM)
        return code;
    const bool has_place = err->file[0] != '\0';
    orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : primitive->line,
                 pattern->name);
    return code;
}

/* ---- Grids ----------------------------------------------------------------------------------- */

/* Returns a grid that was read before; each file is read once per kind (picture or data). */
static struct orl_grid *find_grid(const struct orl_parsed_scene *out, size_t source, bool picture)
{
    for (size_t i = 0; i < out->n_grids; i++)
        if (out->grids[i]->source == source && (out->grids[i]->channels > 1) == picture)
            return out->grids[i];
    return NULL;
}

static size_t values_of(const struct orl_parsed_scene *out)
{
    size_t values = 0;
    for (size_t i = 0; i < out->n_grids; i++)
        values += out->grids[i]->n_values;
    return values;
}

static int read_grid(struct orl_parser *parser, size_t source, bool picture,
                     struct orl_grid **ret_grid, struct orl_error *err)
{
    struct orl_parsed_scene *const out = parser->out;
    const struct orl_source *const s = &parser->sources.items[source];
    struct orl_grid *grid = NULL;
    int code = picture ? orl_grid_read_picture(s->name, s->file.data, s->file.size, &grid, err)
                       : orl_grid_read_data(s->name, s->file.data, s->file.size, &grid, err);
    if (code < 0)
        return code;
    if (grid->n_values > ORL_SCENE_GRID_VALUES - values_of(out)) {
        orl_grid_free(grid);
        code = orl_error_set(err, ORL_ERR_LIMIT,
                             "the scene's pictures and data files hold more than %lu M numbers",
                             ORL_SCENE_GRID_VALUES >> 20);
        orl_error_at(err, s->name, 0, NULL);
        return code;
    }
    if (!orl_array_reserve(&out->grids, &parser->grids_room, out->n_grids,
                           sizeof(struct orl_grid *))) {
        orl_grid_free(grid);
        return ORL_ERR_NOMEM;
    }
    grid->source = source;
    out->grids[out->n_grids++] = grid;
    *ret_grid = grid;
    return 0;
}

int orl_pattern_grid(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                     bool picture, const struct orl_grid **ret_grid, struct orl_error *err)
{
    size_t source = 0;
    int code = orl_sources_find(&parser->sources, scope->folder, name, &source, err);
    struct orl_grid *grid = code == 0 ? find_grid(parser->out, source, picture) : NULL;
    if (code == 0 && !grid)
        code = read_grid(parser, source, picture, &grid, err);
    if (code < 0 && code != ORL_ERR_NOMEM) {
        char primitive[ORL_ERROR_NAME_MAX];
        const bool has_place = err->file[0] != '\0';
        snprintf(primitive, sizeof primitive, "%.40s %.200s", parser->primitive.type,
                 parser->primitive.id);
        orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : parser->primitive.line,
                     primitive);
    }
    *ret_grid = grid;
    return code;
}
