/*
 * Patterns by name: brightfunc, colorfunc, brightdata, colordata, colorpict; spectra (spectra.c):
 * spectrum, specfile, specfunc, specdata, specpict; texts (lettering_reader.c): brighttext,
 * colortext; textures: texfunc, texdata; and mixtures of materials: mixfunc, mixdata, mixpict,
 * mixtext. Strings: two materials (mixtures); one function, or three; files (grids); the function
 * file or
 * '.'; an expression for each coordinate (grids); and the transform from the function's
 * coordinates. Numbers are arg(1) and on. Reference: "The RADIANCE Synthetic Imaging System",
 * section 2.1.4.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "function/function.h"
#include "scene/parse/pattern/pattern_readers.h"

struct pattern_type {
    const char *name;
    size_t n_functions, n_files; /* number of functions of factors; of grid files */
    bool picture;
    size_t n_materials; /* number of mixed materials, which come first */
    bool spectral;
    bool text;
    enum orl_pattern_role role; /* of mixtures: ORL_PATTERN_FACTOR */
    /* other strings before the functions, and between them and the function file */
    size_t n_before, n_between;
};

static const struct pattern_type pattern_types[] = {
    {.name = "brightfunc", .n_functions = 1},
    {.name = "colorfunc", .n_functions = 3},
    {.name = "brightdata", .n_functions = 1, .n_files = 1},
    {.name = "colordata", .n_functions = 3, .n_files = 3},
    {.name = "colorpict", .n_functions = 3, .n_files = 1, .picture = true},
    {.name = "spectrum", .spectral = true},
    {.name = "specfile", .n_files = 1, .spectral = true},
    {.name = "specfunc", .n_functions = 1, .spectral = true},
    {.name = "specdata", .n_functions = 1, .n_files = 1, .spectral = true},
    {.name = "specpict", .n_functions = 1, .n_files = 1, .spectral = true},
    {.name = "mixfunc", .n_functions = 1, .n_materials = 2},
    {.name = "mixdata", .n_functions = 1, .n_files = 1, .n_materials = 2},
    {.name = "mixpict", .n_functions = 1, .n_files = 1, .picture = true, .n_materials = 2},
    {.name = "brighttext", .text = true},
    {.name = "colortext", .text = true},
    {.name = "mixtext", .text = true, .n_materials = 2},
    {.name = "BRTDfunc",
     .n_functions = ORL_PATTERN_ANGLES,
     .role = ORL_PATTERN_GLAZING,
     .n_between = 3},
    {.name = "BRTDfunc",
     .n_functions = 3,
     .role = ORL_PATTERN_LOBES,
     .n_before = ORL_PATTERN_ANGLES},
    {.name = "prism1", .n_functions = 4, .role = ORL_PATTERN_PRISM},
    {.name = "prism2", .n_functions = 8, .role = ORL_PATTERN_PRISM},
    {.name = "plasfunc", .n_functions = 1, .role = ORL_PATTERN_LOBES},
    {.name = "metfunc", .n_functions = 1, .role = ORL_PATTERN_LOBES},
    {.name = "transfunc", .n_functions = 1, .role = ORL_PATTERN_LOBES},
    {.name = "plasdata", .n_functions = 1, .n_files = 1, .role = ORL_PATTERN_LOBES},
    {.name = "metdata", .n_functions = 1, .n_files = 1, .role = ORL_PATTERN_LOBES},
    {.name = "transdata", .n_functions = 1, .n_files = 1, .role = ORL_PATTERN_LOBES},
    {.name = "texfunc", .n_functions = 3, .role = ORL_PATTERN_TEXTURE},
    {.name = "texdata", .n_functions = 3, .n_files = 3, .role = ORL_PATTERN_TEXTURE},
};

/* Returns true for functions of a material, which are not patterns. */
static bool is_function_brdf(enum orl_pattern_role role)
{
    return role == ORL_PATTERN_GLAZING || role == ORL_PATTERN_PRISM || role == ORL_PATTERN_LOBES;
}

/* Finds a pattern, texture or mixture. */
static const struct pattern_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof pattern_types / sizeof *pattern_types; i++)
        if (!is_function_brdf(pattern_types[i].role) && strcmp(pattern_types[i].name, name) == 0)
            return pattern_types + i;
    return NULL;
}

