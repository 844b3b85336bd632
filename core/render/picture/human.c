#include "render/picture/human.h"

#include <string.h>

#include <oriel/units.h>

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

double orl_least_difference(double luminance)
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

static void extend_range(struct orl_human_tally *h, double luminance)
{
    h->least = h->any ? fmin(h->least, luminance) : luminance;
    h->most = h->any ? fmax(h->most, luminance) : luminance;
    h->any = true;
}

void orl_human_look(struct orl_human_tally *h, const struct orl_film *film,
                    const struct orl_fovea *fovea)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        extend_range(h, orl_luminance(film->pixels[i]));
    for (size_t i = 0; i < (size_t)fovea->width * fovea->height; i++)
        extend_range(h, orl_luminance(fovea->pixels[i]));
}

/* The range has one bin below the least luminance, which orl_human_settle fills from the next one,
 * so that the darkest pixels are not black. */
bool orl_human_find_range(struct orl_human_tally *h)
{
    const double most = fmin(1.01 * h->most, most_seen);
    if (!h->any || !(most > least_seen))
        return false;
    h->high = log(most);
    h->low = log(fmax(h->least, least_seen));
    if (h->least > least_seen)
        h->low = h->high - (h->high - h->low) * ORL_HUMAN_BINS / (ORL_HUMAN_BINS - 1);
    return h->high > h->low;
}

static void add_to_bin(struct orl_human_tally *h, double luminance, double weight)
{
    const double b = luminance > least_seen ? log(luminance) : -INFINITY;
    if (!(b > h->low && b < h->high))
        return;
    const int bin = (int)(ORL_HUMAN_BINS * (b - h->low) / (h->high - h->low));
    h->bins[bin < ORL_HUMAN_BINS ? bin : ORL_HUMAN_BINS - 1] += weight;
    h->total += weight;
    h->sum += weight * b;
}

void orl_human_count(struct orl_human_tally *h, const struct orl_film *film,
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
static double accumulate(const double bins[ORL_HUMAN_BINS], double share[ORL_HUMAN_BINS + 1])
{
    double total = 0, sum = 0;
    for (int i = 0; i < ORL_HUMAN_BINS; i++)
        total += bins[i];
    for (int i = 0; i < ORL_HUMAN_BINS; i++) {
        share[i] = total > 0 ? sum / total : 0;
        sum += bins[i];
    }
    share[ORL_HUMAN_BINS] = 1;
    return total;
}

/* Returns the logarithm of the displayed luminance for that of a scene luminance. */
static double display_of(const struct orl_human *human, double b)
{
    const double low = log(display_most / display_range), high = log(display_most);
    if (b <= human->low)
        return low;
    if (b >= human->high)
        return high;
    const double x = ORL_HUMAN_BINS * (b - human->low) / (human->high - human->low);
    const int bin = x < ORL_HUMAN_BINS ? (int)x : ORL_HUMAN_BINS - 1;
    const double share =
        human->share[bin] + (x - bin) * (human->share[bin + 1] - human->share[bin]);
    return low + share * (high - low);
}

/* Trims each bin to the contrast that the eye could see in it (equation 7 of the paper). Returns
 * false if almost nothing is left, because the scene needs less than the display's range. */
static bool trim_histogram(struct orl_human *human, const struct orl_human_tally *h)
{
    double bins[ORL_HUMAN_BINS], cut = INFINITY, total = h->total;
    const double step = (h->high - h->low) / ORL_HUMAN_BINS, range = log(display_range);
    memcpy(bins, h->bins, sizeof bins);
    for (int round = 0; round < MOST_ROUNDS && cut > total * tolerance; round++) {
        total = accumulate(bins, human->share);
        if (total <= h->total * tolerance)
            return false;
        cut = 0;
        for (int i = 0; i < ORL_HUMAN_BINS; i++) {
            const double b = h->low + (i + 0.5) * step, shown = exp(display_of(human, b));
            const double world = exp(b);
            const double ratio = orl_least_difference(shown) / orl_least_difference(world);
            const double ceiling = total * step * ratio * world / (shown * range);
            if (bins[i] > ceiling) {
                cut += bins[i] - ceiling;
                bins[i] = ceiling;
            }
        }
    }
    return true;
}

/* Returns the factor of a linear mapping that keeps the visibility of average luminances. */
static double linear_factor(const struct orl_human_tally *h)
{
    const double middle = display_most / sqrt(display_range);
    const double average = h->total > 0 ? exp(h->sum / h->total) : middle;
    return orl_least_difference(middle) / orl_least_difference(average) / display_most;
}

void orl_human_settle(struct orl_human *human, struct orl_human_tally *h)
{
    h->bins[1] *= 0.5;
    h->bins[0] += h->bins[1];
    human->low = h->low;
    human->high = h->high;
    const bool fits = h->high - h->low <= log(display_range);
    human->factor = fits || !trim_histogram(human, h) ? linear_factor(h) : 0;
}

void orl_human_make(struct orl_human *human, const struct orl_film *film,
                    const struct orl_fovea *fovea)
{
    struct orl_human_tally tally = {.any = false};
    *human = (struct orl_human){.factor = 1 / display_most};
    orl_human_look(&tally, film, fovea);
    if (!orl_human_find_range(&tally))
        return;
    orl_human_count(&tally, film, fovea);
    orl_human_settle(human, &tally);
}

double orl_human_show(const struct orl_human *human, double luminance)
{
    const double least = display_most / display_range;
    if (human->factor > 0)
        return human->factor * luminance;
    if (luminance < least_seen)
        return 0;
    return (exp(display_of(human, log(luminance))) - least) / (display_most - least);
}
