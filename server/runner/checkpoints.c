#include "runner/checkpoints.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/sha256.h>

#include "store/files/folders.h"
#include "store/files/removal.h"
#include "store/files/scene_bundle.h"
#include "view/view_json.h"
#include "json/encode.h"

static void path_below(const char *folder, const char *before, const char *name, const char *ending,
                       char ret_path[ORL_PATH_MAX])
{
    snprintf(ret_path, ORL_PATH_MAX, "%.*s/%s%.400s%s", ORL_PATH_MAX - 512, folder, before, name,
             ending);
}

/* ---- The folder ------------------------------------------------------------------------------ */

void orl_checkpoint_key(const char *program, const char *asked, const char *scene,
                        char ret_key[ORL_SHA_HEX])
{
    struct orl_sha256 hash;
    const char *const texts[] = {"oriel parts 3", program, asked, scene};
    orl_sha256_init(&hash);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        orl_sha256_add(&hash, texts[i], strlen(texts[i]) + 1);
    orl_sha256_finish_hex(&hash, ret_key);
}

void orl_checkpoint_folder(const struct orl_folders *folders, const char *job_id,
                           char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(folders, ret_path, "partial/%s", job_id);
}

static bool has_key(const char *path, const char *key)
{
    struct orl_file file;
    if (orl_map_file(path, &file, NULL))
        return false;
    const bool same = file.size == strlen(key) && memcmp(file.data, key, file.size) == 0;
    orl_unmap_file(&file);
    return same;
}

int orl_checkpoint_open(const char *folder, const char *key, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    path_below(folder, "+", "key", "", path);
    if (has_key(path, key))
        return 0;
    const int rc = orl_remove_tree(folder, err);
    if (rc)
        return rc;
    if (mkdir(folder, 0777) != 0)
        return orl_error_set(err, orl_err_of_errno(errno),
                             "cannot make a folder for the results: %s", strerror(errno));
    return orl_write_file(path, key, strlen(key), err);
}

/* Returns true if the file is for users. Notes and their files are not, nor are photon maps and
 * half-written files left by a killed round. */
static bool is_for_users(const char *name)
{
    const char *ending = strrchr(name, '.');
    const bool half = ending && (strcmp(ending, ".opm") == 0 || strcmp(ending, ".part") == 0);
    return !half && !strchr(name, '+');
}

void orl_checkpoint_remove_internal(const char *folder)
{
    char path[ORL_PATH_MAX];
    DIR *entries = opendir(folder);
    for (const struct dirent *entry; entries && (entry = readdir(entries));) {
        if (is_for_users(entry->d_name) || entry->d_name[0] == '.')
            continue;
        path_below(folder, "", entry->d_name, "", path);
        unlink(path);
    }
    if (entries)
        closedir(entries);
}

bool orl_checkpoint_transfer(const struct orl_folders *folders, const char *from_id,
                             const char *to_id)
{
    char from[ORL_PATH_MAX], to[ORL_PATH_MAX];
    orl_checkpoint_folder(folders, from_id, from);
    orl_checkpoint_folder(folders, to_id, to);
    return rename(from, to) == 0;
}

void orl_checkpoint_sweep(const struct orl_folders *folders,
                          const char *(*successor)(void *ctx, const char *job_id, bool *ret_known),
                          void *ctx)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "partial");
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        bool known = true;
        const char *id =
            entry->d_name[0] == '.' ? entry->d_name : successor(ctx, entry->d_name, &known);
        if (id &&
            (strcmp(id, entry->d_name) == 0 || orl_checkpoint_transfer(folders, entry->d_name, id)))
            continue;
        if (!known) {
            snprintf(path, sizeof path, "partial/%.255s", entry->d_name);
            orl_orphan_set_aside(folders, path, NULL);
            continue;
        }
        orl_checkpoint_folder(folders, entry->d_name, path);
        orl_remove_tree(path, NULL);
    }
    if (folder)
        closedir(folder);
}

/* ---- Parts ----------------------------------------------------------------------------------- */

int orl_checkpoint_add(const char *folder, const char *part, json_t *files, json_t *about,
                       struct orl_error *err)
{
    char path[ORL_PATH_MAX], note[ORL_PATH_MAX];
    json_t *doc = json_pack("{s:O, s:o}", "files", files, "about", about);
    char *text = orl_json_text(doc, JSON_COMPACT);
    json_decref(doc);
    if (!text)
        return orl_error_no_memory(err);
    path_below(folder, "+", part, ".note", path);
    path_below(folder, "+", part, ".done", note);
    int rc = orl_write_file(path, text, strlen(text), err);
    if (rc == 0)
        rc = orl_rename_synced(path, note, err);
    free(text);
    return rc;
}

