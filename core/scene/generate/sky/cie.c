#include "scene/generate/sky/cie.h"

#include <math.h>

#include <oriel/base/units.h>

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
