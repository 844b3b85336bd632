#include "scene/parse/material/material_readers.h"

#include <math.h>
#include <string.h>

#include "base/text/words.h"

struct orl_rgb orl_material_rgb(const struct orl_parser *parser, size_t i)
{
    const double *r = parser->primitive.reals + i;
    return (struct orl_rgb){r[0], r[1], r[2]};
}

static double rgb_min(struct orl_rgb c)
{
    return fmin(c.r, fmin(c.g, c.b));
}

int orl_material_check_range(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_rgb c, bool closed, const char *what, struct orl_error *err)
{
    if (rgb_min(c) >= 0 && (orl_rgb_max(c) < 1 || (closed && orl_rgb_max(c) <= 1)))
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its %s (%g %g %g) is not from 0 to %s1",
                    what, c.r, c.g, c.b, closed ? "" : "below ");
    if (rgb_min(c) < 0)
        orl_error_hint(err, "shares of light cannot be negative: write 0 instead?");
    else
        orl_error_hint(err, "a surface must not return all incident light, or more");
    return ORL_ERR_RANGE;
}

int orl_material_number(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                        double *ret_value, struct orl_error *err)
{
    const char *text = orl_primitive_string(&parser->primitive, i);
    if (orl_number_read(text, strlen(text), ret_value) == ORL_NUMBER_OK)
        return 0;
    orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED, "'%.60s' is not a number", text);
    orl_error_hint(err, "expressions are not evaluated here: write the number itself");
    return ORL_ERR_UNSUPPORTED;
}

/* Checks that a string argument is '.', where Radiance's types name a function file. */
static int expect_no_function(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                              struct orl_error *err)
{
    const char *text = orl_primitive_string(&parser->primitive, i);
    if (strcmp(text, ".") == 0)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                           "function files ('%.60s') are not supported here: write '.' instead",
                           text);
}

bool orl_material_is_patterned(enum orl_material_kind kind, bool directed)
{
    switch (kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_ASHIKHMIN:
    case ORL_MATERIAL_FUNCTION_LOBES:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_MIRROR:
        return !directed;
    case ORL_MATERIAL_LIGHT:
    case ORL_MATERIAL_GLOW:
    case ORL_MATERIAL_SPOTLIGHT:
    case ORL_MATERIAL_ILLUM:
        return true;
    default:
        return false;
    }
}

/* Finds the material that the first string argument names, for views: its index, or that of the
 * material it is seen as, or ORL_SEEN_AS_NOTHING. */
static int find_alternate(struct orl_parser *parser, const struct orl_scope *scope,
                          int32_t *ret_seen_as, struct orl_error *err)
{
    const char *name = orl_primitive_string(&parser->primitive, 0);
    const struct orl_symbol *symbol = orl_symbols_find(&parser->symbols, name);
    if (strcmp(name, "void") == 0) {
        *ret_seen_as = ORL_SEEN_AS_NOTHING;
        return 0;
    }
    if (!symbol || symbol->kind != ORL_SYMBOL_MATERIAL)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "its alternate '%.100s' is not a material defined before it", name);
    const struct orl_material *m = parser->out->materials + symbol->index;
    *ret_seen_as =
        m->kind == ORL_MATERIAL_ILLUM ? orl_illum_of(m)->seen_as : (int32_t)symbol->index;
    return 0;
}

static int check_index(struct orl_parser *parser, const struct orl_scope *scope, double index,
                       struct orl_error *err)
{
    if (index >= 1 && index <= 10)
        return 0;
    return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                           "its index of refraction %g is not from 1 to 10", index);
}

/* ---- Materials ------------------------------------------------------------------------------- */

/* Tolerance: rounding and white paint may exceed 1, and colours from spectra may be below 0, by
 * this much. Beyond it is an error. */
static const double slack = 0.01;
/* Upper bound of a reflectance, so that paths end after some thousand reflections. */
static const double most_returned = 0.999;
/* Limit of ashik2's exponents: a lobe of a hundredth of a degree. */
static const double most_power = 1e8;

