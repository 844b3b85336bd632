#include "metrics/position_index.h"

static const double most = 16;

static double above_sight(double sigma, double tau)
{
    const double by_angle = 35.2 - 0.31889 * tau - 1.22 * exp(-2 * tau / 9);
    const double by_square = 21 + 0.26667 * tau - 0.002963 * tau * tau;
    return exp(by_angle * 1e-3 * sigma + by_square * 1e-5 * sigma * sigma);
}

/* tan beta is the distance from the line of sight on a plane at distance 1, stretched
 * vertically. */
static double below_sight(struct orl_vec3 d)
{
    const double across = hypot(d.x, d.y), cos_tau = across > 0 ? d.y / across : 0;
    const double stretched = across * sqrt(1 + 0.3225 * cos_tau * cos_tau);
    const double beta = atan2(stretched, d.z) / ORL_DEG_TO_RAD;
    return exp(6.49e-3 * beta + 21e-5 * beta * beta);
}

double orl_position_index(struct orl_vec3 direction)
{
    const double across = hypot(direction.x, direction.y);
    const double sigma = atan2(across, direction.z) / ORL_DEG_TO_RAD;
    if (direction.y < 0)
        return fmin(below_sight(direction), most);
    return fmin(above_sight(sigma, atan2(fabs(direction.x), direction.y) / ORL_DEG_TO_RAD), most);
}
