/*
 * BRTDfunc without lobes: glazing whose mirrored and straight shares are functions of the angle
 * (material/glazing.c). They are looked at from both sides at many angles, which bounds them too.
 */
#include <math.h>
#include <string.h>

#include "scene/material/pattern.h"
#include "scene/parse/material_readers.h"

enum { ANGLES = 512, FIRST_LOBE = 6, STRINGS = 10, REALS = 9 };

/* What rounding may exceed 1 by; what approximations may at grazing, below this cosine, is cut. */
static const double slack = 0.001, grazing = 0.4;

static int check_lobes(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_error *err)
{
    if (parser->primitive.n_strings < STRINGS || parser->primitive.n_reals < REALS)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "BRTDfunc takes nine functions, a function file ('.': none), and "
                               "nine numbers");
    for (size_t i = FIRST_LOBE; i < FIRST_LOBE + 3; i++) {
        if (strcmp(orl_primitive_string(&parser->primitive, i), "0") == 0)
            continue;
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        "its function '%.60s' scatters light: BRTDfunc is simulated where the "
                        "seventh to ninth are 0",
                        orl_primitive_string(&parser->primitive, i));
        orl_error_hint(err, "describe it as a BSDF");
        return ORL_ERR_UNSUPPORTED;
    }
    return 0;
}

/* At one angle: all that it does with light, which is to be no more than 1, but at grazing. */
static int look(struct orl_parser *parser, const struct orl_scope *scope, double cosine,
                struct orl_material *m, double *most, struct orl_error *err)
{
    double to[ORL_PATTERN_ANGLES], behind[ORL_PATTERN_ANGLES];
    if (!orl_pattern_of_angle(m->angles, cosine, to) ||
        !orl_pattern_of_angle(m->angles, -cosine, behind)) {
        orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                        "its functions have no value at a cosine of %g", cosine);
        return ORL_ERR_RANGE;
    }
    const struct orl_rgb even = orl_rgb_add(cosine > 0 ? m->front : m->back, m->through);
    const double evenly[3] = {even.r, even.g, even.b};
    for (int c = 0; c < 3; c++) {
        const double mirrored = fmax(to[c], 0), straight = fmax(behind[3 + c], 0);
        const double sum = mirrored + straight + evenly[c];
        if (evenly[c] > 1 || (sum > 1 + slack && fabs(cosine) > grazing))
            return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                                   "at a cosine of %g it returns %g of the light, more than all",
                                   cosine, sum);
        *most = fmax(*most, sum);
        m->transmitted = fmax(m->transmitted, straight);
    }
    m->angles->coloured =
        m->angles->coloured || to[0] != to[1] || to[1] != to[2] || to[3] != to[4] || to[4] != to[5];
    return 0;
}

int orl_material_read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *material, struct orl_error *err)
{
    double most = 0;
    int code = check_lobes(parser, scope, err);
    if (code < 0)
        return code;
    material->front = orl_material_rgb(parser, 0);
    material->back = orl_material_rgb(parser, 3);
    material->through = orl_material_rgb(parser, 6);
    const struct orl_rgb evenly[3] = {material->front, material->back, material->through};
    for (int i = 0; i < 3 && code == 0; i++)
        code = orl_material_share(parser, scope, evenly[i], true, "diffuse share", err);
    if (code == 0)
        code = orl_parser_own(parser, scope, ORL_OWN_ANGLES, &material->angles, err);
    for (int i = 0; i < 2 * ANGLES && code == 0; i++) {
        const double cosine = (i / 2 + 0.5) / ANGLES;
        code = look(parser, scope, i & 1 ? -cosine : cosine, material, &most, err);
    }
    if (code == 0 && most > 1 + slack)
        orl_parser_warn(parser,
                        "BRTDfunc %.100s at %.200s:%d: at grazing it returns up to %.3g of the "
                        "light: cut to all",
                        parser->primitive.id, scope->file, parser->primitive.line, most);
    return code;
}
