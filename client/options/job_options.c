#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "http/upload_bundle.h"
#include "options/job_options.h"
#include "output/terminal.h"
#include "json/encode.h"

void orl_member_options_fill(struct orl_member_options *member_options,
                             struct orl_option *ret_options)
{
    for (size_t i = 0; i < member_options->count; i++)
        ret_options[i] = (struct orl_option){.name = member_options->items[i].name,
                                             .metavar = member_options->items[i].metavar,
                                             .help = member_options->items[i].help,
                                             .value = &member_options->texts[i]};
}

static json_t *value_of(const char *text, bool is_text)
{
    json_t *value = is_text ? NULL : json_loads(text, JSON_DECODE_ANY, NULL);
    return value ? value : json_string(text);
}

int orl_member_options_apply(const struct orl_member_options *member_options, json_t *doc)
{
    int failed = 0;
    for (size_t i = 0; i < member_options->count && !failed; i++)
        if (member_options->texts[i])
            failed = json_object_set_new(
                doc, member_options->items[i].name,
                value_of(member_options->texts[i], member_options->items[i].is_text));
    return failed;
}

json_t *orl_member_options_document(const struct orl_member_options *member_options,
                                    const char *kind, const char *member,
                                    const struct orl_operands *files)
{
    json_t *names = json_array();
    for (int i = 0; i < files->count; i++)
        names = orl_json_append(names, json_string(files->items[i]));
    json_t *doc = json_pack("{s:s, s:{s:o}}", "kind", kind, member, "files", names);
    return orl_json_checked(doc, orl_member_options_apply(member_options, doc));
}

bool orl_member_options_any(const struct orl_member_options *member_options)
{
    bool any = false;
    for (size_t i = 0; i < member_options->count; i++)
        any = any || member_options->texts[i];
    return any;
}

bool orl_is_document_name(const char *operand)
{
    static const char ending[] = ".json";
    const size_t length = strlen(operand), tail = strlen(ending);
    return length > tail && strcmp(operand + length - tail, ending) == 0;
}

bool orl_distributed_is_requested(const struct orl_subcommand *self,
                                  const struct orl_distributed_options *line, int *ret_rc)
{
    uint64_t parts;
    *ret_rc = ORL_EXIT_OK;
    if (line->parts_text && !orl_parse_count(line->parts_text, 1, ORL_PARTS_MOST, &parts))
        *ret_rc = orl_usage_error(self, "--parts takes a number from 1 to %d, not \"%s\"",
                                  ORL_PARTS_MOST, line->parts_text);
    if (line->sbatch && !line->slurm)
        *ret_rc = orl_usage_error(self, "--sbatch requires --slurm");
    return line->parts_text || line->slurm;
}

static int split_options(struct orl_local_distributed *job, const char *options,
                         struct orl_error *err)
{
    char *rest, *word;
    job->options = rest = strdup(options ? options : "");
    if (!job->options)
        return orl_error_no_memory(err);
    while ((word = strsep(&rest, " ")) != NULL) {
        if (!*word)
            continue;
        if (word[0] != '-' || job->n_words == ORL_SBATCH_OPTIONS_MAX)
            return orl_error_set(err, ORL_ERR_INVALID,
                                 "--sbatch takes up to %d options of sbatch separated by spaces, "
                                 "such as --partition=long; '%.100s' is not one",
                                 ORL_SBATCH_OPTIONS_MAX, word);
        job->words[job->n_words++] = word;
    }
    return 0;
}

static int collect_files(const json_t *doc, const char *folder, struct orl_upload *ret_bundle,
                         struct orl_error *err)
{
    struct orl_job_request job_request = {0};
    int rc = orl_job_request_from_json(doc, ORL_JOB_LOCAL, &job_request, NULL, err);
    if (rc == 0)
        rc = orl_job_bundle_collect(folder, &job_request, ret_bundle, err);
    orl_job_request_done(&job_request);
    return rc;
}

/* Opens the shared job with its files. */
static int open_job(struct orl_local_distributed *job, const struct orl_distributed_options *line,
                    struct orl_distributed_job_spec *spec, const struct orl_upload *bundle,
                    struct orl_error *err)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    struct orl_shared_file *files = calloc(bundle->n_parts + 1, sizeof *files);
    uint64_t most = line->slurm ? ORL_PARTS_USUAL : 1;
    if (!files)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < bundle->n_parts; i++)
        files[i] = (struct orl_shared_file){bundle->parts[i].name, bundle->parts[i].path};
    if (line->parts_text)
        orl_parse_count(line->parts_text, 1, ORL_PARTS_MOST, &most);
    spec->files = files;
    spec->n_files = bundle->n_parts;
    spec->most = (uint32_t)most;
    spec->slurm = line->slurm;
    spec->most_processes = cores > (long)spec->threads ? (uint32_t)cores / spec->threads : 1;
    spec->words = job->words;
    spec->n_words = job->n_words;
    int rc = orl_distributed_job_open(&job->distributed, spec, err);
    free(files);
    return rc;
}

int orl_local_distributed_open(struct orl_local_distributed *job,
                               const struct orl_distributed_options *line, const json_t *doc,
                               const char *folder, const char *output, uint32_t threads,
                               struct orl_error *err)
{
    struct orl_distributed_job_spec spec = {.folder = job->folder,
                                            .doc = doc,
                                            .program = job->program,
                                            .threads = threads,
                                            .cancel = orl_local_interrupted(),
                                            .now_s = orl_clock_s};
    struct orl_upload bundle = {0};
    *job = (struct orl_local_distributed){.n_words = 0};
    if (!line)
        return 0;
    orl_local_has_parts();
    job->shared = (struct orl_local_distribution){&job->distributed.tasks, &job->distributed.store};
    job->distribution = &job->shared;
    int rc = orl_own_program(job->program, err);
    if (rc == 0)
        rc = orl_join_path(output, "parts", job->folder, sizeof job->folder, err);
    if (rc == 0)
        rc = split_options(job, line->sbatch, err);
    if (rc == 0)
        rc = collect_files(doc, folder, &bundle, err);
    if (rc == 0)
        rc = open_job(job, line, &spec, &bundle, err);
    orl_bundle_done(&bundle);
    return rc;
}

static void print_parts(const struct orl_distributed_job *distributed)
{
    if (distributed->count.rounds == 0 && distributed->n_reused == 0)
        return;
    fprintf(stderr, "parts: %llu in %u waves, %llu of them repeated\n",
            (unsigned long long)distributed->parts, distributed->count.rounds,
            (unsigned long long)distributed->count.again);
}

void orl_local_distributed_done(struct orl_local_distributed *job, bool remove)
{
    if (!job->distribution)
        return;
    print_parts(&job->distributed);
    orl_distributed_job_done(&job->distributed, remove);
    free(job->options);
}
