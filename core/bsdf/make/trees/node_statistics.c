#include "bsdf/make/trees/node_statistics.h"

/* With 15 degrees of freedom, and with the 3 of a cell out alone. */
static const double chi_square_limits[2] = {3, 7};

double orl_gonio_chi_square_limit(unsigned branching)
{
    return chi_square_limits[branching == 4];
}

double orl_gonio_pairwise_sum(double *values, unsigned branching)
{
    for (unsigned step = 1; step < branching; step *= 2)
        for (unsigned i = 0; i < branching; i += 2 * step)
            values[i] += values[i + step];
    return values[0];
}
