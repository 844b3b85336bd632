/*
 * Shades of a year: groups of windows, the states that each group can be in, and the state of each
 * group at every hour.
 *
 * Windows of a group are the surfaces of the scene whose name or modifier the group lists, or the
 * surfaces in the files of its states. A state can do one of three things. It can add its files to
 * the scene (as in Honeybee: one file per state of an aperture group, with the windows in it). It
 * can give the listed windows another material of the scene. Or it can make them dark: black and
 * opaque. Files of a state are part of the scene in that state only. The first state of a group is
 * the open one. Direct sunlight is reported for it (ASE has blinds open), and controls are
 * evaluated for it.
 *
 * Hours. A group has a series, spans or a control, or none of them: it then stays open. A series
 * may be read from a file (orl_annual_schedules_read), and has the state of every row of the
 * weather file. With spans, the first span that contains the hour counts, by the month and the
 * middle of the row's interval; outside all spans the group is open. Controls close groups by the
 * light that the open ones let in, in each hour by itself, without a lag:
 * - By sun: IES LM-83-12, 2.2.6. Closed in hours in which more than share_percent of the points of
 *   a grid have direct sunlight of above_lx or more. The sunlight is that by windows of the group,
 *   with the blinds of all other groups open. With several grids, one of them is enough. LM-83 has
 *   2 % and 1000 lx: "more than", and "or more".
 * - By light: closed in hours in which a sensor of the grid has above_lx or more in total, with all
 *   groups open. For a grid of eyes this is the vertical illuminance at the eye.
 * - By glare: closed in hours in which DGP at one of the control's viewpoints exceeds above_dgp,
 *   with all groups open (oriel/annual/annual_glare.h).
 *
 * Combination of light. Normally each combination of states is a separate run, without
 * approximation. Two limits end that: ORL_SHADES_MOST_COMBINATIONS, and more combinations beside
 * the open one than the states in use, over all groups, plus one. Beyond them there is one run of
 * all groups in their first state, one of all in their second, and so on. Each run separates light
 * by the group whose window it enters by. The light of a group is added up over the hours of its
 * state, with a warning. Direct sunlight adds up exactly. For the rest, the panes of other groups
 * reflect as if they were in the same state. The relative error is the panes' share of the room's
 * surface, times the change of their reflectance between states, over the average absorptance of
 * the walls. The run returns ORL_ERR_UNSUPPORTED if light does not add up at all: surfaces of a
 * state that are further from a window of their group than half its longer side, sensors outdoors,
 * or buildings that light enters by other ways than windows. The last case also applies if several
 * groups are controlled by sun.
 */
#ifndef ORIEL_ANNUAL_ANNUAL_SHADES_H
#define ORIEL_ANNUAL_ANNUAL_SHADES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Viewpoints: named positions of people with their view directions. */

struct orl_viewpoint {
    char *name;                  /* owned */
    struct orl_vec3 at, towards; /* scene units; `towards` need not be unit */
};

/* Most viewpoints in a request; and viewpoints whose views are in memory together
 * (annual/viewpoints/viewpoints.c). */
enum { ORL_GLARE_MOST_VIEWPOINTS = 256, ORL_GLARE_VIEWPOINTS_AT_ONCE = 4 };
struct orl_viewpoint_request {
    struct orl_viewpoint *viewpoints; /* owned; none: no glare is computed */
    size_t n_viewpoints;
};
void orl_viewpoint_request_done(
    struct orl_viewpoint_request *viewpoint_request); /* zeros are fine */

/* Shade state. It owns its strings and arrays, as do the structs below; orl_window_group_done frees
 * them. */
struct orl_shade_state {
    char *name;
    char **files; /* scene text added in this state, after the scene's own */
    size_t n_files;
    char *material; /* replacement material of the windows; NULL: unchanged */
    bool dark;      /* true: the windows are black */
};

/* Range of months and hours. It wraps over New Year or midnight if the second value is less. */
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
    char *grid; /* NULL: all grids */
    double above_lx, share_percent;
    struct orl_viewpoint_request viewpoints; /* for ORL_SHADES_BY_GLARE */
    double above_dgp;
    uint32_t state; /* state when closed */
};

struct orl_window_group {
    char *name;
    char **windows; /* names or modifiers of surfaces; may be none */
    size_t n_windows;
    struct orl_shade_state *states;
    size_t n_states;
    unsigned char *series; /* one entry per row of the weather file; NULL: none */
    size_t n_series;
    char *schedule_file; /* file that the series is read from; or NULL */
    struct orl_shade_span *spans;
    size_t n_spans;
    struct orl_shade_control control;
};

enum {
    ORL_SHADES_MOST_GROUPS = 64,
    ORL_SHADES_MOST_STATES = 32,      /* per group */
    ORL_SHADES_MOST_NAMES = 256,      /* windows of a group, files of a state, or spans */
    ORL_SHADES_MOST_COMBINATIONS = 64 /* separate runs */
};

void orl_window_group_done(struct orl_window_group *group); /* NULL and half-filled are fine */

struct orl_annual_request;
/* Checks what is known before the year begins: names, existing states, grids of controls. Returns
 * 0, ORL_ERR_INVALID, _LIMIT or _RANGE. */
int orl_shades_validate(const struct orl_annual_request *request, struct orl_error *err);

struct orl_files;
struct orl_scene_size {
    uint64_t surfaces, triangles; /* geometry shared by several instances counts once */
};
/*
 * Reads the scene with every state of every group, as the year would, and returns an upper bound on
 * the size of the largest combination of states. The scene is read as many times as the group with
 * the most states has. Errors are those of reading a scene, and ones for missing windows and
 * materials.
 */
int orl_shades_measure(const struct orl_annual_request *request, const struct orl_files *files,
                       struct orl_scene_size *ret_largest, struct orl_error *err);

#endif
