/*
 * Recipes of Ladybug Tools, as translations to Oriel's jobs. A recipe has inputs, one or more jobs
 * (job_request_json.h) that give its light, and a folder of results. Inputs and folders are those
 * of the recipes in lbt-recipes 0.29, so that Honeybee's tools read the results. The guide lists
 * the differences (client/guide/howto/recipes.md).
 *
 * Use: find the recipe, check the inputs, make a run, then compute its jobs in order and hand over
 * the result of each; the last one also writes the summaries.
 *
 * Ownership: recipes are static. A run owns its data and borrows nothing after orl_recipe_run_new.
 * Threads: a run is for one thread at a time.
 * Errors: ORL_ERR_NOT_FOUND (no such recipe), ORL_ERR_INVALID and ORL_ERR_RANGE (inputs),
 * ORL_ERR_UNSUPPORTED, ORL_ERR_SYNTAX (weather or schedule, with the line), those of writing files.
 *
 * Source of inputs and folders: the recipes' package.json in ladybug-tools/lbt-recipes, and
 * honeybee-radiance-postprocess 0.5.
 */
#ifndef ORL_API_RECIPE_RECIPE_H
#define ORL_API_RECIPE_RECIPE_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/annual/annual_report.h>
#include <oriel/job/run.h>

#include "annual_job/annual_json.h"

/* ---- Recipes and their inputs ---------------------------------------------------------------- */

enum orl_recipe_input_type {
    ORL_INPUT_TEXT,
    ORL_INPUT_FILE,
    ORL_INPUT_NUMBER,
    ORL_INPUT_WHOLE,
    ORL_INPUT_WORD,  /* one of `words` */
    ORL_INPUT_TUNING /* tunes Radiance: accepted, and `help` says what it means here */
};

struct orl_recipe_input {
    const char *name;
    enum orl_recipe_input_type type;
    const char *value; /* the default as text; NULL: none */
    const char *help;
    bool is_required;
    double least, most; /* bounds of a number */
    const char *words;  /* "uniform|cloudy" */
};

enum { ORL_RECIPE_MOST_INPUTS = 16 };

struct orl_recipe_run;
struct orl_recipe {
    const char *name, *summary;
    const char *why_not; /* not NULL: the recipe is known but not supported, and why */
    struct orl_recipe_input inputs[ORL_RECIPE_MOST_INPUTS]; /* a name of NULL ends them */
    /* The steps of a run (recipe_run.h). */
    int (*make_jobs)(struct orl_recipe_run *run, struct orl_error *err);
    int (*take_result)(struct orl_recipe_run *run, size_t job, const struct orl_result *result,
                       struct orl_error *err);
    int (*take_year)(struct orl_recipe_run *run, size_t job, struct orl_error *err);
};

/* Returns the recipe at index, those that are not supported last; NULL after the last. */
const struct orl_recipe *orl_recipe_at(size_t index);
/* Finds a recipe; '_' and '-' are the same. Unknown names get the nearest one as a hint; known ones
 * without support are ORL_ERR_UNSUPPORTED. */
int orl_recipe_find(const char *name, const struct orl_recipe **ret_recipe, struct orl_error *err);

/*
 * Checks inputs, {"NAME": value, ...}, and completes them by defaults. Values are numbers or texts,
 * null counts as absent, and names may have '_' for '-'. Unknown names are errors that name the
 * nearest input. *ret_inputs: a new reference. *ret_notes: an array of sentences about the inputs
 * that tune Radiance; a new reference.
 */
int orl_recipe_check_inputs(const struct orl_recipe *recipe, const json_t *given,
                            json_t **ret_inputs, json_t **ret_notes, struct orl_error *err);
/* Return an input of checked inputs; text: NULL if there is none, number: NaN. */
const char *orl_recipe_text(const json_t *inputs, const char *name);
double orl_recipe_number(const json_t *inputs, const char *name);
/* Returns the weather file's name: the input "wea" or "epw"; NULL if the recipe has none. */
const char *orl_recipe_weather(const json_t *inputs);

/* ---- Runs ------------------------------------------------------------------------------------ */

/* The texts of a run's files, borrowed during orl_recipe_run_new. */
struct orl_recipe_texts {
    const json_t *model; /* the Honeybee model; NULL: the model is a folder of Radiance files */
    const char *weather; /* text of the weather file; NULL: none */
    size_t weather_size;
    const char *schedule; /* text of the schedule, likewise */
    size_t schedule_size;
};

/* Makes a run that writes its results below folder. */
int orl_recipe_run_new(const struct orl_recipe *recipe, const json_t *inputs,
                       const struct orl_recipe_texts *texts, const char *folder,
                       struct orl_recipe_run **ret_run, struct orl_error *err);
void orl_recipe_run_free(struct orl_recipe_run *run); /* NULL is fine */

size_t orl_recipe_job_count(const struct orl_recipe_run *run);
/* Returns the document of a job, borrowed. Its scene is {"project": the input "model"}. */
json_t *orl_recipe_job_document(const struct orl_recipe_run *run, size_t job);
/* Returns texts that must be files beside the scene's: {"NAME": "text"}; borrowed. */
const json_t *orl_recipe_job_files(const struct orl_recipe_run *run);

/* Removes grids and views that the run's filters leave out from a document that lists them. Errors:
 * ORL_ERR_INVALID if none is left. */
int orl_recipe_filter(const struct orl_recipe_run *run, json_t *document, struct orl_error *err);

/* Take the result of a job and write what it gives. output: the folder of the job's own files, for
 * its pictures. */
int orl_recipe_take_result(struct orl_recipe_run *run, size_t job, const struct orl_job *request,
                           const struct orl_result *result, const char *output,
                           struct orl_error *err);
int orl_recipe_take_year(struct orl_recipe_run *run, size_t job,
                         const struct orl_annual_job *request,
                         const struct orl_annual_result *result,
                         const struct orl_annual_report *report, const atomic_bool *cancel,
                         struct orl_error *err);

#endif
