/* The table of recipes. Inputs and defaults are those of lbt-recipes; `samples` and `seed` are
 * Oriel's own. */
#include <string.h>

#include <oriel/base/suggest.h>

#include "recipe/recipe_run.h"

/* clang-format off */
#define MODEL {.name = "model", .type = ORL_INPUT_FILE, .is_required = true, .help = "Honeybee model (HBJSON), or a folder of Radiance files"}
#define WEA {.name = "wea", .type = ORL_INPUT_FILE, .is_required = true, .help = "weather file: WEA or EPW"}
#define EPW {.name = "epw", .type = ORL_INPUT_FILE, .is_required = true, .help = "weather file of a whole year: EPW or WEA"}
#define NORTH {.name = "north", .type = ORL_INPUT_NUMBER, .value = "0", .least = -360, .most = 360, .help = "angle from the Y axis to north, degrees counter-clockwise"}
#define TIMESTEP {.name = "timestep", .type = ORL_INPUT_WHOLE, .value = "1", .least = 1, .most = 60, .help = "rows of the weather file per hour"}
#define SCHEDULE {.name = "schedule", .type = ORL_INPUT_FILE, .help = "a line per hour of the year, 1 in use or 0 (default: 8 to 18, every day)"}
#define THRESHOLDS {.name = "thresholds", .type = ORL_INPUT_TEXT, .value = "-t 300 -lt 100 -ut 3000", .help = "lux for daylight autonomy, and the lower and upper lux of UDI"}
#define GRIDS {.name = "grid-filter", .type = ORL_INPUT_TEXT, .value = "*", .help = "pattern for the names of grids, with * and ?"}
#define GRID_METRICS {.name = "grid-metrics", .type = ORL_INPUT_TUNING, .help = "grid-metrics: grid_summary.csv has mean, minimum, maximum and uniformity alone; custom metrics are left out"}
#define TUNING \
    {.name = "radiance-parameters", .type = ORL_INPUT_TUNING, .help = "radiance-parameters: Oriel chooses its own method and follows all reflections; use samples for more or fewer paths"}, \
    {.name = "cpu-count", .type = ORL_INPUT_TUNING, .help = "cpu-count: Oriel uses the threads that --threads gives, and does not split grids"}, \
    {.name = "min-sensor-count", .type = ORL_INPUT_TUNING, .help = "min-sensor-count: Oriel does not split grids"}
#define ORIEL \
    {.name = "samples", .type = ORL_INPUT_WHOLE, .least = 1, .most = 1048576, .help = "paths per sensor (Oriel's own input; default: by the job)"}, \
    {.name = "seed", .type = ORL_INPUT_WHOLE, .value = "0", .least = 0, .most = 9007199254740991, .help = "seed of the random numbers (Oriel's own input)"}
#define METRIC(usual) {.name = "metric", .type = ORL_INPUT_WORD, .value = (usual), .words = "illuminance|irradiance|luminance|radiance", .help = "quantity to compute"}
#define SKY {.name = "sky", .type = ORL_INPUT_TEXT, .is_required = true, .help = "sky as text, such as \"cie 21 Jun 12:00 -lat 42 -lon -71 -tz -5\""}
#define BLINDS \
    {.name = "diffuse-transmission", .type = ORL_INPUT_NUMBER, .value = "0.05", .least = 0.0001, .most = 1, .help = "diffuse transmission of the blinds that are added"}, \
    {.name = "specular-transmission", .type = ORL_INPUT_NUMBER, .value = "0.0001", .least = 0.0001, .most = 1, .help = "specular transmission of the blinds that are added"}
#define NO_IRRADIANCE "Oriel computes light as the eye sees it, and no irradiance of the whole solar spectrum"

