/*
 * BRTDfunc. Without lobes and patterns it is glazing, whose mirrored and straight shares are
 * functions of the angle (material/function_brdf/glazing.c). They are evaluated at many angles from
 * both sides, which also gives their bounds. Otherwise it is a sum: of the diffuse parts, to which
 * the pattern applies, of such shares, and of lobes by functions of both directions
 * (material/function_brdf/function_lobes.c).
 */
#include <math.h>
#include <string.h>

#include "scene/material/patterns/pattern.h"
#include "scene/parse/material/material_sums.h"

enum { ANGLES = 512, FIRST_LOBE = 6, LOBES = 3, STRINGS = 10, REALS = 9 };

/* slack: rounding above 1; grazing: cosine below which sums above 1, from approximations, are
 * clamped. */
static const double slack = 0.001, grazing = 0.4;

/* Returns true if one of n functions from the first on is not the constant 0. */
static bool any_of(const struct orl_parser *parser, size_t first, size_t n)
{
    for (size_t i = first; i < first + n; i++)
        if (strcmp(orl_primitive_string(&parser->primitive, i), "0") != 0)
            return true;
    return false;
}

static int refuse_gain(struct orl_parser *parser, const struct orl_scope *scope, double cosine,
                       double sum, struct orl_error *err)
{
    orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                    "at a cosine of %g it returns %g of the light, more than all", cosine, sum);
    orl_error_hint(err,
                   "what it mirrors, lets pass and spreads evenly (%s of the nine numbers, and "
                   "the last three) are to add up to 1 at most in each colour",
                   cosine > 0 ? "the first three" : "the second three");
    return ORL_ERR_RANGE;
}

/* Checks one angle: the sum of all shares must not exceed 1, except at grazing. */
static int check_angle(struct orl_parser *parser, const struct orl_scope *scope, double cosine,
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
            return refuse_gain(parser, scope, cosine, sum, err);
        *most = fmax(*most, sum);
        m->transmitted = fmax(m->transmitted, straight);
    }
    m->angles->coloured =
        m->angles->coloured || to[0] != to[1] || to[1] != to[2] || to[3] != to[4] || to[4] != to[5];
    return 0;
}

/* Reads the shares by angle, which add to the diffuse parts. */
static int read_angles(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_material *material, struct orl_error *err)
{
    double most = 0;
    int code =
        orl_parser_function_brdf(parser, scope, ORL_FUNCTION_BRDF_GLAZING, &material->angles, err);
    for (int i = 0; i < 2 * ANGLES && code == 0; i++) {
        const int angle = i / 2;
        const double cosine = (angle + 0.5) / ANGLES;
        code = check_angle(parser, scope, i & 1 ? -cosine : cosine, material, &most, err);
    }
    if (code == 0 && most > 1 + slack)
        orl_parser_warn(parser,
                        "BRTDfunc %.100s at %.200s:%d: at grazing it returns up to %.3g of the "
                        "light: cut to all",
                        parser->primitive.id, scope->file, parser->primitive.line, most);
    return code;
}

static int read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_material *material, struct orl_error *err)
{
    int code = 0;
    material->front = orl_material_rgb(parser, 0);
    material->back = orl_material_rgb(parser, 3);
    material->through = orl_material_rgb(parser, 6);
    const struct orl_rgb evenly[3] = {material->front, material->back, material->through};
    for (int i = 0; i < 3 && code == 0; i++)
        code = orl_material_check_range(parser, scope, evenly[i], true, "diffuse share", err);
    return code < 0 ? code : read_angles(parser, scope, material, err);
}

/* Reads the parts that exist: diffuse, mirrored and straight, lobes. */
static int read_sum(struct orl_parser *parser, const struct orl_scope *scope,
                    struct orl_material *material, struct orl_error *err)
{
    struct orl_material_sum sum = {parser, scope, err, .own = *material};
    struct orl_material glazing = orl_material_sum_part(ORL_MATERIAL_GLAZING, orl_gray(0));
    struct orl_material lobes = orl_material_sum_part(ORL_MATERIAL_FUNCTION_LOBES, orl_gray(1));
    int code = orl_material_sum_add_reflected(&sum, orl_material_rgb(parser, 0),
                                              orl_material_rgb(parser, 3));
    if (code == 0)
        code = orl_material_sum_add_through(&sum, orl_material_rgb(parser, 6), material->pattern);
    if (code == 0 && any_of(parser, 0, FIRST_LOBE)) {
        code = read_angles(parser, scope, &glazing, err);
        code = code < 0 ? code : orl_material_sum_add(&sum, &glazing);
    }
    if (code == 0 && any_of(parser, FIRST_LOBE, LOBES)) {
        lobes.specular = 1;
        lobes.is_whole_bsdf = true;
        lobes.pattern = material->pattern;
        code = orl_parser_function_brdf(parser, scope, ORL_FUNCTION_BRDF_LOBES, &lobes.lobes, err);
        code = code < 0 ? code : orl_material_sum_add(&sum, &lobes);
    }
    if (code == 0)
        *material = orl_material_sum_result(&sum);
    return code;
}

static int refuse_texture(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_error *err)
{
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                    "textures are not simulated on BRTDfunc: '%.200s' is one",
                    parser->primitive.modifier);
    orl_error_hint(err, "write void in its place");
    return ORL_ERR_UNSUPPORTED;
}

int orl_material_read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *material, struct orl_error *err)
{
    if (parser->primitive.n_strings < STRINGS || parser->primitive.n_reals < REALS)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "BRTDfunc takes nine functions, a function file ('.': none), and "
                               "nine numbers");
    if (material->texture)
        return refuse_texture(parser, scope, err);
    return any_of(parser, FIRST_LOBE, LOBES) || material->pattern
               ? read_sum(parser, scope, material, err)
               : read_glazing(parser, scope, material, err);
}
