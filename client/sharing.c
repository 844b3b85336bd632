#include "sharing.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <oriel/sha256.h>
#include <oriel/version.h>

#include "command.h"
#include "decode.h"
#include "digest.h"
#include "files.h"
#include "place.h"
#include "problem.h"
#include "task_bundle.h"

enum { MOST_PARTS = 1000, USUAL_PARTS = 64, MOST_TRIES = 3 };

/* Looked at so often, and so often must its runner say that a part is gone that left nothing: what
 * another machine has written may take seconds to be seen here. */
static const struct timespec between = {.tv_nsec = 50000000};
enum { GONE_TIMES = 100 };

/* ---- The folder ------------------------------------------------------------------------------ */

static int copy_file(const char *from, const char *to, struct orl_error *err)
{
    char buffer[1 << 16], folder[8400];
    struct orl_new_file file;
    long long size;
    FILE *stream;
    size_t got;
    int rc;

    snprintf(folder, sizeof folder, "%s", to);
    *strrchr(folder, '/') = '\0';
    rc = orl_make_folder(folder, err);
    if (rc == 0)
        rc = orl_open_for_reading(from, &stream, &size, err);
    if (rc)
        return rc;
    rc = orl_new_file_open(&file, to, err);
    if (rc == 0) {
        while ((got = fread(buffer, 1, sizeof buffer, stream)) > 0)
            fwrite(buffer, 1, got, file.stream);
        rc = orl_new_file_commit(&file, err);
    }
    fclose(stream);
    return rc;
}

