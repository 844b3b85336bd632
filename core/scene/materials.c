/*
 * Modifiers: materials, and aliases of them. A material's own modifier may be void or
 * a sky; anything else would be a pattern or texture that is not simulated.
 * Reference: "The RADIANCE Synthetic Imaging System", section 2.1.2.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/number.h"
#include "scene/parser.h"

typedef int (*material_reader)(struct orl_parser *parser, const struct orl_scope *scope,
                               struct orl_material *material, struct orl_error *err);

static struct orl_rgb real_rgb(const struct orl_parser *parser, size_t i)
{
    const double *r = parser->primitive.reals + i;
    return (struct orl_rgb){r[0], r[1], r[2]};
}

/* ---- Materials ------------------------------------------------------------------------------- */

static double rgb_min(struct orl_rgb c)
{
    return fmin(c.r, fmin(c.g, c.b));
}

/* Channels from 0 up to below most (or to most itself, if closed). */
static int check_share(struct orl_parser *parser, const struct orl_scope *scope, struct orl_rgb c,
                       bool closed, const char *what, struct orl_error *err)
{
    if (rgb_min(c) >= 0 && (orl_rgb_max(c) < 1 || (closed && orl_rgb_max(c) <= 1)))
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its %s (%g %g %g) is not from 0 to %s 1",
                    what, c.r, c.g, c.b, closed ? "" : "below");
    orl_error_hint(err, "a surface that returns all light, or more, has no answer");
    return ORL_ERR_RANGE;
}

/* Plastic and metal share their arguments. */
static int read_opaque(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_material *material, struct orl_error *err)
{
    const bool plastic = material->kind == ORL_MATERIAL_PLASTIC;
    int code = orl_parser_expect(parser, scope, 0, 5, err);
    if (code < 0)
        return code;
    material->color = real_rgb(parser, 0);
    material->specular = parser->primitive.reals[3];
    material->roughness[0] = material->roughness[1] = parser->primitive.reals[4];
    code = check_share(parser, scope, material->color, false, "reflectance", err);
    if (code == 0)
        code =
            check_share(parser, scope, orl_gray(material->specular), !plastic, "specularity", err);
    if (code == 0 && !(material->roughness[0] >= 0 && material->roughness[0] <= 1))
        code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its roughness %g is not from 0 to 1", material->roughness[0]);
    return code;
}

static int read_glass(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_material *material, struct orl_error *err)
{
    const bool has_index = parser->primitive.n_reals == 4;
    int code = orl_parser_expect(parser, scope, 0, has_index ? 4 : 3, err);
    if (code < 0)
        return code;
    material->transmissivity = real_rgb(parser, 0);
    material->ior = has_index ? parser->primitive.reals[3] : 1.52;
    code = check_share(parser, scope, material->transmissivity, true, "transmissivity", err);
    if (code == ORL_ERR_RANGE)
        orl_error_hint(err, "transmissivity excludes reflection: clear glass that transmits 0.88 "
                            "has 0.96");
    if (code == 0 && !(material->ior >= 1 && material->ior <= 10))
        code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its index of refraction %g is not from 1 to 10", material->ior);
    return code;
}

static int read_light(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_material *material, struct orl_error *err)
{
    const bool glow = material->kind == ORL_MATERIAL_GLOW;
    const int code = orl_parser_expect(parser, scope, 0, glow ? 4 : 3, err);
    if (code < 0)
        return code;
    material->color = real_rgb(parser, 0);
    if (glow)
        material->max_radius = parser->primitive.reals[3] * scope->xform.scale;
    if (rgb_min(material->color) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is negative");
    if (orl_rgb_max(material->color) > 1e30) /* the sun's is 1e7; sums must stay finite */
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is too large");
    return 0;
}

/* A string argument that must be a number: expressions of function files are not evaluated. */
static int string_number(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                         double *ret_value, struct orl_error *err)
{
    const char *text = orl_primitive_string(&parser->primitive, i);
    if (orl_number_read(text, strlen(text), ret_value) == ORL_NUMBER_OK)
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED, "'%.60s' is not a number", text);
    orl_error_hint(err, "expressions are not evaluated: write thickness and up vector as numbers");
    return ORL_ERR_UNSUPPORTED;
}

static int read_bsdf_file(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_material *material, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    size_t source = 0;
    char name[ORL_ERROR_NAME_MAX];
    int code = orl_sources_find(&parser->sources, scope->folder,
                                orl_primitive_string(&parser->primitive, 1), &source, err);
    if (code < 0) {
        snprintf(name, sizeof name, "%.*s", (int)sizeof name - 1, err->message);
        return orl_parser_fail(parser, scope, err, code, "its BSDF file is missing: %s", name);
    }
    code = orl_sources_bsdf(&parser->sources, source, &bsdf, err);
    if (code < 0) {
        /* The place is in the XML; only what is not said yet is added. */
        const bool has_place = err->file[0] != '\0';
        snprintf(name, sizeof name, "BSDF %.200s", parser->primitive.id);
        orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : parser->primitive.line,
                     err->primitive[0] ? NULL : name);
        return code;
    }
    material->bsdf = orl_bsdf_ref(bsdf);
    return 0;
}

