#include "parts/wave.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "parts/files.h"
#include "problem.h"

enum { MOST_TRIES = 3, PATH = 4300 };

/* How often parts are looked at: ever more rarely, after a share of the wave's age. */
static const double look_least_s = 0.05, look_most_s = 1, look_share = 0.005;

struct part {
    bool done;
    unsigned tries;
    enum orl_part_state state;
    double gone_s; /* since when its runner has had it no more; 0: it has */
    double runs_s; /* since when it runs; 0: it does not */
};

/* Parts of a wave, and how they stand. */
struct wave {
    char name[ORL_WAVE_NAME];
    size_t n;
    struct part *parts;
    enum orl_part_state *states; /* as its runner tells */
    double began_s;
};

static double now_s(const struct orl_sharing *sharing)
{
    return sharing->spec.now_s(NULL);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static int write_in(const struct orl_sharing *sharing, const char *name, json_t *json,
                    struct orl_error *err)
{
    char path[PATH];

    snprintf(path, sizeof path, "%s/%s", sharing->folder, name);
    const int rc =
        json ? orl_write_json(path, json, err) : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    json_decref(json);
    return rc;
}

static bool is_there(const struct orl_sharing *sharing, const struct wave *wave, size_t number,
                     const char *what, char ret_path[PATH])
{
    struct stat st;

    snprintf(ret_path, PATH, "%s/%s-%zu.%s", sharing->folder, wave->name, number, what);
    return stat(ret_path, &st) == 0;
}

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
                     (json_int_t)sharing->spec.threads, "pieces", list);
}

/* Writes the wave's parts; *ret_n: how many there are, for empty ones are none. */
static int write_parts(const struct orl_sharing *sharing, const char *wave,
                       const struct orl_piece *pieces, size_t n, size_t *ret_n,
                       struct orl_error *err)
{
    const uint32_t most = n < sharing->spec.most ? (uint32_t)n : sharing->spec.most;
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
        rc = write_in(sharing, name, part_to_json(sharing, pieces, first, i + 1 - first), err);
        first = i + 1;
    }
    *ret_n = parts;
    return rc;
}

/* While it is there the wave has not ended. */
static int note_wave(const struct orl_sharing *sharing, const struct wave *wave,
                     struct orl_error *err)
{
    char name[120];

    snprintf(name, sizeof name, "%s.wave", wave->name);
    return write_in(sharing, name, json_pack("{s:I}", "parts", (json_int_t)wave->n), err);
}

