/*
 * Deviation of f(in, out) from f(out, in), as a share of the light. Means over a fixed set of
 * evenly spread samples, accurate to about half a per cent.
 */
#include "bsdf/bsdf_internal.h"

enum { DRAWS = 40000 };

void orl_r_sequence_point(unsigned i, double ret_u[4])
{
    double step = 1;
    for (int k = 0; k < 4; k++) {
        double whole;
        step /= 1.1673039782614187;
        ret_u[k] = modf(0.5 + step * (i + 1), &whole);
    }
}

/*
 * Returns the mean, over the light scattered one way, of max(0, 1 - f(out, in) / f(in, out)): the
 * light that reverse paths lack. Sets *ret_amount to the light's amount. Pairs that are dark only
 * this way are found from the other side, where the roles are exchanged.
 */
static double missing_in_reverse(const struct orl_bsdf *bsdf, bool front, enum orl_bsdf_side side,
                                 double *ret_amount)
{
    double missing = 0, amount = 0;
    for (unsigned i = 0; i < DRAWS; i++) {
        double u[4], r, pdf, f;
        struct orl_vec3 in, out;
        struct orl_rgb weight;
        orl_r_sequence_point(i, u);
        r = sqrt(u[0]);
        in = orl_v3(r * cos(2 * ORL_PI * u[1]), r * sin(2 * ORL_PI * u[1]), sqrt(1 - u[0]));
        in.z = front ? in.z : -in.z;
        if (!orl_bsdf_sample(bsdf, in, side, (double[3]){u[2], u[3], 0.5}, &out, &weight, &pdf))
            continue;
        f = orl_luma(orl_bsdf_eval(bsdf, in, out));
        amount += orl_luma(weight);
        missing += orl_luma(weight) * fmax(0, 1 - orl_luma(orl_bsdf_eval(bsdf, out, in)) / f);
    }
    *ret_amount = amount / DRAWS;
    return missing / DRAWS;
}

double orl_bsdf_irreciprocal_reflection(const struct orl_bsdf *bsdf, bool front)
{
    double amount;
    const double missing = missing_in_reverse(bsdf, front, ORL_BSDF_REFLECT, &amount);
    return amount > 0 ? missing / amount : -1;
}

double orl_bsdf_irreciprocal_transmission(const struct orl_bsdf *bsdf)
{
    double missing = 0, amount = 0, part;
    for (int front = 0; front < 2; front++) {
        missing += missing_in_reverse(bsdf, front, ORL_BSDF_TRANSMIT, &part);
        amount += part;
    }
    return amount > 0 ? missing / amount : -1;
}