static int read_bsdf_diffuse(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err)
{
    struct orl_rgb *const parts[3] = {&material->front, &material->back, &material->through};
    const size_t n = parser->primitive.n_reals;
    int code = 0;
    if (n > 9 || n % 3 != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a BSDF takes 0, 3, 6 or 9 number arguments, not %zu", n);
    for (size_t i = 0; i < 3 && 3 * i < n && code == 0; i++) {
        *parts[i] = real_rgb(parser, 3 * i);
        code = check_share(parser, scope, *parts[i], false, "diffuse part", err);
    }
    return code;
}

static int read_bsdf(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_material *material, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    struct orl_xform xform;
    double up[3] = {0, 0, 0};
    int code;
    if (primitive->n_strings < 6)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a BSDF takes six string arguments: thickness, file, up x y z, and "
                               "'.'; here are %zu",
                               primitive->n_strings);
    code = string_number(parser, scope, 0, &material->thickness, err);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = string_number(parser, scope, 2 + i, up + i, err);
    if (code == 0 && strcmp(orl_primitive_string(primitive, 5), ".") != 0)
        code = orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "function files ('%.60s') are not read: '.' must stand there",
                               orl_primitive_string(primitive, 5));
    if (code == 0)
        code = orl_parser_string_xform(parser, scope, 6, &xform, err);
    if (code == 0 && material->thickness != 0)
        code = orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "BSDFs with a thickness, which stand for other geometry, are not "
                               "supported yet");
    if (code < 0)
        return code;
    material->up = orl_xform_vector(&xform, orl_v3(up[0], up[1], up[2]));
    if (!(orl_length(material->up) > 0) || !isfinite(orl_length(material->up)))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its up vector has no length");
    code = read_bsdf_diffuse(parser, scope, material, err);
    return code == 0 ? read_bsdf_file(parser, scope, material, err) : code;
}

struct material_type {
    const char *name;
    enum orl_material_kind kind;
    material_reader read;
};

static const struct material_type material_types[] = {
    {"plastic", ORL_MATERIAL_PLASTIC, read_opaque}, {"metal", ORL_MATERIAL_METAL, read_opaque},
    {"glass", ORL_MATERIAL_GLASS, read_glass},      {"BSDF", ORL_MATERIAL_BSDF, read_bsdf},
    {"light", ORL_MATERIAL_LIGHT, read_light},      {"glow", ORL_MATERIAL_GLOW, read_light},
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
    return find_type(type) || strcmp(type, "brightfunc") == 0;
}

/* ---- Definitions ----------------------------------------------------------------------------- */

