/* Sums over the parts of a node, and their expected differences by chance. */
#ifndef ORL_GONIOMETER_FAN_H
#define ORL_GONIOMETER_FAN_H

/* Returns the ratio of sums of squares that chance exceeds in 1 of 10^4 cases (chi-square with fan
 * - 1 degrees of freedom). */
double orl_gonio_by_chance(unsigned fan);

/* Returns the sum, added by pairs. Mirrors (i ^ mirror) do not change the pairs, so mirrored sums
 * are equal to the last bit. The values are overwritten. */
double orl_gonio_sum(double *values, unsigned fan);

#endif
