/*
 * A run of a recipe, for the sources of this folder: its inputs, model and weather, its jobs, and
 * what it keeps of their results. recipe_table.c has the recipes; each names functions of one of
 * the sources below, which make its jobs and write its results.
 */
#ifndef ORL_API_RECIPE_RECIPE_RUN_H
#define ORL_API_RECIPE_RECIPE_RUN_H

#include "recipe/model_grids.h"
#include "recipe/recipe.h"
#include "recipe/result_files.h"
#include "recipe/weather_rows.h"

enum { ORL_RECIPE_MOST_JOBS = 3 };

struct orl_recipe_run {
    const struct orl_recipe *recipe;
    json_t *inputs;
    json_t *model; /* a copy; NULL: none */
    struct orl_model_grids grids;
    struct orl_weather_rows weather; /* no rows: none was read */
    json_t *documents[ORL_RECIPE_MOST_JOBS];
    size_t n_jobs;
    json_t *files; /* {"NAME": "text"} */
    struct orl_result_folder out;
    double *kept[ORL_RECIPE_MOST_JOBS]; /* one number per sensor of earlier jobs, owned */
    /* The year that is being taken; all borrowed, and set only during take_year. */
    const struct orl_annual_job *job;
    const struct orl_annual_result *result;
    const struct orl_annual_report *report;
    const atomic_bool *cancel;
    /* Likewise the job of take_result. */
    const struct orl_job *render;
    const char *output;
};

/* ---- Jobs: recipe_jobs.c --------------------------------------------------------------------- */

int orl_recipe_sky_job(struct orl_recipe_run *run, struct orl_error *err); /* daylight factor */
int orl_recipe_sky_view_job(struct orl_recipe_run *run, struct orl_error *err); /* sky view */
int orl_recipe_moment_job(struct orl_recipe_run *run, struct orl_error *err);   /* point in time */
int orl_recipe_equinox_jobs(struct orl_recipe_run *run, struct orl_error *err); /* LEED, option 2 */
int orl_recipe_year_job(struct orl_recipe_run *run, struct orl_error *err);
int orl_recipe_daylight_year_job(struct orl_recipe_run *run, struct orl_error *err); /* EN 17037 */
int orl_recipe_sun_hours_job(struct orl_recipe_run *run, struct orl_error *err);
int orl_recipe_glare_job(struct orl_recipe_run *run, struct orl_error *err);
int orl_recipe_blinds_jobs(struct orl_recipe_run *run,
                           struct orl_error *err); /* open, closed, LM-83 */

/* Adds a job; takes document. NULL: out of memory. */
int orl_recipe_add_job(struct orl_recipe_run *run, json_t *document, struct orl_error *err);
/* Makes a year's document from the recipe's inputs. */
json_t *orl_recipe_year_document(const struct orl_recipe_run *run);
/* Adds blinds to windows without states of their own, as shades of a year: a group for each room
 * and side. blinds.c. Returns the shades, a new reference, empty if all windows have states. */
int orl_recipe_add_blinds(struct orl_recipe_run *run, json_t **ret_shades, struct orl_error *err);

/* ---- Results --------------------------------------------------------------------------------- */

typedef int orl_recipe_result_taker(struct orl_recipe_run *run, size_t job,
                                    const struct orl_result *result, struct orl_error *err);
typedef int orl_recipe_year_taker(struct orl_recipe_run *run, size_t job, struct orl_error *err);

/* moment_results.c */
orl_recipe_result_taker orl_recipe_write_factors, orl_recipe_write_sky_view,
    orl_recipe_write_illuminance, orl_recipe_write_views, orl_recipe_write_equinox;
/* year_results.c */
orl_recipe_year_taker orl_recipe_write_year, orl_recipe_write_sun_hours, orl_recipe_write_glare;
/* en17037_results.c, breeam_results.c, blinds_results.c */
orl_recipe_year_taker orl_recipe_write_en17037, orl_recipe_write_breeam, orl_recipe_write_leed,
    orl_recipe_write_well;

/* Writes the EN 17037 folder; shared with WELL. */
int orl_recipe_write_en17037_folder(struct orl_recipe_run *run, const char *folder,
                                    struct orl_error *err);
/* Writes results/, the hours of all sensors, and for recipes that have it the model's copy. */
int orl_recipe_write_hours(struct orl_recipe_run *run, struct orl_error *err);
/* Writes daylight_hours.json and daylight_hours.csv: the hours that EN 17037 counts. */
int orl_recipe_write_daylight_hours(struct orl_recipe_run *run, struct orl_error *err);

/* Returns the grid of the model that a grid of the report or result is, or NULL. */
const struct orl_model_grid *orl_recipe_grid(const struct orl_recipe_run *run, const char *name);
/* Returns the area of a sensor of a grid: its mesh's face, or 1 where grids have no meshes. */
double orl_recipe_sensor_area(const struct orl_recipe_run *run, const struct orl_model_grid *grid,
                              size_t sensor);
/* Returns true if all grids of the year have a face of a mesh for each sensor. */
bool orl_recipe_has_areas(const struct orl_recipe_run *run);
/* Returns grids_info.json of the year's grids, or of the job's; a new reference. */
json_t *orl_recipe_grids_info(const struct orl_recipe_run *run, const struct orl_result *result);
/* Evaluates a metric of a sensor of the year. */
double orl_recipe_metric(const struct orl_recipe_run *run, enum orl_metric_kind kind,
                         enum orl_annual_when when, double low, double high, size_t sensor);
/* Returns an hourly data collection of Ladybug Tools of the year: takes data_type, metadata and
 * values. A new reference. */
json_t *orl_recipe_hourly(const struct orl_recipe_run *run, json_t *data_type, const char *unit,
                          json_t *metadata, json_t *values);

#endif