static bool clamp_share(double *share, double from, double most)
{
    const bool over = *share >= from && *share <= 1 + slack;
    *share = over ? fmin(*share, most) : *share;
    return over;
}

static bool clamp_rgb(struct orl_rgb *c, double from, double most)
{
    const bool r = clamp_share(&c->r, from, most), g = clamp_share(&c->g, from, most);
    return clamp_share(&c->b, from, most) || r || g;
}

static bool lift_negative(double *share)
{
    const bool below = *share < 0 && *share >= -slack;
    *share = below ? 0 : *share;
    return below;
}

static void lift_negative_rgb(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_rgb *c)
{
    const bool r = lift_negative(&c->r), g = lift_negative(&c->g);
    if (lift_negative(&c->b) || r || g)
        orl_parser_tally(parser, scope, &parser->below);
}

/* Clamps shares. Light that is transmitted straight without loss leaves the scene somewhere, but
 * light that is reflected without loss may never end. For metal and trans, mirrored light has the
 * colour, or a share is lost. */
static void clamp_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *m, struct orl_reflector_shares *shares)
{
    const double above = nextafter(1, 2);
    const bool clear = shares->transmitted >= 1 && shares->transmitted_specular >= 1;
    bool white = clamp_rgb(&m->color, clear ? above : 1, clear ? 1 : most_returned);
    if (m->kind == ORL_MATERIAL_PLASTIC)
        white |= clamp_share(&shares->specular, 1, most_returned);
    else
        white |= clamp_share(&shares->specular, above, 1);
    white |= clamp_share(&shares->transmitted, above, 1);
    white |= clamp_share(&shares->transmitted_specular, above, 1);
    if (white)
        orl_parser_tally(parser, scope, &parser->white);
}

/* Clamps a transmissivity or a mirror's reflectance that is slightly above 1, with a warning. */
static void clamp_clear(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_rgb *share)
{
    lift_negative_rgb(parser, scope, share);
    if (clamp_rgb(share, nextafter(1, 2), 1))
        orl_parser_tally(parser, scope, &parser->white);
}

/* A specularity of 1 makes metal a mirror; for plastic and trans, whose highlight is white, it is
 * clamped. */
int orl_material_check_shares(struct orl_parser *parser, const struct orl_scope *scope,
                              struct orl_material *m, struct orl_reflector_shares *shares,
                              struct orl_error *err)
{
    lift_negative_rgb(parser, scope, &m->color);
    clamp_reflector(parser, scope, m, shares);
    int code = orl_material_check_range(parser, scope, m->color, true, "reflectance", err);
    if (code == 0)
        code = orl_material_check_range(parser, scope, orl_gray(shares->specular), true,
                                        "specularity", err);
    if (code == 0)
        code = orl_material_check_range(parser, scope, orl_gray(shares->transmitted), true,
                                        "transmission", err);
    if (code == 0)
        code = orl_material_check_range(parser, scope, orl_gray(shares->transmitted_specular), true,
                                        "transmitted specularity", err);
    return code;
}

/* Checks colour, shares and roughness. */
static int check_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *m, struct orl_error *err)
{
    struct orl_reflector *const reflector = &m->as.reflector;
    int code = orl_material_check_shares(parser, scope, m, &reflector->shares, err);
    for (int i = 0; i < 2 && code == 0; i++)
        if (!(reflector->roughness[i] >= 0 && reflector->roughness[i] <= 1))
            code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                                   "its roughness %g is not from 0 to 1", reflector->roughness[i]);
    return code;
}

