/* Sums over the parts of a node, and their expected differences by chance. */
#ifndef ORL_BSDF_MAKE_TREES_NODE_STATISTICS_H
#define ORL_BSDF_MAKE_TREES_NODE_STATISTICS_H

/* Returns the ratio of sums of squares that chance exceeds in 1 of 10^4 cases (chi-square with fan
 * - 1 degrees of freedom). */
double orl_gonio_chi_square_limit(unsigned branching);

/* Returns the sum, added by pairs. Mirrors (i ^ mirror) do not change the pairs, so mirrored sums
 * are equal to the last bit. The values are overwritten. */
double orl_gonio_pairwise_sum(double *values, unsigned branching);

#endif
