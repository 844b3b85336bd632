#include "bsdf/shirley.h"

/*
 * The four pie slices of the square pair up: with a signed radius, right and left obey one
 * formula, top and bottom another, and the angle stays within 45 degrees of the slice's axis.
 */
struct orl_square orl_disk_to_square(double x, double y)
{
    const double r = sqrt(x * x + y * y);
    if (!(r > 0)) /* NaN too */
        return (struct orl_square){0, 0};
    if (fabs(x) >= fabs(y)) {
        const double a = copysign(r, x);
        return (struct orl_square){a, a * (4 / ORL_PI) * atan(y / x)};
    }
    const double b = copysign(r, y);
    return (struct orl_square){b * (4 / ORL_PI) * atan(x / y), b};
}
