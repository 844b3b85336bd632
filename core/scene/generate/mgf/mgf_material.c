/* Colours and materials of MGF. Colours are given by chromaticity, spectrum or temperature, or as
 * mixtures. */
#include <math.h>

#include "scene/generate/mgf/mgf_context.h"
#include "scene/material/patterns/observer.h"

enum { STEP_NM = 5 };

static struct orl_mgf_color *current_color(struct orl_mgf_reader *r)
{
    return &r->current[ORL_MGF_COLOR]->is.color;
}

static bool is_gray(struct orl_mgf_color color)
{
    return fabs(color.x - 1. / 3) <= 0.01 && fabs(color.y - 1. / 3) <= 0.01;
}

/* Returns the RGB of a colour with that luminance. */
static struct orl_rgb color_rgb(struct orl_mgf_color color, double luminance)
{
    const double scale = luminance / color.y;
    return orl_tristimulus_rgb(
        (struct orl_tristimulus){color.x * scale, luminance, (1 - color.x - color.y) * scale});
}

static void set_seen(struct orl_mgf_reader *r, struct orl_tristimulus seen)
{
    const double sum = seen.x + seen.y + seen.z;
    if (!(seen.y > 0) || !isfinite(sum))
        orl_mgf_fail(r, ORL_ERR_RANGE, "the colour has no visible part");
    *current_color(r) = (struct orl_mgf_color){seen.x / sum, seen.y / sum};
}

void orl_mgf_cxy(struct orl_mgf_reader *r)
{
    const double x = orl_mgf_number(r, 1), y = orl_mgf_number(r, 2);
    if (!(x >= 0 && y > 1e-4 && x + y <= 1.0001))
        orl_mgf_fail(r, ORL_ERR_RANGE, "x %g and y %g are not a chromaticity", x, y);
    *current_color(r) = (struct orl_mgf_color){x, y};
}

/* Evenly spaced values, linear in between. */
void orl_mgf_cspec(struct orl_mgf_reader *r)
{
    struct orl_tristimulus seen = {0};
    const size_t n = r->n_words - 3;
    const double begin = orl_mgf_number(r, 1), end = orl_mgf_number(r, 2);
    if (!(begin > 0 && end > begin))
        orl_mgf_fail(r, ORL_ERR_RANGE, "wavelengths from %g to %g", begin, end);
    double value = orl_mgf_number(r, 3);
    for (size_t i = 1; i < n && !r->code; i++) {
        const double step = (end - begin) / (double)(n - 1);
        const double from = begin + (double)(i - 1) * step;
        const int parts = (int)fmin(64, ceil(step / STEP_NM));
        const double next = orl_mgf_number(r, 3 + i);
        for (int k = 0; k < parts; k++)
            orl_tristimulus_add(&seen, from + step * k / parts, from + step * (k + 1) / parts,
                                value + (next - value) * (k + 0.5) / parts);
        value = next;
    }
    set_seen(r, seen);
}

/* Colour of a black body by Planck's law; temperature in K. */
void orl_mgf_cct(struct orl_mgf_reader *r)
{
    const double second_radiation_constant = 1.4388e7; /* nm K */
    const double kelvin = orl_mgf_number(r, 1);
    struct orl_tristimulus seen = {0};
    if (!(kelvin >= 300 && kelvin <= 1e6))
        orl_mgf_fail(r, ORL_ERR_RANGE, "a temperature of %g K", kelvin);
    for (int nm = 380; nm < 780 && !r->code; nm += STEP_NM) {
        const double middle = nm + STEP_NM / 2.;
        const double exponent = second_radiation_constant / kelvin * (1 / middle - 1. / 560);
        const double below = -expm1(-second_radiation_constant / (middle * kelvin));
        orl_tristimulus_add(&seen, nm, nm + STEP_NM, pow(560 / middle, 5) * exp(-exponent) / below);
    }
    set_seen(r, seen);
}

/* Sum of colours, each weighted by a luminance. */
void orl_mgf_cmix(struct orl_mgf_reader *r)
{
    struct orl_tristimulus seen = {0};
    if (r->n_words % 2 == 0)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "the last weight has no colour");
    for (size_t i = 1; i + 1 < r->n_words; i += 2) {
        const double weight = orl_mgf_number(r, i);
        const struct orl_mgf_color color =
            orl_mgf_find(r, ORL_MGF_COLOR, r->words[i + 1])->is.color;
        seen.x += weight * color.x / color.y;
        seen.y += weight;
        seen.z += weight * (1 - color.x - color.y) / color.y;
    }
    set_seen(r, seen);
}

