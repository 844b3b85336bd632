#include "parts/wave.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "parts/limits.h"
#include "parts/wave_files.h"
#include "parts/wave_told.h"
#include "problem.h"

enum { MOST_TRIES = 3, MOST_RAISED = 5 };

/* Interval between looks at the parts, in seconds. It grows with the wave's age. */
static const double look_least_s = 0.05, look_most_s = 1, look_share = 0.005;
/* Seconds until a full disk is checked again. */
static const double full_s = 10;

static double now_s(const struct orl_sharing *sharing)
{
    return sharing->spec.now_s(NULL);
}

/* ---- Counts ---------------------------------------------------------------------------------- */

static void count_lost(struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                       const char *why)
{
    struct orl_part *part = &wave->parts[i];

    orl_part_tell(sharing, wave, i, "again", why);
    sharing->count.again++;
    sharing->count.lost_s += orl_part_ran_s(sharing, part);
    part->runs_s = 0;
    part->told = false;
}

/* Takes over the state reported by the runner. A part that ran and now waits was requeued by
 * Slurm. */
static void update_state(struct orl_sharing *sharing, struct orl_wave *wave, size_t i)
{
    struct orl_part *part = &wave->parts[i];
    const enum orl_part_state state = wave->seen[i].state;

    if (state == ORL_PART_UNKNOWN)
        return;
    if (part->runs_s > 0 && state == ORL_PART_WAITING)
        count_lost(sharing, wave, i, "Slurm has put it back");
    if (state == ORL_PART_RUNNING && part->runs_s <= 0) {
        part->runs_s = now_s(sharing);
        orl_part_tell_start(sharing, wave, i);
    }
    part->state = state;
}

static bool is_same(const struct orl_parts_count *a, const struct orl_parts_count *b)
{
    return a->waiting == b->waiting && a->running == b->running && a->done == b->done &&
           a->held == b->held && a->again == b->again && a->waves == b->waves;
}

static void report_count(struct orl_sharing *sharing)
{
    if (is_same(&sharing->count, &sharing->told))
        return;
    sharing->told = sharing->count;
    if (sharing->spec.told)
        sharing->spec.told(sharing->spec.ctx, &sharing->count);
}