/* Finds the functions of a material in that role. */
static const struct pattern_type *find_function_brdf(const char *name, enum orl_pattern_role role)
{
    for (size_t i = 0; i < sizeof pattern_types / sizeof *pattern_types; i++)
        if (pattern_types[i].role == role && strcmp(pattern_types[i].name, name) == 0)
            return pattern_types + i;
    return NULL;
}

bool orl_parser_is_pattern(const char *type)
{
    return find_type(type) != NULL;
}

bool orl_parser_is_mixture(const char *type)
{
    const struct pattern_type *const found = find_type(type);
    return found && found->n_materials > 0;
}

/* ---- Definitions ----------------------------------------------------------------------------- */

/* Makes the key of all properties of the pattern; definitions with equal keys share one pattern. */
static int make_key(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct pattern_type *type, const struct orl_xform *to_world,
                    struct orl_pattern *pattern)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    const size_t reals = primitive->n_reals * sizeof *primitive->reals;
    const size_t folder = strlen(scope->folder) + 1;
    double numbers[14 + 8] = {[12] = pattern->under ? pattern->under->index + 1.0 : 0,
                              [13] = pattern->other ? pattern->other->index + 1.0 : 0};
    memcpy(numbers, to_world->row, sizeof to_world->row);
    memcpy(numbers + 9, &to_world->offset, sizeof to_world->offset);
    for (size_t i = 0; pattern->role == ORL_PATTERN_BLEND && i < 2; i++) {
        const struct orl_mixed *const m = &orl_blend_of(pattern)->mixed[i];
        const double numbers_of_material[4] = {m->color.r, m->color.g, m->color.b,
                                               m->pattern ? m->pattern->index + 1.0 : 0};
        memcpy(numbers + 14 + 4 * i, numbers_of_material, sizeof numbers_of_material);
    }
    size_t strings = 0;
    for (size_t i = 0; i < primitive->n_strings; i++)
        strings += strlen(orl_primitive_string(primitive, i)) + 1;
    unsigned char *at =
        orl_arena_alloc(parser->out->arena, sizeof numbers + reals + folder + strings + 1);
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
    *at = (unsigned char)((unsigned)type->role << 5 | (unsigned)type->text << 4 |
                          (unsigned)type->spectral << 3 | (unsigned)pattern->program.n_grids << 1 |
                          (unsigned)pattern->is_rgb);
    return 0;
}

int orl_parser_add_pattern(struct orl_parser *parser, struct orl_pattern *pattern)
{
    struct orl_parsed_scene *const out = parser->out;
    if (out->n_patterns >= UINT32_MAX ||
        !orl_array_reserve(&out->patterns, &parser->patterns_room, out->n_patterns,
                           sizeof(struct orl_pattern *))) {
        orl_pattern_free(pattern);
        return ORL_ERR_NOMEM;
    }
    pattern->index = (uint32_t)out->n_patterns;
    out->patterns[out->n_patterns++] = pattern;
    return 0;
}

/* Adds the pattern to the parsed scene, and defines a name for it. */
static int define_pattern(struct orl_parser *parser, struct orl_pattern *pattern, const char *id)
{
    struct orl_symbol symbol = {.kind = ORL_SYMBOL_PATTERN};
    const int code = orl_parser_add_pattern(parser, pattern);
    if (code < 0)
        return code;
    symbol.index = pattern->index;
    symbol.name = orl_arena_copy_text(parser->out->arena, id, strlen(id));
    return symbol.name ? orl_symbols_set(&parser->symbols, symbol) : ORL_ERR_NOMEM;
}

static int begin_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                         struct orl_pattern *pattern)
{
    char name[ORL_ERROR_NAME_MAX];
    snprintf(name, sizeof name, "%.40s %.200s", parser->primitive.type, parser->primitive.id);
    if (!parser->functions)
        parser->functions = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    pattern->name = orl_arena_copy_text(parser->out->arena, name, strlen(name));
    pattern->file = scope->file;
    pattern->line = parser->primitive.line;
    return parser->functions && pattern->name ? 0 : ORL_ERR_NOMEM;
}