int orl_material_read_reflector(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err)
{
    const bool trans = material->kind == ORL_MATERIAL_TRANS;
    const double *r = parser->primitive.reals;
    const int code = orl_parser_expect(parser, scope, 0, trans ? 7 : 5, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    material->as.reflector = (struct orl_reflector){
        .shares = {r[3], trans ? r[5] : 0, trans ? r[6] : 0}, .roughness = {r[4], r[4]}};
    return check_reflector(parser, scope, material, err);
}

/* Reads the direction of the anisotropy axis: three numbers, '.', and a transform. */
static int read_anisotropy_axis(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_vec3 *ret_axis, struct orl_error *err)
{
    struct orl_xform xform;
    double written[3] = {0, 0, 0};
    int code = 0;
    if (parser->primitive.n_strings < 4)
        return orl_parser_fail(
            parser, scope, err, ORL_ERR_SYNTAX,
            "%s takes four string arguments: the grain's x y z, and '.', not %zu",
            parser->primitive.type, parser->primitive.n_strings);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = orl_material_number(parser, scope, i, written + i, err);
    if (code == 0)
        code = expect_no_function(parser, scope, 3, err);
    if (code == 0)
        code = orl_parser_string_xform(parser, scope, 4, &xform, err);
    if (code < 0)
        return code;
    const struct orl_vec3 axis =
        orl_xform_vector(&xform, orl_v3(written[0], written[1], written[2]));
    if (!(orl_length(axis) > 0) || !isfinite(orl_length(axis)))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its grain has no length");
    *ret_axis = orl_normalize(axis);
    return 0;
}

int orl_material_read_anisotropic(struct orl_parser *parser, const struct orl_scope *scope,
                                  struct orl_material *material, struct orl_error *err)
{
    const bool trans = material->kind == ORL_MATERIAL_TRANS;
    const size_t n_strings = parser->primitive.n_strings;
    const double *r = parser->primitive.reals;
    struct orl_vec3 axis;
    int code = orl_parser_expect(parser, scope, n_strings, trans ? 8 : 6, err);
    if (code == 0)
        code = read_anisotropy_axis(parser, scope, &axis, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    material->as.reflector =
        (struct orl_reflector){.shares = {r[3], trans ? r[6] : 0, trans ? r[7] : 0},
                               .roughness = {r[4], r[5]},
                               .anisotropy_axis = axis};
    code = check_reflector(parser, scope, material, err);
    if (code == 0 && !(r[4] >= 1e-6 && r[5] >= 1e-6)) {
        code = orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its roughness is too small: %g along the grain, %g across", r[4],
                               r[5]);
        orl_error_hint(err, "a smooth surface has no grain: use %s",
                       trans                                  ? "trans"
                       : material->kind == ORL_MATERIAL_METAL ? "metal"
                                                              : "plastic");
    }
    return code;
}

int orl_material_read_ashikhmin(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err)
{
    const double *r = parser->primitive.reals;
    struct orl_vec3 axis;
    int code = orl_parser_expect(parser, scope, parser->primitive.n_strings, 8, err);
    if (code == 0)
        code = read_anisotropy_axis(parser, scope, &axis, err);
    if (code < 0)
        return code;
    const struct orl_rgb gloss = orl_material_rgb(parser, 3);
    material->color = orl_material_rgb(parser, 0);
    material->as.ashikhmin = (struct orl_ashikhmin){gloss, {r[6], r[7]}, axis};
    code =
        orl_material_check_range(parser, scope, material->color, true, "diffuse reflectance", err);
    if (code == 0)
        code = orl_material_check_range(parser, scope, gloss, true, "specular reflectance", err);
    if (code == 0)
        code = orl_material_check_range(parser, scope, orl_rgb_add(material->color, gloss), false,
                                        "diffuse and specular reflectance together", err);
    if (code == 0 && !(r[6] >= 0 && r[7] >= 0 && r[6] <= most_power && r[7] <= most_power))
        code =
            orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                            "its powers, %g and %g, are not from 0 to %g", r[6], r[7], most_power);
    return code;
}

int orl_material_read_glass(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    const bool has_index = parser->primitive.n_reals == 4;
    struct orl_glass *const glass = &material->as.glass;
    int code = orl_parser_expect(parser, scope, 0, has_index ? 4 : 3, err);
    if (code < 0)
        return code;
    glass->transmissivity = orl_material_rgb(parser, 0);
    glass->ior = has_index ? parser->primitive.reals[3] : 1.52;
    clamp_clear(parser, scope, &glass->transmissivity);
    code =
        orl_material_check_range(parser, scope, glass->transmissivity, true, "transmissivity", err);
    if (code == ORL_ERR_RANGE)
        orl_error_hint(
            err,
            "transmissivity excludes reflection: for clear glass that transmits 0.88 it is 0.96");
    return code == 0 ? check_index(parser, scope, glass->ior, err) : code;
}

