/* Sums over the nodes that one is divided into, and how far they may differ by chance. */
#ifndef ORL_GONIOMETER_FAN_H
#define ORL_GONIOMETER_FAN_H

/* The ratio of sums of squares that chance exceeds in 1 of 10^4 cases (chi-square), of fan - 1
 * degrees of freedom. */
double orl_gonio_by_chance(unsigned fan);

/* By pairs, which mirrors (i ^ mirror) leave as they are, so that no rounding tells them apart. The
 * values are used up. */
double orl_gonio_sum(double *values, unsigned fan);

#endif
