#include "photon/emission/parallel_beam.h"

#include <math.h>

double orl_parallel_beam_sample(const struct orl_geometry *g, struct orl_vec3 towards,
                                const double u[2], struct orl_vec3 *ret_point)
{
    const double pad = g->radius * 1e-4;
    const double low[3] = {g->low.x - pad, g->low.y - pad, g->low.z - pad};
    const double high[3] = {g->high.x + pad, g->high.y + pad, g->high.z + pad};
    const double d[3] = {towards.x, towards.y, towards.z};
    double area[3], total = 0, at[3];
    int face = 0;
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        area[k] = fabs(d[k]) * (high[i] - low[i]) * (high[j] - low[j]);
        total += area[k];
    }
    double left = u[0] * total;
    while (face < 2 && left >= area[face])
        left -= area[face++];
    const int i = (face + 1) % 3, j = (face + 2) % 3;
    at[face] = d[face] > 0 ? high[face] : low[face];
    at[i] = low[i] + fmin(area[face] > 0 ? left / area[face] : 0, 1) * (high[i] - low[i]);
    at[j] = low[j] + u[1] * (high[j] - low[j]);
    *ret_point = orl_v3(at[0], at[1], at[2]);
    return total;
}
