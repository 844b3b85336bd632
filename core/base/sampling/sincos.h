/*
 * Sines and cosines for sampling: inlined, without tables, and with the same bits on any machine
 * (the results of a C library vary with the processor's instructions). Taylor series up to the last
 * bit of an eighth of a turn; errors are within 3e-16.
 */
#ifndef ORL_BASE_SAMPLING_SINCOS_H
#define ORL_BASE_SAMPLING_SINCOS_H

struct orl_sincos {
    double cosine, sine;
};

/* Returns cosine and sine of an angle in radians, -pi / 4 to pi / 4. */
static inline struct orl_sincos orl_sincos_small(double angle)
{
    const double a = angle * angle, b = a * a, c = b * b;
    const double sine = ((1 - a * (1.0 / 6)) + b * (1.0 / 120 - a * (1.0 / 5040))) +
                        c * ((1.0 / 362880 - a * (1.0 / 39916800)) +
                             b * (1.0 / 6227020800.0 - a * (1.0 / 1307674368000.0)));
    const double cosine =
        ((1 - 0.5 * a) + b * (1.0 / 24 - a * (1.0 / 720))) +
        c * ((1.0 / 40320 - a * (1.0 / 3628800)) +
             b * ((1.0 / 479001600.0 - a * (1.0 / 87178291200.0)) + b * (1.0 / 20922789888000.0)));
    return (struct orl_sincos){cosine, angle * sine};
}

/* Returns cosine and sine of a share of a whole turn, 0 to 1. */
static inline struct orl_sincos orl_sincos_turn(double turn)
{
    const int quarter = (int)(4 * turn + 0.5);
    const struct orl_sincos near = orl_sincos_small((turn - 0.25 * quarter) * 6.283185307179586);
    const double sign = quarter & 2 ? -1 : 1;
    return quarter & 1 ? (struct orl_sincos){-sign * near.sine, sign * near.cosine}
                       : (struct orl_sincos){sign * near.cosine, sign * near.sine};
}

#endif