/* The bundle's files into FOLDER/files, and their digests. */
static int lay_out_files(const struct orl_sharing *sharing, const struct orl_upload *bundle,
                         json_t *digests, struct orl_error *err)
{
    int rc = 0;

    for (size_t i = 0; i < bundle->n_parts && rc == 0; i++) {
        const struct orl_upload_part *part = &bundle->parts[i];
        char to[8400], digest[ORL_DIGEST_TEXT];

        snprintf(to, sizeof to, "%s/files/%s", sharing->folder, part->name);
        rc = copy_file(part->path, to, err);
        if (rc == 0)
            rc = orl_digest_file(to, digest, err);
        if (rc == 0 && json_object_set_new(digests, part->name, json_string(digest)))
            rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    return rc;
}

static int write_in(const struct orl_sharing *sharing, const char *name, const json_t *json,
                    struct orl_error *err)
{
    char path[4200];

    snprintf(path, sizeof path, "%s/%s", sharing->folder, name);
    return orl_write_json(path, json, err);
}

static int lay_out(const struct orl_sharing *sharing, const json_t *doc, const char *folder,
                   struct orl_error *err)
{
    struct orl_upload bundle = {0};
    struct orl_task task = {0};
    json_t *digests = json_object();
    int rc = orl_task_from_json(doc, ORL_JOB_LOCAL, &task, NULL, err);

    if (rc == 0)
        rc = orl_task_bundle_collect(folder, &task, &bundle, err);
    if (rc == 0)
        rc = lay_out_files(sharing, &bundle, digests, err);
    if (rc == 0)
        rc = write_in(sharing, "files.json", digests, err);
    if (rc == 0)
        rc = write_in(sharing, "job.json", doc, err);
    orl_bundle_done(&bundle);
    orl_task_done(&task);
    json_decref(digests);
    return rc;
}

/* Whether a run has made it, rather than someone else. */
static bool is_ours(const char *folder)
{
    char store[8400], files[8400];
    struct stat st;

    snprintf(store, sizeof store, "%s/store", folder);
    snprintf(files, sizeof files, "%s/files.json", folder);
    return stat(store, &st) == 0 && stat(files, &st) == 0;
}

/* What an earlier run has left steps aside; *ret_job: what it was of, "" for nothing. */
static void set_aside(const char *folder, const char *aside, char ret_job[ORL_PIECE_KEY])
{
    json_t *doc = NULL;

    ret_job[0] = '\0';
    if (is_ours(aside))
        orl_place_remove(aside);
    if (!is_ours(folder))
        return;
    if (orl_sharing_verify(folder, ret_job, &doc, NULL))
        ret_job[0] = '\0';
    json_decref(doc);
    if (rename(folder, aside) != 0)
        ret_job[0] = '\0';
}

static size_t count_files(const char *folder)
{
    DIR *entries = opendir(folder);
    size_t n = 0;

    for (const struct dirent *entry; entries && (entry = readdir(entries)) != NULL;)
        n += entry->d_name[0] != '.';
    if (entries)
        closedir(entries);
    return n;
}

/* Pieces of the same job, by the same program, serve again. */
static void take_earlier(struct orl_sharing *sharing)
{
    char from[8400], to[8400];
    const bool same = strcmp(sharing->earlier_job, sharing->job) == 0;

    snprintf(from, sizeof from, "%s/store", sharing->aside);
    snprintf(to, sizeof to, "%s/store", sharing->folder);
    if (same && rmdir(to) == 0 && rename(from, to) != 0)
        mkdir(to, 0700);
    sharing->earlier = same ? count_files(to) : 0;
    if (same)
        mkdir(from, 0700); /* by which it is known to be ours */
    if (is_ours(sharing->aside))
        orl_place_remove(sharing->aside);
}

static int make_folder(struct orl_sharing *sharing, const char *output, struct orl_error *err)
{
    char relative[4096], store[4200];
    int rc = orl_join_path(output, "parts", relative, sizeof relative, err);

    if (rc)
        return rc;
    snprintf(sharing->aside, sizeof sharing->aside, "%.4000s.old", relative);
    set_aside(relative, sharing->aside, sharing->earlier_job);
    if (mkdir(relative, 0700) != 0 || !realpath(relative, sharing->folder))
        return orl_error_set(err, orl_err_of_errno(errno), "cannot make '%s': %s", relative,
                             strerror(errno));
    snprintf(store, sizeof store, "%s/store", sharing->folder);
    if (mkdir(store, 0700) != 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot make '%s': %s", store,
                             strerror(errno));
    snprintf(sharing->in_folder.folder, sizeof sharing->in_folder.folder, "%.4000s/store",
             sharing->folder);
    return 0;
}

static int read_json(const char *folder, const char *name, json_t **ret_json,
                     struct orl_sha256 *hash, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_file file;
    int rc = files.open(files.ctx, name, &file, err);

    if (rc)
        return rc;
    orl_sha256_add(hash, file.data, file.size);
    rc = orl_json_parse(name, file.data, file.size, ret_json, err);
    files.close(files.ctx, &file);
    return rc;
}

int orl_sharing_verify(const char *folder, char ret_job[ORL_PIECE_KEY], json_t **ret_doc,
                       struct orl_error *err)
{
    unsigned char digest[ORL_SHA256_BYTES];
    struct orl_sha256 hash;
    json_t *digests = NULL, *wanted;
    const char *name;
    int rc;

    *ret_doc = NULL;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, ORL_VERSION, sizeof ORL_VERSION);
    rc = read_json(folder, "job.json", ret_doc, &hash, err);
    if (rc == 0)
        rc = read_json(folder, "files.json", &digests, &hash, err);
    json_object_foreach(digests, name, wanted)
    {
        char path[8400], found[ORL_DIGEST_TEXT];

        snprintf(path, sizeof path, "%.4000s/files/%.4000s", folder, name);
        rc = rc ? rc : orl_digest_file(path, found, err);
        const char *text = json_string_value(wanted);
        if (rc == 0 && (!text || strcmp(found, text) != 0))
            rc = orl_error_set(err, ORL_ERR_CORRUPT, "'%.300s' is not what it was", path);
    }
    json_decref(digests);
    orl_sha256_finish(&hash, digest);
    for (size_t i = 0; i < sizeof digest; i++)
        snprintf(ret_job + 2 * i, 3, "%02x", digest[i]);
    if (rc) {
        json_decref(*ret_doc);
        *ret_doc = NULL;
    }
    return rc;
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Parts of a wave, and how they stand. */
struct wave {
    char name[64];
    size_t n;
    enum orl_part_state *states;
    bool *done;
    unsigned *tries, *gone; /* and how often in a row its runner had it no more */
};

/* Which part a piece belongs to: by the work before the middle of it. */
static uint32_t part_of(double before, double work, double all, uint32_t n)
{
    const double at = floor((before + 0.5 * work) / all * n);

    return at < n ? (uint32_t)at : n - 1;
}

static json_t *part_to_json(const struct orl_sharing *sharing, const struct orl_piece *pieces,
                            size_t first, size_t count)
{
    json_t *list = json_array();

    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "kind", pieces[first + i].kind, "key",
                                              pieces[first + i].key));
    return json_pack("{s:s, s:I, s:o}", "job", sharing->job, "threads",
                     (json_int_t)sharing->threads, "pieces", list);
}