static void report_wave(struct orl_sharing *sharing, const struct orl_wave *wave,
                        uint64_t done_before)
{
    struct orl_parts_count *count = &sharing->count;

    count->waiting = count->running = count->held = 0;
    count->done = done_before;
    for (size_t i = 0; i < wave->n; i++) {
        const struct orl_part *part = &wave->parts[i];

        count->done += part->done;
        count->running += !part->done && part->state == ORL_PART_RUNNING;
        count->waiting += !part->done && part->state != ORL_PART_RUNNING;
        count->held += part->held_s > 0;
    }
    report_count(sharing);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

/* Returns the limits for a part's first try, from what is known of the job by now. */
static struct orl_part_limits first_limits(const struct orl_sharing *sharing,
                                           const struct orl_part *part)
{
    const struct orl_limit_basis basis = {
        .load_s = sharing->load_s,
        .pace = sharing->foreseen_s > 0 ? sharing->took_s / sharing->foreseen_s : 1,
        .threads = sharing->spec.threads,
        .memory_bytes = sharing->spec.memory_bytes};

    return orl_part_limits(&part->needs, &basis);
}

/* Starts all due parts at once. */
static int start_due(struct orl_sharing *sharing, struct orl_wave *wave, struct orl_error *err)
{
    size_t n = 0;

    for (size_t i = 0; i < wave->n; i++) {
        struct orl_part *part = &wave->parts[i];

        if (!part->due)
            continue;
        if (part->limits.mib == 0)
            part->limits = first_limits(sharing, part);
        wave->orders[n++] = (struct orl_part_order){(uint32_t)i, part->limits};
        part->due = false;
        part->tries++;
        part->gone_s = part->held_s = 0;
        part->state = ORL_PART_WAITING;
        sharing->parts++;
    }
    return n == 0 ? 0
                  : sharing->runner.start(sharing->runner.ctx, wave->name, wave->orders, n, wave->n,
                                          err);
}

/* Reads the error of a failed part. */
static void read_error(const char *path, struct orl_error *ret_said)
{
    json_t *problem = json_load_file(path, 0, NULL);

    *ret_said = (struct orl_error){.code = 0};
    if (problem)
        orl_problem_to_error(problem, ret_said);
    if (ret_said->code == 0)
        orl_error_set(ret_said, ORL_ERR_INTERNAL, "a part of the job failed, and does not say why");
    json_decref(problem);
}

/* Holds a part back until the disk has room. This does not count as a failure of the part. */
static void hold_part(const struct orl_sharing *sharing, struct orl_part *part)
{
    part->held_s = now_s(sharing) + full_s;
    part->state = ORL_PART_WAITING;
}

/* Raises the exceeded limit if this program had set it. Returns true if it did; the part is
 * then restarted. */
static bool raise_limits(struct orl_part *part, const struct orl_part_seen *seen,
                         enum orl_part_end end)
{
    const bool of_time = end == ORL_PART_OUT_OF_TIME;
    const uint32_t asked = of_time ? part->limits.minutes : part->limits.mib;
    const uint32_t given = of_time ? seen->limits.minutes : seen->limits.mib;

    if (end == ORL_PART_ENDED || asked == 0 || given < asked || part->raised == MOST_RAISED)
        return false;
    part->limits = orl_part_limits_raised(part->limits, end);
    part->raised++;
    part->tries--;
    return true;
}

/* Describes why a part has no result. */
static void describe_end(const struct orl_sharing *sharing, const struct orl_part *part,
                         const struct orl_part_seen *seen, enum orl_part_end end,
                         struct orl_error *ret_said)
{
    if (end == ORL_PART_OUT_OF_TIME)
        orl_error_set(ret_said, ORL_ERR_LIMIT,
                      "a part of the job ran out of its time, %u minutes in the end",
                      seen->limits.minutes);
    else if (end == ORL_PART_OUT_OF_MEMORY)
        orl_error_set(ret_said, ORL_ERR_LIMIT,
                      "a part of the job ran out of its memory, %u MiB in the end",
                      seen->limits.mib);
    else
        orl_error_set(ret_said, ORL_ERR_INTERNAL,
                      "a part of the job ended %u times without a word: it was killed, or its node "
                      "was lost; its log is in '%s'",
                      part->tries, sharing->folder);
}

/* Restarts a part that left an error or nothing, or fails if its tries are used up. */
static int try_again(struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                     const char *error_path, struct orl_error *err)
{
    struct orl_part *part = &wave->parts[i];
    enum orl_part_end end = ORL_PART_ENDED;
    struct orl_error said = {.code = 0};

    if (error_path)
        read_error(error_path, &said);
    if ((!error_path || said.code == ORL_ERR_CANCELLED) && sharing->runner.end)
        end = sharing->runner.end(sharing->runner.ctx, wave->name, (uint32_t)i);
    if (!error_path || end != ORL_PART_ENDED)
        describe_end(sharing, part, &wave->seen[i], end, &said);
    if (error_path)
        unlink(error_path);
    if (said.code == ORL_ERR_FULL || !orl_wave_has_room(sharing->folder)) {
        count_lost(sharing, wave, i, "the shared folder's disk is full");
        part->tries--;
        hold_part(sharing, part);
        return 0;
    }
    part->due = raise_limits(part, &wave->seen[i], end) || part->tries < MOST_TRIES;
    if (part->due)
        count_lost(sharing, wave, i, said.message);
    else
        orl_part_tell(sharing, wave, i, "failed", said.message);
    if (!part->due && err)
        *err = said;
    return part->due ? 0 : said.code;
}

static void look_at_held(const struct orl_sharing *sharing, struct orl_part *part)
{
    if (now_s(sharing) < part->held_s)
        return;
    part->due = orl_wave_has_room(sharing->folder);
    if (!part->due)
        hold_part(sharing, part);
}

static void end_well(struct orl_sharing *sharing, struct orl_wave *wave, size_t i)
{
    struct orl_part *part = &wave->parts[i];

    orl_part_tell(sharing, wave, i, "end", NULL);
    orl_wave_learn(sharing, wave, part);
    part->done = true;
    part->held_s = 0;
}

static int look_at(struct orl_sharing *sharing, struct orl_wave *wave, size_t i,
                   struct orl_error *err)
{
    struct orl_part *part = &wave->parts[i];
    char path[ORL_PART_PATH];

    if (orl_part_file(sharing->folder, wave->name, i, "done", path)) {
        end_well(sharing, wave, i);
        return 0;
    }
    if (part->held_s > 0) {
        look_at_held(sharing, part);
        return 0;
    }
    if (orl_part_file(sharing->folder, wave->name, i, "error", path))
        return try_again(sharing, wave, i, path, err);
    update_state(sharing, wave, i);
    if (wave->seen[i].state != ORL_PART_GONE) {
        part->gone_s = 0;
        return 0;
    }
    orl_shared_folder_look(sharing->folder);
    if (part->gone_s <= 0)
        part->gone_s = now_s(sharing);
    return now_s(sharing) - part->gone_s < sharing->runner.settle_s
               ? 0
               : try_again(sharing, wave, i, NULL, err);
}

/* ---- The wave -------------------------------------------------------------------------------- */

static void sleep_between_looks(const struct orl_sharing *sharing, const struct orl_wave *wave)
{
    const double share = look_share * (now_s(sharing) - wave->began_s);
    const double wait = share < look_least_s  ? look_least_s
                        : share > look_most_s ? look_most_s
                                              : share;
    const struct timespec time = {(time_t)wait, (long)(1e9 * (wait - floor(wait)))};

    nanosleep(&time, NULL);
}

static int wait_for(struct orl_sharing *sharing, struct orl_wave *wave, struct orl_error *err)
{
    const uint64_t done_before = sharing->count.done;
    size_t left = wave->n;
    int rc = 0;

    while (left > 0 && rc == 0) {
        rc = sharing->runner.look(sharing->runner.ctx, wave->name, wave->seen, wave->n, err);
        left = 0;
        for (size_t i = 0; i < wave->n && rc == 0; i++) {
            if (!wave->parts[i].done)
                rc = look_at(sharing, wave, i, err);
            left += !wave->parts[i].done;
        }
        if (rc == 0)
            rc = start_due(sharing, wave, err);
        report_wave(sharing, wave, done_before);
        if (rc == 0)
            orl_wave_tell_share(sharing, wave);
        if (rc == 0 && left > 0 && atomic_load(sharing->spec.cancel))
            rc = orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while others made parts of it");
        if (left > 0 && rc == 0)
            sleep_between_looks(sharing, wave);
    }
    return rc;
}

/* Ends a wave. Active parts end with the run, unless a later run is to find them. */
static void end_wave(struct orl_sharing *sharing, struct orl_wave *wave, int rc,
                     struct orl_error *err)
{
    const atomic_bool *leaves = sharing->spec.leaves;
    struct orl_error second = {0};

    if (rc && leaves && atomic_load(leaves))
        return;
    if (rc && sharing->runner.cancel(sharing->runner.ctx, wave->name, &second) && err)
        orl_error_hint(err, "%s%s%.300s", err->hint, err->hint[0] ? "; " : "", second.message);
    orl_wave_forget(sharing->folder, wave->name);
}

static void wave_done(struct orl_wave *wave)
{
    free(wave->parts);
    free(wave->seen);
    free(wave->orders);
}

static int make_tables(struct orl_sharing *sharing, struct orl_wave *wave, struct orl_error *err)
{
    wave->parts = calloc(wave->n + 1, sizeof *wave->parts);
    wave->seen = calloc(wave->n + 1, sizeof *wave->seen);
    wave->orders = calloc(wave->n + 1, sizeof *wave->orders);
    wave->began_s = now_s(sharing);
    if (!wave->parts || !wave->seen || !wave->orders)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < wave->n; i++)
        wave->parts[i].needs = orl_wave_needs(sharing->folder, wave->name, i);
    return 0;
}

