#include "http/upload_bundle.h"

#include <dirent.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/limits.h>
#include <oriel/base/sha256.h>
#include <oriel/bsdf/bsdf_fit.h>
#include <oriel/job/run.h>
#include <sys/stat.h>

#include "distributed/atomic_files.h"
#include "http/json_get.h"
#include "input/input_folders.h"
#include "output/terminal.h"
#include "project/main_files.h"

static int by_name(const void *a, const void *b)
{
    const struct orl_upload_part *x = a, *y = b;
    return strcmp(x->name, y->name);
}

/* Hashes a line "main <digest> <name>\n", or with "resource". */
static int add_line(struct orl_sha256 *hash, const struct orl_upload_part *part,
                    struct orl_error *err)
{
    const char *role = part->resource ? "resource " : "main ";
    char digest[ORL_DIGEST_TEXT];
    const int rc = orl_digest_file(part->path, digest, err);
    if (rc)
        return rc;
    orl_sha256_add(hash, role, strlen(role));
    orl_sha256_add(hash, digest, strlen(digest));
    orl_sha256_add(hash, " ", 1);
    orl_sha256_add(hash, part->name, strlen(part->name));
    orl_sha256_add(hash, "\n", 1);
    return 0;
}

/* Computes the daemon's id of a scene of these files (defined at POST /v1/scenes), so that uploads
 * that the daemon already has are skipped. */
static int digest_scene(const struct orl_upload_part *parts, size_t n_parts,
                        char ret_id[ORL_DIGEST_TEXT], struct orl_error *err)
{
    static const char first[] = "oriel-scene 1\n";
    struct orl_upload_part *resources =
        calloc(n_parts + 1, sizeof *resources); /* strings are borrowed */
    struct orl_sha256 hash;
    size_t n_resources = 0;
    int rc = 0;
    if (!resources)
        return orl_error_no_memory(err);
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, first, strlen(first));
    for (size_t i = 0; i < n_parts && rc == 0; i++) {
        if (parts[i].resource)
            resources[n_resources++] = parts[i];
        else
            rc = add_line(&hash, &parts[i], err);
    }
    qsort(resources, n_resources, sizeof *resources, by_name);
    for (size_t i = 0; i < n_resources && rc == 0; i++)
        rc = add_line(&hash, &resources[i], err);
    free(resources);
    if (rc == 0)
        orl_digest_end(&hash, ret_id);
    return rc;
}

static bool name_can_travel(const char *name)
{
    if (name[0] == '/' || name[0] == '\0')
        return false;
    for (const char *part = name; part; part = strchr(part, '/')) {
        part += *part == '/';
        if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == '\0'))
            return false;
    }
    return true;
}

static bool is_xml(const char *name)
{
    const size_t length = strlen(name);
    return length > 4 && strcmp(name + length - 4, ".xml") == 0;
}

/* Finds a file: below the folder, or else in the user's library. */
static int find_path(const char *folder, const char *name, char *ret_path, size_t size,
                     struct orl_error *err)
{
    char of_library[4096];
    const int rc = orl_join_path(folder, name, ret_path, size, err);
    if (rc == 0 && access(ret_path, F_OK) != 0 &&
        orl_raypath_find(name, of_library, sizeof of_library))
        snprintf(ret_path, size, "%s", of_library);
    return rc;
}

/* Adds a file unless it was added before: a file may be referred to many times. */
static int add_part(struct orl_upload *bundle, const char *folder, const char *name, bool resource,
                    struct orl_error *err)
{
    char path[4096];
    for (size_t i = 0; i < bundle->n_parts; i++)
        if (strcmp(bundle->parts[i].name, name) == 0)
            return 0;
    if (!name_can_travel(name)) {
        orl_error_set(err, ORL_ERR_INVALID, "\"%.200s\" lies outside the scene's folder", name);
        orl_error_hint(err, "only files below the folder are uploaded: move it there");
        return ORL_ERR_INVALID;
    }
    int rc = find_path(folder, name, path, sizeof path, err);
    if (rc)
        return rc;
    if (bundle->n_parts == bundle->room)
        return orl_error_set(err, ORL_ERR_LIMIT, "the scene has more than %u files",
                             ORL_LIMIT_SCENE_FILES);
    struct orl_upload_part *part = &bundle->parts[bundle->n_parts++];
    *part = (struct orl_upload_part){strdup(path), strdup(name), resource || is_xml(name)};
    if (!part->path || !part->name)
        return orl_error_no_memory(err);
    return 0;
}

