/*
 * Materials defined by functions, and sums of materials: prism1 to transdata, BRTDfunc (WGMDfunc:
 * wgmd_material.c).
 */
#include <math.h>
#include <string.h>

#include "scene/material/patterns/pattern.h"
#include "scene/parse/material/material_readers.h"

struct orl_material orl_material_sum_part(enum orl_material_kind kind, struct orl_rgb color)
{
    return (struct orl_material){.kind = kind, .color = color, .sky = -1};
}

static int refuse_directed(struct orl_material_sum *sum)
{
    orl_parser_fail(sum->parser, sum->scope, sum->err, ORL_ERR_UNSUPPORTED,
                    "a pattern of one of its parts depends on the ray's direction (Dx Dy Dz, "
                    "Rdot), which is simulated only on light sources");
    orl_error_hint(sum->err, "write void instead");
    return ORL_ERR_UNSUPPORTED;
}

int orl_material_sum_add(struct orl_material_sum *sum, const struct orl_material *part)
{
    struct orl_material *const two = orl_arena_alloc(sum->parser->out->arena, 2 * sizeof *two);
    if (part->pattern && part->pattern->directed)
        return refuse_directed(sum);
    if (!two)
        return orl_error_set(sum->err, ORL_ERR_NOMEM, "out of memory");
    if (!sum->any) {
        sum->sum = *part;
        sum->any = true;
        return 0;
    }
    two[0] = sum->sum;
    two[1] = *part;
    sum->sum = (struct orl_material){
        .kind = ORL_MATERIAL_MIXTURE, .sky = -1, .as.mixture = {.mixed = two}};
    return 0;
}

static int add_reflected(struct orl_material_sum *sum, struct orl_rgb color,
                         enum orl_diffuse_side diffuse_side)
{
    struct orl_material part = orl_material_sum_part(ORL_MATERIAL_PLASTIC, color);
    const int code =
        orl_material_check_range(sum->parser, sum->scope, color, true, "diffuse share", sum->err);
    part.pattern = sum->own.pattern;
    part.texture = sum->own.texture;
    part.as.reflector.diffuse_side = diffuse_side;
    return code < 0 || !(orl_rgb_max(color) > 0) ? code : orl_material_sum_add(sum, &part);
}

int orl_material_sum_add_reflected(struct orl_material_sum *sum, struct orl_rgb front,
                                   struct orl_rgb back)
{
    const bool even = front.r == back.r && front.g == back.g && front.b == back.b;
    const int code =
        add_reflected(sum, front, even ? ORL_DIFFUSE_SIDE_BOTH : ORL_DIFFUSE_SIDE_FRONT);
    return code < 0 || even ? code : add_reflected(sum, back, ORL_DIFFUSE_SIDE_BACK);
}

int orl_material_sum_add_through(struct orl_material_sum *sum, struct orl_rgb color,
                                 struct orl_pattern *pattern)
{
    struct orl_material part = orl_material_sum_part(ORL_MATERIAL_TRANS, color);
    const int code =
        orl_material_check_range(sum->parser, sum->scope, color, true, "diffuse share", sum->err);
    part.as.reflector.shares.transmitted = 1;
    part.pattern = pattern;
    return code < 0 || !(orl_rgb_max(color) > 0) ? code : orl_material_sum_add(sum, &part);
}

struct orl_material orl_material_sum_result(const struct orl_material_sum *sum)
{
    return sum->any ? sum->sum : orl_material_sum_part(ORL_MATERIAL_PLASTIC, orl_gray(0));
}

/* Materials defined by functions (material/function_brdf/function_brdf.h): prism1 and prism2;
 * plasfunc, metfunc, transfunc, plasdata, metdata and transdata. */

int orl_material_read_prism(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    return orl_parser_function_brdf(parser, scope, ORL_PATTERN_PRISM, &material->as.prism.rays,
                                    err);
}

int orl_material_read_function_lobes(struct orl_parser *parser, const struct orl_scope *scope,
                                     struct orl_material *material, struct orl_error *err)
{
    const char *const type = parser->primitive.type;
    const double *const r = parser->primitive.reals;
    const bool trans = strncmp(type, "trans", 5) == 0;
    const size_t least = trans ? 6 : 4;
    if (parser->primitive.n_reals < least)
        return orl_parser_fail(
            parser, scope, err, ORL_ERR_SYNTAX,
            "%s takes at least %zu numbers, plus those that its function uses, but has %zu", type,
            least, parser->primitive.n_reals);
    struct orl_function_lobes *const lobes = &material->as.function_lobes;
    material->color = orl_material_rgb(parser, 0);
    lobes->shares = (struct orl_reflector_shares){r[3], trans ? r[4] : 0, trans ? r[5] : 0};
    lobes->tints_lobes = strncmp(type, "met", 3) == 0;
    const int code = orl_material_check_shares(parser, scope, material, &lobes->shares, err);
    return code < 0
               ? code
               : orl_parser_function_brdf(parser, scope, ORL_PATTERN_LOBES, &lobes->functions, err);
}

