#include "distributed/task_round.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "distributed/atomic_files.h"

/* ---- Writing --------------------------------------------------------------------------------- */

static int write_in(const struct orl_distributed_job *distributed, const char *name, json_t *json,
                    struct orl_error *err)
{
    char path[ORL_PART_PATH];
    snprintf(path, sizeof path, "%s/%s", distributed->folder, name);
    const int rc = orl_write_json(path, json, err);
    json_decref(json);
    return rc;
}

/* Returns the part of a task, by the cumulated work at the middle of the task. */
static uint32_t part_of(double before, double work, double all, uint32_t n)
{
    const double at = floor((before + 0.5 * work) / all * n);
    return at < n ? (uint32_t)at : n - 1;
}

static struct orl_part_needs needs_of(const struct orl_job_task *tasks, size_t count)
{
    struct orl_part_needs needs = {.core_s = 0};
    bool known = true;
    for (size_t i = 0; i < count; i++) {
        known = known && tasks[i].core_s > 0;
        needs.core_s += tasks[i].core_s;
        needs.bytes = tasks[i].bytes > needs.bytes ? tasks[i].bytes : needs.bytes;
    }
    if (!known)
        needs.core_s = 0;
    return needs;
}

static json_t *part_to_json(const struct orl_distributed_job *distributed,
                            const struct orl_job_task *tasks, size_t first, size_t count)
{
    const struct orl_part_needs needs = needs_of(tasks + first, count);
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, json_pack("{s:s, s:s}", "kind", tasks[first + i].kind, "key",
                                              tasks[first + i].key));
    return json_pack("{s:s, s:I, s:f, s:I, s:o}", "job", distributed->job, "threads",
                     (json_int_t)distributed->spec.threads, "core_s", needs.core_s, "bytes",
                     (json_int_t)needs.bytes, "pieces", list);
}

/* Writes the round's parts. *ret_n: their number; parts without tasks are not written. */
static int write_parts(const struct orl_distributed_job *distributed, const char *round,
                       const struct orl_job_task *tasks, size_t n, size_t *ret_n,
                       struct orl_error *err)
{
    const uint32_t most = n < distributed->spec.most ? (uint32_t)n : distributed->spec.most;
    double all = 0, before = 0;
    size_t first = 0, parts = 0;
    int rc = 0;
    for (size_t i = 0; i < n; i++)
        all += tasks[i].work;
    for (size_t i = 0; i < n && rc == 0; i++) {
        const uint32_t mine = part_of(before, tasks[i].work, all, most);
        const double next = before + tasks[i].work;
        char name[120];
        before = next;
        if (i + 1 < n && part_of(next, tasks[i + 1].work, all, most) == mine)
            continue;
        snprintf(name, sizeof name, "%s-%zu.json", round, parts++);
        rc = write_in(distributed, name, part_to_json(distributed, tasks, first, i + 1 - first),
                      err);
        first = i + 1;
    }
    *ret_n = parts;
    return rc;
}

int orl_task_round_write(const struct orl_distributed_job *distributed, const char *round,
                         const struct orl_job_task *tasks, size_t n, size_t *ret_parts,
                         struct orl_error *err)
{
    char name[120];
    int rc = write_parts(distributed, round, tasks, n, ret_parts, err);
    snprintf(name, sizeof name, "%s.wave", round);
    return rc ? rc
              : write_in(distributed, name, json_pack("{s:I}", "parts", (json_int_t)*ret_parts),
                         err);
}

bool orl_task_round_remove_marker(const char *folder, const char *round)
{
    char path[ORL_PART_PATH];
    snprintf(path, sizeof path, "%s/%s.wave", folder, round);
    return unlink(path) == 0;
}

bool orl_folder_has_space(const char *folder)
{
    static const char probe[1 << 16];
    struct orl_error err = {0};
    char path[ORL_PART_PATH];
    snprintf(path, sizeof path, "%s/room", folder);
    const bool full = orl_write_text(path, probe, sizeof probe, &err) == ORL_ERR_FULL;
    unlink(path);
    return !full;
}

/* ---- Reading --------------------------------------------------------------------------------- */

bool orl_part_file(const char *folder, const char *round, size_t number, const char *what,
                   char ret_path[ORL_PART_PATH])
{
    struct stat st;
    snprintf(ret_path, ORL_PART_PATH, "%s/%s-%zu.%s", folder, round, number, what);
    return stat(ret_path, &st) == 0;
}

bool orl_task_round_find(const char *folder, char ret_round[ORL_TASK_ROUND_NAME])
{
    static const char ending[] = ".wave";
    DIR *entries = opendir(folder);
    bool found = false;
    for (const struct dirent *entry; entries && !found && (entry = readdir(entries)) != NULL;) {
        const size_t length = strlen(entry->d_name), stem = length - strlen(ending);
        if (length <= strlen(ending) || strcmp(entry->d_name + stem, ending) != 0 ||
            stem >= ORL_TASK_ROUND_NAME)
            continue;
        memcpy(ret_round, entry->d_name, stem);
        ret_round[stem] = '\0';
        found = true;
    }
    if (entries)
        closedir(entries);
    return found;
}

size_t orl_task_round_count_parts(const char *folder, const char *round)
{
    char path[ORL_PART_PATH];
    snprintf(path, sizeof path, "%s/%s.wave", folder, round);
    json_t *note = json_load_file(path, 0, NULL);
    const json_int_t n = json_integer_value(json_object_get(note, "parts"));
    json_decref(note);
    return n > 0 && n <= ORL_PARTS_MOST ? (size_t)n : 0;
}

struct orl_part_needs orl_task_round_part_needs(const char *folder, const char *round,
                                                size_t number)
{
    char path[ORL_PART_PATH];
    json_t *part =
        orl_part_file(folder, round, number, "json", path) ? json_load_file(path, 0, NULL) : NULL;
    const double core_s = json_number_value(json_object_get(part, "core_s"));
    const json_int_t bytes = json_integer_value(json_object_get(part, "bytes"));
    json_decref(part);
    return (struct orl_part_needs){core_s > 0 ? core_s : 0, bytes > 0 ? (uint64_t)bytes : 0};
}

static void mark_pieces_of_part(const json_t *part, const struct orl_job_task *tasks, size_t n,
                                bool *ret_made)
{
    const json_t *own;
    size_t i;
    json_array_foreach(json_object_get(part, "pieces"), i, own)
    {
        const char *key = json_string_value(json_object_get(own, "key"));
        for (size_t k = 0; key && k < n; k++)
            ret_made[k] = ret_made[k] || strcmp(tasks[k].key, key) == 0;
    }
}

void orl_task_round_mark_made(const char *folder, const char *round, size_t n_parts,
                              const struct orl_job_task *tasks, size_t n, bool *ret_made)
{
    for (size_t i = 0; i < n_parts; i++) {
        char path[ORL_PART_PATH];
        json_t *part =
            orl_part_file(folder, round, i, "json", path) ? json_load_file(path, 0, NULL) : NULL;
        mark_pieces_of_part(part, tasks, n, ret_made);
        json_decref(part);
    }
}
