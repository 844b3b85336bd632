/* A year with shades under way: its hours, and one of the runs that it is put together of. */
#ifndef ORL_ANNUAL_SHADING_H
#define ORL_ANNUAL_SHADING_H

#include "annual/schedule.h"
#include "annual/year.h"

struct orl_shading {
    const struct orl_annual_request *request;
    const struct orl_annual_env *env;
    struct orl_annual_result *result; /* of all open, which becomes that of all */
    struct orl_year *reader;          /* of the hours alone */
    unsigned char *states;            /* [group * n_steps + step] */
    unsigned char (*combinations)[ORL_SHADES_MOST_GROUPS]; /* the first: all open */
    size_t n_combinations;
    unsigned char *which;           /* of them, by column; MOST: one that there was no room for */
    bool opened;                    /* the run of all open is done */
    bool summed;                    /* light is added up by parts of the windows */
    struct orl_shade_count *counts; /* by group: sensors in direct sunlight; or not begun */
    double told;                    /* of the whole, by runs that are over */
    bool sensors_checked;           /* by the first run */
    struct orl_error *err;
};

/* Memory for combinations, and the hours with their schedules, into the result and states. */
int orl_shading_begin(struct orl_shading *shading);
/* All but what is the result's. */
void orl_shading_done(struct orl_shading *shading);

/* A run of the year. */
struct orl_sub_run {
    const unsigned char *states;        /* of each group */
    uint32_t index;                     /* its own, of all runs there may be */
    const struct orl_year_parts *parts; /* NULL: light is not told apart */
    bool sun_only;                      /* direct sunlight alone, by parts */
    double share;                       /* of what there is to do in all */
};

/* Its account and warnings go into the result. Its errors are orl_annual_run's. */
int orl_shading_run(struct orl_shading *shading, const struct orl_sub_run *sub,
                    struct orl_annual_result *ret_run);

#endif