bool orl_wave_forget(const char *folder, const char *name)
{
    char path[PATH];

    snprintf(path, sizeof path, "%s/%s.wave", folder, name);
    return unlink(path) == 0;
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static void count_lost(struct orl_sharing *sharing, struct part *part)
{
    sharing->count.again++;
    if (part->runs_s > 0)
        sharing->count.lost_s += now_s(sharing) - part->runs_s;
    part->runs_s = 0;
}

/* What its runner tells of a part. One that ran and waits was put back by Slurm. */
static void take_state(struct orl_sharing *sharing, struct part *part, enum orl_part_state state)
{
    if (state == ORL_PART_UNKNOWN)
        return;
    if (part->runs_s > 0 && state == ORL_PART_WAITING)
        count_lost(sharing, part);
    if (state == ORL_PART_RUNNING && part->runs_s <= 0)
        part->runs_s = now_s(sharing);
    part->state = state;
}

static void tell(struct orl_sharing *sharing, const struct wave *wave, uint64_t done_before)
{
    struct orl_parts_count count = sharing->count;

    count.waiting = count.running = 0;
    count.done = done_before;
    for (size_t i = 0; i < wave->n; i++) {
        const struct part *part = &wave->parts[i];

        count.done += part->done;
        count.running += !part->done && part->state == ORL_PART_RUNNING;
        count.waiting += !part->done && part->state != ORL_PART_RUNNING;
    }
    const bool same = count.waiting == sharing->count.waiting &&
                      count.running == sharing->count.running && count.done == sharing->count.done;

    sharing->count = count;
    if (!same && sharing->spec.told)
        sharing->spec.told(sharing->spec.ctx, &count);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

static int start(struct orl_sharing *sharing, struct wave *wave, const uint32_t *numbers, size_t n,
                 struct orl_error *err)
{
    for (size_t i = 0; i < n; i++) {
        struct part *part = &wave->parts[numbers[i]];

        if (part->tries++ > 0)
            count_lost(sharing, part);
        part->gone_s = 0;
        part->state = ORL_PART_WAITING;
        sharing->parts++;
    }
    return sharing->runner.start(sharing->runner.ctx, wave->name, numbers, n, wave->n, err);
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
    struct orl_error said = {0};
    json_t *problem = json_load_file(path, 0, NULL);

    if (problem)
        orl_problem_to_error(problem, &said);
    if (!problem || said.code == 0)
        orl_error_set(&said, ORL_ERR_INTERNAL, "a part of the job failed, and does not say why");
    json_decref(problem);
    if (err)
        *err = said;
    return said.code;
}

/* One that has left an error, or nothing: once more, or never again. */
static int try_again(struct orl_sharing *sharing, struct wave *wave, uint32_t number,
                     const char *error_path, struct orl_error *err)
{
    if (wave->parts[number].tries < MOST_TRIES) {
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
    struct part *part = &wave->parts[i];
    char path[PATH];

    if (is_there(sharing, wave, i, "done", path)) {
        part->done = true;
        return 0;
    }
    if (is_there(sharing, wave, i, "error", path))
        return try_again(sharing, wave, (uint32_t)i, path, err);
    take_state(sharing, part, wave->states[i]);
    if (wave->states[i] != ORL_PART_GONE) {
        part->gone_s = 0;
        return 0;
    }
    orl_shared_folder_look(sharing->folder);
    if (part->gone_s <= 0)
        part->gone_s = now_s(sharing);
    return now_s(sharing) - part->gone_s < sharing->runner.settle_s
               ? 0
               : try_again(sharing, wave, (uint32_t)i, NULL, err);
}

/* ---- The wave -------------------------------------------------------------------------------- */

static void rest(const struct orl_sharing *sharing, const struct wave *wave)
{
    const double share = look_share * (now_s(sharing) - wave->began_s);
    const double wait = share < look_least_s  ? look_least_s
                        : share > look_most_s ? look_most_s
                                              : share;
    const struct timespec time = {(time_t)wait, (long)(1e9 * (wait - floor(wait)))};

    nanosleep(&time, NULL);
}

static int wait_for(struct orl_sharing *sharing, struct wave *wave, struct orl_error *err)
{
    const uint64_t done_before = sharing->count.done;
    size_t left = wave->n;
    int rc = 0;

    while (left > 0 && rc == 0) {
        rc = sharing->runner.look(sharing->runner.ctx, wave->name, wave->states, wave->n, err);
        left = 0;
        for (size_t i = 0; i < wave->n && rc == 0; i++) {
            if (!wave->parts[i].done)
                rc = look_at(sharing, wave, i, err);
            left += !wave->parts[i].done;
        }
        tell(sharing, wave, done_before);
        if (rc == 0 && left > 0 && atomic_load(sharing->spec.cancel))
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while others made parts of it");
        if (left > 0 && rc == 0)
            rest(sharing, wave);
    }
    return rc;
}

/* What is under way ends with the run, unless a run after it is to find it. */
static void end_wave(struct orl_sharing *sharing, struct wave *wave, int rc, struct orl_error *err)
{
    const atomic_bool *leaves = sharing->spec.leaves;
    struct orl_error second = {0};

    if (rc && leaves && atomic_load(leaves))
        return;
    if (rc && sharing->runner.cancel(sharing->runner.ctx, wave->name, &second) && err)
        orl_error_hint(err, "%s%s%.300s", err->hint, err->hint[0] ? "; " : "", second.message);
    orl_wave_forget(sharing->folder, wave->name);
}

static void wave_done(struct wave *wave)
{
    free(wave->parts);
    free(wave->states);
}

static int make_room(struct orl_sharing *sharing, struct wave *wave, struct orl_error *err)
{
    wave->parts = calloc(wave->n + 1, sizeof *wave->parts);
    wave->states = calloc(wave->n + 1, sizeof *wave->states);
    wave->began_s = now_s(sharing);
    return wave->parts && wave->states ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

int orl_wave_run(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                 struct orl_error *err)
{
    struct wave wave = {.n = 0};
    int rc;

    /* Tasks of an earlier run may still leave their files here. */
    snprintf(wave.name, sizeof wave.name, "%lx.%lx-wave%u", (long)sharing->began, (long)getpid(),
             ++sharing->count.waves);
    rc = write_parts(sharing, wave.name, pieces, n, &wave.n, err);
    if (rc == 0)
        rc = make_room(sharing, &wave, err);
    if (rc == 0)
        rc = note_wave(sharing, &wave, err);
    if (rc == 0) {
        rc = start_all(sharing, &wave, err);
        if (rc == 0)
            rc = wait_for(sharing, &wave, err);
        end_wave(sharing, &wave, rc, err);
    }
    wave_done(&wave);
    return rc;
}

/* ---- Waves of an earlier run ----------------------------------------------------------------- */

static void mark(const json_t *part, const struct orl_piece *pieces, size_t n, bool *ret_made)
{
    const json_t *own;
    size_t i;

    json_array_foreach(json_object_get(part, "pieces"), i, own)
    {
        const char *key = json_string_value(json_object_get(own, "key"));

        for (size_t k = 0; key && k < n; k++)
            ret_made[k] = ret_made[k] || strcmp(pieces[k].key, key) == 0;
    }
}

static void mark_wave(const struct orl_sharing *sharing, const struct wave *wave,
                      const struct orl_piece *pieces, size_t n, bool *ret_made)
{
    for (size_t i = 0; i < wave->n; i++) {
        char path[PATH];
        json_t *part =
            is_there(sharing, wave, i, "json", path) ? json_load_file(path, 0, NULL) : NULL;

        mark(part, pieces, n, ret_made);
        json_decref(part);
    }
}

/* Its parts count as tried once: whether they are under way will be seen. */
static int finish_wave(struct orl_sharing *sharing, struct wave *wave, struct orl_error *err)
{
    int rc = make_room(sharing, wave, err);

    if (rc)
        return rc;
    for (size_t i = 0; i < wave->n; i++)
        wave->parts[i].tries = 1;
    sharing->parts += wave->n;
    sharing->count.waves++;
    rc = wait_for(sharing, wave, err);
    end_wave(sharing, wave, rc, err);
    return rc;
}

bool orl_wave_find(const char *folder, char ret_name[ORL_WAVE_NAME])
{
    static const char ending[] = ".wave";
    DIR *entries = opendir(folder);
    bool found = false;

    for (const struct dirent *entry; entries && !found && (entry = readdir(entries)) != NULL;) {
        const size_t length = strlen(entry->d_name), stem = length - strlen(ending);

        if (length <= strlen(ending) || strcmp(entry->d_name + stem, ending) != 0 ||
            stem >= ORL_WAVE_NAME)
            continue;
        memcpy(ret_name, entry->d_name, stem);
        ret_name[stem] = '\0';
        found = true;
    }
    if (entries)
        closedir(entries);
    return found;
}

static size_t parts_of(const struct orl_sharing *sharing, const struct wave *wave)
{
    char path[PATH];

    snprintf(path, sizeof path, "%s/%s.wave", sharing->folder, wave->name);
    json_t *note = json_load_file(path, 0, NULL);
    const json_int_t n = json_integer_value(json_object_get(note, "parts"));
    json_decref(note);
    return n > 0 && n <= ORL_PARTS_MOST ? (size_t)n : 0;
}

int orl_wave_adopt(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                   bool *ret_made, struct orl_error *err)
{
    struct wave wave = {.n = 0};
    int rc = 0;

    while (rc == 0 && orl_wave_find(sharing->folder, wave.name)) {
        wave.n = parts_of(sharing, &wave);
        rc = finish_wave(sharing, &wave, err);
        if (rc == 0)
            mark_wave(sharing, &wave, pieces, n, ret_made);
        wave_done(&wave);
        wave = (struct wave){.n = 0};
    }
    return rc;
}
