/*
 * mirror. Radiance reflects light sources in it, and shades all other light by the alternate
 * material, if it names one.
 */
#include "scene/parse/material/material_readers.h"

/* Returns true if the alternate material replaces the mirror for all light: it mirrors or transmits
 * light itself, so suns are found through it. */
static bool replaces_mirror(const struct orl_parser *parser, int32_t other)
{
    const struct orl_material *const m = other < 0 ? NULL : parser->out->materials + other;
    switch (m ? m->kind : ORL_MATERIAL_VOID) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return m->specular > 0;
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
    case ORL_MATERIAL_SPOTLIGHT:
    case ORL_MATERIAL_ILLUM:
        return false;
    default:
        return true;
    }
}

static void use_alternate(struct orl_parser *parser, const struct orl_scope *scope, int32_t other,
                          struct orl_material *material)
{
    const struct orl_primitive *const primitive = &parser->primitive;
    *material = other >= 0 ? parser->out->materials[other]
                           : (struct orl_material){.kind = ORL_MATERIAL_VOID,
                                                   .seen_as = ORL_SEEN_AS_ITSELF,
                                                   .sky = -1};
    if (material->bsdf)
        orl_bsdf_ref(material->bsdf);
    orl_parser_warn(
        parser,
        "mirror %.100s at %.200s:%d: it is '%.100s', which it is to be seen as, for all "
        "light: suns are mirrored as by that",
        primitive->id, scope->file, primitive->line, orl_primitive_string(primitive, 0));
}

int orl_material_read_mirror(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err)
{
    const size_t n_strings = parser->primitive.n_strings;
    int32_t instead = ORL_SEEN_AS_ITSELF;
    int code = orl_parser_expect(parser, scope, n_strings > 0 ? 1 : 0, 3, err);
    if (code == 0 && n_strings > 0)
        code = orl_material_alternate(parser, scope, &instead, err);
    if (code < 0)
        return code;
    if (instead != ORL_SEEN_AS_ITSELF && replaces_mirror(parser, instead)) {
        use_alternate(parser, scope, instead, material);
        return 0;
    }
    material->color = orl_material_rgb(parser, 0);
    if (instead != ORL_SEEN_AS_ITSELF)
        orl_parser_warn(parser,
                        "mirror %.100s at %.200s:%d: it is a mirror for all light and every view, "
                        "not '%.100s'",
                        parser->primitive.id, scope->file, parser->primitive.line,
                        orl_primitive_string(&parser->primitive, 0));
    orl_material_clamp_clear(parser, scope, &material->color);
    return orl_material_check_range(parser, scope, material->color, true, "reflectance", err);
}
