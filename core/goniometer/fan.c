#include "goniometer/fan.h"

/* With 15 degrees of freedom, and with the 3 of a cell out alone. */
static const double by_chance[2] = {3, 7};

double orl_gonio_by_chance(unsigned fan)
{
    return by_chance[fan == 4];
}

double orl_gonio_sum(double *values, unsigned fan)
{
    for (unsigned step = 1; step < fan; step *= 2)
        for (unsigned i = 0; i < fan; i += 2 * step)
            values[i] += values[i + step];
    return values[0];
}
