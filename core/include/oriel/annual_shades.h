/*
 * Shades of a year: groups of windows, what states each group can be in, and which one it is in at
 * every hour.
 *
 * Windows of a group are those surfaces of the scene whose name or modifier it names, or those that
 * the files of its states bring. A state adds its files to the scene's (Honeybee's: a file for each
 * state of an aperture group, with the windows in it); gives the windows it names another material
 * of the scene; or makes them dark: black, and opaque. Files that a state names are in the scene in
 * that state alone. The first state of a group is the open one: the one that direct sunlight by
 * itself is told of (ASE has blinds open), and that controls look at.
 *
 * Hours. A series may be a file's (orl_annual_schedules_read). Of series, spans and control a group
 * has one, or none: it stays open then. A series has the state of every row of the weather file. Of
 * spans the first one that an hour lies in counts, by the month and the middle of the row's
 * interval; outside of all the group is open. Controls close groups by what the open ones let in,
 * in each hour by itself, without a lag:
 *
 * by sun   IES LM-83-12, 2.2.6: in hours in which more than share_percent of the points of a grid
 *          have direct sunlight of above_lx or more by windows of that group, blinds of all other
 *          groups being open; with several grids, of any of them. LM-83 has 2 % and 1000 lx:
 *          "more than", and "or more".
 * by light in hours in which a sensor of the grid has above_lx or more in all, all groups being
 *          open: an eye's vertical illuminance, where the grid is of eyes.
 * by glare in hours in which DGP at one of the control's seats is above above_dgp, all groups being
 *          open (oriel/annual_glare.h).
 *
 * How light is put together. Each combination of states that there is makes a run by itself, and
 * nothing is left out, unless the combinations are more than the states that groups are in, and
 * one. Then there is a run of all groups in their first state, one of all in their second, and so
 * on. Each tells light apart by the group whose window it comes in by, and the light of a group is
 * added up in the hours that it is in that state, with a warning. Straight sunlight adds up
 * exactly. For the rest the other groups' panes reflect as if they were in the same state: that is
 * off by the share of the room's surface that they have, times how much more or less they reflect
 * in another, over what walls absorb on average. ORL_ERR_UNSUPPORTED where it does not add up at
 * all: surfaces of a state that are further from their group's windows than half of these, sensors
 * outdoors, buildings into which light has other ways than windows (likewise where several groups
 * are controlled by sun).
 */
#ifndef ORIEL_ANNUAL_SHADES_H
#define ORIEL_ANNUAL_SHADES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/seat.h>

/* Strings and arrays are owned, here and below; orl_window_group_done frees them. */
struct orl_shade_state {
    char *name;
    char **files; /* scene text that is there in this state, after the scene's own */
    size_t n_files;
    char *material; /* that the windows have; NULL: as they are written */
    bool dark;      /* the windows are black */
};

/* Months and hours, over New Year and midnight where the second is less. */
struct orl_shade_span {
    uint32_t from_month, to_month; /* 1..12, both included */
    double from_h, to_h;           /* from <= middle of the row < to */
    uint32_t state;
};

enum orl_shade_control_kind {
    ORL_SHADES_NO_CONTROL,
    ORL_SHADES_BY_SUN,
    ORL_SHADES_BY_LIGHT,
    ORL_SHADES_BY_GLARE
};

struct orl_shade_control {
    enum orl_shade_control_kind kind;
    char *grid; /* NULL: all of them */
    double above_lx, share_percent;
    struct orl_seats_wish seats; /* by glare */
    double above_dgp;
    uint32_t state; /* when closed */
};

struct orl_window_group {
    char *name;
    char **windows; /* names or modifiers of surfaces; may be none */
    size_t n_windows;
    struct orl_shade_state *states;
    size_t n_states;
    unsigned char *series; /* of every row of the weather file; NULL: none */
    size_t n_series;
    char *schedule_file; /* which the series is read from; or NULL */
    struct orl_shade_span *spans;
    size_t n_spans;
    struct orl_shade_control control;
};

enum {
    ORL_SHADES_MOST_GROUPS = 64,
    ORL_SHADES_MOST_STATES = 32,      /* of a group */
    ORL_SHADES_MOST_NAMES = 256,      /* of a group's windows, of a state's files, of spans */
    ORL_SHADES_MOST_COMBINATIONS = 64 /* that are runs by themselves */
};

void orl_window_group_done(struct orl_window_group *group); /* NULL and half-filled are fine */

struct orl_annual_request;
/* What can be told before the year begins: names, states that are there, grids of controls.
 * ORL_ERR_INVALID, _LIMIT, _RANGE. */
int orl_shades_validate(const struct orl_annual_request *request, struct orl_error *err);

struct orl_files;
struct orl_scene_size {
    uint64_t surfaces, triangles; /* what is kept once for several places is counted once */
};
/*
 * Reads the scene with every state of every group, as the year would, and bounds what the largest
 * combination of states holds. Errors are those of reading a scene, and of windows and materials
 * that it does not have. It takes as many readings as the group with the most has states.
 */
int orl_shades_measure(const struct orl_annual_request *request, const struct orl_files *files,
                       struct orl_scene_size *ret_largest, struct orl_error *err);

#endif
