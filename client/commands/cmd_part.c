/*
 * oriel part FILE: makes some tasks of a shared job (distributed/distributed_job.h) in the shared
 * folder that contains FILE. It leaves FILE.done when they are made, or FILE.error with the reason;
 * the ending replaces .json.
 */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "annual_job/annual_json.h"
#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "distributed/distributed_job.h"
#include "input/input_folders.h"
#include "job/job_request_json.h"
#include "output/reports.h"
#include "json/decode.h"
#include "json/problem.h"

/* The part: its tasks and progress. */
struct part {
    char folder[4096], stem[4200], scratch[4300];
    char job[ORL_JOB_TASK_KEY];
    json_t *doc, *tasks;
    uint32_t threads;
    size_t begun; /* tasks begun, or already made */
    bool over;    /* true if all tasks are begun and the run can stop */
    struct orl_shared_store shared_store;
};

/* ---- The file -------------------------------------------------------------------------------- */

static int read_part(struct part *part, const char *path, struct orl_error *err)
{
    const struct orl_files here = orl_files_from_folder(".");
    const char *slash = strrchr(path, '/');
    char job[ORL_JOB_TASK_KEY];
    struct orl_file text;
    json_t *json = NULL;
    uint64_t threads = 1;
    int rc = here.open(here.ctx, path, &text, err);
    if (rc)
        return rc;
    rc = orl_json_parse(path, text.data, text.size, &json, err);
    here.close(here.ctx, &text);
    snprintf(part->folder, sizeof part->folder, "%.*s", slash ? (int)(slash - path) : 1,
             slash ? path : ".");
    if (rc == 0)
        rc = orl_shared_folder_verify(part->folder, part->job, &part->doc, err);
    if (rc == 0)
        rc = orl_json_whole(json_object_get(json, "threads"), "threads", 1, 1024, &threads, err);
    part->threads = (uint32_t)threads;
    part->tasks = json_incref(json_object_get(json, "pieces"));
    snprintf(job, sizeof job, "%s",
             json_string_value(json_object_get(json, "job"))
                 ? json_string_value(json_object_get(json, "job"))
                 : "");
    json_decref(json);
    if (rc == 0 && strcmp(job, part->job) != 0)
        rc = orl_error_set(
            err, ORL_ERR_CORRUPT,
            "the part belongs to another job than its folder, or to another version of oriel");
    if (rc == 0 && json_array_size(part->tasks) == 0)
        rc = orl_error_set(err, ORL_ERR_INVALID, "the part lists no pieces");
    if (rc && err->file[0] == '\0')
        orl_error_at(err, path, 0, NULL);
    return rc;
}

/* ---- The run --------------------------------------------------------------------------------- */

static bool is_mine(const struct part *part, const struct orl_job_task *job_task)
{
    const json_t *own;
    size_t i;
    json_array_foreach(part->tasks, i, own)
    {
        const char *key = json_string_value(json_object_get(own, "key"));
        if (key && strcmp(key, job_task->key) == 0)
            return true;
    }
    return false;
}

/* Returns true for kinds of tasks that no other task of this part depends on. */
static bool is_last(const struct orl_job_task *job_task)
{
    static const char *const last[] = {"sensors", "view", "sky", "rows", "run", "speed", "lot"};
    for (size_t i = 0; i < sizeof last / sizeof *last; i++)
        if (strcmp(job_task->kind, last[i]) == 0)
            return true;
    return false;
}

/* Returns how many of the part's tasks are in the store, from an earlier try or another part.
 * Rows count when the first half, which their key names, is there. */
static size_t count_made(const struct part *part)
{
    const json_t *own;
    size_t i, made = 0;
    json_array_foreach(part->tasks, i, own)
    {
        const char *kind = json_string_value(json_object_get(own, "kind"));
        const char *key = json_string_value(json_object_get(own, "key"));
        char path[8400];
        if (!kind || !key)
            continue;
        snprintf(path, sizeof path, "%.4000s/%.16s-%.64s.opm", part->shared_store.folder,
                 strcmp(kind, "rows") == 0 ? "annual" : kind, key);
        made += access(path, F_OK) == 0;
    }
    return made;
}

/* Returns true if all tasks are begun. Other processes combine the tasks. */
static bool is_over(void *ctx)
{
    struct part *part = ctx;
    part->over = part->begun >= json_array_size(part->tasks);
    return part->over;
}

/* Returns true if the run asks for tasks of others after all own ones are begun. Tasks that
 * are not last may be needed by an own task, so then all own ones must be made. */
static bool is_asked_for_more(struct part *part, bool of_last)
{
    return is_over(part) && (of_last || count_made(part) >= json_array_size(part->tasks));
}

/* Chooses the part's own tasks, and missing maps that these need. */
static int choose_pieces(void *ctx, const struct orl_job_task *tasks, size_t n, bool *ret_here,
                         const struct orl_job_tasks_watch *watch, struct orl_error *err)
{
    struct part *part = ctx;
    size_t mine = 0, last = 0;
    (void)watch;
    for (size_t i = 0; i < n; i++) {
        ret_here[i] = is_mine(part, &tasks[i]);
        mine += ret_here[i];
        last += is_last(&tasks[i]);
    }
    const bool ends = mine == 0 && (is_asked_for_more(part, last > 0) || last > 0);
    part->begun += mine;
    if (ends)
        return orl_error_set(err, ORL_ERR_CANCELLED, "the job now needs other pieces");
    part->over = false;
    for (size_t i = 0; i < n; i++)
        ret_here[i] = ret_here[i] || !is_last(&tasks[i]);
    return 0;
}