/* Checks a scene and finds its references, or checks measurements, which have none. */
static int check_scene(const char *const *main_files, size_t n_files, const struct orl_files *files,
                       struct orl_scene_summary *ret_summary, struct orl_error *err)
{
    struct orl_bsdf_measurements found;
    struct orl_file first;
    bool measured = false;
    if (n_files > 0 && files->open(files->ctx, main_files[0], &first, NULL) == 0) {
        measured = orl_bsdf_is_measured(first.data, first.size);
        files->close(files->ctx, &first);
    }
    return measured ? orl_bsdf_measurements_check(main_files, n_files, files, &found, err)
                    : orl_scene_check(main_files, n_files, files, NULL, ret_summary, err);
}

int orl_bundle_collect(const char *folder, const char *const *main_files, size_t n_files,
                       struct orl_upload *ret_bundle, struct orl_error *err)
{
    const struct orl_files files = orl_raypath_files(folder);
    struct orl_upload bundle = {.room = ORL_LIMIT_SCENE_FILES};
    struct orl_scene_summary summary = {0};
    int rc;
    bundle.parts = calloc(bundle.room, sizeof *bundle.parts);
    if (!bundle.parts) {
        rc = orl_error_no_memory(err);
        goto done;
    }
    rc = check_scene(main_files, n_files, &files, &summary, err);
    for (size_t i = 0; i < n_files && rc == 0; i++)
        rc = add_part(&bundle, folder, main_files[i], false, err);
    for (size_t i = 0; i < summary.n_referenced && rc == 0; i++)
        rc = add_part(&bundle, folder, summary.referenced[i], true, err);
    if (rc == 0) {
        *ret_bundle = bundle;
        bundle = (struct orl_upload){0};
    }
done:
    orl_scene_summary_done(&summary);
    orl_bundle_done(&bundle);
    return rc;
}

/* Adds the files that these files refer to when read in order, but not these files themselves. */
static int add_referenced(struct orl_upload *bundle, const char *folder, const char *const *names,
                          size_t count, struct orl_error *err)
{
    const struct orl_files files = orl_raypath_files(folder);
    struct orl_scene_summary summary = {0};
    int rc = orl_scene_check(names, count, &files, NULL, &summary, err);
    for (size_t i = 0; i < summary.n_referenced && rc == 0; i++)
        rc = add_part(bundle, folder, summary.referenced[i], true, err);
    orl_scene_summary_done(&summary);
    return rc;
}

