/* Plans of small rooms for tests. */
#ifndef ORL_TESTS_SUPPORT_PLAN_QUERY_H
#define ORL_TESTS_SUPPORT_PLAN_QUERY_H

#include "plan/plan.h"
#include "support/room.h"

#define SKY ROOM_SKY
#define SUN ROOM_SUN
#define NORTH_SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 1 1 .533\n"
#define SECOND_NORTH_SUN "l source sun2 0 0 4 .2 1 1 .533\n"
#define ROOM ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE
/* A block of flats opposite, 200 m off, 2 m of it above the sill. */
#define OPPOSITE "w polygon flats 0 0 12 -1 -200 0 5 -200 0 5 -200 3 -1 -200 3\n"
/* A dish in the only patch that the sun lights: the sun comes in at 45 degrees. */
#define DISH "void mirror m 0 0 3 .9 .9 .9\nm cup dish 0 0 8 2 1.5 .02 2 1.5 .03 .002 .012\n"
#define DISH_IN_SHADE "void mirror m 0 0 3 .9 .9 .9\nm cup dish 0 0 8 2 .5 .02 2 .5 .03 .002 .012\n"

struct plan_query {
    const char *text;
    const char *bsdf; /* text of pane.xml */
    enum orl_technique technique;
    enum orl_effect effect; /* effect to which `override` applies */
    enum orl_effect_override override;
    bool view;
    uint32_t threads;
    uint64_t caustic;
    const struct orl_sensor *sensor; /* NULL: one indoors, if there is no view */
};

/* State of the lit scene after planning. */
struct plan_left {
    size_t suns, domes, emitters;
    struct orl_omissions omit;
    bool caustics_lit, clear, silent;
};

bool plan_holds_number(const char *why);
/* Returns the plan; fails the test if a reason states no number. ret_left may be NULL. */
struct orl_plan plan_of(const struct plan_query *q, struct plan_left *ret_left);
struct orl_plan plan_text(const char *text, struct plan_left *ret_left);
/* Expect an effect that the plan skips at no more than that cost, or simulates. */
void plan_expect_skipped(const char *text, enum orl_effect effect, double bound);
void plan_expect_simulated(const char *text, enum orl_effect effect);

#endif
