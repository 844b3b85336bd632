/*
 * Modifiers: materials, and aliases of them. A material's own modifier may be void, a sky, or, for
 * most types, a pattern or texture. The modifier of a pattern or texture may be a material, which
 * surfaces then have together with it (as obj2rad and gensurf -s write it). Other combinations are
 * not supported.
 * Reference: "The RADIANCE Synthetic Imaging System", section 2.1.2.
 */
#include <string.h>

#include "scene/material/patterns/pattern.h"
#include "scene/parse/material/material_readers.h"

struct material_type {
    const char *name;
    enum orl_material_kind kind;
    orl_material_reader read;
};

static const struct material_type material_types[] = {
    {"plastic", ORL_MATERIAL_PLASTIC, orl_material_read_reflector},
    {"metal", ORL_MATERIAL_METAL, orl_material_read_reflector},
    {"trans", ORL_MATERIAL_TRANS, orl_material_read_reflector},
    {"plastic2", ORL_MATERIAL_PLASTIC, orl_material_read_anisotropic},
    {"metal2", ORL_MATERIAL_METAL, orl_material_read_anisotropic},
    {"trans2", ORL_MATERIAL_TRANS, orl_material_read_anisotropic},
    {"glass", ORL_MATERIAL_GLASS, orl_material_read_glass},
    {"WGMDfunc", ORL_MATERIAL_MIXTURE, orl_material_read_wgmd},
    {"ashik2", ORL_MATERIAL_ASHIKHMIN, orl_material_read_ashikhmin},
    {"BRTDfunc", ORL_MATERIAL_GLAZING, orl_material_read_glazing},
    {"dielectric", ORL_MATERIAL_DIELECTRIC, orl_material_read_dielectric},
    {"interface", ORL_MATERIAL_DIELECTRIC, orl_material_read_interface},
    {"plasfunc", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"metfunc", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"transfunc", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"plasdata", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"metdata", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"transdata", ORL_MATERIAL_FUNCTION_LOBES, orl_material_read_function_lobes},
    {"prism1", ORL_MATERIAL_PRISM, orl_material_read_prism},
    {"prism2", ORL_MATERIAL_PRISM, orl_material_read_prism},
    {"mirror", ORL_MATERIAL_MIRROR, orl_material_read_mirror},
    {"BSDF", ORL_MATERIAL_BSDF, orl_material_read_bsdf},
    {"aBSDF", ORL_MATERIAL_BSDF, orl_material_read_bsdf},
    {"light", ORL_MATERIAL_LIGHT, orl_material_read_light},
    {"glow", ORL_MATERIAL_GLOW, orl_material_read_light},
    {"spotlight", ORL_MATERIAL_SPOTLIGHT, orl_material_read_spotlight},
    {"illum", ORL_MATERIAL_ILLUM, orl_material_read_illum},
    {"mist", ORL_MATERIAL_MIST, orl_material_read_mist},
    {"antimatter", ORL_MATERIAL_ANTIMATTER, orl_material_read_antimatter},
};

static const struct material_type *find_type(const char *name)
{
    for (size_t i = 0; i < sizeof material_types / sizeof *material_types; i++)
        if (strcmp(material_types[i].name, name) == 0)
            return material_types + i;
    return NULL;
}

bool orl_parser_is_modifier(const char *type)
{
    return find_type(type) || orl_parser_is_pattern(type);
}

/* ---- Definitions ----------------------------------------------------------------------------- */