/*
 * BRTDfunc. Without lobes and patterns it is glazing, whose mirrored and straight shares are
 * functions of the angle (material/function_brdf/glazing.c). They are evaluated at many angles from
 * both sides, which also gives their bounds. Otherwise it is a sum: of diffuse scattering, to which
 * the pattern applies, of such shares, and of lobes by functions of both directions
 * (material/function_brdf/function_lobes.c).
 */

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
                    "at a cosine of %g it scatters %g of the incident light, which is more than 1",
                    cosine, sum);
    orl_error_hint(err,
                   "its mirrored, straight and diffuse light (%s of the nine numbers, and the last "
                   "three) must add up to at most 1 in each colour",
                   cosine > 0 ? "the first three" : "the second three");
    return ORL_ERR_RANGE;
}

/* Checks one angle: the sum of all shares must not exceed 1, except at grazing. */
static int check_angle(struct orl_parser *parser, const struct orl_scope *scope, double cosine,
                       struct orl_glazing *glazing, double *most, struct orl_error *err)
{
    const struct orl_diffuse_parts *const diffuse = &glazing->diffuse;
    struct orl_pattern *const angles = glazing->angles;
    double to[ORL_PATTERN_ANGLES], behind[ORL_PATTERN_ANGLES];
    if (!orl_pattern_of_angle(angles, cosine, to) ||
        !orl_pattern_of_angle(angles, -cosine, behind)) {
        orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                        "its functions have no value at a cosine of %g", cosine);
        return ORL_ERR_RANGE;
    }
    const struct orl_rgb even =
        orl_rgb_add(cosine > 0 ? diffuse->front : diffuse->back, diffuse->through);
    const double evenly[3] = {even.r, even.g, even.b};
    for (int c = 0; c < 3; c++) {
        const double mirrored = fmax(to[c], 0), straight = fmax(behind[3 + c], 0);
        const double sum = mirrored + straight + evenly[c];
        if (evenly[c] > 1 || (sum > 1 + slack && fabs(cosine) > grazing))
            return refuse_gain(parser, scope, cosine, sum, err);
        *most = fmax(*most, sum);
        glazing->transmitted = fmax(glazing->transmitted, straight);
    }
    angles->coloured =
        angles->coloured || to[0] != to[1] || to[1] != to[2] || to[3] != to[4] || to[4] != to[5];
    return 0;
}

/* Reads the shares by angle, which add to diffuse scattering. */
static int read_angles(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_glazing *glazing, struct orl_error *err)
{
    double most = 0;
    int code = orl_parser_function_brdf(parser, scope, ORL_PATTERN_GLAZING, &glazing->angles, err);
    for (int i = 0; i < 2 * ANGLES && code == 0; i++) {
        const int angle = i / 2;
        const double cosine = (angle + 0.5) / ANGLES;
        code = check_angle(parser, scope, i & 1 ? -cosine : cosine, glazing, &most, err);
    }
    if (code == 0 && most > 1 + slack)
        orl_parser_warn(parser,
                        "BRTDfunc %.100s at %.200s:%d: at grazing angles it scatters up to %.3g of "
                        "the incident light: clamped to 1",
                        parser->primitive.id, scope->file, parser->primitive.line, most);
    return code;
}

static int read_glazing(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_glazing *glazing, struct orl_error *err)
{
    const struct orl_rgb evenly[3] = {orl_material_rgb(parser, 0), orl_material_rgb(parser, 3),
                                      orl_material_rgb(parser, 6)};
    int code = 0;
    glazing->diffuse = (struct orl_diffuse_parts){evenly[0], evenly[1], evenly[2]};
    for (int i = 0; i < 3 && code == 0; i++)
        code = orl_material_check_range(parser, scope, evenly[i], true, "diffuse share", err);
    return code < 0 ? code : read_angles(parser, scope, glazing, err);
}

/* Reads the terms that exist: diffuse, mirrored and straight, lobes. */
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
        code = read_angles(parser, scope, &glazing.as.glazing, err);
        code = code < 0 ? code : orl_material_sum_add(&sum, &glazing);
    }
    if (code == 0 && any_of(parser, FIRST_LOBE, LOBES)) {
        struct orl_function_lobes *const whole = &lobes.as.function_lobes;
        whole->shares.specular = 1;
        whole->is_whole_bsdf = true;
        lobes.pattern = material->pattern;
        code = orl_parser_function_brdf(parser, scope, ORL_PATTERN_LOBES, &whole->functions, err);
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
                    "textures such as '%.200s' are not simulated on BRTDfunc",
                    parser->primitive.modifier);
    orl_error_hint(err, "write void instead");
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
               : read_glazing(parser, scope, &material->as.glazing, err);
}