/* Reads a medium at index i of the numbers. Transmissivity is per unit of length, which a transform
 * scales. */
static int read_medium(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                       struct orl_medium *medium, struct orl_error *err)
{
    const struct orl_rgb t = orl_material_rgb(parser, i);
    const double power = 1 / scope->xform.scale;
    int code = orl_material_check_range(parser, scope, t, true, "transmissivity", err);
    medium->transmissivity = (struct orl_rgb){pow(t.r, power), pow(t.g, power), pow(t.b, power)};
    medium->ior = parser->primitive.reals[i + 3];
    return code == 0 ? check_index(parser, scope, medium->ior, err) : code;
}

int orl_material_read_dielectric(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err)
{
    struct orl_medium *const media = material->as.interface.media;
    const double *r = parser->primitive.reals;
    int code = orl_parser_expect(parser, scope, 0, 5, err);
    if (code == 0)
        code = read_medium(parser, scope, 0, &media[0], err);
    if (code < 0)
        return code;
    media[1] = (struct orl_medium){orl_gray(1), 1};
    if (r[4] != 0)
        orl_parser_warn(parser,
                        "dielectric %.100s at %.200s:%d: its Hartmann constant %g is ignored: "
                        "dispersion is not simulated",
                        parser->primitive.id, scope->file, parser->primitive.line, r[4]);
    return 0;
}

int orl_material_read_interface(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err)
{
    int code = orl_parser_expect(parser, scope, 0, 8, err);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = read_medium(parser, scope, 4 * i, &material->as.interface.media[i], err);
    return code;
}

/* Reads extinction, albedo and asymmetry. The sources that mist may name are a hint for Radiance's
 * sampling, and ignored. Transforms scale lengths. */
int orl_material_read_mist(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err)
{
    const size_t n = parser->primitive.n_reals;
    const double per_length = 1 / scope->xform.scale;
    if (n != 0 && n != 3 && n != 6 && n != 7)
        return orl_parser_fail(
            parser, scope, err, ORL_ERR_SYNTAX,
            "mist takes 0, 3, 6 or 7 numbers (extinction, albedo, eccentricity), not %zu", n);
    const struct orl_rgb extinction = n >= 3 ? orl_material_rgb(parser, 0) : orl_gray(0);
    const struct orl_rgb albedo = n >= 6 ? orl_material_rgb(parser, 3) : orl_gray(0);
    const double asymmetry = n == 7 ? parser->primitive.reals[6] : 0;
    if (!(rgb_min(extinction) >= 0) || !(orl_rgb_max(extinction) * per_length <= 1e9))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its extinction is not from 0 to 1e9 per unit of length");
    const int code = orl_material_check_range(parser, scope, albedo, true, "albedo", err);
    if (code < 0)
        return code;
    if (!(fabs(asymmetry) < 1))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its eccentricity %g is not between -1 and 1", asymmetry);
    const struct orl_rgb scaled = orl_rgb_scale(extinction, per_length);
    material->as.mist = (struct orl_mist){scaled, orl_rgb_mul(scaled, albedo), asymmetry};
    return 0;
}

/* ---- Lights ---------------------------------------------------------------------------------- */

