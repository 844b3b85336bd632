#include "scene/material/patterns/observer.h"

#include <stddef.h>

enum { FIRST_NM = 380, STEP_NM = 5, POINTS = 81 };

static const struct orl_tristimulus matching[POINTS] = {
    {0.0014, 0, 0.0065},      {0.0022, 0.0001, 0.0105}, {0.0042, 0.0001, 0.0201},
    {0.0076, 0.0002, 0.0362}, {0.0143, 0.0004, 0.0679}, {0.0232, 0.0006, 0.1102},
    {0.0435, 0.0012, 0.2074}, {0.0776, 0.0022, 0.3713}, {0.1344, 0.004, 0.6456},
    {0.2148, 0.0073, 1.0391}, {0.2839, 0.0116, 1.3856}, {0.3285, 0.0168, 1.623},
    {0.3483, 0.023, 1.7471},  {0.3481, 0.0298, 1.7826}, {0.3362, 0.038, 1.7721},
    {0.3187, 0.048, 1.7441},  {0.2908, 0.06, 1.6692},   {0.2511, 0.0739, 1.5281},
    {0.1954, 0.091, 1.2876},  {0.1421, 0.1126, 1.0419}, {0.0956, 0.139, 0.813},
    {0.058, 0.1693, 0.6162},  {0.032, 0.208, 0.4652},   {0.0147, 0.2586, 0.3533},
    {0.0049, 0.323, 0.272},   {0.0024, 0.4073, 0.2123}, {0.0093, 0.503, 0.1582},
    {0.0291, 0.6082, 0.1117}, {0.0633, 0.71, 0.0782},   {0.1096, 0.7932, 0.0573},
    {0.1655, 0.862, 0.0422},  {0.2257, 0.9149, 0.0298}, {0.2904, 0.954, 0.0203},
    {0.3597, 0.9803, 0.0134}, {0.4334, 0.995, 0.0087},  {0.5121, 1, 0.0057},
    {0.5945, 0.995, 0.0039},  {0.6784, 0.9786, 0.0027}, {0.7621, 0.952, 0.0021},
    {0.8425, 0.9154, 0.0018}, {0.9163, 0.87, 0.0017},   {0.9786, 0.8163, 0.0014},
    {1.0263, 0.757, 0.0011},  {1.0567, 0.6949, 0.001},  {1.0622, 0.631, 0.0008},
    {1.0456, 0.5668, 0.0006}, {1.0026, 0.503, 0.0003},  {0.9384, 0.4412, 0.0002},
    {0.8544, 0.381, 0.0002},  {0.7514, 0.321, 0.0001},  {0.6424, 0.265, 0},
    {0.5419, 0.217, 0},       {0.4479, 0.175, 0},       {0.3608, 0.1382, 0},
    {0.2835, 0.107, 0},       {0.2187, 0.0816, 0},      {0.1649, 0.061, 0},
    {0.1212, 0.0446, 0},      {0.0874, 0.032, 0},       {0.0636, 0.0232, 0},
    {0.0468, 0.017, 0},       {0.0329, 0.0119, 0},      {0.0227, 0.0082, 0},
    {0.0158, 0.0057, 0},      {0.0114, 0.0041, 0},      {0.0081, 0.0029, 0},
    {0.0058, 0.0021, 0},      {0.0041, 0.0015, 0},      {0.0029, 0.001, 0},
    {0.002, 0.0007, 0},       {0.0014, 0.0005, 0},      {0.001, 0.0004, 0},
    {0.0007, 0.0002, 0},      {0.0005, 0.0002, 0},      {0.0003, 0.0001, 0},
    {0.0002, 0.0001, 0},      {0.0002, 0.0001, 0},      {0.0001, 0.0001, 0},
    {0.0001, 0, 0},           {0.0001, 0, 0},           {0, 0, 0},
};

/* Integrals over the table, in units of steps, by the trapezoidal rule. */
static const struct orl_tristimulus whole = {21.3707, 21.3712, 21.36825};

/* Integral from the table's start to a position, in steps. */
static double integral(size_t channel, double at)
{
    double sum = 0;
    const size_t last = (size_t)at;
    for (size_t i = 0; i < POINTS - 1 && i <= last; i++) {
        const double a = (&matching[i].x)[channel], b = (&matching[i + 1].x)[channel];
        const double t = orl_smaller(at - (double)i, 1);
        sum += t * (a + 0.5 * t * (b - a));
    }
    return sum;
}

static double place_of(double nm)
{
    return orl_smaller(orl_larger((nm - FIRST_NM) / STEP_NM, 0), POINTS - 1);
}

void orl_tristimulus_add(struct orl_tristimulus *sum, double from_nm, double to_nm, double value)
{
    const double a = place_of(orl_smaller(from_nm, to_nm));
    const double b = place_of(orl_larger(from_nm, to_nm));
    if (!(b > a))
        return;
    for (size_t c = 0; c < 3; c++)
        (&sum->x)[c] += value * (integral(c, b) - integral(c, a)) / (&whole.x)[c];
}

/* Primaries (.640, .330), (.290, .600), (.150, .060); each row's sum is 1, so an equal-energy
 * spectrum is white. */
struct orl_rgb orl_tristimulus_rgb(struct orl_tristimulus s)
{
    const struct orl_rgb rgb = {(2337 * s.x - 1063 * s.y - 363 * s.z) / 911,
                                (-2589 * s.x + 5011 * s.y + 111 * s.z) / 2533,
                                (183 * s.x - 617 * s.y + 2883 * s.z) / 2449};
    const double least = orl_smaller(rgb.r, orl_smaller(rgb.g, rgb.b));
    if (!(s.y > 0))
        return orl_gray(0);
    if (least >= 0)
        return rgb;
    const double left = s.y / (s.y - least);
    return (struct orl_rgb){orl_larger(0, s.y + left * (rgb.r - s.y)),
                            orl_larger(0, s.y + left * (rgb.g - s.y)),
                            orl_larger(0, s.y + left * (rgb.b - s.y))};
}
