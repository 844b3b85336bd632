#include "render/picture/display.h"

#include <string.h>

#include <oriel/base/vec.h>

/* Ranges of the display and of the eye, cd/m2. */
static const double display_most = 100, display_range = 100;
static const double least_seen = 1e-7, most_seen = 1e7;
/* Trimming ends when it removes less than this share of the histogram; if less than that is left,
 * all has been trimmed. */
static const double tolerance = 0.025;
/* Limit of the iterations: with a flat ceiling trimming would not end. */
enum { MOST_ROUNDS = 200 };

double orl_luminance(const float rgb[3])
{
    const double y = ORL_EFFICACY_LM_PER_W * orl_luma((struct orl_rgb){rgb[0], rgb[1], rgb[2]});
    return isfinite(y) && y > 0 ? y : 0;
}

double orl_visible_difference(double luminance)
{
    const double l = luminance > 0 ? log10(luminance) : -10;
    double difference;
    if (l < -3.94)
        difference = -2.86;
    else if (l < -1.44)
        difference = pow(0.405 * l + 1.6, 2.18) - 2.86;
    else if (l < -0.0184)
        difference = l - 0.395;
    else if (l < 1.9)
        difference = pow(0.249 * l + 0.65, 2.7) - 0.72;
    else
        difference = l - 1.255;
    return pow(10, difference);
}

double orl_acuity(double luminance)
{
    return 17.25 * atan(1.4 * log10(fmax(luminance, least_seen)) + 0.35) + 25.72;
}

/* ---- Histogram ------------------------------------------------------------------------------- */

static void extend_range(struct orl_tonemap_histogram *h, double luminance)
{
    h->least = h->any ? fmin(h->least, luminance) : luminance;
    h->most = h->any ? fmax(h->most, luminance) : luminance;
    h->any = true;
}

void orl_tonemap_histogram_extend(struct orl_tonemap_histogram *h, const struct orl_film *film,
                                  const struct orl_fovea *fovea)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        extend_range(h, orl_luminance(film->pixels[i]));
    for (size_t i = 0; i < (size_t)fovea->width * fovea->height; i++)
        extend_range(h, orl_luminance(fovea->pixels[i]));
}

/* The range has one bin below the least luminance, which orl_tonemap_from_histogram fills from the
 * next one, so that the darkest pixels are not black. */
bool orl_tonemap_histogram_range(struct orl_tonemap_histogram *h)
{
    const double most = fmin(1.01 * h->most, most_seen);
    if (!h->any || !(most > least_seen))
        return false;
    h->high = log(most);
    h->low = log(fmax(h->least, least_seen));
    if (h->least > least_seen)
        h->low = h->high - (h->high - h->low) * ORL_TONEMAP_BINS / (ORL_TONEMAP_BINS - 1);
    return h->high > h->low;
}

static void add_to_bin(struct orl_tonemap_histogram *h, double luminance, double weight)
{
    const double b = luminance > least_seen ? log(luminance) : -INFINITY;
    if (!(b > h->low && b < h->high))
        return;
    const int bin = (int)(ORL_TONEMAP_BINS * (b - h->low) / (h->high - h->low));
    h->bins[bin < ORL_TONEMAP_BINS ? bin : ORL_TONEMAP_BINS - 1] += weight;
    h->total += weight;
    h->sum += weight * b;
}

void orl_tonemap_histogram_add(struct orl_tonemap_histogram *h, const struct orl_film *film,
                               const struct orl_fovea *fovea)
{
    const size_t samples = (size_t)fovea->width * fovea->height;
    const size_t pixels = (size_t)film->width * film->height;
    for (size_t i = 0; i < samples; i++)
        add_to_bin(h, orl_luminance(fovea->pixels[i]), 1);
    const double weight = (double)samples / (double)pixels;
    for (size_t i = 0; i < pixels; i++)
        add_to_bin(h, orl_luminance(film->pixels[i]), weight);
}

/* ---- The curve ------------------------------------------------------------------------------- */