/* Finds the grids of the primitive's files; *ret_axes: their number of coordinates. */
static int find_grids(struct orl_parser *parser, const struct orl_scope *scope,
                      const struct pattern_type *type, struct orl_pattern *pattern,
                      size_t *ret_axes, struct orl_error *err)
{
    int code = 0;
    *ret_axes = 0;
    for (size_t i = 0; i < type->n_files && code == 0; i++) {
        const char *const name =
            orl_primitive_string(&parser->primitive, type->n_materials + type->n_functions + i);
        code =
            orl_pattern_grid(parser, scope, name, type->picture, &pattern->program.grids[i], err);
        if (code < 0)
            return code;
        if (i > 0 && pattern->program.grids[i]->n_axes != *ret_axes)
            return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                                   "its data files have different numbers of axes");
        *ret_axes = pattern->program.grids[i]->n_axes;
    }
    pattern->program.n_grids = (uint32_t)type->n_files;
    return code;
}

/* Returns a material's functions in that role, or those of the first of its mixed materials that
 * has any. */
static struct orl_pattern *function_brdf_of(const struct orl_material *material,
                                            enum orl_pattern_role role)
{
    const struct orl_material *const mixed = orl_material_mixed(material);
    struct orl_pattern *found = NULL;
    if (role == ORL_PATTERN_GLAZING && material->kind == ORL_MATERIAL_GLAZING)
        found = orl_glazing_of(material)->angles;
    if (role == ORL_PATTERN_PRISM && material->kind == ORL_MATERIAL_PRISM)
        found = orl_prism_of(material)->rays;
    if (role == ORL_PATTERN_LOBES && material->kind == ORL_MATERIAL_FUNCTION_LOBES)
        found = orl_function_lobes_of(material)->functions;
    for (int i = 0; mixed && i < 2 && !found; i++)
        found = function_brdf_of(&mixed[i], role);
    return found;
}

/* Returns the pattern of a mixture's shares, or NULL. */
static struct orl_pattern *share_of(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_MIXTURE ? orl_mixture_of(material)->share : NULL;
}

/* Returns an equal one that was defined before, or NULL. */
static const struct orl_symbol *find_same(const struct orl_parser *parser,
                                          const struct pattern_type *type,
                                          const struct orl_pattern *pattern, bool of_material)
{
    const bool blend = pattern->role == ORL_PATTERN_BLEND;
    const bool share = type->n_materials > 0 && !blend;
    const struct orl_symbol *const old = orl_symbols_find(&parser->symbols, parser->primitive.id);
    const struct orl_pattern *other = NULL;
    if (old && old->kind == ORL_SYMBOL_MATERIAL && is_function_brdf(type->role))
        other = function_brdf_of(&parser->out->materials[old->index], type->role);
    if (old && old->kind == ORL_SYMBOL_MATERIAL && share)
        other = share_of(&parser->out->materials[old->index]);
    if (old && old->kind == ORL_SYMBOL_PATTERN && type->n_materials == 0 && !of_material)
        other = parser->out->patterns[old->index];
    if (old && old->kind == ORL_SYMBOL_MATERIAL && (blend || of_material))
        other = pattern->role == ORL_PATTERN_TEXTURE ? parser->out->materials[old->index].texture
                                                     : parser->out->materials[old->index].pattern;
    return other && other->key_size == pattern->key_size &&
                   memcmp(other->key, pattern->key, other->key_size) == 0
               ? old
               : NULL;
}

/* Returns true if the pattern is constant: it has no function. */
static bool is_fixed(const struct pattern_type *type)
{
    return type->n_functions == 0 && !type->text;
}

static bool is_coloured(struct orl_rgb color)
{
    return color.r != color.g || color.g != color.b;
}

static void inherit_properties(struct orl_pattern *pattern, const struct orl_pattern *other)
{
    pattern->steps += other ? other->steps : 0;
    pattern->coloured = pattern->coloured || (other && other->coloured);
    pattern->directed = pattern->directed || (other && other->directed);
}

