/*
 * oriel verify RESULT [--files DIR]: repeats a year from its provenance and compares the bytes.
 * Exit codes: 0 identical, 1 different, 2 cannot be repeated.
 */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/version.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "http/json_get.h"
#include "input/input_folders.h"
#include "input/job_file.h"
#include "output/reports.h"

enum { EXIT_CANNOT = 2, PATH_SIZE = 4096 };

/* The result to verify, and the folder where it is repeated. */
struct verification {
    struct orl_job_file result; /* its folder has the result's files */
    const char *files;          /* folder of the inputs */
    char work[PATH_SIZE];
    json_t *repeated_result; /* owned: the new result.json */
    size_t same, differing, absent;
};

static int report_cannot(const struct orl_error *err)
{
    orl_report_error(err);
    return EXIT_CANNOT;
}

/* ---- The inputs ------------------------------------------------------------------------------ */

/* Returns true if the input has its recorded digest; else prints the reason. */
static bool is_unchanged(const struct verification *v, const json_t *input)
{
    const char *name = orl_get_text(input, "name"), *wanted = orl_get_text(input, "sha256");
    char path[PATH_SIZE], digest[ORL_DIGEST_TEXT];
    struct orl_error err = {0};
    if (orl_join_path(v->files, name, path, sizeof path, &err) ||
        orl_digest_file(path, digest, &err)) {
        orl_report_error(&err);
        return false;
    }
    if (strcmp(digest, wanted) == 0)
        return true;
    fprintf(stderr, "%s: the file has changed: its SHA-256 is %s, the result was made from %s\n",
            path, digest, wanted);
    return false;
}

static int check_inputs(const struct verification *v, const json_t *provenance)
{
    const json_t *inputs = json_object_get(provenance, "inputs"), *input;
    size_t i, wrong = 0;
    json_array_foreach(inputs, i, input) wrong += !is_unchanged(v, input);
    if (wrong == 0)
        return 0;
    fprintf(stderr, "%zu of %zu inputs %s from those of the result\n", wrong,
            json_array_size(inputs), wrong == 1 ? "differs" : "differ");
    return EXIT_CANNOT;
}

/* ---- Second run ------------------------------------------------------------------------------ */

static int on_result(void *ctx, const struct orl_annual_result *result,
                     const struct orl_annual_report *report, json_t *document,
                     struct orl_error *err)
{
    struct verification *v = ctx;
    (void)result, (void)report;
    v->repeated_result = json_deep_copy(document);
    return v->repeated_result ? 0 : orl_error_no_memory(err);
}

static int run_again(struct verification *v, const json_t *document, uint32_t threads)
{
    const struct orl_local_callback callback = {on_result, v};
    struct orl_annual_job job = {0};
    struct orl_error err = {0};
    int rc = orl_annual_job_from_json(document, ORL_JOB_LOCAL, &job, NULL, &err);
    if (rc == 0)
        rc = orl_local_annual(&job, v->files, v->work, NULL, threads, NULL, &callback, &err);
    orl_annual_job_done(&job);
    return rc ? report_cannot(&err) : 0;
}

/* ---- Comparison ------------------------------------------------------------------------------ */

/* Returns 0 if the bytes are equal, 1 if not, or ORL_ERR_NOT_FOUND and others if the first file
 * cannot be read. */
static int compare_files(const char *a, const char *b)
{
    const struct orl_files here = orl_files_from_folder(".");
    struct orl_file one, other;
    int rc = here.open(here.ctx, a, &one, NULL);
    if (rc)
        return rc;
    rc = here.open(here.ctx, b, &other, NULL);
    if (rc == 0) {
        rc = one.size != other.size || (one.size && memcmp(one.data, other.data, one.size) != 0);
        here.close(here.ctx, &other);
    } else {
        rc = 1;
    }
    here.close(here.ctx, &one);
    return rc;
}

static void compare_file(struct verification *v, const char *name)
{
    char first[PATH_SIZE], repeated_result[PATH_SIZE];
    int rc = orl_join_path(v->result.folder, name, first, sizeof first, NULL);
    if (rc == 0)
        rc = orl_join_path(v->work, name, repeated_result, sizeof repeated_result, NULL);
    if (rc == 0)
        rc = compare_files(first, repeated_result);
    v->same += rc == 0;
    v->absent += rc < 0;
    v->differing += rc > 0;
    if (rc > 0)
        printf("differs: %s\n", name);
}

