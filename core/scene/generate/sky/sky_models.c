#include <math.h>
#include <stddef.h>

#include <oriel/base/vec.h>

#include "scene/generate/sky/sky_models.h"

double orl_cie_shape(enum orl_cie_type type, double altitude_rad)
{
    const double from_zenith = ORL_PI / 2.0 - altitude_rad, height = sin(altitude_rad);
    if (type == ORL_CIE_CLEAR)
        return 0.274 * (0.91 + 10.0 * exp(-3.0 * from_zenith) + 0.45 * height * height);
    return (2.739 + 0.9891 * sin(0.3119 + 2.6 * altitude_rad)) *
           exp(-from_zenith * (0.4441 + 1.48 * altitude_rad));
}

double orl_cie_factor(enum orl_cie_type type, double altitude_rad)
{
    static const double fits[2][5] = {{2.766521, 0.547665, -0.369832, 0.009237, 0.059229},
                                      {3.5556, -2.7152, -1.3081, 1.0660, 0.60227}};
    const double *c = fits[type];
    const double x = (altitude_rad - ORL_PI / 4.0) / (ORL_PI / 4.0);
    const double integral = (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
    return integral / orl_cie_shape(type, altitude_rad) / ORL_PI;
}

enum { BINS = 8 };

/* Upper bounds of clearness for all bins but the last: Perez 1990, table 1. */
static const double bin_ends[BINS - 1] = {1.065, 1.230, 1.500, 1.950, 2.800, 4.500, 6.200};

/* Perez 1993, table 1: for each bin, for each of a..e, four coefficients. */
static const float shapes[BINS][5][4] = {
    {{1.3525F, -0.2576F, -0.2690F, -1.4366F},
     {-0.7670F, 0.0007F, 1.2734F, -0.1233F},
     {2.8000F, 0.6004F, 1.2375F, 1.0000F},
     {1.8734F, 0.6297F, 0.9738F, 0.2809F},
     {0.0356F, -0.1246F, -0.5718F, 0.9938F}},
    {{-1.2219F, -0.7730F, 1.4148F, 1.1016F},
     {-0.2054F, 0.0367F, -3.9128F, 0.9156F},
     {6.9750F, 0.1774F, 6.4477F, -0.1239F},
     {-1.5798F, -0.5081F, -1.7812F, 0.1080F},
     {0.2624F, 0.0672F, -0.2190F, -0.4285F}},
    {{-1.1000F, -0.2515F, 0.8952F, 0.0156F},
     {0.2782F, -0.1812F, -4.5000F, 1.1766F},
     {24.7219F, -13.0812F, -37.7000F, 34.8438F},
     {-5.0000F, 1.5218F, 3.9229F, -2.6204F},
     {-0.0156F, 0.1597F, 0.4199F, -0.5562F}},
    {{-0.5484F, -0.6654F, -0.2672F, 0.7117F},
     {0.7234F, -0.6219F, -5.6812F, 2.6297F},
     {33.3389F, -18.3000F, -62.2500F, 52.0781F},
     {-3.5000F, 0.0016F, 1.1477F, 0.1062F},
     {0.4659F, -0.3296F, -0.0876F, -0.0329F}},
    {{-0.6000F, -0.3566F, -2.5000F, 2.3250F},
     {0.2937F, 0.0496F, -5.6812F, 1.8415F},
     {21.0000F, -4.7656F, -21.5906F, 7.2492F},
     {-3.5000F, -0.1554F, 1.4062F, 0.3988F},
     {0.0032F, 0.0766F, -0.0656F, -0.1294F}},
    {{-1.0156F, -0.3670F, 1.0078F, 1.4051F},
     {0.2875F, -0.5328F, -3.8500F, 3.3750F},
     {14.0000F, -0.9999F, -7.1406F, 7.5469F},
     {-3.4000F, -0.1078F, -1.0750F, 1.5702F},
     {-0.0672F, 0.4016F, 0.3017F, -0.4844F}},
    {{-1.0000F, 0.0211F, 0.5025F, -0.5119F},
     {-0.3000F, 0.1922F, 0.7023F, -1.6317F},
     {19.0000F, -5.0000F, 1.2438F, -1.9094F},
     {-4.0000F, 0.0250F, 0.3844F, 0.2656F},
     {1.0468F, -0.3788F, -2.4517F, 1.4656F}},
    {{-1.0500F, 0.0289F, 0.4260F, 0.3590F},
     {-0.3250F, 0.1156F, 0.7781F, 0.0025F},
     {31.0625F, -14.5000F, -46.1148F, 55.3750F},
     {-7.2312F, 0.4050F, 13.3500F, 0.6234F},
     {1.5000F, -0.6426F, 1.8564F, 0.5636F}},
};

/* Perez 1990, table 4: a, b, c, d for each bin. */
static const double diffuse_efficacies[BINS][4] = {
    {97.24, -0.46, 12.00, -8.91},   {107.22, 1.15, 0.59, -3.95},    {104.97, 2.96, -5.53, -8.77},
    {102.39, 5.59, -13.95, -13.90}, {100.71, 5.94, -22.75, -23.74}, {106.42, 3.83, -36.15, -28.83},
    {141.88, 1.90, -53.24, -14.03}, {152.23, 0.35, -45.27, -7.98},
};
static const double direct_efficacies[BINS][4] = {
    {57.20, -4.55, -2.98, 117.12}, {98.99, -3.46, -1.21, 12.38},  {109.83, -4.90, -1.71, -8.81},
    {110.34, -5.84, -1.99, -4.56}, {106.36, -3.97, -1.75, -6.16}, {107.19, -1.25, -1.51, -26.73},
    {105.75, 0.77, -1.26, -34.44}, {101.18, 1.58, -1.10, -8.29},
};

static int bin_of(double clearness)
{
    int bin = 0;
    while (bin < BINS - 1 && !(clearness < bin_ends[bin]))
        bin++;
    return bin;
}

int orl_perez_bin(double clearness)
{
    if (!(clearness >= ORL_PEREZ_CLEARNESS_MIN && clearness < ORL_PEREZ_CLEARNESS_MAX))
        return -1;
    return bin_of(clearness);
}

struct orl_perez orl_perez_shape(double sun_zenith_rad, double clearness, double brightness)
{
    const int bin = bin_of((float)clearness);
    const float(*x)[4] = shapes[bin];
    const double z = sun_zenith_rad;
    /* Below 0.2 the model fails for intermediate skies; this is the authors' own correction. */
    const double delta = clearness > 1.065 && clearness < 2.8 ? fmax(brightness, 0.2) : brightness;
    struct orl_perez shape;
    for (size_t i = 0; i < 5; i++)
        shape.c[i] = x[i][0] + x[i][1] * z + delta * (x[i][2] + x[i][3] * z);
    if (bin == 0) { /* equations 7 and 8 of Perez 1993 */
        shape.c[2] = exp(pow(delta * (x[2][0] + x[2][1] * z), x[2][2])) - x[2][3];
        shape.c[3] = -exp(delta * (x[3][0] + x[3][1] * z)) + x[3][2] + delta * x[3][3];
    }
    return shape;
}

double orl_perez_luminance(const struct orl_perez *shape, double zenith_rad, double gamma_rad)
{
    const double *c = shape->c, cos_gamma = cos(gamma_rad);
    return (1.0 + c[0] * exp(c[1] / cos(zenith_rad))) *
           (1.0 + c[2] * exp(c[3] * gamma_rad) + c[4] * cos_gamma * cos_gamma);
}

double orl_perez_patch_integral(const struct orl_perez *shape, double sun_zenith_rad)
{
    /* Number of patches in each of Tregenza's rows, 12 degrees apart, from the horizon up. */
    static const int patches[8] = {30, 30, 24, 24, 18, 12, 6, 1};
    double sum = 0;
    for (int row = 0; row < 8; row++) {
        const double zenith = (84 - 12 * row) * ORL_DEG_TO_RAD;
        for (int i = 0; i < patches[row]; i++) {
            const double phi = 360.0 * i / patches[row] * ORL_DEG_TO_RAD;
            const double cos_gamma =
                cos(sun_zenith_rad) * cos(zenith) + sin(sun_zenith_rad) * sin(zenith) * cos(phi);
            const double gamma = cos_gamma > 1.0 ? 0.0 : acos(cos_gamma);
            sum += (float)orl_perez_luminance(shape, zenith, gamma) * cos(zenith);
        }
    }
    return sum * (2.0 * ORL_PI / 145.0);
}

double orl_perez_diffuse_efficacy(int bin, double brightness, double sun_zenith_rad,
                                  double water_cm)
{
    const double *k = diffuse_efficacies[bin];
    return k[0] + k[1] * water_cm + k[2] * cos(sun_zenith_rad) + k[3] * log(brightness);
}

double orl_perez_direct_efficacy(int bin, double brightness, double sun_zenith_rad, double water_cm)
{
    const double *k = direct_efficacies[bin];
    return fmax(0.0, k[0] + k[1] * water_cm + k[2] * exp(5.73 * sun_zenith_rad - 5.0) +
                         k[3] * brightness);
}
