/*
 * Rare light: what so few of a sensor's rays happen on that their spread does not tell its error.
 *
 * A sensor whose rays have met none of it is low, and by its own rays knows nothing of that. But
 * others of the job have met some. Of a sensor's rays the sums of the fourth and of the eighth
 * powers of what each adds tell how many are the brightest, (sum of fourths)^2 / (sum of eighths),
 * as Kish's effective number of weights does: hundreds where those to a window are, one or two
 * where these are several times as bright as what many meet. Few ones, if they make up most of the
 * sensor's variance, are events of one size, and of a Poisson law with a rate of each sensor's own;
 * over sensors rates are thought to be exponential (the law of most entropy for a mean), the mean
 * being that of what all have met. With k events of its own a sensor's rate is then a gamma's of
 * shape 1 + k. Where every sensor's brightest rays are many, nothing changes.
 *
 * Sensors that face another way see other things: those of one job tell each other of what they
 * have met by the axis, up or down it, that each faces most.
 *
 * Where one sensor has a hundredth of another's light, indoors beside a street, it is not known
 * whether such an event would be as bright there or a hundredth of it: it is taken to go by the
 * root of the light, half way between the two.
 *
 * What all such sensors have missed stays unknown, and so does what a single one has.
 *
 * References: Kish 1965, Survey Sampling (effective numbers); Buehlmann 1967, ASTIN Bulletin 4, 199
 * (credibility: how much of a claim rate is one's own); Wilson and Hilferty 1931, Proceedings of
 * the National Academy of Sciences 17, 684 (percentiles of gamma laws).
 */
#ifndef ORL_BASE_RARE_H
#define ORL_BASE_RARE_H

#include <stddef.h>

#include <oriel/run.h>

/* What a sensor's rays add to its luma, each by itself: sums of powers. */
struct orl_rays {
    double fourths, eighths;
};

static inline void orl_rays_add(struct orl_rays *rays, double luma)
{
    const double fourth = luma * luma * luma * luma;
    rays->fourths += fourth;
    rays->eighths += fourth * fourth;
}

/* Those of a sum in which these and others' have such factors. */
struct orl_rays orl_rays_mix(struct orl_rays a, double of_a, struct orl_rays b, double of_b);

enum { ORL_RARE_SIDES = 6 }; /* which way sensors face: along which axis, and whether down it */

int orl_rare_side(struct orl_vec3 direction);

/* What all sensors of a job that face one way have met of it. */
struct orl_rare {
    double events; /* mean over sensors; 0: there is no rare light */
    double size;   /* of an event, in the root of the unit of what rays add */
    double light;  /* mean over sensors */
};

/* What sensors are told of: values, and standard errors by the spread of their groups, both in the
 * unit of what rays add. */
struct orl_rare_sensors {
    const struct orl_sensor *sensors;
    const struct orl_rays *rays;
    const double *values, *standard_errors;
    size_t count;
};
void orl_rare_of(const struct orl_rare_sensors *sensors, struct orl_rare ret_rare[ORL_RARE_SIDES]);

/* What a sensor's standard error is at the least, and how far its 95 % interval reaches from its
 * value at the least; all 0 without rare light. */
struct orl_rare_bounds {
    double standard_error, below, above;
};
struct orl_rare_bounds orl_rare_bounds(const struct orl_rare *rare, const struct orl_rays *own,
                                       double value);

#endif
