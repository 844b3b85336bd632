/* A year with shades: the scene in given states, the states in every hour, and the runs. */
#ifndef ORL_ANNUAL_SHADES_SHADED_YEAR_H
#define ORL_ANNUAL_SHADES_SHADED_YEAR_H

#include <oriel/annual/annual.h>

#include "annual/year/annual_year.h"
#include "scene/surfaces.h"

/* The scene of a year with its window groups in given states: its files, and material
 * overrides. */

struct orl_shaded_scene {
    /* The year's request with other scene_files and no groups; the rest is borrowed. */
    struct orl_annual_request request;
    char **files;                        /* owned array; names are borrowed */
    struct orl_material_override *items; /* one per group */
    struct orl_material_overrides material_overrides;
};

/* Builds the scene. states: one per group. by_window_group: light can be split by window group
 * (scene/surfaces.h). Borrows the request, and contains pointers to itself, so it must not be
 * moved. Returns 0, ORL_ERR_NOMEM or ORL_ERR_INVALID (no file is left); the caller calls
 * orl_shaded_scene_done in either case. */
int orl_shaded_scene_init(struct orl_shaded_scene *shaded_scene,
                          const struct orl_annual_request *request, const unsigned char *states,
                          bool by_window_group, struct orl_error *err);
void orl_shaded_scene_done(struct orl_shaded_scene *shaded_scene);

/* Returns the largest number of states of a window group; 1 without groups. */
size_t orl_shades_most_states(const struct orl_annual_request *request);

/* State of each window group of a year at every row of the weather file
 * (oriel/annual/annual_shades.h has the rules). */

/* Sets the states by series and spans; groups with a control, or without any of these, get 0.
 * result: only its steps are read. ret_states: [group * n_steps + step]. Returns 0 or ORL_ERR_RANGE
 * (a series of another length). */
int orl_shades_schedule(const struct orl_annual_request *request,
                        const struct orl_annual_result *result, unsigned char *ret_states,
                        struct orl_error *err);

/*
 * Control by light. Sensors are counted in order, one by one. After the last sensor of a grid its
 * decision is recorded, so memory does not grow with the grids. If there is no grid, all sensors
 * form one.
 */
struct orl_shade_count {
    size_t grid;   /* index of the current grid */
    uint32_t *lit; /* by column: sensors of the current grid at or above the threshold */
    bool *closed;  /* by column: true if some earlier grid closes the group */
    size_t columns;
};

/* Starts a count, with arrays owned by `arrays`. Returns 0 or ORL_ERR_NOMEM. */
int orl_shade_count_init(struct orl_shade_count *count, struct orl_arrays *arrays, size_t columns);
/* Counts a sensor. lx: its light by column with all groups open: total light, or direct light
 * through the group's own windows. Sensors without light may be skipped. */
void orl_shade_count_add(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control, size_t sensor, const float *lx);
/* Ends the count after the last sensor; closed then covers all grids. */
void orl_shade_count_end(struct orl_shade_count *count, const struct orl_annual_request *request,
                         const struct orl_shade_control *control);

/* State of a year with shades: its hours, and the runs that it is composed of. */

struct orl_shaded_year {
    const struct orl_annual_request *request;
    const struct orl_annual_env *env;
    /* Result of the run with all groups open, then of the whole year. */
    struct orl_annual_result *result;
    struct orl_year *reader;                               /* a year used only for its hours */
    struct orl_arrays arrays;                              /* the arrays below but `states` */
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