static int define(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                  struct orl_material *material, struct orl_error *err)
{
    const struct orl_symbol *old = orl_symbols_find(&parser->symbols, name);
    struct orl_symbol symbol = {.kind = ORL_SYMBOL_MATERIAL};
    if (old && old->kind == ORL_SYMBOL_MATERIAL &&
        orl_material_same(parser->out->materials + old->index, material)) {
        orl_bsdf_unref(orl_material_bsdf(material));
        /* the same definition again, but with a later order */
        if (orl_symbols_set(&parser->symbols, *old) < 0)
            return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
        return 0;
    }
    if (orl_parser_add_material(parser, name, material, &symbol.index) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    symbol.name = parser->out->materials[symbol.index].name;
    if (orl_symbols_set(&parser->symbols, symbol) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

/* ---- Entry points ---------------------------------------------------------------------------- */

int orl_parser_define_refused(struct orl_parser *parser, const char *name,
                              const struct orl_error *refused, struct orl_error *err)
{
    struct orl_arena *arena = parser->out->arena;
    struct orl_symbol symbol = {.name = orl_arena_copy_text(arena, name, strlen(name)),
                                .kind = ORL_SYMBOL_REFUSED};
    if (!symbol.name || orl_deferred_add(&parser->deferred, refused, arena, &symbol.index) < 0 ||
        orl_symbols_set(&parser->symbols, symbol) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

/* Defines the current primitive's name as a copy of another symbol. */
static int define_like(struct orl_parser *parser, const struct orl_scope *scope,
                       const struct orl_symbol *other, struct orl_error *err)
{
    const char *id = parser->primitive.id;
    const struct orl_symbol copy = {orl_arena_copy_text(parser->out->arena, id, strlen(id)),
                                    other->kind, other->index, 0};
    if (!copy.name || orl_symbols_set(&parser->symbols, copy) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

static const struct orl_symbol *find_refused(const struct orl_parser *parser, const char *name)
{
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    return symbol && symbol->kind == ORL_SYMBOL_REFUSED ? symbol : NULL;
}

/* Returns the refused symbol that modifies the current primitive or is one of its materials; or
 * NULL. */
static const struct orl_symbol *refused_with(const struct orl_parser *parser)
{
    const struct orl_primitive *primitive = &parser->primitive;
    const struct orl_symbol *refused = find_refused(parser, primitive->modifier);
    const bool mixture = orl_parser_is_mixture(primitive->type);
    const bool seen_as =
        strcmp(primitive->type, "illum") == 0 || strcmp(primitive->type, "mirror") == 0;
    for (size_t i = 0; !refused && i < primitive->n_strings && i < 2; i++)
        if (mixture || (seen_as && i == 0))
            refused = find_refused(parser, orl_primitive_string(primitive, i));
    return refused;
}

/* Sets the material's own modifier: void, a sky or a pattern. */
static int find_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_material *material, struct orl_error *err)
{
    const char *name = parser->primitive.modifier;
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    material->sky = -1;
    material->pattern = material->texture = NULL;
    if (strcmp(name, "void") == 0)
        return 0;
    if (!symbol) {
        orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                        "its modifier '%.200s' is not defined", name);
        orl_error_hint(
            err, "a pattern must be defined before what it modifies; write void for no pattern");
        return ORL_ERR_NOT_FOUND;
    }
    if (symbol->kind == ORL_SYMBOL_PATTERN) {
        struct orl_pattern *const top = parser->out->patterns[symbol->index];
        struct orl_pattern *const other =
            top->other ? parser->out->patterns[top->other->index] : NULL;
        const bool texture = top->role == ORL_PATTERN_TEXTURE;
        material->pattern = texture ? other : top;
        material->texture = texture ? top : other;
        return 0;
    }
    if (symbol->kind != ORL_SYMBOL_SKY) {
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        "a material such as '%.200s' cannot modify another", name);
        orl_error_hint(err, "write void instead, or use alias to give the material another name");
        return ORL_ERR_UNSUPPORTED;
    }
    material->sky = (int32_t)symbol->index;
    return 0;
}

/* Checks that a sky is on light or glow only, and that the kind of material supports its
 * pattern. */
static int check_lit(struct orl_parser *parser, const struct orl_scope *scope,
                     const struct orl_material *material, struct orl_error *err)
{
    if (material->pattern &&
        !orl_material_is_patterned(material->kind, material->pattern->directed)) {
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        orl_material_is_patterned(material->kind, false)
                            ? "patterns that depend on the ray's direction (Dx Dy Dz, Rdot), such "
                              "as '%.200s', are simulated only on light sources"
                            : "patterns such as '%.200s' are not simulated on dielectrics, BSDFs, "
                              "BRTDfunc, prisms, antimatter and mixtures of unlike materials",
                        parser->primitive.modifier);
        orl_error_hint(err, "write void instead");
        return ORL_ERR_UNSUPPORTED;
    }
    if (material->texture &&
        (material->kind == ORL_MATERIAL_BSDF || material->kind == ORL_MATERIAL_GLAZING ||
         material->kind == ORL_MATERIAL_PRISM || material->kind == ORL_MATERIAL_FUNCTION_LOBES ||
         material->kind == ORL_MATERIAL_ANTIMATTER)) {
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        "textures such as '%.200s' are not simulated on BSDFs, BRTDfunc, prisms, "
                        "antimatter and lobes by functions or data",
                        parser->primitive.modifier);
        orl_error_hint(err, "write void instead");
        return ORL_ERR_UNSUPPORTED;
    }
    if (material->sky < 0 || material->kind == ORL_MATERIAL_LIGHT ||
        material->kind == ORL_MATERIAL_GLOW)
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                    "a sky can modify only light and glow");
    orl_error_hint(err, "write void instead: a sky cannot be a pattern of reflected light");
    return ORL_ERR_UNSUPPORTED;
}

static int check_name(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_error *err)
{
    const char *id = parser->primitive.id;
    if (strcmp(id, "void") != 0 && strcmp(id, "inherit") != 0)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX, "'%s' is a reserved name", id);
}

