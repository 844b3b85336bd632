#include "sharing_line.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "local.h"
#include "parts/whole_files.h"
#include "progress.h"
#include "task_bundle.h"

bool orl_sharing_asked(const struct orl_subcommand *self, const struct orl_sharing_line *line,
                       int *ret_rc)
{
    uint64_t parts;

    *ret_rc = ORL_EXIT_OK;
    if (line->parts_text && !orl_parse_count(line->parts_text, 1, ORL_PARTS_MOST, &parts))
        *ret_rc = orl_usage_error(self, "--parts takes a number from 1 to %d, not \"%s\"",
                                  ORL_PARTS_MOST, line->parts_text);
    if (line->sbatch && !line->slurm)
        *ret_rc = orl_usage_error(self, "--sbatch goes with --slurm");
    return line->parts_text || line->slurm;
}

static int cut_words(struct orl_shared_job *job, const char *options, struct orl_error *err)
{
    char *rest, *word;

    job->options = rest = strdup(options ? options : "");
    if (!job->options)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    while ((word = strsep(&rest, " ")) != NULL) {
        if (!*word)
            continue;
        if (word[0] != '-' || job->n_words == ORL_SLURM_WORDS)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "--sbatch takes up to %d options of sbatch, as --partition=long, "
                                 "with spaces between them; '%.100s' is none",
                                 ORL_SLURM_WORDS, word);
        job->words[job->n_words++] = word;
    }
    return 0;
}

static int collect_files(const json_t *doc, const char *folder, struct orl_upload *ret_bundle,
                         struct orl_error *err)
{
    struct orl_task task = {0};
    int rc = orl_task_from_json(doc, ORL_JOB_LOCAL, &task, NULL, err);

    if (rc == 0)
        rc = orl_task_bundle_collect(folder, &task, ret_bundle, err);
    orl_task_done(&task);
    return rc;
}

/* Opens the shared job with its files. */
static int open_job(struct orl_shared_job *job, const struct orl_sharing_line *line,
                    struct orl_sharing_spec *spec, const struct orl_upload *bundle,
                    struct orl_error *err)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    struct orl_shared_file *files = calloc(bundle->n_parts + 1, sizeof *files);
    uint64_t most = line->slurm ? ORL_PARTS_USUAL : 1;
    int rc;

    if (!files)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < bundle->n_parts; i++)
        files[i] = (struct orl_shared_file){bundle->parts[i].name, bundle->parts[i].path};
    if (line->parts_text)
        orl_parse_count(line->parts_text, 1, ORL_PARTS_MOST, &most);
    spec->files = files;
    spec->n_files = bundle->n_parts;
    spec->most = (uint32_t)most;
    spec->slurm = line->slurm;
    spec->abreast = cores > (long)spec->threads ? (uint32_t)cores / spec->threads : 1;
    spec->words = job->words;
    spec->n_words = job->n_words;
    rc = orl_sharing_open(&job->sharing, spec, err);
    free(files);
    return rc;
}

int orl_shared_job_open(struct orl_shared_job *job, const struct orl_sharing_line *line,
                        const json_t *doc, const char *folder, const char *output, uint32_t threads,
                        const atomic_bool *cancel, struct orl_error *err)
{
    struct orl_sharing_spec spec = {.folder = job->folder,
                                    .doc = doc,
                                    .program = job->program,
                                    .threads = threads,
                                    .cancel = cancel,
                                    .now_s = orl_clock_s};
    struct orl_upload bundle = {0};
    int rc;

    orl_local_has_parts();
    *job = (struct orl_shared_job){.n_words = 0};
    rc = orl_own_program(job->program, err);
    if (rc == 0)
        rc = orl_join_path(output, "parts", job->folder, sizeof job->folder, err);
    if (rc == 0)
        rc = cut_words(job, line->sbatch, err);
    if (rc == 0)
        rc = collect_files(doc, folder, &bundle, err);
    if (rc == 0)
        rc = open_job(job, line, &spec, &bundle, err);
    orl_bundle_done(&bundle);
    return rc;
}

static void print_parts(const struct orl_sharing *sharing)
{
    if (sharing->count.waves == 0 && sharing->earlier == 0)
        return;
    fprintf(stderr, "parts: %llu in %u waves, %llu of them once more\n",
            (unsigned long long)sharing->parts, sharing->count.waves,
            (unsigned long long)sharing->count.again);
}

void orl_shared_job_done(struct orl_shared_job *job, bool remove)
{
    print_parts(&job->sharing);
    orl_sharing_done(&job->sharing, remove);
    free(job->options);
}