static bool same_rgb(struct orl_rgb a, struct orl_rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static bool same_vec3(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_medium(struct orl_medium a, struct orl_medium b)
{
    return same_rgb(a.transmissivity, b.transmissivity) && a.ior == b.ior;
}

static bool same_reflector(const struct orl_material *a, const struct orl_material *b)
{
    return same_rgb(a->color, b->color) && a->specular == b->specular &&
           a->roughness[0] == b->roughness[0] && a->roughness[1] == b->roughness[1] &&
           same_vec3(a->grain, b->grain) && a->transmitted == b->transmitted &&
           a->transmitted_specular == b->transmitted_specular;
}

static bool same_clear(const struct orl_material *a, const struct orl_material *b)
{
    return same_rgb(a->transmissivity, b->transmissivity) && a->ior == b->ior &&
           same_medium(a->media[0], b->media[0]) && same_medium(a->media[1], b->media[1]);
}

static bool same_bsdf(const struct orl_material *a, const struct orl_material *b)
{
    return a->bsdf == b->bsdf && a->thickness == b->thickness && same_vec3(a->up, b->up) &&
           a->peak == b->peak && same_rgb(a->front, b->front) && same_rgb(a->back, b->back) &&
           same_rgb(a->through, b->through);
}

static bool same_light(const struct orl_material *a, const struct orl_material *b)
{
    return a->max_radius == b->max_radius && same_vec3(a->aim, b->aim) &&
           a->cos_cone == b->cos_cone && a->focus == b->focus && a->seen_as == b->seen_as &&
           a->sky == b->sky;
}

/* Whether two materials of one name are the same: arrays read their materials again and again. */
static bool same_material(const struct orl_material *a, const struct orl_material *b)
{
    return a->kind == b->kind && same_reflector(a, b) && same_clear(a, b) && same_bsdf(a, b) &&
           same_light(a, b);
}

/* Adds the material; takes its BSDF reference, whatever happens. */
static int add_material(struct orl_parser *parser, const char *name, struct orl_material *material,
                        uint32_t *ret_index)
{
    struct orl_description *out = parser->out;
    material->name = orl_storage_text(out->storage, name, strlen(name));
    if (!material->name || out->n_materials >= UINT32_MAX ||
        !orl_parser_grow(&out->materials, &parser->materials_room, out->n_materials,
                         sizeof *out->materials)) {
        orl_bsdf_unref(material->bsdf);
        return ORL_ERR_NOMEM;
    }
    *ret_index = (uint32_t)out->n_materials;
    out->materials[out->n_materials++] = *material;
    return 0;
}

int orl_parser_void(struct orl_parser *parser, uint32_t *ret_index)
{
    struct orl_material nothing = {
        .kind = ORL_MATERIAL_VOID, .seen_as = ORL_SEEN_AS_ITSELF, .sky = -1};
    if (parser->void_material < 0) {
        uint32_t index = 0;
        if (add_material(parser, "void", &nothing, &index) < 0)
            return ORL_ERR_NOMEM;
        parser->void_material = (int32_t)index;
    }
    *ret_index = (uint32_t)parser->void_material;
    return 0;
}

static int define(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                  struct orl_material *material, struct orl_error *err)
{
    const struct orl_symbol *old = orl_symbols_find(&parser->symbols, name);
    struct orl_symbol symbol = {.kind = ORL_SYMBOL_MATERIAL};
    if (old && old->kind == ORL_SYMBOL_MATERIAL &&
        same_material(parser->out->materials + old->index, material)) {
        orl_bsdf_unref(material->bsdf);
        return 0;
    }
    if (add_material(parser, name, material, &symbol.index) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    symbol.name = parser->out->materials[symbol.index].name;
    if (orl_symbols_set(&parser->symbols, symbol) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

/* ---- Entry points ---------------------------------------------------------------------------- */

/* A modifier's own modifier: void (-1) or a sky. */
static int find_sky(struct orl_parser *parser, const struct orl_scope *scope, int32_t *ret_sky,
                    struct orl_error *err)
{
    const char *name = parser->primitive.modifier;
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    if (strcmp(name, "void") == 0) {
        *ret_sky = -1;
        return 0;
    }
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "its modifier '%.200s' is not defined", name);
    if (symbol->kind != ORL_SYMBOL_SKY)
        return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "a material cannot modify another: '%.200s' is one", name);
    *ret_sky = (int32_t)symbol->index;
    return 0;
}

/* Skies shine through light and glow only. */
static int check_lit(struct orl_parser *parser, const struct orl_scope *scope,
                     const struct orl_material *material, struct orl_error *err)
{
    if (material->sky < 0 || material->kind == ORL_MATERIAL_LIGHT ||
        material->kind == ORL_MATERIAL_GLOW)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                           "a sky can modify light and glow only");
}

static int check_name(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_error *err)
{
    const char *id = parser->primitive.id;
    if (strcmp(id, "void") != 0 && strcmp(id, "inherit") != 0)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX, "'%s' is a reserved name", id);
}

int orl_parser_modifier(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_error *err)
{
    const struct material_type *type = find_type(parser->primitive.type);
    struct orl_material material = {.seen_as = ORL_SEEN_AS_ITSELF, .sky = -1};
    int code = check_name(parser, scope, err);
    if (code == 0)
        code = find_sky(parser, scope, &material.sky, err);
    if (code < 0)
        return code;
    if (!type) {
        if (material.sky >= 0)
            return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                                   "a pattern cannot modify another");
        return orl_parser_sky(parser, scope, parser->primitive.id, err);
    }
    material.kind = type->kind;
    code = type->read(parser, scope, &material, err);
    if (code == 0)
        code = check_lit(parser, scope, &material, err);
    if (code < 0) {
        orl_bsdf_unref(material.bsdf);
        return code;
    }
    return define(parser, scope, parser->primitive.id, &material, err);
}

int orl_parser_alias(struct orl_parser *parser, const struct orl_scope *scope,
                     struct orl_error *err)
{
    const char *target = orl_primitive_string(&parser->primitive, 0);
    const bool inherit = strcmp(parser->primitive.modifier, "inherit") == 0;
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, target);
    struct orl_material material;
    int32_t sky = -1;
    int code = check_name(parser, scope, err);
    if (code == 0 && !inherit)
        code = find_sky(parser, scope, &sky, err);
    if (code < 0)
        return code;
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "'%.200s', which it stands for, is not defined", target);
    if (symbol->kind == ORL_SYMBOL_SKY) {
        const char *id = parser->primitive.id;
        const struct orl_symbol copy = {orl_storage_text(parser->out->storage, id, strlen(id)),
                                        symbol->kind, symbol->index};
        if (!copy.name || orl_symbols_set(&parser->symbols, copy) < 0)
            return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
        return 0;
    }
    material = parser->out->materials[symbol->index];
    material.sky = inherit ? material.sky : sky;
    code = check_lit(parser, scope, &material, err);
    if (code < 0)
        return code;
    material.bsdf = material.bsdf ? orl_bsdf_ref(material.bsdf) : NULL;
    return define(parser, scope, parser->primitive.id, &material, err);
}