/* Defers the error of the current primitive until something uses it. */
static int defer_error(struct orl_parser *parser, struct orl_error *err)
{
    const struct orl_error told = *err;
    return orl_parser_define_refused(parser, parser->primitive.id, &told, err);
}

/* Handles a pattern or texture whose modifier is a material: defines a copy of that material with
 * it. The material's own pattern and texture go under it. */
static int overlay_pattern(struct orl_parser *parser, const struct orl_scope *scope, uint32_t index,
                           struct orl_error *err)
{
    struct orl_material material = parser->out->materials[index];
    const bool mixture = material.kind == ORL_MATERIAL_MIXTURE;
    const char *const id = parser->primitive.id;
    const bool texture = strncmp(parser->primitive.type, "tex", 3) == 0;
    if (material.sky >= 0 || (mixture && !texture))
        return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "'%.200s', which it modifies, %s", parser->primitive.modifier,
                               mixture ? "is a mixture of unlike materials"
                                       : "is modified by a sky");
    int code = orl_parser_pattern(parser, scope, material.pattern, material.texture, true, err);
    if (code < 0)
        return code;
    const struct orl_symbol *const made = orl_symbols_find(&parser->symbols, id);
    if (made->kind == ORL_SYMBOL_MATERIAL) {
        material.pattern = parser->out->materials[made->index].pattern;
        material.texture = parser->out->materials[made->index].texture;
    } else if (parser->out->patterns[made->index]->role == ORL_PATTERN_TEXTURE) {
        material.texture = parser->out->patterns[made->index];
    } else {
        material.pattern = parser->out->patterns[made->index];
    }
    code = mixture ? orl_parser_texture_mixture(parser, scope, &material, err) : 0;
    if (code == 0)
        code = check_lit(parser, scope, &material, err);
    if (code < 0)
        return code;
    if (orl_material_bsdf(&material))
        orl_bsdf_ref(orl_material_bsdf(&material));
    return define(parser, scope, id, &material, err);
}

/* Returns the material that modifies the current pattern or texture, or NULL. */
static const struct orl_symbol *find_below(const struct orl_parser *parser)
{
    const struct orl_symbol *const symbol =
        orl_symbols_find(&parser->symbols, parser->primitive.modifier);
    const bool pattern = orl_parser_is_pattern(parser->primitive.type) &&
                         !orl_parser_is_mixture(parser->primitive.type) &&
                         !orl_parser_is_sky(&parser->primitive);
    return pattern && symbol && symbol->kind == ORL_SYMBOL_MATERIAL ? symbol : NULL;
}

