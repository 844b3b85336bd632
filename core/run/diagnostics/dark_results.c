/* Results without light: a warning if some are black, an error if all are. */
#include <stdio.h>

#include "run/diagnostics/diagnostics.h"
#include "run/diagnostics/run_warnings.h"
#include "run/run_state.h"

/* Numbers of black results. */
struct dark_counts {
    size_t sensors, views; /* number of black sensors and views */
    size_t first_sensor, first_view;
};

static struct dark_counts count_dark(const struct orl_result *result)
{
    struct dark_counts dark = {0};
    for (size_t i = 0; i < result->n_sensors; i++)
        if (result->illuminance_lx[i] == 0 && dark.sensors++ == 0)
            dark.first_sensor = i;
    for (size_t i = 0; i < result->n_views; i++)
        if (result->views[i].black && dark.views++ == 0)
            dark.first_view = i;
    return dark;
}

static int fail_dark(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    const struct orl_result *result = state->result;
    const bool lit = lit_scene->n_suns + lit_scene->n_domes + lit_scene->n_emitters > 0;
    char what[96];
    if (result->n_views == 0 && result->n_sensors == 1)
        snprintf(what, sizeof what, "the only sensor is at 0 lx");
    else if (result->n_views == 0)
        snprintf(what, sizeof what, "every one of the %zu sensors is at 0 lx", result->n_sensors);
    else if (result->n_sensors == 0 && result->n_views == 1)
        snprintf(what, sizeof what, "the only view is black");
    else if (result->n_sensors == 0)
        snprintf(what, sizeof what, "every one of the %zu views is black", result->n_views);
    else
        snprintf(what, sizeof what, "all sensors (%zu) and views (%zu) are black",
                 result->n_sensors, result->n_views);
    orl_error_set(err, ORL_ERR_UNLIT, "%s: %s", what,
                  lit ? "none of the scene's light reaches them"
                      : "the scene has no light that is simulated, no sky, sun or lamp");
    orl_error_hint(
        err, "%s; where darkness is right, the job says \"dark\": \"expected\"",
        lit ? "They may lie inside a solid, face a surface, or be walled in: see whether "
              "windows are open to the outside and normals face the room"
            : "Give the job a \"sky\" (of a project: --sky), or the scene lights");
    return ORL_ERR_UNLIT;
}

int orl_run_diagnose_dark(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_result *result = state->result;
    const struct dark_counts dark = count_dark(result);
    if ((result->sky_given && result->sky_dark) || state->job->dark_expected)
        return 0;
    if (dark.sensors == result->n_sensors && dark.views == result->n_views)
        return fail_dark(state, err);
    if (dark.sensors > 0)
        orl_run_warn(state,
                     "%zu of %zu sensors %s at 0 lx, the first of them sensors[%zu]: no light was "
                     "found there, as inside a solid; the others are not touched by that",
                     dark.sensors, result->n_sensors, dark.sensors == 1 ? "is" : "are",
                     dark.first_sensor);
    if (dark.views > 0)
        orl_run_warn(state, "%zu of %zu views %s black, the first of them '%s'", dark.views,
                     result->n_views, dark.views == 1 ? "is" : "are",
                     result->views[dark.first_view].name);
    return 0;
}
