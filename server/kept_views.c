#include "kept_views.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/version.h>

#include "encode.h"

enum { IMAGES = 4 };

static void list_images(const struct orl_view_result *view, const char *ret_names[IMAGES])
{
    ret_names[0] = view->hdr;
    ret_names[1] = view->png;
    ret_names[2] = view->error_hdr;
    ret_names[3] = view->error_png;
}

static void path_below(const char *folder, const char *name, const char *ending,
                       char ret_path[ORL_PATH_MAX])
{
    snprintf(ret_path, ORL_PATH_MAX, "%.*s/%s%s", ORL_PATH_MAX - 512, folder, name, ending);
}

void orl_kept_views_folder(const struct orl_folders *folders, const char *job_id,
                           char ret_path[ORL_PATH_MAX])
{
    orl_folders_path(folders, ret_path, "partial/%s", job_id);
}

int orl_kept_views_add(const char *folder, const struct orl_view_result *view,
                       struct orl_error *err)
{
    const char *images[IMAGES];
    char path[ORL_PATH_MAX], note[ORL_PATH_MAX];
    int rc = 0;
    list_images(view, images);
    for (int i = 0; i < IMAGES && rc == 0; i++) {
        if (!images[i])
            continue;
        path_below(folder, images[i], "", path);
        rc = orl_sync_path(path, err);
    }
    if (rc)
        return rc;
    json_t *doc = json_pack("{s:s, s:o, s:s, s:s, s:s*, s:s*}", "version", ORL_VERSION, "seconds",
                            orl_json_from_real(view->seconds), "hdr", view->hdr, "png", view->png,
                            "error_hdr", view->error_hdr, "error_png", view->error_png);
    char *text = doc ? json_dumps(doc, JSON_COMPACT) : NULL;
    json_decref(doc);
    if (!text)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    path_below(folder, view->name, ".note", path);
    path_below(folder, view->name, ".done", note);
    rc = orl_write_file(path, text, strlen(text), err);
    if (rc == 0)
        rc = orl_rename_synced(path, note, err);
    free(text);
    return rc;
}

/* An image that a note names is there; *ret_name is owned. */
static bool find_image(const char *folder, const json_t *note, const char *key, char **ret_name)
{
    char path[ORL_PATH_MAX];
    const char *name = json_string_value(json_object_get(note, key));
    if (!name)
        return false;
    path_below(folder, name, "", path);
    *ret_name = access(path, R_OK) == 0 ? strdup(name) : NULL;
    return *ret_name != NULL;
}

static void view_done(struct orl_view_result *view)
{
    free(view->name);
    free(view->hdr);
    free(view->png);
    free(view->error_hdr);
    free(view->error_png);
}

bool orl_kept_views_find(const char *folder, const char *name, struct orl_view_result *ret_view)
{
    char path[ORL_PATH_MAX];
    struct orl_view_result view = {0};
    path_below(folder, name, ".done", path);
    json_t *note = json_load_file(path, 0, NULL);
    const char *version = json_string_value(json_object_get(note, "version"));
    bool found = version && strcmp(version, ORL_VERSION) == 0;
    if (found) {
        view.name = strdup(name);
        view.seconds = json_number_value(json_object_get(note, "seconds"));
        found = view.name && find_image(folder, note, "hdr", &view.hdr) &&
                find_image(folder, note, "png", &view.png);
    }
    if (found && json_object_get(note, "error_hdr"))
        found = find_image(folder, note, "error_hdr", &view.error_hdr) &&
                find_image(folder, note, "error_png", &view.error_png);
    json_decref(note);
    if (found)
        *ret_view = view;
    else
        view_done(&view);
    return found;
}

void orl_kept_views_forget(const char *folder, const struct orl_job *job)
{
    char path[ORL_PATH_MAX];
    for (size_t i = 0; i < job->n_views; i++) {
        path_below(folder, job->views[i].name, ".done", path);
        unlink(path);
    }
}

void orl_kept_views_list(const char *folder, const struct orl_view_result *view, json_t *files)
{
    const char *images[IMAGES];
    char path[ORL_PATH_MAX];
    struct stat st;
    list_images(view, images);
    for (int i = 0; i < IMAGES; i++) {
        if (!images[i])
            continue;
        path_below(folder, images[i], "", path);
        if (stat(path, &st) == 0)
            json_array_append_new(
                files, json_pack("{s:s, s:I}", "name", images[i], "bytes", (json_int_t)st.st_size));
    }
}

void orl_kept_views_sweep(const struct orl_folders *folders,
                          bool (*wanted)(void *ctx, const char *job_id), void *ctx)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "partial");
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        if (entry->d_name[0] == '.' || wanted(ctx, entry->d_name))
            continue;
        orl_kept_views_folder(folders, entry->d_name, path);
        orl_remove_tree(path, NULL);
    }
    if (folder)
        closedir(folder);
}