/* Writes the wave's parts; *ret_n: how many there are, for empty ones are none. */
static int write_parts(const struct orl_sharing *sharing, const char *wave,
                       const struct orl_piece *pieces, size_t n, size_t *ret_n,
                       struct orl_error *err)
{
    const uint32_t most = n < sharing->most ? (uint32_t)n : sharing->most;
    double all = 0, before = 0;
    size_t first = 0, parts = 0;
    int rc = 0;

    for (size_t i = 0; i < n; i++)
        all += pieces[i].work;
    for (size_t i = 0; i < n && rc == 0; i++) {
        const uint32_t mine = part_of(before, pieces[i].work, all, most);
        const double next = before + pieces[i].work;
        char name[120];

        before = next;
        if (i + 1 < n && part_of(next, pieces[i + 1].work, all, most) == mine)
            continue;
        snprintf(name, sizeof name, "%s-%zu.json", wave, parts++);
        json_t *json = part_to_json(sharing, pieces, first, i + 1 - first);
        rc = json ? write_in(sharing, name, json, err)
                  : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        json_decref(json);
        first = i + 1;
    }
    *ret_n = parts;
    return rc;
}

static bool is_there(const struct orl_sharing *sharing, const struct wave *wave, size_t number,
                     const char *what, char ret_path[4300])
{
    struct stat st;

    snprintf(ret_path, 4300, "%s/%s-%zu.%s", sharing->folder, wave->name, number, what);
    return stat(ret_path, &st) == 0;
}

static int start(struct orl_sharing *sharing, struct wave *wave, const uint32_t *numbers, size_t n,
                 struct orl_error *err)
{
    for (size_t i = 0; i < n; i++) {
        sharing->again += wave->tries[numbers[i]] > 0;
        wave->tries[numbers[i]]++;
        wave->gone[numbers[i]] = 0;
        sharing->parts++;
    }
    return sharing->runner.start(sharing->runner.ctx, wave->name, numbers, n, err);
}

static int start_all(struct orl_sharing *sharing, struct wave *wave, struct orl_error *err)
{
    uint32_t *numbers = malloc((wave->n + 1) * sizeof *numbers);
    int rc;

    if (!numbers)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < wave->n; i++)
        numbers[i] = (uint32_t)i;
    rc = start(sharing, wave, numbers, wave->n, err);
    free(numbers);
    return rc;
}

/* What a part that failed says. */
static int part_error(const char *path, struct orl_error *err)
{
    json_t *problem = json_load_file(path, 0, NULL);

    if (problem)
        orl_problem_to_error(problem, err);
    else
        orl_error_set(err, ORL_ERR_INTERNAL, "a part of the job failed, and does not say why");
    json_decref(problem);
    return err->code;
}

/* One that has left an error, or nothing: once more, or never again. */
static int try_again(struct orl_sharing *sharing, struct wave *wave, uint32_t number,
                     const char *error_path, struct orl_error *err)
{
    if (wave->tries[number] < MOST_TRIES) {
        if (error_path)
            unlink(error_path);
        return start(sharing, wave, &number, 1, err);
    }
    if (error_path)
        return part_error(error_path, err);
    return orl_error_set(err, ORL_ERR_INTERNAL,
                         "a part of the job ended %d times without a word: it was killed, or ran "
                         "out of memory or time; its log is in '%s'",
                         MOST_TRIES, sharing->folder);
}

static int look_at(struct orl_sharing *sharing, struct wave *wave, size_t i, struct orl_error *err)
{
    char path[4300];

    if (is_there(sharing, wave, i, "done", path)) {
        wave->done[i] = true;
        return 0;
    }
    if (is_there(sharing, wave, i, "error", path))
        return try_again(sharing, wave, (uint32_t)i, path, err);
    wave->gone[i] = wave->states[i] == ORL_PART_GONE ? wave->gone[i] + 1 : 0;
    if (wave->gone[i] > 0)
        count_files(sharing->folder); /* network file systems look again for what was not there */
    return wave->gone[i] < GONE_TIMES ? 0 : try_again(sharing, wave, (uint32_t)i, NULL, err);
}