int orl_parser_modifier(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err)
{
    const struct material_type *type = find_type(parser->primitive.type);
    struct orl_material material = {.kind = ORL_MATERIAL_VOID, .sky = -1};
    const struct orl_symbol *refused = refused_with(parser);
    int code = check_name(parser, scope, err);
    if (code == 0 && refused)
        return define_like(parser, scope, refused, err);
    if (code == 0 && orl_parser_is_mixture(parser->primitive.type)) {
        code = orl_parser_mix(parser, scope, &material, err);
        if (code == 0)
            code = check_lit(parser, scope, &material, err);
        if (code == 0)
            return define(parser, scope, parser->primitive.id, &material, err);
        return orl_is_deferrable(code) ? defer_error(parser, err) : code;
    }
    const struct orl_symbol *const below = code == 0 ? find_below(parser) : NULL;
    if (below) {
        code = overlay_pattern(parser, scope, below->index, err);
        return orl_is_deferrable(code) ? defer_error(parser, err) : code;
    }
    if (code == 0)
        code = find_pattern(parser, scope, &material, err);
    if (code < 0)
        return code;
    if (!type) {
        const bool sky = orl_parser_is_sky(&parser->primitive);
        if (material.sky >= 0 || ((material.pattern || material.texture) && sky))
            return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                                   "a pattern cannot modify a sky, nor a sky a pattern");
        if (sky)
            return orl_parser_sky(parser, scope, parser->primitive.id, err);
        code = orl_parser_pattern(parser, scope, material.pattern, material.texture, false, err);
        return orl_is_deferrable(code) ? defer_error(parser, err) : code;
    }
    material.kind = type->kind;
    code = type->read(parser, scope, &material, err);
    if (code == 0)
        code = check_lit(parser, scope, &material, err);
    if (code < 0)
        orl_bsdf_unref(orl_material_bsdf(&material));
    if (orl_is_deferrable(code))
        return defer_error(parser, err);
    return code < 0 ? code : define(parser, scope, parser->primitive.id, &material, err);
}

int orl_parser_alias(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_error *err)
{
    const char *target = orl_primitive_string(&parser->primitive, 0);
    const bool inherit = strcmp(parser->primitive.modifier, "inherit") == 0;
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, target);
    struct orl_material material;
    const struct orl_symbol *refused =
        inherit ? NULL : find_refused(parser, parser->primitive.modifier);
    struct orl_material own = {.sky = -1};
    int code = check_name(parser, scope, err);
    if (code == 0 && refused)
        return define_like(parser, scope, refused, err);
    if (code == 0 && !inherit)
        code = find_pattern(parser, scope, &own, err);
    if (code < 0)
        return code;
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "its original '%.200s' is not defined", target);
    if (symbol->kind != ORL_SYMBOL_MATERIAL)
        return define_like(parser, scope, symbol, err);
    material = parser->out->materials[symbol->index];
    const bool unlike = material.kind == ORL_MATERIAL_MIXTURE;
    const bool mixture =
        unlike || (material.pattern && material.pattern->role == ORL_PATTERN_BLEND);
    if (mixture && (own.pattern || own.sky >= 0 || (unlike && own.texture)))
        return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "the mixture '%.200s' can have only the patterns of its materials",
                               target);
    material.sky = inherit ? material.sky : own.sky;
    material.pattern = inherit || mixture ? material.pattern : own.pattern;
    material.texture = inherit || unlike ? material.texture : own.texture;
    code = check_lit(parser, scope, &material, err);
    if (code < 0)
        return code;
    if (orl_material_bsdf(&material))
        orl_bsdf_ref(orl_material_bsdf(&material));
    return define(parser, scope, parser->primitive.id, &material, err);
}
