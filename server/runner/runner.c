#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sys/stat.h>

#include "distributed/runner.h"
#include "runner/runner.h"
#include "json/encode.h"

/* Checks that only the daemon's user has access: the folder holds uploads, and its contents run as
 * that user. */
static int check_folder(const char *folder, struct orl_error *err)
{
    struct stat st;
    if (mkdir(folder, 0700) != 0 && errno != EEXIST)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot make the shared folder '%s': %s",
                             folder, strerror(errno));
    if (stat(folder, &st) != 0 || !S_ISDIR(st.st_mode))
        return orl_error_set(err, ORL_ERR_INVALID, "the shared folder '%s' is not a folder",
                             folder);
    if (st.st_uid != geteuid() || (st.st_mode & 077) != 0) {
        orl_error_set(err, ORL_ERR_INVALID, "other users may use the shared folder '%s'", folder);
        orl_error_hint(err, "Use chown and chmod 700, or name a folder that does not exist yet");
        return ORL_ERR_INVALID;
    }
    return access(folder, W_OK) == 0
               ? 0
               : orl_error_set(err, ORL_ERR_IO, "cannot write to the shared folder '%s': %s",
                               folder, strerror(errno));
}

/* Finds oriel, which is installed beside the daemon. */
static int find_program(struct orl_slurm_config *slurm, struct orl_error *err)
{
    char own[4096];
    const int rc = orl_own_program(own, err);
    if (rc)
        return rc;
    *strrchr(own, '/') = '\0';
    snprintf(slurm->program, sizeof slurm->program, "%.*s/oriel", (int)sizeof slurm->program - 8,
             own);
    if (access(slurm->program, X_OK) == 0)
        return 0;
    orl_error_set(err, ORL_ERR_NOT_FOUND, "'%s', which computes the parts of jobs, is not there",
                  slurm->program);
    orl_error_hint(err, "Install oriel in the same folder as orield, where all nodes see it");
    return ORL_ERR_NOT_FOUND;
}

static int list_words(const struct orl_runner_options *options, struct orl_slurm_config *slurm,
                      struct orl_error *err)
{
    for (size_t i = 0; i < ORL_RUNNER_NAMED; i++) {
        char *word = slurm->named[i];
        if (!options->named[i])
            continue;
        if (snprintf(word, ORL_SLURM_ARG_BYTES, "--%s=%s", orl_runner_named[i],
                     options->named[i]) >= ORL_SLURM_ARG_BYTES)
            return orl_error_set(err, ORL_ERR_LIMIT, "--slurm-%s is too long", orl_runner_named[i]);
        slurm->words[slurm->n_words++] = word;
    }
    for (size_t i = 0; i < options->n_words; i++)
        slurm->words[slurm->n_words++] = options->words[i];
    return 0;
}

int orl_slurm_config_open(const struct orl_runner_options *options,
                          struct orl_slurm_config *ret_slurm, struct orl_error *err)
{
    char full_path[4096];
    memset(ret_slurm, 0, sizeof *ret_slurm);
    ret_slurm->parts = options->parts;
    ret_slurm->part_threads = options->part_threads;
    ret_slurm->least_s = options->least_s;
    int rc = check_folder(options->shared, err);
    if (rc)
        return rc;
    if (!realpath(options->shared, full_path) || strlen(full_path) + 80 >= sizeof ret_slurm->folder)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the shared folder is too long");
    snprintf(ret_slurm->folder, sizeof ret_slurm->folder, "%s", full_path);
    rc = find_program(ret_slurm, err);
    return rc ? rc : list_words(options, ret_slurm, err);
}

/* ---- JSON ------------------------------------------------------------------------------------ */

json_t *orl_parts_to_json(const struct orl_parts_count *count)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:o, s:i, s:I}", "waiting", (json_int_t)count->waiting,
                     "running", (json_int_t)count->running, "done", (json_int_t)count->done,
                     "again", (json_int_t)count->again, "lost_s",
                     orl_json_from_real(round(10 * count->lost_s) / 10), "waves",
                     (int)count->rounds, "held", (json_int_t)count->held);
}

json_t *orl_runner_to_json(bool in_parts, const char *why, const struct orl_parts_count *count)
{
    json_t *runner = json_pack("{s:s, s:s}", "name", in_parts ? "slurm" : "local", "why", why);
    if (!runner || !count || json_object_set_new(runner, "parts", orl_parts_to_json(count)) == 0)
        return runner;
    json_decref(runner);
    return NULL;
}
