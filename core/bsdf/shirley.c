#include "bsdf/shirley.h"

static double clamp_unit(double s)
{
    if (!(s > 0)) /* NaN too */
        return 0;
    return s < 1 ? s : 1;
}

/*
 * The four pie slices of the square pair up: with a signed radius, right and left obey one
 * formula, top and bottom another, and the angle stays within 45 degrees of the slice's axis.
 */
struct orl_square orl_disk_to_square(double x, double y)
{
    const double r = sqrt(x * x + y * y);
    double a, b;
    if (!(r > 0))
        return (struct orl_square){0.5, 0.5};
    if (fabs(x) >= fabs(y)) {
        a = copysign(r, x);
        b = a * (4 / ORL_PI) * atan(y / x);
    } else {
        b = copysign(r, y);
        a = b * (4 / ORL_PI) * atan(x / y);
    }
    return (struct orl_square){clamp_unit(0.5 + 0.5 * a), clamp_unit(0.5 + 0.5 * b)};
}

struct orl_vec3 orl_square_to_hemisphere(struct orl_square s)
{
    const double a = 2 * s.x - 1, b = 2 * s.y - 1;
    const int sideways = fabs(a) >= fabs(b);
    const double r = sideways ? a : b, other = sideways ? b : a;
    const double angle = r != 0 ? (ORL_PI / 4) * (other / r) : 0;
    const double along = r * cos(angle), across = r * sin(angle);
    const double z = sqrt(fmax(0, (1 - r) * (1 + r)));
    return sideways ? orl_v3(along, across, z) : orl_v3(across, along, z);
}