/* Returns true if the file still matches its note. */
static bool is_whole(const char *folder, const json_t *entry)
{
    const char *name = json_string_value(json_object_get(entry, "name"));
    const char *wanted = json_string_value(json_object_get(entry, "sha256"));
    char path[ORL_PATH_MAX], sha[ORL_SHA_HEX];
    struct orl_file file;
    if (!name || !wanted || strchr(name, '/'))
        return false;
    path_below(folder, "", name, "", path);
    if (orl_map_file(path, &file, NULL))
        return false;
    orl_sha256_hex(file.data, file.size, sha);
    orl_unmap_file(&file);
    return strcmp(sha, wanted) == 0;
}

bool orl_checkpoint_find(const char *folder, const char *part, json_t **ret_files,
                         json_t **ret_about)
{
    char path[ORL_PATH_MAX];
    const json_t *entry;
    size_t i;
    path_below(folder, "+", part, ".done", path);
    json_t *note = json_load_file(path, 0, NULL);
    json_t *files = json_object_get(note, "files"), *about = json_object_get(note, "about");
    bool whole = json_is_array(files) && about;
    json_array_foreach(files, i, entry)
    {
        whole = whole && is_whole(folder, entry);
    }
    if (whole && ret_files)
        *ret_files = json_incref(files);
    if (whole && ret_about)
        *ret_about = json_incref(about);
    json_decref(note);
    return whole;
}

json_t *orl_checkpoint_view_to_json(const struct orl_view_result *view)
{
    json_t *json = json_pack("{s:s, s:o, s:b, s:b}", "name", view->name, "seconds",
                             orl_json_from_real(view->seconds), "black", (int)view->black, "rated",
                             (int)(view->glare != NULL));
    return orl_json_checked(json, json && orl_pictures_to_json(view, json));
}

/* Returns a copy, or NULL: there is no such text, or no memory. */
static char *copy_text(const json_t *json, const char *key)
{
    const char *text = json_string_value(json_object_get(json, key));
    return text ? strdup(text) : NULL;
}

bool orl_checkpoint_view_from_json(const json_t *json, struct orl_view_result *ret_view)
{
    struct orl_view_result view = {.name = copy_text(json, "name")};
    view.seconds = json_number_value(json_object_get(json, "seconds"));
    view.black = json_is_true(json_object_get(json, "black"));
    /* Glare results of a view are not stored, so such a view is rendered again. */
    if (!json_is_true(json_object_get(json, "rated")) && orl_pictures_read_back(json, &view) &&
        view.name) {
        *ret_view = view;
        return true;
    }
    orl_view_result_done(&view);
    return false;
}

/* ---- Sensors --------------------------------------------------------------------------------- */

/* Layout of the file: for each sensor, one after the other, value, error, bias, low, high. */
enum { SENSOR_NUMBERS = 5 };

int orl_checkpoint_sensors_write(const char *folder, const char *name,
                                 const struct orl_result *result, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    double *numbers = malloc((SENSOR_NUMBERS * result->n_sensors + 1) * sizeof *numbers);
    if (!numbers)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < result->n_sensors; i++) {
        double *n = numbers + SENSOR_NUMBERS * i;
        n[0] = result->illuminance_lx[i];
        n[1] = result->standard_error_lx[i];
        n[2] = result->bias_estimate_lx[i];
        n[3] = result->interval_95_lx[i][0];
        n[4] = result->interval_95_lx[i][1];
    }
    path_below(folder, "", name, "", path);
    const int rc =
        orl_write_file(path, numbers, SENSOR_NUMBERS * result->n_sensors * sizeof *numbers, err);
    free(numbers);
    return rc;
}

bool orl_checkpoint_sensors_read(const char *folder, const char *name, struct orl_result *result)
{
    char path[ORL_PATH_MAX];
    struct orl_file file;
    path_below(folder, "", name, "", path);
    if (orl_map_file(path, &file, NULL))
        return false;
    const bool fits = file.size == SENSOR_NUMBERS * result->n_sensors * sizeof(double);
    for (size_t i = 0; fits && i < result->n_sensors; i++) {
        double n[SENSOR_NUMBERS];
        memcpy(n, file.data + i * sizeof n, sizeof n);
        result->illuminance_lx[i] = n[0];
        result->standard_error_lx[i] = n[1];
        result->bias_estimate_lx[i] = n[2];
        result->interval_95_lx[i][0] = n[3];
        result->interval_95_lx[i][1] = n[4];
    }
    orl_unmap_file(&file);
    return fits;
}