/* Compares result.json without the members of a run itself and without the version, which is
 * reported separately. */
static void compare_documents(struct verification *v)
{
    static const char *const own[] = {"timings_s", "threads", "reuse", "rays"};
    json_t *const both[2] = {v->result.doc, v->repeated_result};
    const size_t before = v->differing;
    const char *key;
    json_t *value;
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < sizeof own / sizeof *own; i++)
            json_object_del(both[k], own[i]);
        json_object_del(json_object_get(both[k], "provenance"), "version");
    }
    json_object_foreach(both[0], key, value)
    {
        if (json_equal(value, json_object_get(both[1], key)))
            continue;
        printf("differs: result.json: \"%s\"\n", key);
        v->differing++;
    }
    json_object_foreach(both[1], key, value)
    {
        if (json_object_get(both[0], key))
            continue;
        printf("differs: result.json: \"%s\" is new\n", key);
        v->differing++;
    }
    v->same += v->differing == before;
}

static int compare_results(struct verification *v)
{
    const json_t *names = json_object_get(v->result.doc, "files"), *name;
    size_t i;
    json_array_foreach(names, i, name) if (json_is_string(name))
        compare_file(v, json_string_value(name));
    compare_documents(v);
    if (v->absent > 0)
        fprintf(stderr, "%zu files of the result are not in %s: they are not compared\n", v->absent,
                v->result.folder);
    if (v->differing > 0)
        return ORL_EXIT_FAILED;
    printf("the same: %zu files\n", v->same);
    return ORL_EXIT_OK;
}

/* ---- Command --------------------------------------------------------------------------------- */

static const json_t *provenance_of(const struct verification *v)
{
    const json_t *provenance = json_object_get(v->result.doc, "provenance");
    const char *kind = orl_get_text(v->result.doc, "kind");
    if (strcmp(kind, "annual") == 0 &&
        strcmp(orl_get_text(v->result.doc, "state"), "succeeded") == 0 &&
        json_is_object(json_object_get(provenance, "document")))
        return provenance;
    fprintf(stderr, "%s: %s\n", v->result.path,
            strcmp(kind, "annual") == 0
                ? "the year did not succeed, or its result has no provenance"
                : "only results of years (\"annual\") can be verified");
    return NULL;
}

static int verify_result(struct verification *v, uint32_t threads)
{
    const json_t *provenance = provenance_of(v);
    struct orl_error err = {0};
    int code = provenance ? check_inputs(v, provenance) : EXIT_CANNOT;
    if (code)
        return code;
    if (strcmp(orl_get_text(provenance, "version"), ORL_VERSION) != 0)
        fprintf(stderr, "the result was made by Oriel %s, this is %s\n",
                orl_get_text(provenance, "version"), ORL_VERSION);
    if (orl_temp_folder_make("verify", v->work, &err))
        return report_cannot(&err);
    code = run_again(v, json_object_get(provenance, "document"), threads);
    return code ? code : compare_results(v);
}

int orl_cmd_verify(const struct orl_subcommand *self, int argc, char **argv)
{
    struct verification v = {.files = "."};
    struct orl_local_line line = {0};
    const struct orl_option options[] = {
        {"files", 0, "DIR", "folder of scene, weather and sensors (default: the current folder)",
         &v.files, NULL},
        ORL_OPTION_THREADS(&line.threads_text),
    };
    struct orl_error err = {0};
    struct stat st;
    char path[PATH_SIZE];
    int code;
    if (!orl_local_parse(self, argc, argv, options, 2, &line, &code))
        return code;
    snprintf(path, sizeof path, "%s%s", line.operand,
             stat(line.operand, &st) == 0 && S_ISDIR(st.st_mode) ? "/result.json" : "");
    code = orl_job_file_read(path, &v.result, &err) ? report_cannot(&err)
                                                    : verify_result(&v, line.threads);
    if (v.work[0])
        orl_remove_folder(v.work);
    json_decref(v.repeated_result);
    orl_job_file_done(&v.result);
    return code;
}