/* Sets the share of a histogram below each bin; returns its total. */
static double accumulate(const double bins[ORL_TONEMAP_BINS], double share[ORL_TONEMAP_BINS + 1])
{
    double total = 0, sum = 0;
    for (int i = 0; i < ORL_TONEMAP_BINS; i++)
        total += bins[i];
    for (int i = 0; i < ORL_TONEMAP_BINS; i++) {
        share[i] = total > 0 ? sum / total : 0;
        sum += bins[i];
    }
    share[ORL_TONEMAP_BINS] = 1;
    return total;
}

/* Returns the logarithm of the displayed luminance for that of a scene luminance. */
static double display_of(const struct orl_tonemap *tonemap, double b)
{
    const double low = log(display_most / display_range), high = log(display_most);
    if (b <= tonemap->low)
        return low;
    if (b >= tonemap->high)
        return high;
    const double x = ORL_TONEMAP_BINS * (b - tonemap->low) / (tonemap->high - tonemap->low);
    const int bin = x < ORL_TONEMAP_BINS ? (int)x : ORL_TONEMAP_BINS - 1;
    const double share =
        tonemap->share[bin] + (x - bin) * (tonemap->share[bin + 1] - tonemap->share[bin]);
    return low + share * (high - low);
}

/* Trims each bin to the contrast that the eye could see in it (equation 7 of the paper). Returns
 * false if almost nothing is left, because the scene needs less than the display's range. */
static bool trim_histogram(struct orl_tonemap *tonemap, const struct orl_tonemap_histogram *h)
{
    double bins[ORL_TONEMAP_BINS], cut = INFINITY, total = h->total;
    const double step = (h->high - h->low) / ORL_TONEMAP_BINS, range = log(display_range);
    memcpy(bins, h->bins, sizeof bins);
    for (int round = 0; round < MOST_ROUNDS && cut > total * tolerance; round++) {
        total = accumulate(bins, tonemap->share);
        if (total <= h->total * tolerance)
            return false;
        cut = 0;
        for (int i = 0; i < ORL_TONEMAP_BINS; i++) {
            const double b = h->low + (i + 0.5) * step, shown = exp(display_of(tonemap, b));
            const double lit_scene = exp(b);
            const double ratio = orl_visible_difference(shown) / orl_visible_difference(lit_scene);
            const double ceiling = total * step * ratio * lit_scene / (shown * range);
            if (bins[i] > ceiling) {
                cut += bins[i] - ceiling;
                bins[i] = ceiling;
            }
        }
    }
    return true;
}

/* Returns the factor of a linear mapping that keeps the visibility of average luminances. */
static double linear_factor(const struct orl_tonemap_histogram *h)
{
    const double middle = display_most / sqrt(display_range);
    const double average = h->total > 0 ? exp(h->sum / h->total) : middle;
    return orl_visible_difference(middle) / orl_visible_difference(average) / display_most;
}

void orl_tonemap_from_histogram(struct orl_tonemap *tonemap, struct orl_tonemap_histogram *h)
{
    h->bins[1] *= 0.5;
    h->bins[0] += h->bins[1];
    tonemap->low = h->low;
    tonemap->high = h->high;
    const bool fits = h->high - h->low <= log(display_range);
    tonemap->factor = fits || !trim_histogram(tonemap, h) ? linear_factor(h) : 0;
}

void orl_tonemap_make(struct orl_tonemap *tonemap, const struct orl_film *film,
                      const struct orl_fovea *fovea)
{
    struct orl_tonemap_histogram histogram = {.any = false};
    *tonemap = (struct orl_tonemap){.factor = 1 / display_most};
    orl_tonemap_histogram_extend(&histogram, film, fovea);
    if (!orl_tonemap_histogram_range(&histogram))
        return;
    orl_tonemap_histogram_add(&histogram, film, fovea);
    orl_tonemap_from_histogram(tonemap, &histogram);
}

double orl_tonemap_apply(const struct orl_tonemap *tonemap, double luminance)
{
    const double least = display_most / display_range;
    if (tonemap->factor > 0)
        return tonemap->factor * luminance;
    if (luminance < least_seen)
        return 0;
    return (exp(display_of(tonemap, log(luminance))) - least) / (display_most - least);
}