/*
 * Conversion of MGF materials to Radiance's: lamps by their emission; panes and prisms by their
 * refractive index; trans by its transmission; plastic and metal by the colour of their specular
 * reflection. WGMDfunc is used for components whose colours or roughnesses none of these can
 * represent.
 */

typedef struct orl_mgf_material material_t;

/* lm/W of white, by which Radiance converts luminous to radiant quantities. */
static const double white_efficacy = 179;
/* Thickness of a solid of one-sided faces, for which its colour is the transmittance. */
static const double solid_m = 0.005;

static void add_rgb(struct orl_text *text, struct orl_rgb color)
{
    orl_text_add(text, " %f %f %f", color.r, color.g, color.b);
}

/* Adds a share of the light. Colours brighter than a surface can be exceed 1 in a channel; they are
 * clamped. */
static void add_share(struct orl_mgf_reader *r, struct orl_rgb color)
{
    r->n_cut += orl_rgb_max(color) > 1;
    add_rgb(r->text, (struct orl_rgb){orl_smaller(color.r, 1), orl_smaller(color.g, 1),
                                      orl_smaller(color.b, 1)});
}

static void add_head(struct orl_text *text, const char *type, const char *name)
{
    orl_text_add(text, "void %s '%s'\n0\n0\n", type, name);
}

static struct orl_rgb part_rgb(const struct orl_mgf_component *part, double scale)
{
    return part->value > 0 ? color_rgb(part->color, part->value * scale) : orl_gray(0);
}

/* ---- Lamps and clear materials --------------------------------------------------------------- */

static void write_lamp(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    const double glow = r->mgf->glow_radius;
    add_head(r->text, glow > 0 ? "glow" : "light", name);
    orl_text_add(r->text, glow > 0 ? "4" : "3");
    add_rgb(r->text, part_rgb(&m->ed, r->mgf->emission / (M_PI * white_efficacy)));
    if (glow > 0)
        orl_text_add(r->text, " %f", glow);
    orl_text_add(r->text, "\n");
}

static bool is_clear(const material_t *m)
{
    return m->index > 1.1 && m->ts.value > 0.25 && m->rs.value <= 0.125 && m->td.value <= 0.01 &&
           m->rd.value <= 0.01 && m->rs.roughness <= 0.01 && m->ts.roughness <= 0.01;
}

static void write_clear(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    struct orl_rgb color = color_rgb(m->ts.color, m->ts.value + m->rs.value);
    add_head(r->text, m->one_sided ? "dielectric" : "glass", name);
    if (m->one_sided)
        color = (struct orl_rgb){pow(color.r, 1 / solid_m), pow(color.g, 1 / solid_m),
                                 pow(color.b, 1 / solid_m)};
    if (m->one_sided)
        orl_text_add(r->text, "5 %g %g %g %f 0\n", color.r, color.g, color.b, m->index);
    else
        orl_text_add(r->text, "4 %f %f %f %f\n", color.r, color.g, color.b, m->index);
}

/* ---- Materials with several colours or roughnesses ------------------------------------------- */

/* Returns true if both components exist and have different colours. */
static bool colors_differ(const struct orl_mgf_component *a, const struct orl_mgf_component *b)
{
    return a->value > 0.01 && b->value > 0.01 &&
           fabs(a->color.x - b->color.x) + fabs(a->color.y - b->color.y) > 0.015;
}

static bool needs_parts(const material_t *m)
{
    const bool two_roughnesses =
        m->rs.value > 0.02 && m->ts.value > 0.02 && fabs(m->rs.roughness - m->ts.roughness) > 0.02;
    const bool colored_gloss = m->rs.value > 0.05 && m->rd.value > 0.05 && !is_gray(m->rs.color) &&
                               colors_differ(&m->rd, &m->rs);
    return two_roughnesses || colored_gloss || colors_differ(&m->ts, &m->td) ||
           colors_differ(&m->td, &m->rd) || colors_differ(&m->rd, &m->ts);
}

