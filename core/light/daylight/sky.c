#include "light/daylight/daylight.h"

/* Blends sky and ground near the horizon, with weights (z + 1.01)^10 and its inverse. */
static double blend_at_horizon(double z, double sky, double ground)
{
    const double t = z + 1.01, t2 = t * t, t4 = t2 * t2, t5 = t4 * t;
    const double weight = t5 * t5 * t5 * t5; /* the ratio of the two weights */
    return (weight * sky + ground) / (weight + 1.0);
}

/* Returns the angle between unit vectors from their cosine, which rounding may have taken beyond
 * 1. */
static double angle_of(double cosine)
{
    return acos(orl_smaller(orl_larger(cosine, -1.0), 1.0));
}

/* Returns exp(x), or 0 for far too negative x, as rayinit.cal defines it; this is faster. */
static double damped_exp(double x)
{
    return x < -100.0 ? 0.0 : exp(x);
}

/* Parameters as in perezlum.cal: A1 normalisation, A2 ground, A3..A7 the model's a..e, A8..A10
 * the sun. */
static double perez(const double a[10], struct orl_vec3 d)
{
    const double cos_gamma = d.x * a[7] + d.y * a[8] + d.z * a[9];
    const double gamma = angle_of(cos_gamma);
    const double gradation = 1.0 + a[2] * damped_exp(a[3] / orl_larger(d.z, 0.01));
    const double indicatrix = 1.0 + a[4] * damped_exp(a[5] * gamma) + a[6] * cos_gamma * cos_gamma;
    return blend_at_horizon(d.z, a[0] * gradation * indicatrix, a[1]);
}

/* Parameters as in skybright.cal: A1 type, A2 zenith, A3 ground, A4 normalisation, A5..A7 the
 * sun. */
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
    return blend_at_horizon(d.z, sky, a[2]);
}

double orl_sky_brightness(const struct orl_sky *sky, struct orl_vec3 direction)
{
    const double value =
        sky->kind == ORL_SKY_PEREZ ? perez(sky->a, direction) : cie(sky->a, direction);
    return orl_larger(value, 0.0);
}

/* ---- Irradiance from the upper half ---------------------------------------------------------- */

enum { GAUSS = 24 };

/* Computes Gauss-Legendre nodes and weights on [0, 1]: roots of P_n by Newton steps from
 * Tricomi's initial values. */
static void gauss_legendre(double ret_at[GAUSS], double ret_weights[GAUSS])
{
    for (int i = 0; i < GAUSS; i++) {
        double x = cos(ORL_PI * (i + 0.75) / (GAUSS + 0.5)), slope = 1;
        for (int step = 0; step < 8; step++) {
            double before = 1, value = x;
            for (int k = 2; k <= GAUSS; k++) {
                const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
                before = value;
                value = next;
            }
            slope = GAUSS * (x * value - before) / (x * x - 1);
            x -= value / slope;
        }
        ret_at[i] = 0.5 * (1 + x);
        ret_weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
}

/* Returns the direction of the sun; straight up if the pattern has none. */
static struct orl_vec3 sun_of(const struct orl_sky *sky)
{
    const double *a = sky->a + (sky->kind == ORL_SKY_PEREZ ? 7 : 4);
    const bool has_sun = sky->kind == ORL_SKY_PEREZ || sky->a[0] == 1 || sky->a[0] == 4;
    return has_sun ? orl_v3(a[0], a[1], a[2]) : orl_v3(0, 0, 1);
}

/*
 * Heights are integrated in three parts, separated where the formulas have a corner (0.01) and
 * where they have their peak (the sun's height). Azimuths start at the sun's and cover half the
 * circle, as the other half is symmetric. Nodes are denser at the peak; those of heights also at
 * the zenith, where r has no slope.
 */
double orl_sky_horizontal(const struct orl_sky *sky)
{
    const struct orl_vec3 sun = sun_of(sky);
    const double level = hypot(sun.x, sun.y), middle = orl_smaller(orl_larger(sun.z, 0.011), 0.999);
    const double east = level > 0 ? sun.x / level : 1, north = level > 0 ? sun.y / level : 0;
    const double edges[4] = {0, 0.01, middle, 1};
    double at[GAUSS], weights[GAUSS], sum = 0;
    gauss_legendre(at, weights);
    for (int i = 0; i < 3 * GAUSS; i++) {
        const double t = at[i % GAUSS], *edge = edges + i / GAUSS, height = edge[1] - edge[0];
        const double z = edge[0] + height * t * t * (3 - 2 * t), r = sqrt(1 - z * z);
        double row = 0;
        for (int k = 0; k < GAUSS; k++) {
            const double phi = ORL_PI * at[k] * at[k], x = r * cos(phi), y = r * sin(phi);
            const struct orl_vec3 d = {x * east - y * north, x * north + y * east, z};
            row += orl_sky_brightness(sky, d) * 2 * at[k] * weights[k];
        }
        sum += row * z * height * 6 * t * (1 - t) * weights[i % GAUSS];
    }
    return 2 * ORL_PI * sum;
}
