/* State of a year with shades: its hours, and the runs that it is composed of. */
#ifndef ORL_ANNUAL_SHADES_SHADED_YEAR_H
#define ORL_ANNUAL_SHADES_SHADED_YEAR_H

#include "annual/shades/schedule.h"
#include "annual/year/annual_year.h"

struct orl_shaded_year {
    const struct orl_annual_request *request;
    const struct orl_annual_env *env;
    /* Result of the run with all groups open, then of the whole year. */
    struct orl_annual_result *result;
    struct orl_year *reader;                               /* a year used only for its hours */
    unsigned char *states;                                 /* [group * n_steps + step] */
    unsigned char (*combinations)[ORL_SHADES_MOST_GROUPS]; /* the first one: all open */
    size_t n_combinations;
    unsigned char
        *combination_of; /* by column: index of the combination; MOST: there was no room for it */
    bool opened;         /* true once the run with all groups open is done */
    bool summed;         /* true if light is added up by window groups */
    struct orl_shade_count *counts; /* by group: sensors in direct sunlight; zero until begun */
    double reported_progress;       /* progress: share of the whole in runs that have ended */
    bool sensors_checked;           /* true once a run has checked the sensors */
    struct orl_error *err;
};

/* Allocates memory for combinations, and reads the hours and their schedules into result and
 * states. */
int orl_shaded_year_begin(struct orl_shaded_year *shaded_year);
/* Frees everything except the result. */
void orl_shaded_year_done(struct orl_shaded_year *shaded_year);

/* One run of the year. */
struct orl_sub_run {
    const unsigned char *states; /* one per group */
    uint32_t index;              /* unique among all possible runs */
    const struct orl_year_window_groups
        *window_groups; /* NULL: light is not split by window group */
    bool sun_only;      /* true: direct sunlight alone, by window groups */
    double share;       /* share of the total work, for progress */
};

/* Runs the year in given states. Adds the run's statistics and warnings to the result. Errors are
 * those of orl_annual_run. */
int orl_shaded_year_run(struct orl_shaded_year *shaded_year, const struct orl_sub_run *sub,
                        struct orl_annual_result *ret_run);

#endif
