/*
 * Position index: the factor by which a source beside the line of sight may be brighter than one on
 * it for the same glare.
 *
 * Above the line of sight it is Guth's (Guth 1963, as fitted in the IES Lighting Handbook). tau is
 * the angle from vertical about the line of sight, and sigma the angle from the line of sight, in
 * degrees:
 *     P = exp((35.2 - 0.31889 tau - 1.22 e^(-2 tau / 9)) 10^-3 sigma
 *           + (21 + 0.26667 tau - 0.002963 tau^2) 10^-5 sigma^2);
 * below it is that of Iwata and Tokura (1998), in the notation of CIE 232:2019, with beta for
 * sigma:
 *     P = exp(6.49 10^-3 beta + 21 10^-5 beta^2),
 *     tan beta = tan sigma sqrt(1 + 0.3225 cos^2 tau).
 * It is at most 16. On the line of sight it is 1, and both formulas agree at eye level.
 */
#ifndef ORL_METRICS_POSITION_INDEX_H
#define ORL_METRICS_POSITION_INDEX_H

#include <oriel/base/vec.h>

/* Returns the position index. direction: unit, in the eye's axes (view_field.h), in front of the
 * eye. */
double orl_position_index(struct orl_vec3 direction);

#endif
