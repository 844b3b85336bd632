#include "scene/parse/pattern/pattern_readers.h"

#include <math.h>

enum { STEP_NM = 5, FIRST_NM = 380, LAST_NM = 780, MOST_BANDS = 496, MOST_SAMPLES = 1 << 16 };

/* Share of an equal-energy spectrum's luminance that a range must cover to avoid a warning. */
static const double least_covered = 0.99;

static void warn_of_range(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_tristimulus white)
{
    if (white.y < least_covered)
        orl_parser_warn(parser,
                        "%.40s %.100s at %.200s:%d: its wavelengths cover %.0f %% of the eye's "
                        "response; it is dark at the others",
                        parser->primitive.type, parser->primitive.id, scope->file,
                        parser->primitive.line, 100 * white.y);
}

/* ---- Constant spectra ------------------------------------------------------------------------ */

/* Evenly spaced samples; the first and last are at the ends. */
struct samples {
    const double *values;
    size_t n;
    double first_nm, last_nm;
};

static struct orl_rgb see_samples(const struct samples *s, struct orl_tristimulus *white)
{
    const double step = (s->last_nm - s->first_nm) / ((double)s->n - 1);
    struct orl_tristimulus seen = {0, 0, 0};
    for (size_t i = 0; i < s->n; i++) {
        const double middle = s->first_nm + (double)i * step;
        orl_tristimulus_add(&seen, middle - step / 2, middle + step / 2, s->values[i]);
    }
    orl_tristimulus_add(white, s->first_nm - step / 2, s->last_nm + step / 2, 1);
    return orl_tristimulus_rgb(seen);
}

static int too_many(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err)
{
    return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT, "it has more than %d samples",
                           MOST_SAMPLES);
}

static int read_numbers(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_rgb *ret_factor, struct orl_error *err)
{
    const struct orl_primitive *const p = &parser->primitive;
    struct orl_tristimulus white = {0, 0, 0};
    if (p->n_reals < 5 || p->reals[0] == p->reals[1])
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "spectrum takes two wavelengths that differ, and three values or "
                               "more");
    if (p->n_reals > MOST_SAMPLES)
        return too_many(parser, scope, err);
    const struct samples s = {p->reals + 2, p->n_reals - 2, p->reals[0], p->reals[1]};
    *ret_factor = see_samples(&s, &white);
    warn_of_range(parser, scope, white);
    return 0;
}

static int read_file(struct orl_parser *parser, const struct orl_scope *scope,
                     const struct orl_grid *grid, struct orl_rgb *ret_factor, struct orl_error *err)
{
    const struct orl_grid_axis *const axis = &grid->axes[0];
    const double fine = axis->places ? 1 : fabs(axis->size) / (axis->n - 1.0);
    const double from =
        fmin(axis->origin, axis->origin + axis->size) - (axis->places ? 0 : fine / 2);
    const size_t n = (size_t)(axis->places ? ceil(fabs(axis->size)) : axis->n);
    struct orl_tristimulus seen = {0, 0, 0}, white = seen;
    if (grid->n_axes != 1)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "its data has %u axes: a spectrum needs exactly one, of wavelengths",
                               grid->n_axes);
    if (axis->n > MOST_SAMPLES)
        return too_many(parser, scope, err);
    if (fabs(axis->size) > 1e5)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its wavelengths span %g nm",
                               fabs(axis->size));
    for (size_t i = 0; i < n; i++) {
        const double a = from + (double)i * fine, b = a + fine;
        double value[ORL_GRID_CHANNELS];
        const double middle = (a + fmin(b, from + fabs(axis->size))) / 2;
        const double at = axis->places ? middle : a + fine / 2;
        orl_grid_at(grid, &at, value);
        orl_tristimulus_add(&seen, a, axis->places ? fmin(b, from + fabs(axis->size)) : b,
                            value[0]);
    }
    orl_tristimulus_add(&white, from, from + (double)n * fine, 1);
    *ret_factor = orl_tristimulus_rgb(seen);
    warn_of_range(parser, scope, white);
    return 0;
}