/* Sets the fields that depend on the patterns under it; checks the limit of steps. */
static int combine_properties(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_pattern *pattern, struct orl_error *err)
{
    const bool texture = pattern->role == ORL_PATTERN_TEXTURE;
    pattern->steps = 1;
    pattern->coloured = pattern->coloured || pattern->is_rgb;
    if (pattern->source == ORL_PATTERN_SPECTRUM)
        pattern->steps += orl_spectrum_of(pattern)->n_bands / ORL_FUNCTION_LANES;
    if (pattern->source == ORL_PATTERN_CONSTANT)
        pattern->coloured = pattern->coloured || is_coloured(orl_constant_of(pattern));
    if (pattern->source == ORL_PATTERN_TEXT)
        pattern->coloured = pattern->coloured || is_coloured(orl_text_of(pattern)->inside);
    inherit_properties(pattern, pattern->under);
    for (int i = 0; pattern->role == ORL_PATTERN_BLEND && i < 2; i++) {
        const struct orl_mixed *const mixed = &orl_blend_of(pattern)->mixed[i];
        inherit_properties(pattern, mixed->pattern);
        pattern->coloured = pattern->coloured || is_coloured(mixed->color);
    }
    /* Textures have no colour, and their dependence on direction needs no support by the
     * material. */
    pattern->directed = pattern->directed && !texture;
    pattern->coloured = pattern->coloured && !texture;
    if (pattern->steps <= ORL_PATTERN_STEPS)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                           "it and the patterns that it depends on have more than %d functions",
                           ORL_PATTERN_STEPS);
}

/* read_pattern for texts. */
static int read_text(struct orl_parser *parser, const struct orl_scope *scope,
                     const struct pattern_type *type, struct orl_pattern *pattern, bool of_material,
                     const struct orl_symbol **ret_same, struct orl_error *err)
{
    int code = begin_pattern(parser, scope, pattern);
    if (code == 0)
        code = make_key(parser, scope, type, &scope->xform, pattern);
    *ret_same = code == 0 ? find_same(parser, type, pattern, of_material) : NULL;
    if (code < 0 || *ret_same)
        return code;
    code = orl_lettering_read(parser, scope, pattern, type->n_materials, err);
    return code < 0 ? code : combine_properties(parser, scope, pattern, err);
}

/* Fills in the pattern; *ret_same: an equal one that exists already. */
static int read_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct pattern_type *type, struct orl_pattern *pattern,
                        bool of_material, const struct orl_symbol **ret_same, struct orl_error *err)
{
    const size_t first = type->n_materials + type->n_before;
    const size_t file = first + type->n_functions + type->n_files + type->n_between;
    struct orl_xform to_world = orl_xform_identity;
    size_t axes = 0;
    if (type->text)
        return read_text(parser, scope, type, pattern, of_material, ret_same, err);
    int code = find_grids(parser, scope, type, pattern, &axes, err);
    if (code < 0)
        return code;
    if (type->spectral && axes == 1 && !is_fixed(type))
        return orl_parser_fail(
            parser, scope, err, ORL_ERR_SYNTAX,
            "its data has one axis: it needs an axis of wavelengths and one per coordinate");
    axes -= type->spectral && axes > 0;
    if (!is_fixed(type) && parser->primitive.n_strings < file + 1 + axes)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "its %s needs %zu coordinates after the function file",
                               type->picture ? "picture" : "data", axes);
    if (!is_fixed(type))
        code = orl_parser_string_xform(parser, scope, file + 1 + axes, &to_world, err);
    if (code == 0)
        code = begin_pattern(parser, scope, pattern);
    if (code == 0)
        code = make_key(parser, scope, type, &to_world, pattern);
    *ret_same = code == 0 ? find_same(parser, type, pattern, of_material) : NULL;
    if (code < 0 || *ret_same)
        return code;
    const struct orl_pattern_strings strings = {first, file, axes > 0 ? axes : type->n_functions,
                                                type->spectral};
    code = is_fixed(type) ? orl_spectrum_read(parser, scope, pattern, err)
                          : orl_pattern_compile(parser, scope, pattern, &to_world, &strings, err);
    if (code == 0 && type->spectral && !is_fixed(type))
        code = orl_spectrum_bands(parser, scope, pattern, err);
    return code < 0 ? code : combine_properties(parser, scope, pattern, err);
}

