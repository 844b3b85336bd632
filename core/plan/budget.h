/*
 * How many caustic photons a job is to have when it does not say, from what a pilot says of them
 * (photon/shooting/worth.h); and what the photons of a plan will take.
 *
 * Their worth is their share of the light times their contrast where they land. From a twentieth on
 * they are as many as the global ones; below that fewer, in proportion, since noise and blur of
 * what is faint are faint; but never so few that a kernel holds none. And their rays are bounded by
 * those of the global photons: by half of these where caustics are worth nothing, thirty times as
 * many where they are worth all, and between by the square of their worth. Nor have they more rays
 * than half of the global ones and those by which the light where they land errs least (Neyman
 * 1934, Journal of the Royal Statistical Society 97, 558): more would do more for the picture as
 * global photons. By the first bound, or more where caustics outshine what else is there, what a
 * job asks for is bounded too, unless it wants exactly that, whatever it takes.
 */
#ifndef ORL_PLAN_BUDGET_H
#define ORL_PLAN_BUDGET_H

#include <oriel/run.h>

#include "photon/shooting/worth.h"

/* So few are not worth a pilot. */
enum { ORL_FEW_PHOTONS = 5000 };

/* Whether the job asks for a number of caustic photons that a pilot may bound. */
bool orl_plan_bounds_caustics(const struct orl_job *job);

/* Fills the plan's foresight; and its caustic photons, where the job leaves them open, or asks for
 * more than are worth their time. */
void orl_plan_budget(const struct orl_job *job, const struct orl_worth *worth,
                     struct orl_plan *plan);

#endif
