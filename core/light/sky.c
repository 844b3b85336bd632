#include "light/sky.h"

/* Near the horizon sky and ground blend: weights (z + 1.01)^10 and its inverse. */
static double blend(double z, double sky, double ground)
{
    const double t = z + 1.01, t2 = t * t, t4 = t2 * t2, t5 = t4 * t;
    const double weight = t5 * t5 * t5 * t5; /* the ratio of the two */
    return (weight * sky + ground) / (weight + 1.0);
}

/* The angle between unit vectors, one of which may be rounded. */
static double angle_of(double cosine)
{
    return acos(fmin(fmax(cosine, -1.0), 1.0));
}

/* exp, that a far too negative argument does not slow down; so defined in rayinit.cal. */
static double damped(double x)
{
    return x < -100.0 ? 0.0 : exp(x);
}

/* perezlum.cal: A1 normalisation, A2 ground, A3..A7 the model's a..e, A8..A10 the sun. */
static double perez(const double a[10], struct orl_vec3 d)
{
    const double cos_gamma = d.x * a[7] + d.y * a[8] + d.z * a[9];
    const double gamma = angle_of(cos_gamma);
    const double gradation = 1.0 + a[2] * damped(a[3] / fmax(d.z, 0.01));
    const double indicatrix = 1.0 + a[4] * damped(a[5] * gamma) + a[6] * cos_gamma * cos_gamma;
    return blend(d.z, a[0] * gradation * indicatrix, a[1]);
}

/* skybright.cal: A1 type, A2 zenith, A3 ground, A4 normalisation, A5..A7 the sun. */
static double cie_clear(const double a[10], struct orl_vec3 d)
{
    const double cos_gamma = d.x * a[4] + d.y * a[5] + d.z * a[6];
    const double gamma = angle_of(cos_gamma);
    const double gradation = d.z > 0.01 ? 1.0 - exp(-0.32 / d.z) : 1.0;
    return a[1] * (0.91 + 10.0 * exp(-3.0 * gamma) + 0.45 * cos_gamma * cos_gamma) * gradation /
           a[3];
}

static double cie_intermediate(const double a[10], struct orl_vec3 d)
{
    const double gamma = angle_of(d.x * a[4] + d.y * a[5] + d.z * a[6]);
    const double eta = angle_of(d.z), sun = angle_of(a[6]);
    const double zenith =
        ((1.35 * sin(5.631 - 3.59 * eta) + 3.12) * sin(4.396 - 2.6 * sun) + 6.37 - eta) / 2.326;
    return a[1] * zenith * exp(gamma * -0.563 * ((2.629 - eta) * (1.562 - sun) + 0.812)) / a[3];
}

static double cie(const double a[10], struct orl_vec3 d)
{
    double sky;
    if (a[0] == 1)
        sky = cie_clear(a, d);
    else if (a[0] == 2)
        sky = a[1] * (1.0 + 2.0 * d.z) / 3.0;
    else if (a[0] == 3)
        sky = a[1];
    else
        sky = cie_intermediate(a, d);
    return blend(d.z, sky, a[2]);
}

double orl_sky_brightness(const struct orl_sky *sky, struct orl_vec3 direction)
{
    const double value =
        sky->kind == ORL_SKY_PEREZ ? perez(sky->a, direction) : cie(sky->a, direction);
    return fmax(value, 0.0);
}

/*
 * Midpoints in height and azimuth. Rows are even in z, not in z^2 as equal shares of flux would be:
 * the formulas change most near the horizon. The peak about the sun is wider than the columns.
 */
double orl_sky_horizontal(const struct orl_sky *sky)
{
    enum { ROWS = 256, COLUMNS = 256 };
    double sum = 0;
    for (int i = 0; i < ROWS; i++) {
        const double z = (i + 0.5) / ROWS, r = sqrt(1.0 - z * z);
        double row = 0;
        for (int k = 0; k < COLUMNS; k++) {
            const double phi = 2.0 * ORL_PI * (k + 0.5) / COLUMNS;
            row += orl_sky_brightness(sky, orl_v3(r * cos(phi), r * sin(phi), z));
        }
        sum += row * z;
    }
    return 2.0 * ORL_PI * sum / (ROWS * COLUMNS);
}
