/*
 * Mixtures: two materials that differ only in colours and patterns become one with a pattern;
 * others become a mixture of both with shares (material/scatter.h).
 */
#include <string.h>

#include "function/function.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"
#include "scene/parse/material/material_readers.h"

/* Returns one of the materials that the current primitive mixes. */
static int find_mixed(struct orl_parser *parser, const struct orl_scope *scope, size_t which,
                      struct orl_material *ret_material, struct orl_error *err)
{
    const char *const name = orl_primitive_string(&parser->primitive, which);
    const struct orl_symbol *const symbol = orl_symbols_find(&parser->symbols, name);
    if (symbol && symbol->kind == ORL_SYMBOL_MATERIAL) {
        *ret_material = parser->out->materials[symbol->index];
        return 0;
    }
    if (!symbol && strcmp(name, "void") == 0) {
        *ret_material = (struct orl_material){
            .kind = ORL_MATERIAL_GLASS, .sky = -1, .as.glass = {orl_gray(1), 1}};
        return 0;
    }
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "its material '%.200s' is not defined", name);
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                    "only mixtures of two materials are simulated: '%.200s' is not a material",
                    name);
    orl_error_hint(err, "use one of the materials instead");
    return ORL_ERR_UNSUPPORTED;
}

/* Returns true if the kind may occur in a mixture of different kinds. */
static bool is_mixable(enum orl_material_kind kind)
{
    switch (kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_ASHIKHMIN:
    case ORL_MATERIAL_FUNCTION_LOBES:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_GLAZING:
    case ORL_MATERIAL_MIRROR:
    case ORL_MATERIAL_GLOW:
    case ORL_MATERIAL_MIXTURE:
        return true;
    default:
        return false;
    }
}

static int count_leaves(const struct orl_material *m)
{
    const struct orl_material *const mixed = orl_material_mixed(m);
    return mixed ? count_leaves(&mixed[0]) + count_leaves(&mixed[1]) : 1;
}

/* Returns true for materials that textures do not affect: glow and void. */
static bool has_no_normal(const struct orl_material *m)
{
    if (m->kind != ORL_MATERIAL_GLASS)
        return m->kind == ORL_MATERIAL_GLOW;
    const struct orl_rgb t = orl_glass_of(m)->transmissivity;
    return !m->pattern && !m->texture && orl_glass_of(m)->ior == 1 && t.r == 1 && t.g == 1 &&
           t.b == 1;
}

static int check_unlike(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_material two[2], struct orl_error *err)
{
    const char *what = NULL;
    if (!is_mixable(two[0].kind) || !is_mixable(two[1].kind))
        what = "mixtures of unlike materials are simulated only for plastic, metal, trans, those "
               "by functions, ashik2, glass, BRTDfunc, mirror, glow and void";
    else if (two[0].sky >= 0 || two[1].sky >= 0)
        what = "a glow that a sky modifies cannot be mixed";
    else if (two[0].texture != two[1].texture && !has_no_normal(&two[0]) && !has_no_normal(&two[1]))
        what = "mixtures of unlike materials are simulated only if both have the same texture, or "
               "none";
    else if (count_leaves(&two[0]) + count_leaves(&two[1]) > ORL_MIXED_MAX)
        what = "it mixes more than eight materials in total";
    if (!what)
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED, "%s", what);
    orl_error_hint(err, "use one of the materials instead");
    return ORL_ERR_UNSUPPORTED;
}

/* Returns true if the pattern depends on the direction beyond its angle to the normal. */
static bool depends_on_azimuth(const struct orl_pattern *pattern)
{
    const uint64_t inputs =
        pattern->program.function ? orl_function_inputs(pattern->program.function) : 0;
    return (inputs >> ORL_RAY_DX & 7) != 0;
}

static int check_direction(struct orl_parser *parser, const struct orl_scope *scope,
                           const struct orl_pattern *mix, const struct orl_material two[2],
                           struct orl_error *err)
{
    if (!mix->directed || (!depends_on_azimuth(mix) && !orl_material_is_window(&two[0]) &&
                           !orl_material_is_window(&two[1])))
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                    "its function uses the ray's direction: such mixtures of unlike materials may "
                    "depend only on Rdot, and must be opaque");
    orl_error_hint(err, "use one of the materials instead");
    return ORL_ERR_UNSUPPORTED;
}

static int mix_unlike(struct orl_parser *parser, const struct orl_scope *scope,
                      const struct orl_material two[2], struct orl_material *ret_material,
                      struct orl_error *err)
{
    struct orl_pattern *share = NULL;
    int code = check_unlike(parser, scope, two, err);
    if (code == 0)
        code = orl_parser_mixture(parser, scope, NULL, &share, err);
    if (code == 0)
        code = check_direction(parser, scope, share, two, err);
    if (code < 0)
        return code;
    struct orl_material *const kept = orl_arena_alloc(parser->out->arena, 2 * sizeof *kept);
    if (!kept)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    memcpy(kept, two, 2 * sizeof *kept);
    ret_material->kind = ORL_MATERIAL_MIXTURE;
    ret_material->as.mixture = (struct orl_mixture){share, kept};
    ret_material->texture = two[has_no_normal(&two[0])].texture;
    return 0;
}

/* Returns true if the kind supports textures. */
static bool can_be_turned(enum orl_material_kind kind)
{
    return kind != ORL_MATERIAL_FUNCTION_LOBES && kind != ORL_MATERIAL_GLAZING;
}

int orl_parser_texture_mixture(struct orl_parser *parser, const struct orl_scope *scope,
                               struct orl_material *mixture, struct orl_error *err)
{
    struct orl_material *const turned = orl_arena_alloc(parser->out->arena, 2 * sizeof *turned);
    if (!turned)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    memcpy(turned, orl_mixture_of(mixture)->mixed, 2 * sizeof *turned);
    mixture->as.mixture.mixed = turned;
    for (int i = 0; i < 2; i++) {
        if (turned[i].kind == ORL_MATERIAL_GLOW)
            continue;
        if (!can_be_turned(turned[i].kind))
            return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                                   "'%.200s', which it modifies, mixes BRTDfunc or lobes by "
                                   "functions or data: textures are not simulated on these",
                                   parser->primitive.modifier);
        turned[i].texture = mixture->texture;
        const int code = turned[i].kind == ORL_MATERIAL_MIXTURE
                             ? orl_parser_texture_mixture(parser, scope, &turned[i], err)
                             : 0;
        if (code < 0)
            return code;
    }
    return 0;
}

int orl_parser_mix(struct orl_parser *parser, const struct orl_scope *scope,
                   struct orl_material *ret_material, struct orl_error *err)
{
    struct orl_material two[2] = {{0}}, bare[2];
    int code = 0;
    if (parser->primitive.n_strings < 2 || strcmp(parser->primitive.modifier, "void") != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a mixture takes two materials, and its modifier must be void");
    for (size_t i = 0; i < 2 && code == 0; i++) {
        code = find_mixed(parser, scope, i, &two[i], err);
        bare[i] = two[i];
        bare[i].color = orl_gray(1);
        bare[i].pattern = NULL;
    }
    if (code < 0)
        return code;
    const bool colored = two[0].kind != ORL_MATERIAL_GLASS && two[0].sky < 0 &&
                         orl_material_is_patterned(two[0].kind, false);
    if (!colored || !orl_material_same(&bare[0], &bare[1]))
        return mix_unlike(parser, scope, two, ret_material, err);
    code = orl_parser_mixture(parser, scope, two, &bare[0].pattern, err);
    if (code == 0)
        *ret_material = bare[0];
    return code;
}