static int check_radiance(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_rgb radiance, struct orl_error *err)
{
    if (rgb_min(radiance) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is negative");
    if (orl_rgb_max(radiance) > 1e30) /* the sun's is 1e7; sums must stay finite */
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its radiance is too large");
    return 0;
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
        material->as.glow.max_radius = parser->primitive.reals[3] * scope->xform.scale;
    return check_radiance(parser, scope, material->color, err);
}

int orl_material_read_illum(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    const size_t n_strings = parser->primitive.n_strings;
    struct orl_illum *const illum = &material->as.illum;
    int code = orl_parser_expect(parser, scope, n_strings > 0 ? 1 : 0, 3, err);
    illum->seen_as = ORL_SEEN_AS_NOTHING;
    if (code == 0 && n_strings > 0)
        code = find_alternate(parser, scope, &illum->seen_as, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    const struct orl_material *const seen =
        illum->seen_as >= 0 ? &parser->out->materials[illum->seen_as] : NULL;
    const bool glass = seen && seen->kind == ORL_MATERIAL_GLASS && !seen->pattern;
    illum->pane = glass ? *orl_glass_of(seen) : (struct orl_glass){orl_gray(seen ? 0 : 1), 1};
    orl_parser_warn(parser,
                    "illum %.100s at %.200s:%d: its light replaces the sky and everything behind "
                    "it; through it, %s",
                    parser->primitive.id, scope->file, parser->primitive.line,
                    seen && !glass ? "no light passes" : "only light from suns and lamps passes");
    return check_radiance(parser, scope, material->color, err);
}

/* The length of the axis vector is the distance of the focus behind the lamp. */
int orl_material_read_spotlight(struct orl_parser *parser, const struct orl_scope *scope,
                                struct orl_material *material, struct orl_error *err)
{
    const double *r = parser->primitive.reals;
    const int code = orl_parser_expect(parser, scope, 0, 7, err);
    if (code < 0)
        return code;
    material->color = orl_material_rgb(parser, 0);
    if (!(r[3] > 0 && r[3] <= 360))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its cone's angle %g is not between 0 and 360 degrees", r[3]);
    const struct orl_vec3 beam_axis = orl_xform_vector(&scope->xform, orl_v3(r[4], r[5], r[6]));
    const struct orl_spotlight spot = {.beam_axis = orl_normalize(beam_axis),
                                       .cos_cone = cos(0.5 * r[3] * ORL_DEG_TO_RAD),
                                       .focus = orl_length(beam_axis)};
    material->as.spotlight = spot;
    if (!(fabs(orl_length(spot.beam_axis) - 1) < 1e-6) || !isfinite(spot.focus))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its direction (%g %g %g) has no length", r[4], r[5], r[6]);
    return check_radiance(parser, scope, material->color, err);
}

/*
 * mirror. Radiance reflects light sources in it, and shades all other light by the alternate
 * material, if it names one.
 */

/* Returns true if the alternate material replaces the mirror for all light: it mirrors or transmits
 * light itself, so suns are found through it. */
static bool replaces_mirror(const struct orl_parser *parser, int32_t other)
{
    const struct orl_material *const m = other < 0 ? NULL : parser->out->materials + other;
    switch (m ? m->kind : ORL_MATERIAL_VOID) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
        return orl_reflector_of(m)->shares.specular > 0;
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
                           : (struct orl_material){.kind = ORL_MATERIAL_VOID, .sky = -1};
    if (orl_material_bsdf(material))
        orl_bsdf_ref(orl_material_bsdf(material));
    orl_parser_warn(parser,
                    "mirror %.100s at %.200s:%d: its alternate '%.100s' is used for all light, "
                    "including the reflection of suns",
                    primitive->id, scope->file, primitive->line,
                    orl_primitive_string(primitive, 0));
}

int orl_material_read_mirror(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err)
{
    const size_t n_strings = parser->primitive.n_strings;
    int32_t instead = ORL_SEEN_AS_ITSELF;
    int code = orl_parser_expect(parser, scope, n_strings > 0 ? 1 : 0, 3, err);
    if (code == 0 && n_strings > 0)
        code = find_alternate(parser, scope, &instead, err);
    if (code < 0)
        return code;
    if (instead != ORL_SEEN_AS_ITSELF && replaces_mirror(parser, instead)) {
        use_alternate(parser, scope, instead, material);
        return 0;
    }
    material->color = orl_material_rgb(parser, 0);
    if (instead != ORL_SEEN_AS_ITSELF)
        orl_parser_warn(parser,
                        "mirror %.100s at %.200s:%d: it is simulated as a mirror for all light and "
                        "every view; its alternate '%.100s' is ignored",
                        parser->primitive.id, scope->file, parser->primitive.line,
                        orl_primitive_string(&parser->primitive, 0));
    clamp_clear(parser, scope, &material->color);
    return orl_material_check_range(parser, scope, material->color, true, "reflectance", err);
}