/* Checks the strings and allocates a pattern; NULL with err filled on failure. */
static struct orl_pattern *new_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                                       const struct pattern_type *type, struct orl_error *err)
{
    const size_t least =
        type->n_materials + type->n_before + type->n_functions + type->n_files + !is_fixed(type);
    if (is_fixed(type) && parser->primitive.n_strings != least) {
        orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                        "%s takes %zu string arguments, not %zu", type->name, least,
                        parser->primitive.n_strings);
        return NULL;
    }
    if (parser->primitive.n_strings < least) {
        orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                        "%s takes %s%zu expression%s%s, a function file ('.': none) and optionally "
                        "a transform, not %zu string arguments",
                        type->name, type->n_materials > 0 ? "two materials, " : "",
                        type->n_functions, type->n_functions == 1 ? "" : "s",
                        type->n_files > 0 ? ", the data to interpolate" : "",
                        parser->primitive.n_strings);
        return NULL;
    }
    struct orl_pattern *const pattern = calloc(1, sizeof *pattern);
    if (!pattern) {
        orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        return NULL;
    }
    pattern->is_rgb = type->n_functions == 3 || strcmp(type->name, "colortext") == 0;
    pattern->role = type->role;
    if (type->role == ORL_PATTERN_PRISM)
        pattern->as_role.prism.n_rays = (uint32_t)type->n_functions / 4;
    if (type->role == ORL_PATTERN_LOBES)
        pattern->as_role.lobes.sided = type->n_before > 0; /* BRTDfunc's lobes */
    return pattern;
}

int orl_parser_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_pattern *color, const struct orl_pattern *texture,
                       bool of_material, struct orl_error *err)
{
    const struct pattern_type *const type = find_type(parser->primitive.type);
    const struct orl_symbol *same = NULL;
    struct orl_pattern *const pattern = new_pattern(parser, scope, type, err);
    if (!pattern)
        return err->code;
    const bool is_texture = type->role == ORL_PATTERN_TEXTURE;
    pattern->under = is_texture ? texture : color;
    pattern->other = is_texture ? color : texture;
    int code = read_pattern(parser, scope, type, pattern, of_material, &same, err);
    if (code < 0 || same)
        orl_pattern_free(pattern);
    if (code == 0)
        code = same ? orl_symbols_set(&parser->symbols, *same)
                    : define_pattern(parser, pattern, parser->primitive.id);
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory") : code;
}

/* Reads a pattern without its own name: a mixture's, or the functions of a material. */
static int read_unnamed(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct pattern_type *type, const struct orl_material *mixed,
                        struct orl_pattern **ret_pattern, struct orl_error *err)
{
    const struct orl_symbol *same = NULL;
    struct orl_pattern *const pattern = new_pattern(parser, scope, type, err);
    if (!pattern)
        return err->code;
    if (mixed)
        pattern->role = ORL_PATTERN_BLEND;
    for (int i = 0; mixed && i < 2; i++)
        pattern->as_role.blend.mixed[i] = (struct orl_mixed){mixed[i].color, mixed[i].pattern};
    int code = read_pattern(parser, scope, type, pattern, false, &same, err);
    if (code < 0 || same)
        orl_pattern_free(pattern);
    else
        code = orl_parser_add_pattern(parser, pattern);
    if (code == 0) {
        struct orl_material *const old = same ? &parser->out->materials[same->index] : NULL;
        *ret_pattern = !old                           ? pattern
                       : is_function_brdf(type->role) ? function_brdf_of(old, type->role)
                       : mixed                        ? old->pattern
                                                      : share_of(old);
    }
    return code == ORL_ERR_NOMEM ? orl_error_set(err, code, "out of memory") : code;
}

int orl_parser_mixture(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_material *mixed, struct orl_pattern **ret_pattern,
                       struct orl_error *err)
{
    return read_unnamed(parser, scope, find_type(parser->primitive.type), mixed, ret_pattern, err);
}

int orl_parser_function_brdf(struct orl_parser *parser, const struct orl_scope *scope,
                             enum orl_pattern_role role, struct orl_pattern **ret_pattern,
                             struct orl_error *err)
{
    return read_unnamed(parser, scope, find_function_brdf(parser->primitive.type, role), NULL,
                        ret_pattern, err);
}