static int wait_for(struct orl_sharing *sharing, struct wave *wave, struct orl_error *err)
{
    size_t left = wave->n;
    int rc = 0;

    while (left > 0 && rc == 0) {
        rc = sharing->runner.look(sharing->runner.ctx, wave->states, wave->n, err);
        left = 0;
        for (size_t i = 0; i < wave->n && rc == 0; i++) {
            if (!wave->done[i])
                rc = look_at(sharing, wave, i, err);
            left += !wave->done[i];
        }
        if (rc == 0 && atomic_load(sharing->cancel))
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while others made parts of it");
        if (left > 0 && rc == 0)
            nanosleep(&between, NULL);
    }
    if (rc)
        sharing->runner.cancel(sharing->runner.ctx);
    return rc;
}

/* Of a run that hands all pieces to others. */
static int divide(void *ctx, const struct orl_piece *pieces, size_t n, bool *ret_here,
                  struct orl_error *err)
{
    struct orl_sharing *sharing = ctx;
    struct wave wave = {.n = 0};
    int rc;

    (void)ret_here;
    /* Tasks of an earlier run may still leave their files here. */
    snprintf(wave.name, sizeof wave.name, "%lx.%lx-wave%u", (long)sharing->began, (long)getpid(),
             ++sharing->wave);
    rc = write_parts(sharing, wave.name, pieces, n, &wave.n, err);
    wave.states = calloc(wave.n + 1, sizeof *wave.states);
    wave.done = calloc(wave.n + 1, sizeof *wave.done);
    wave.tries = calloc(wave.n + 1, sizeof *wave.tries);
    wave.gone = calloc(wave.n + 1, sizeof *wave.gone);
    if (rc == 0 && (!wave.states || !wave.done || !wave.tries || !wave.gone))
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (rc == 0)
        rc = start_all(sharing, &wave, err);
    if (rc == 0)
        rc = wait_for(sharing, &wave, err);
    free(wave.states);
    free(wave.done);
    free(wave.tries);
    free(wave.gone);
    return rc;
}

/* ---- All of it ------------------------------------------------------------------------------- */

bool orl_sharing_asked(const struct orl_subcommand *self, const struct orl_sharing_line *line,
                       int *ret_rc)
{
    uint64_t parts;

    *ret_rc = ORL_EXIT_OK;
    if (line->parts_text && !orl_parse_count(line->parts_text, 1, MOST_PARTS, &parts))
        *ret_rc = orl_usage_error(self, "--parts takes a number from 1 to %d, not \"%s\"",
                                  MOST_PARTS, line->parts_text);
    if (line->sbatch && !line->slurm)
        *ret_rc = orl_usage_error(self, "--sbatch goes with --slurm");
    return line->parts_text || line->slurm;
}

int orl_sharing_open(struct orl_sharing *sharing, const struct orl_sharing_line *line,
                     const json_t *doc, const char *folder, const char *output, uint32_t threads,
                     const atomic_bool *cancel, struct orl_error *err)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    uint64_t most = line->slurm ? USUAL_PARTS : 1;
    json_t *read = NULL;
    int rc;

    *sharing = (struct orl_sharing){.cancel = cancel, .began = time(NULL)};
    rc = make_folder(sharing, output, err);
    if (rc == 0)
        rc = lay_out(sharing, doc, folder, err);
    if (rc == 0)
        rc = orl_sharing_verify(sharing->folder, sharing->job, &read, err);
    json_decref(read);
    if (rc)
        return rc;
    take_earlier(sharing);
    if (line->parts_text)
        orl_parse_count(line->parts_text, 1, MOST_PARTS, &most);
    sharing->most = (uint32_t)most;
    const uint32_t abreast = cores > (long)threads ? (uint32_t)cores / threads : 1;
    sharing->threads = threads;
    orl_shared_store_init(&sharing->in_folder, &sharing->store);
    sharing->pieces = (struct orl_pieces){sharing, sharing->job, divide};
    return line->slurm ? orl_runner_slurm(sharing->folder, threads, sharing->most, line->sbatch,
                                          &sharing->runner, err)
                       : orl_runner_local(sharing->folder, threads, abreast, &sharing->runner, err);
}

void orl_sharing_tell(const struct orl_sharing *sharing)
{
    if (sharing->wave == 0 && sharing->earlier == 0)
        return;
    fprintf(stderr, "parts: %llu in %u waves, %llu of them once more\n",
            (unsigned long long)sharing->parts, sharing->wave, (unsigned long long)sharing->again);
}

void orl_sharing_done(struct orl_sharing *sharing, bool remove)
{
    if (sharing->runner.done)
        sharing->runner.done(sharing->runner.ctx);
    orl_shared_store_done(&sharing->in_folder);
    if (remove && sharing->folder[0])
        orl_place_remove(sharing->folder);
}