void orl_bundle_names_free(char **names, size_t count)
{
    for (size_t i = 0; i < count; i++)
        free(names[i]);
    free(names);
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static bool is_of_scene(const char *name)
{
    return orl_name_has_ending(name, ".rad") || orl_name_has_ending(name, ".mat") ||
           orl_name_has_ending(name, ".json");
}

/* Lists a folder's files that end in .rad, .mat or .json, sorted. */
static int list_scene_files(const char *folder, char **names, size_t *count, struct orl_error *err)
{
    DIR *entries = NULL;
    int rc = orl_open_folder(folder, &entries, err);
    if (rc)
        return rc;
    for (const struct dirent *entry; rc == 0 && (entry = readdir(entries)) != NULL;) {
        if (entry->d_name[0] == '.' || !is_of_scene(entry->d_name))
            continue;
        if (*count == ORL_LIMIT_SCENE_FILES)
            rc = orl_error_set(err, ORL_ERR_LIMIT,
                               "the folder has more than %u .rad, .mat and .json files",
                               ORL_LIMIT_SCENE_FILES);
        else if (!(names[*count] = strdup(entry->d_name)))
            rc = orl_error_no_memory(err);
        *count += rc == 0;
    }
    closedir(entries);
    qsort(names, *count, sizeof *names, compare_names);
    return rc;
}

int orl_bundle_main_files(const char *folder, char ***ret_names, size_t *ret_count,
                          struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    size_t chosen[ORL_LIMIT_SCENE_FILES];
    char **names = calloc(ORL_LIMIT_SCENE_FILES, sizeof *names);
    size_t count = 0, kept = 0;
    int rc = names ? list_scene_files(folder, names, &count, err) : orl_error_no_memory(err);
    if (rc == 0)
        rc = orl_main_files_choose((const char *const *)names, count, &files, chosen, &kept, err);
    char **mains = rc == 0 ? calloc(kept + 1, sizeof *mains) : NULL;
    if (rc == 0 && !mains)
        rc = orl_error_no_memory(err);
    for (size_t i = 0; i < kept && mains && names; i++) {
        mains[i] = names[chosen[i]]; /* moved */
        names[chosen[i]] = NULL;
    }
    orl_bundle_names_free(names, count);
    *ret_names = mains;
    *ret_count = mains ? kept : 0;
    return rc;
}

int orl_bundle_add(struct orl_upload *bundle, const char *folder, const char *name,
                   struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    struct orl_file file;
    /* Opening it reports a misspelt name before anything is sent. */
    const int rc = files.open(files.ctx, name, &file, err);
    if (rc)
        return rc;
    files.close(files.ctx, &file);
    return add_part(bundle, folder, name, true, err);
}

void orl_bundle_done(struct orl_upload *bundle)
{
    if (!bundle)
        return;
    for (size_t i = 0; i < bundle->n_parts; i++) {
        free(bundle->parts[i].path);
        free(bundle->parts[i].name);
    }
    free(bundle->parts);
    *bundle = (struct orl_upload){0};
}

int orl_bundle_upload(const struct orl_upload *bundle, struct orl_http *http, char **ret_id,
                      struct orl_error *err)
{
    const double start_s = orl_clock_s(NULL);
    double bytes = 0;
    char amount[32];
    json_t *reply = NULL;
    bool known = false;
    char id[ORL_DIGEST_TEXT], path[ORL_DIGEST_TEXT + 32];
    int rc = digest_scene(bundle->parts, bundle->n_parts, id, err);
    if (rc)
        return rc;
    for (size_t i = 0; i < bundle->n_parts; i++) {
        struct stat info;
        if (stat(bundle->parts[i].path, &info) == 0)
            bytes += (double)info.st_size;
    }
    snprintf(path, sizeof path, "/v1/scenes/%s", id);
    rc = orl_http_has(http, path, &known, err);
    if (rc == 0 && !known)
        rc = orl_http_post_parts(http, "/v1/scenes", bundle->parts, bundle->n_parts, &reply, err);
    if (rc)
        return rc;
    orl_format_amount(bytes, "B", amount, sizeof amount);
    fprintf(stderr, "scene: %zu files, %s, %s in %.1f s\n", bundle->n_parts, amount,
            http->status == 201 ? "uploaded" : "already known to the daemon",
            orl_clock_s(NULL) - start_s);
    *ret_id = strdup(known ? id : orl_get_text(reply, "id"));
    json_decref(reply);
    if (!*ret_id)
        return orl_error_no_memory(err);
    return 0;
}

/* Destination for files that the scene itself does not name. */
struct resources {
    struct orl_upload *bundle;
    const char *folder;
};

static int add_file(void *ctx, const struct orl_job_request_file *file, struct orl_error *err)
{
    const struct resources *resources = ctx;
    return orl_bundle_add(resources->bundle, resources->folder, file->name, err);
}

/* Collects references of a state's files, read after the scene, whose definitions they may use. */
static int collect_state(const struct resources *resources,
                         const struct orl_job_request *job_request,
                         const struct orl_shade_state *state, struct orl_error *err)
{
    size_t count;
    char *const *names = orl_job_request_scene(job_request, &count);
    const char **all = malloc((count + state->n_files + 1) * sizeof *all);
    if (!all)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < count; i++)
        all[i] = names[i];
    for (size_t i = 0; i < state->n_files; i++)
        all[count + i] = state->files[i];
    int rc = add_referenced(resources->bundle, resources->folder, all, count + state->n_files, err);
    free(all);
    return rc;
}

/* Collects references of all shade states. */
static int collect_shades(const struct resources *resources,
                          const struct orl_job_request *job_request, struct orl_error *err)
{
    const struct orl_annual_request *year = &job_request->of.annual.request;
    const size_t groups = job_request->kind == ORL_JOB_KIND_ANNUAL ? year->n_groups : 0;
    int rc = 0;
    for (size_t g = 0; g < groups; g++)
        for (size_t s = 0; s < year->groups[g].n_states && rc == 0; s++)
            if (year->groups[g].states[s].n_files > 0)
                rc = collect_state(resources, job_request, &year->groups[g].states[s], err);
    return rc;
}

int orl_job_bundle_collect(const char *folder, const struct orl_job_request *job_request,
                           struct orl_upload *ret_bundle, struct orl_error *err)
{
    const struct resources resources = {ret_bundle, folder};
    size_t count;
    const char *const *names = (const char *const *)orl_job_request_scene(job_request, &count);
    int rc = orl_bundle_collect(folder, names, count, ret_bundle, err);
    if (rc == 0)
        rc = orl_job_request_files(job_request, add_file, (void *)(uintptr_t)&resources, err);
    return rc ? rc : collect_shades(&resources, job_request, err);
}