static const struct orl_recipe recipes[] = {
    {"point-in-time-grid", "illuminance of grids under one sky", NULL,
     {MODEL, SKY, METRIC("illuminance"), GRIDS, TUNING, ORIEL},
     orl_recipe_moment_job, orl_recipe_write_illuminance, NULL},
    {"point-in-time-view", "pictures of views under one sky", NULL,
     {MODEL, SKY, METRIC("luminance"),
      {.name = "resolution", .type = ORL_INPUT_WHOLE, .value = "800", .least = 1, .most = 16384, .help = "largest width and height of a picture"},
      {.name = "view-filter", .type = ORL_INPUT_TEXT, .value = "*", .help = "pattern for the names of views, with * and ?"},
      {.name = "skip-overture", .type = ORL_INPUT_TUNING, .help = "skip-overture: Oriel has no overture"},
      TUNING, ORIEL},
     orl_recipe_moment_job, orl_recipe_write_views, NULL},
    {"daylight-factor", "daylight factors of grids under the CIE overcast sky", NULL,
     {MODEL, GRIDS, GRID_METRICS, TUNING, ORIEL},
     orl_recipe_sky_job, orl_recipe_write_factors, NULL},
    {"annual-daylight", "daylight autonomy and UDI of a year", NULL,
     {MODEL, WEA, NORTH, TIMESTEP, SCHEDULE, THRESHOLDS, GRIDS, GRID_METRICS, TUNING, ORIEL},
     orl_recipe_year_job, NULL, orl_recipe_write_year},
    {"annual-daylight-enhanced", "the same, with direct sunlight by itself", NULL,
     {MODEL, WEA, NORTH, TIMESTEP, SCHEDULE, THRESHOLDS, GRIDS, GRID_METRICS, TUNING, ORIEL},
     orl_recipe_year_job, NULL, orl_recipe_write_year},
    {"annual-daylight-en17037", "daylight provision by EN 17037", NULL,
     {MODEL, EPW, NORTH, THRESHOLDS, GRIDS, GRID_METRICS, TUNING, ORIEL},
     orl_recipe_daylight_year_job, NULL, orl_recipe_write_en17037},
    {"direct-sun-hours", "hours with the sun in sight of each sensor", NULL,
     {MODEL, WEA, NORTH, TIMESTEP, GRIDS, TUNING, ORIEL},
     orl_recipe_sun_hours_job, NULL, orl_recipe_write_sun_hours},
    {"imageless-annual-glare", "DGP of a year at the sensors, which are eyes", NULL,
     {MODEL, WEA, NORTH, SCHEDULE,
      {.name = "glare-threshold", .type = ORL_INPUT_NUMBER, .value = "0.4", .least = 0, .most = 1, .help = "DGP above which there is glare"},
      {.name = "luminance-factor", .type = ORL_INPUT_NUMBER, .value = "2000", .least = 2000, .most = 2000.5, .help = "luminance of glare sources, cd/m2: 2000 alone is supported"},
      GRIDS, TUNING, ORIEL},
     orl_recipe_glare_job, NULL, orl_recipe_write_glare},
    {"leed-daylight-option-one", "LEED v4.1, option 1: sDA and ASE", NULL,
     {MODEL, WEA, NORTH, BLINDS, GRIDS, TUNING, ORIEL},
     orl_recipe_blinds_jobs, NULL, orl_recipe_write_leed},
    {"leed-daylight-option-two", "LEED v4.1, option 2: 9 and 15 o'clock at the equinox", NULL,
     {MODEL, WEA, NORTH,
      {.name = "glare-control-devices", .type = ORL_INPUT_WORD, .value = "glare-control", .words = "glare-control|no-glare-control", .help = "whether sensors above 3000 lx pass"},
      GRIDS, TUNING, ORIEL},
     orl_recipe_equinox_jobs, orl_recipe_write_equinox, NULL},
    {"breeam-daylight-4b", "BREEAM Hea 01, 4b: hours of average and minimum illuminance", NULL,
     {MODEL, WEA, NORTH, GRIDS, TUNING, ORIEL},
     orl_recipe_year_job, NULL, orl_recipe_write_breeam},
    {"well-daylight", "WELL v2: L01 and L06", NULL,
     {MODEL, EPW, NORTH, BLINDS, GRIDS, TUNING, ORIEL},
     orl_recipe_blinds_jobs, NULL, orl_recipe_write_well},
    {"sky-view", "percentage of the sky that each sensor sees", NULL,
     {MODEL,
      {.name = "cloudy-sky", .type = ORL_INPUT_WORD, .value = "uniform", .words = "uniform|cloudy", .help = "uniform: all directions count alike; cloudy: as the CIE overcast sky"},
      GRIDS, TUNING, ORIEL},
     orl_recipe_sky_view_job, orl_recipe_write_sky_view, NULL},
    {.name = "annual-irradiance", .why_not = NO_IRRADIANCE},
    {.name = "cumulative-radiation", .why_not = NO_IRRADIANCE},
};
/* clang-format on */

const struct orl_recipe *orl_recipe_at(size_t index)
{
    return index < sizeof recipes / sizeof *recipes ? &recipes[index] : NULL;
}

/* Compares names, with '_' as '-'. */
static bool is_name(const char *text, const char *name)
{
    for (; *text && (*text == '_' ? '-' : *text) == *name; text++, name++)
        ;
    return *text == *name;
}

int orl_recipe_find(const char *name, const struct orl_recipe **ret_recipe, struct orl_error *err)
{
    struct orl_suggestion nearest = {.word = name};
    for (size_t i = 0; i < sizeof recipes / sizeof *recipes; i++) {
        const struct orl_recipe *recipe = &recipes[i];
        orl_suggestion_add(&nearest, recipe->name);
        if (!is_name(name, recipe->name))
            continue;
        if (recipe->why_not)
            return orl_error_set(err, ORL_ERR_UNSUPPORTED, "the recipe %s is not supported: %s",
                                 recipe->name, recipe->why_not);
        *ret_recipe = recipe;
        return 0;
    }
    orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no recipe '%.100s'", name);
    if (nearest.best)
        orl_error_hint(err, "did you mean %s?", nearest.best);
    else
        orl_error_hint(err, "`oriel recipe --help` lists the recipes");
    return ORL_ERR_NOT_FOUND;
}