static int ignore_result(void *ctx, const struct orl_annual_result *result,
                         const struct orl_annual_report *report, json_t *document,
                         struct orl_error *err)
{
    (void)ctx, (void)result, (void)report, (void)document, (void)err;
    return 0;
}

static int run_job(const struct part *part, struct orl_job_request *job_request, const char *files,
                   const struct orl_local_distribution *distribution, struct orl_error *err)
{
    const struct orl_local_callback callback = {ignore_result, NULL};
    struct orl_result result = {0};
    struct orl_study study = {0};
    struct orl_bsdf_make_result made = {0};
    json_t *results = NULL;
    int rc;
    if (job_request->kind == ORL_JOB_KIND_ANNUAL)
        return orl_local_annual(&job_request->of.annual, files, part->scratch, NULL, part->threads,
                                distribution, &callback, err);
    if (job_request->kind == ORL_JOB_KIND_BSDF_MAKE) {
        rc = orl_local_make_bsdf(&job_request->of.bsdf_make, files, part->threads, distribution,
                                 &made, err);
        orl_bsdf_make_result_done(&made);
        return rc;
    }
    if (job_request->kind == ORL_JOB_KIND_STUDY) {
        rc = orl_local_study(&job_request->of.study, files, part->scratch, part->threads,
                             distribution, &study, err);
        if (rc == 0)
            orl_study_done(&study);
        return rc;
    }
    if (job_request->of.render.n_skies > 0) {
        rc = orl_local_run_skies(&job_request->of.render, files, part->scratch, part->threads,
                                 distribution, &results, err);
        if (rc == 0)
            json_decref(results);
        return rc;
    }
    rc = orl_local_run(&job_request->of.render, files, part->scratch, part->threads, distribution,
                       &result, err);
    orl_result_done(&result);
    return rc;
}

static int make_pieces(struct part *part, struct orl_error *err)
{
    const struct orl_job_tasks tasks = {part, part->job, choose_pieces, is_over};
    struct orl_map_store store;
    const struct orl_local_distribution distribution = {&tasks, &store};
    struct orl_job_request job_request = {0};
    char files[4200];
    int rc = orl_job_request_from_json(part->doc, ORL_JOB_LOCAL, &job_request, NULL, err);
    snprintf(files, sizeof files, "%s/files", part->folder);
    snprintf(part->scratch, sizeof part->scratch, "%s.%ld", part->stem, (long)getpid());
    snprintf(part->shared_store.folder, sizeof part->shared_store.folder, "%.4000s/store",
             part->folder);
    orl_shared_store_init(&part->shared_store, &store);
    part->begun = count_made(part);
    if (rc == 0)
        rc = orl_make_folder(part->scratch, err);
    if (rc == 0)
        rc = run_job(part, &job_request, files, &distribution, err);
    orl_remove_folder(part->scratch);
    orl_shared_store_done(&part->shared_store);
    orl_job_request_done(&job_request);
    if (rc == ORL_ERR_CANCELLED && part->over)
        return 0;
    if (rc == 0 && part->begun < json_array_size(part->tasks))
        rc = orl_error_set(err, ORL_ERR_INVALID,
                           "the job has no such pieces: was the part written by another version?");
    return rc;
}

/* ---- The command ----------------------------------------------------------------------------- */

static int write_ending(const struct part *part, const char *ending, const json_t *json)
{
    struct orl_error err = {0};
    char path[4300];
    snprintf(path, sizeof path, "%s.%s", part->stem, ending);
    return orl_write_json(path, json, &err) ? orl_report_error(&err) : ORL_EXIT_OK;
}

static int run_part(const char *path)
{
    struct part part = {.begun = 0};
    struct orl_error err = {0};
    json_t *json;
    int rc, code;
    snprintf(part.stem, sizeof part.stem, "%.*s", (int)(strlen(path) - strlen(".json")), path);
    rc = read_part(&part, path, &err);
    if (rc == 0)
        rc = make_pieces(&part, &err);
    json = rc ? orl_problem_from_error(&err, NULL) : json_object();
    code = write_ending(&part, rc ? "error" : "done", json);
    json_decref(json);
    json_decref(part.doc);
    json_decref(part.tasks);
    if (rc)
        orl_report_error(&err);
    return rc ? ORL_EXIT_FAILED : code;
}

int orl_cmd_part(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {.threads = 1};
    const size_t ending = strlen(".json");
    int code;
    if (!orl_local_parse(self, argc, argv, NULL, 0, &line, &code))
        return code;
    if (strlen(line.operand) <= ending ||
        strcmp(line.operand + strlen(line.operand) - ending, ".json") != 0)
        return orl_usage_error(self, "the file of a part must end in .json");
    return run_part(line.operand);
}
