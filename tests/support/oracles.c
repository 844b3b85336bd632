#include "support/oracles.h"

#include <math.h>
#include <stdio.h>

double oracle_polygon(struct orl_vec3 point, struct orl_vec3 normal, const struct orl_vec3 *corners,
                      int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) {
        const struct orl_vec3 p = orl_sub(corners[i], point);
        const struct orl_vec3 q = orl_sub(corners[(i + 1) % n], point);
        const struct orl_vec3 turn = orl_cross(p, q);
        const double sine = orl_length(turn);
        /* An edge seen end-on contributes nothing. */
        if (sine > 0)
            sum += atan2(sine, orl_dot(p, q)) * orl_dot(turn, normal) / sine;
    }
    return fabs(sum) / (2 * ORL_PI);
}

double oracle_rectangle(struct orl_vec3 point, struct orl_vec3 normal, struct orl_vec3 corner,
                        struct orl_vec3 a, struct orl_vec3 b)
{
    const struct orl_vec3 corners[4] = {corner, orl_add(corner, a), orl_add(orl_add(corner, a), b),
                                        orl_add(corner, b)};
    return oracle_polygon(point, normal, corners, 4);
}

double oracle_pane(double cosine, double index, double pass)
{
    const double inside = sqrt(1 - (1 - cosine * cosine) / (index * index));
    const double s = (cosine - index * inside) / (cosine + index * inside);
    const double p = (index * cosine - inside) / (index * cosine + inside);
    const double through = pow(pass, 1 / inside);
    const double reflected[2] = {s * s, p * p};
    double sum = 0;
    for (int i = 0; i < 2; i++) {
        const double r = reflected[i];
        sum += 0.5 * (1 - r) * (1 - r) * through / (1 - r * r * through * through);
    }
    return sum;
}

struct oracle_sky oracle_sky(int number, struct orl_vec3 sun)
{
    static const double gradations[6][2] = {{4, -.7},   {1.1, -.8}, {0, -1},
                                            {-1, -.55}, {-1, -.32}, {-1, -.15}};
    static const double indicatrices[6][3] = {{0, -1, 0},    {2, -1.5, .15}, {5, -2.5, .3},
                                              {10, -3, .45}, {16, -3, .3},   {24, -2.8, .15}};
    /* Numbers of each sky's gradation and indicatrix, counted from 1. */
    static const int groups[15][2] = {{1, 1}, {1, 2}, {2, 1}, {2, 2}, {3, 1},
                                      {3, 2}, {3, 3}, {3, 4}, {4, 2}, {4, 3},
                                      {4, 4}, {5, 4}, {5, 5}, {6, 5}, {6, 6}};
    if (number > 15)
        return (struct oracle_sky){.sun = sun, .traditional = true};
    const double *g = gradations[groups[number - 1][0] - 1];
    const double *f = indicatrices[groups[number - 1][1] - 1];
    return (struct oracle_sky){g[0], g[1], f[0], f[1], f[2], sun, false};
}

double oracle_sky_luminance(const struct oracle_sky *sky, struct orl_vec3 direction)
{
    if (direction.z <= 0)
        return 0;
    if (sky->traditional)
        return (1 + 2 * direction.z) / 3;
    const double cosine = fmin(fmax(orl_dot(direction, sky->sun), -1), 1), angle = acos(cosine);
    return (1 + sky->a * exp(sky->b / direction.z)) *
           (1 + sky->c * (exp(sky->d * angle) - exp(sky->d * ORL_PI / 2)) +
            sky->e * cosine * cosine);
}

double oracle_sky_horizontal(const struct oracle_sky *sky)
{
    enum { ROWS = 720, COLUMNS = 720 };
    double sum = 0;
    for (int i = 0; i < ROWS * COLUMNS; i++) {
        const double z = (i / COLUMNS + 0.5) / ROWS, s = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * (i % COLUMNS + 0.5) / COLUMNS;
        sum += z * oracle_sky_luminance(sky, orl_v3(s * cos(phi), s * sin(phi), z));
    }
    return 2 * ORL_PI * sum / ((double)ROWS * COLUMNS);
}

/* perezlum.cal has 1 + c exp(d x) + e cos^2 x, so the constant that the standard subtracts is
 * divided out. */
void oracle_sky_text(const struct oracle_sky *sky, double scale, double ground, char ret_text[256])
{
    const double k = 1 - sky->c * exp(sky->d * ORL_PI / 2);
    if (sky->traditional)
        snprintf(ret_text, 256,
                 "void brightfunc general 2 skybright skybright.cal 0 3 2 %.9g %.9g\n", scale,
                 ground);
    else
        snprintf(ret_text, 256,
                 "void brightfunc general 2 skybright perezlum.cal 0\n"
                 "10 %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g %.9g\n",
                 scale * k, ground, sky->a, sky->b, sky->c / k, sky->d, sky->e / k, sky->sun.x,
                 sky->sun.y, sky->sun.z);
}
