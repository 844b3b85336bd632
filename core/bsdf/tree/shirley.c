#include "bsdf/tree/shirley.h"

/*
 * Opposite slices of the square share a formula if the radius is signed: one for right and left,
 * one for top and bottom. The angle then stays within 45 degrees of the slice's axis.
 */
struct orl_square orl_disk_to_square(double x, double y)
{
    const double r = sqrt(x * x + y * y);
    if (!(r > 0)) /* also for NaN */
        return (struct orl_square){0, 0};
    if (fabs(x) >= fabs(y)) {
        const double a = copysign(r, x);
        return (struct orl_square){a, a * (4 / ORL_PI) * atan(y / x)};
    }
    const double b = copysign(r, y);
    return (struct orl_square){b * (4 / ORL_PI) * atan(x / y), b};
}