/* Writes the wave's files, and waits while the disk is full. */
static int write_wave(struct orl_sharing *sharing, struct orl_wave *wave,
                      const struct orl_piece *pieces, size_t n, struct orl_error *err)
{
    int rc = orl_wave_write(sharing, wave->name, pieces, n, &wave->n, err);

    wave->began_s = now_s(sharing);
    while (rc == ORL_ERR_FULL && !atomic_load(sharing->spec.cancel)) {
        const double until_s = now_s(sharing) + full_s;

        sharing->count.held = 1;
        report_count(sharing);
        while (now_s(sharing) < until_s && !atomic_load(sharing->spec.cancel))
            sleep_between_looks(sharing, wave);
        rc = orl_wave_write(sharing, wave->name, pieces, n, &wave->n, err);
    }
    sharing->count.held = 0;
    return rc;
}

int orl_wave_run(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                 struct orl_error *err)
{
    struct orl_wave wave = {.n = 0};
    int rc;

    if (sharing->load_s <= 0)
        sharing->load_s = now_s(sharing) - sharing->opened_s;
    /* A unique name: tasks of an earlier run may still write files here. */
    snprintf(wave.name, sizeof wave.name, "%lx.%lx-wave%u", (long)sharing->began, (long)getpid(),
             ++sharing->count.waves);
    rc = write_wave(sharing, &wave, pieces, n, err);
    if (rc == 0)
        rc = make_tables(sharing, &wave, err);
    if (rc == 0) {
        for (size_t i = 0; i < wave.n; i++)
            wave.parts[i].due = true;
        rc = start_due(sharing, &wave, err);
        if (rc == 0)
            rc = wait_for(sharing, &wave, err);
        end_wave(sharing, &wave, rc, err);
    }
    wave_done(&wave);
    return rc;
}

/* ---- Waves of an earlier run ----------------------------------------------------------------- */

/* Finishes a wave of an earlier run. Its parts count as tried once; the runner reports which
 * are active. */
static int finish_wave(struct orl_sharing *sharing, struct orl_wave *wave, struct orl_error *err)
{
    int rc = make_tables(sharing, wave, err);

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

int orl_wave_adopt(struct orl_sharing *sharing, const struct orl_piece *pieces, size_t n,
                   bool *ret_made, struct orl_error *err)
{
    struct orl_wave wave = {.n = 0};
    int rc = 0;

    while (rc == 0 && orl_wave_find(sharing->folder, wave.name)) {
        wave.n = orl_wave_parts(sharing->folder, wave.name);
        char again[sizeof wave.name];
        rc = finish_wave(sharing, &wave, err);
        if (rc == 0 && orl_wave_find(sharing->folder, again) && strcmp(again, wave.name) == 0)
            rc = orl_error_set(err, ORL_ERR_IO, "%s/%s.wave cannot be removed", sharing->folder,
                               wave.name);
        if (rc == 0)
            orl_wave_mark(sharing->folder, wave.name, wave.n, pieces, n, ret_made);
        wave_done(&wave);
        wave = (struct orl_wave){.n = 0};
    }
    return rc;
}