/* A specular component for WGMDfunc: a pattern, the factor of it, and the roughness along both
 * axes. For a coloured component, the pattern includes the value. */
struct specular {
    const char *pattern;
    double value, roughness;
};

static struct specular write_specular(struct orl_mgf_reader *r,
                                      const struct orl_mgf_component *part, const char *name)
{
    const struct orl_rgb color = part_rgb(part, 1);
    if (part->value <= 0 || is_gray(part->color))
        return (struct specular){"void", part->value, part->roughness};
    orl_text_add(r->text, "void colorfunc %s\n4 %f %f %f .\n0\n0\n", name, color.r, color.g,
                 color.b);
    return (struct specular){name, 1, part->roughness};
}

static void add_specular(struct orl_text *text, const struct specular *part)
{
    orl_text_add(text, " %s %f %f %f", part->pattern, part->value, part->roughness,
                 part->roughness);
}

static void write_parts(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    const struct specular reflected = write_specular(r, &m->rs, "rs_rgb*");
    const struct specular passed = write_specular(r, &m->ts, "ts_rgb*");
    orl_text_add(r->text, "void WGMDfunc '%s'\n13", name);
    add_specular(r->text, &reflected);
    add_specular(r->text, &passed);
    orl_text_add(r->text, " void 0 0 1 .\n0\n9");
    add_share(r, part_rgb(&m->rd, 1));
    add_share(r, part_rgb(&m->rd, 1));
    add_share(r, part_rgb(&m->td, 1));
    orl_text_add(r->text, "\n");
}

/* ---- trans, plastic, metal ------------------------------------------------------------------- */

static void write_trans(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    const double passed = m->td.value + m->ts.value, all = m->rd.value + passed;
    const double specular = m->rs.value + m->ts.value, share = passed / all;
    const double roughness =
        specular > 1e-4 ? (m->rs.value * m->rs.roughness + m->ts.value * m->ts.roughness) / specular
                        : 0;
    const double scale = share < 0.999 ? m->rd.value / (1 - m->rs.value) / (1 - share) : passed;
    struct orl_rgb color =
        orl_rgb_add(part_rgb(&m->rd, scale / all), part_rgb(&m->td, scale / all));
    color = orl_rgb_add(color, part_rgb(&m->ts, scale / all));
    add_head(r->text, "trans", name);
    orl_text_add(r->text, "7");
    add_share(r, color);
    orl_text_add(r->text, " %f %f %f %f\n", m->rs.value, roughness, share, m->ts.value / passed);
}

static void write_opaque(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    const bool plastic =
        m->rs.value < 0.1 && (m->rs.value < 0.1 * m->rd.value || is_gray(m->rs.color));
    const double all = m->rd.value + m->rs.value;
    const struct orl_rgb color = plastic ? part_rgb(&m->rd, 1 / (1 - m->rs.value))
                                         : orl_rgb_add(part_rgb(&m->rd, 1), part_rgb(&m->rs, 1));
    add_head(r->text, plastic ? "plastic" : "metal", name);
    orl_text_add(r->text, "5");
    add_share(r, color);
    orl_text_add(r->text, " %f %f\n", plastic ? m->rs.value : m->rs.value / all, m->rs.roughness);
}

/* ---- Selection ------------------------------------------------------------------------------- */

static void write_material(struct orl_mgf_reader *r, const material_t *m, const char *name)
{
    if (m->ed.value > 0.1)
        write_lamp(r, m, name);
    else if (is_clear(m))
        write_clear(r, m, name);
    else if (needs_parts(m))
        write_parts(r, m, name);
    else if (m->td.value + m->ts.value > 0.01)
        write_trans(r, m, name);
    else
        write_opaque(r, m, name);
}

const char *orl_mgf_use_material(struct orl_mgf_reader *r)
{
    struct orl_mgf_item *item = r->current[ORL_MGF_MATERIAL];
    material_t *m = &item->is.material;
    const double all = m->rd.value + m->td.value + m->rs.value + m->ts.value;
    const char *const name = item->name[0] ? item->name : "mat";
    if (m->written)
        return name;
    if (!(all <= 1.0001))
        orl_mgf_fail(r, ORL_ERR_RANGE,
                     "the material '%.60s' reflects and transmits %g of the incident light", name,
                     all);
    write_material(r, m, name);
    m->written = true;
    return name;
}
