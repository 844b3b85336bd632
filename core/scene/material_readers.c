#include "scene/material_readers.h"

#include <math.h>
#include <string.h>

#include "scene/number.h"

struct orl_rgb orl_material_rgb(const struct orl_parser *parser, size_t i)
{
    const double *r = parser->primitive.reals + i;
    return (struct orl_rgb){r[0], r[1], r[2]};
}

static double rgb_min(struct orl_rgb c)
{
    return fmin(c.r, fmin(c.g, c.b));
}

int orl_material_share(struct orl_parser *parser, const struct orl_scope *scope, struct orl_rgb c,
                       bool closed, const char *what, struct orl_error *err)
{
    if (rgb_min(c) >= 0 && (orl_rgb_max(c) < 1 || (closed && orl_rgb_max(c) <= 1)))
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its %s (%g %g %g) is not from 0 to %s 1",
                    what, c.r, c.g, c.b, closed ? "" : "below");
    orl_error_hint(err, "a surface that returns all light, or more, has no answer");
    return ORL_ERR_RANGE;
}

int orl_material_number(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                        double *ret_value, struct orl_error *err)
{
    const char *text = orl_primitive_string(&parser->primitive, i);
    if (orl_number_read(text, strlen(text), ret_value) == ORL_NUMBER_OK)
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED, "'%.60s' is not a number", text);
    orl_error_hint(err, "expressions are not evaluated: write the number itself");
    return ORL_ERR_UNSUPPORTED;
}

/* ---- Materials ------------------------------------------------------------------------------- */

/* Plastic and metal share their arguments. */
int orl_material_read_opaque(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err)
{
    const bool plastic = material->kind == ORL_MATERIAL_PLASTIC;
    int code = orl_parser_expect(parser, scope, 0, 5, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    material->specular = parser->primitive.reals[3];
    material->roughness[0] = material->roughness[1] = parser->primitive.reals[4];
    code = orl_material_share(parser, scope, material->color, false, "reflectance", err);
    if (code == 0)
        code = orl_material_share(parser, scope, orl_gray(material->specular), !plastic,
                                  "specularity", err);
    if (code == 0 && !(material->roughness[0] >= 0 && material->roughness[0] <= 1))
        code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its roughness %g is not from 0 to 1", material->roughness[0]);
    return code;
}

int orl_material_read_glass(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    const bool has_index = parser->primitive.n_reals == 4;
    int code = orl_parser_expect(parser, scope, 0, has_index ? 4 : 3, err);
    if (code < 0)
        return code;
    material->transmissivity = orl_material_rgb(parser, 0);
    material->ior = has_index ? parser->primitive.reals[3] : 1.52;
    code = orl_material_share(parser, scope, material->transmissivity, true, "transmissivity", err);
    if (code == ORL_ERR_RANGE)
        orl_error_hint(err, "transmissivity excludes reflection: clear glass that transmits 0.88 "
                            "has 0.96");
    if (code == 0 && !(material->ior >= 1 && material->ior <= 10))
        code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its index of refraction %g is not from 1 to 10", material->ior);
    return code;
}

int orl_material_read_light(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    const bool glow = material->kind == ORL_MATERIAL_GLOW;
    const int code = orl_parser_expect(parser, scope, 0, glow ? 4 : 3, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    if (glow)
        material->max_radius = parser->primitive.reals[3] * scope->xform.scale;
    if (rgb_min(material->color) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is negative");
    if (orl_rgb_max(material->color) > 1e30) /* the sun's is 1e7; sums must stay finite */
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is too large");
    return 0;
}