int orl_spectrum_read(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_pattern *pattern, struct orl_error *err)
{
    struct orl_rgb factor = orl_gray(0);
    const int code = pattern->program.n_grids > 0
                         ? read_file(parser, scope, pattern->program.grids[0], &factor, err)
                         : read_numbers(parser, scope, &factor, err);
    pattern->source = ORL_PATTERN_CONSTANT;
    pattern->as_source.constant = factor;
    if (code == 0 && !(orl_rgb_max(factor) < 1e30))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its values are too large");
    return code;
}

/* ---- Bands ----------------------------------------------------------------------------------- */

/* Returns the start of band i, midway between its sample and the previous one; i = n: the end of
 * the last band. */
static double edge_of(const struct orl_grid_axis *axis, uint32_t i)
{
    const double step = axis->size / (axis->n - 1.0);
    if (!axis->places)
        return axis->origin + (i - 0.5) * step;
    const uint32_t k = i < 1 ? 1 : i < axis->n ? i : axis->n - 1;
    const double half = (axis->places[k] - axis->places[k - 1]) / 2;
    return axis->places[k - 1] + (i < 1 ? -half : i < axis->n ? half : 3 * half);
}

static struct orl_spectral_band *new_bands(struct orl_parser *parser, struct orl_pattern *pattern,
                                           size_t n)
{
    struct orl_spectral_band *const bands = orl_arena_alloc(parser->out->arena, n * sizeof *bands);
    pattern->source = ORL_PATTERN_SPECTRUM;
    pattern->as_source.spectrum = (struct orl_pattern_spectrum){bands, bands ? (uint32_t)n : 0};
    return bands;
}

static void set_band(struct orl_spectral_band *band, double nm, double from, double to,
                     struct orl_tristimulus *white)
{
    *band = (struct orl_spectral_band){.nm = nm};
    orl_tristimulus_add(&band->weight, from, to, 1);
    orl_tristimulus_add(white, from, to, 1);
}

static int bands_of_data(struct orl_parser *parser, struct orl_pattern *pattern,
                         struct orl_tristimulus *white)
{
    const struct orl_grid_axis *const axis =
        &pattern->program.grids[0]->axes[pattern->program.grids[0]->n_axes - 1];
    struct orl_spectral_band *const bands = new_bands(parser, pattern, axis->n);
    for (uint32_t i = 0; bands && i < axis->n; i++) {
        const double nm =
            axis->places ? axis->places[i] : axis->origin + i * axis->size / (axis->n - 1.0);
        set_band(&bands[i], nm, edge_of(axis, i), edge_of(axis, i + 1), white);
    }
    return bands ? 0 : ORL_ERR_NOMEM;
}

static int bands_of_range(struct orl_parser *parser, struct orl_pattern *pattern, double from,
                          double to, struct orl_tristimulus *white)
{
    const size_t n = (size_t)ceil((to - from) / STEP_NM);
    struct orl_spectral_band *const bands = new_bands(parser, pattern, n);
    for (size_t i = 0; bands && i < n; i++) {
        const double a = from + (double)i * (to - from) / (double)n;
        const double b = from + (double)(i + 1) * (to - from) / (double)n;
        set_band(&bands[i], (a + b) / 2, a, b, white);
    }
    return bands ? 0 : ORL_ERR_NOMEM;
}

int orl_spectrum_bands(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, struct orl_error *err)
{
    const struct orl_primitive *const p = &parser->primitive;
    struct orl_tristimulus white = {0, 0, 0};
    int code;
    if (pattern->program.n_grids > 0 &&
        pattern->program.grids[0]->axes[pattern->program.grids[0]->n_axes - 1].n > MOST_BANDS)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                               "its data has more than %d wavelengths", MOST_BANDS);
    if (pattern->program.n_grids > 0) {
        code = bands_of_data(parser, pattern, &white);
    } else if (p->n_reals < 2) {
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "specfunc's first two numbers must be wavelengths, in nm");
    } else {
        const double from = fmax(fmin(p->reals[0], p->reals[1]), FIRST_NM);
        const double to = fmin(fmax(p->reals[0], p->reals[1]), LAST_NM);
        if (!(from < to))
            return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                                   "of its wavelengths, %g to %g nm, none is visible", p->reals[0],
                                   p->reals[1]);
        code = bands_of_range(parser, pattern, from, to, &white);
    }
    if (code < 0)
        return code;
    warn_of_range(parser, scope, white);
    pattern->coloured = true;
    orl_pattern_make_constant(pattern);
    return 0;
}
