#include "handlers/scenes/upload.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/base/limits.h>

#include "uploads/uploads.h"
#include "json/decode.h"

void orl_scene_upload_done(struct orl_scene_upload *upload)
{
    orl_bundle_done(&upload->bundle);
    free(upload->mains);
    free(upload->summary);
    json_decref(upload->choice);
    upload->mains = upload->summary = NULL;
    upload->choice = NULL;
}

static int add_choice(struct orl_scene_upload *upload, const char *group, size_t length,
                      const char *state, struct orl_error *err)
{
    if (!upload->choice)
        upload->choice = json_pack("{s:{}}", "states");
    json_t *states = json_object_get(upload->choice, "states"), *named = json_string(state);
    const int failed = group ? json_object_setn_new(states, group, length, named)
                             : json_object_set_new(upload->choice, "sky", named);
    return failed ? orl_error_set(err, ORL_ERR_INVALID,
                                  "the chosen state or sky of the project is not UTF-8")
                  : 0;
}

int orl_scene_upload_choose_state(struct orl_scene_upload *upload, const char *choice,
                                  struct orl_error *err)
{
    const char *state = strchr(choice, '=');
    if (state)
        return add_choice(upload, choice, (size_t)(state - choice), state + 1, err);
    orl_error_set(err, ORL_ERR_INVALID, "choose a state as GROUP=STATE");
    orl_error_at(err, NULL, 0, "state");
    return ORL_ERR_INVALID;
}

int orl_scene_upload_choose_sky(struct orl_scene_upload *upload, const char *name,
                                struct orl_error *err)
{
    return add_choice(upload, NULL, 0, name, err);
}

/* Returns the choices of a project, empty if none were made; NULL if main files are named. */
static const json_t *choice_of(struct orl_scene_upload *upload)
{
    if (!upload->choice)
        upload->choice = json_object();
    return upload->mains ? NULL : upload->choice;
}

int orl_scene_upload_add_main(struct orl_scene_upload *upload, const char *names,
                              struct orl_error *err)
{
    const size_t before = upload->mains ? strlen(upload->mains) : 0, size = strlen(names);
    char *grown = realloc(upload->mains, before + size + 2);
    if (!grown)
        return orl_error_no_memory(err);
    if (before > 0)
        grown[before] = '\n';
    memcpy(grown + before + (before > 0), names, size + 1);
    upload->mains = grown;
    return 0;
}

/* Adds one entry of "bsdfs": a BSDF uploaded before, under its name in the scene. */
static int add_bsdf(struct orl_scene_upload *upload, const char *name, const json_t *id,
                    const struct orl_folders *folders, struct orl_error *err)
{
    char where[ORL_JSON_PATH_MAX], path[ORL_PATH_MAX];
    struct stat st;
    snprintf(where, sizeof where, "bsdfs.%.120s", name);
    const char *sha = json_string_value(id);
    if (!sha || !orl_is_sha256(sha))
        return orl_json_fail(err, ORL_ERR_INVALID, where,
                             "this is not the id of a BSDF: 64 hexadecimal digits");
    orl_blob_path(folders, sha, path);
    if (stat(path, &st) != 0) {
        orl_json_fail(err, ORL_ERR_NOT_FOUND, where, "no BSDF of that id is stored");
        orl_error_hint(err, "Upload it with POST /v1/bsdfs first");
        return ORL_ERR_NOT_FOUND;
    }
    return orl_bundle_add(&upload->bundle, name, true, path, (uint64_t)st.st_size, sha, false, err);
}

static int add_bsdfs(struct orl_scene_upload *upload, json_t *bsdfs,
                     const struct orl_folders *folders, struct orl_error *err)
{
    const char *name;
    json_t *id;
    if (!json_is_object(bsdfs))
        return orl_json_fail(err, ORL_ERR_INVALID, "bsdfs",
                             "this is not an object such as {\"name.xml\": \"id\"}");
    json_object_foreach(bsdfs, name, id)
    {
        const int rc = add_bsdf(upload, name, id, folders, err);
        if (rc)
            return rc;
    }
    return 0;
}

/* Makes the file of that name a main file, after those that are. */
static int make_main(struct orl_bundle *bundle, size_t place, const char *name,
                     struct orl_error *err)
{
    size_t i = place;
    while (i < bundle->count && strcmp(bundle->files[i].name, name) != 0)
        i++;
    if (i == bundle->count) {
        orl_error_set(err, ORL_ERR_INVALID,
                      "the main file '%.200s' was not sent, or is named twice", name);
        orl_error_at(err, NULL, 0, "main");
        return ORL_ERR_INVALID;
    }
    const struct orl_bundle_file file = bundle->files[i];
    memmove(&bundle->files[place + 1], &bundle->files[place], (i - place) * sizeof file);
    bundle->files[place] = file;
    bundle->files[place].resource = false;
    return 0;
}

static int choose_mains(struct orl_scene_upload *upload, struct orl_error *err)
{
    size_t place = 0;
    int rc = 0;
    char *save = NULL;
    if (!upload->mains)
        return 0;
    for (size_t i = 0; i < upload->bundle.count; i++)
        upload->bundle.files[i].resource = true;
    for (char *name = strtok_r(upload->mains, "\r\n", &save); name && rc == 0;
         name = strtok_r(NULL, "\r\n", &save))
        rc = make_main(&upload->bundle, place++, name, err);
    return rc;
}

/* Lists the first names of the bundle: of main files, or else of files that end in .rad, or of all
 * if none do. */
static void list_names(const struct orl_bundle *bundle, bool mains, char *ret_text, size_t capacity)
{
    enum { MOST = 8 };
    size_t n_radiance = 0, listed = 0, length = 0;
    for (size_t i = 0; i < bundle->count; i++)
        n_radiance += orl_name_has_ending(bundle->files[i].name, ".rad");
    for (size_t i = 0; i < bundle->count && length < capacity; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        if (mains ? file->resource : n_radiance > 0 && !orl_name_has_ending(file->name, ".rad"))
            continue;
        if (listed++ == MOST) {
            snprintf(ret_text + length, capacity - length, " and others");
            return;
        }
        length += (size_t)snprintf(ret_text + length, capacity - length, "%s%.60s",
                                   listed > 1 ? ", " : "", file->name);
    }
}

/* Refuses an upload whose main files were not named and cannot be guessed. */
static int refuse_without_mains(struct orl_bundle *bundle, struct orl_error *err)
{
    char names[ORL_ERROR_TEXT_MAX / 2] = "";
    bool radiance = false;
    for (size_t i = 0; i < bundle->count; i++)
        radiance = radiance || orl_name_has_ending(bundle->files[i].name, ".rad");
    orl_bundle_sort(bundle);
    list_names(bundle, false, names, sizeof names);
    if (radiance)
        orl_error_set(err, ORL_ERR_INVALID,
                      "cannot tell which files are the main files of the scene: %s", names);
    else
        orl_error_set(err, ORL_ERR_INVALID, "no scene file was sent%s%s",
                      bundle->count > 0 ? ", only " : "", names);
    orl_error_hint(err, radiance
                            ? "They are in several folders, or each is used by another's command: "
                              "name the main files with main, or move them to the top folder"
                            : "Send at least one Radiance file (.rad)");
    return ORL_ERR_INVALID;
}

/* Completes every form of upload: checks that there are main files and none is empty, sorts the
 * files, and computes the id. */
static int finish_upload(struct orl_scene_upload *upload, struct orl_error *err)
{
    const int rc = choose_mains(upload, err);
    if (rc)
        return rc;
    if (orl_bundle_main_count(&upload->bundle) == 0)
        return refuse_without_mains(&upload->bundle, err);
    for (size_t i = 0; i < upload->bundle.count; i++)
        if (upload->bundle.files[i].bytes == 0) {
            orl_error_set(err, ORL_ERR_SYNTAX, "the file is empty");
            orl_error_at(err, upload->bundle.files[i].name, 1, NULL);
            return ORL_ERR_SYNTAX;
        }
    orl_bundle_sort(&upload->bundle);
    return orl_bundle_id(&upload->bundle, upload->id, err);
}

static int add_zips(struct orl_scene_upload *upload, const struct orl_bundle *zips,
                    const struct orl_folders *folders, struct orl_check_call *call,
                    struct orl_error *err)
{
    int rc = 0;
    upload->guessed = zips->count > 0 && !upload->mains;
    for (size_t i = 0; i < zips->count && rc == 0; i++)
        rc = orl_check_client_unzip(call, zips->files[i].path, folders, choice_of(upload),
                                    &upload->bundle, err);
    return rc;
}

/* Returns the index of the Honeybee model among the parts: a main file named .hbjson, or .json if
 * it is the only one. Returns bundle->count if there is none. */
static size_t find_model(const struct orl_bundle *bundle, bool alone)
{
    for (size_t i = 0; i < bundle->count; i++)
        if (!bundle->files[i].resource && orl_name_has_ending(bundle->files[i].name, ".hbjson"))
            return i;
    for (size_t i = 0; alone && i < bundle->count; i++)
        if (!bundle->files[i].resource)
            return orl_bundle_main_count(bundle) == 1 &&
                           orl_name_has_ending(bundle->files[i].name, ".json")
                       ? i
                       : bundle->count;
    return bundle->count;
}

/* Refuses a second model, since a scene is one model and the second would be stored unread. */
static int refuse_second_model(const struct orl_bundle *bundle, size_t first, struct orl_error *err)
{
    for (size_t i = first + 1; i < bundle->count; i++) {
        if (bundle->files[i].resource || !orl_name_has_ending(bundle->files[i].name, ".hbjson"))
            continue;
        orl_error_set(err, ORL_ERR_INVALID,
                      "a scene has only one Honeybee model, and '%.100s' came before",
                      bundle->files[first].name);
        orl_error_at(err, bundle->files[i].name, 0, NULL);
        orl_error_hint(err, "Upload each model by itself");
        return ORL_ERR_INVALID;
    }
    return 0;
}

/* Replaces the model at that index by its files. Other files are stored with them. */
static int add_model(struct orl_scene_upload *upload, size_t place,
                     const struct orl_folders *folders, struct orl_check_call *call,
                     struct orl_error *err)
{
    struct orl_bundle *bundle = &upload->bundle;
    json_t *bsdfs = NULL;
    for (size_t i = 0; i < bundle->count; i++)
        bundle->files[i].resource = true;
    int rc = orl_check_client_document(call, bundle->files[place].path, folders, choice_of(upload),
                                       bundle, &bsdfs, err);
    if (rc && err && !err->file[0])
        orl_error_at(err, bundle->files[place].name, 0, NULL);
    if (rc == 0 && bsdfs)
        rc = add_bsdfs(upload, bsdfs, folders, err);
    json_decref(bsdfs);
    orl_bundle_remove(bundle, place);
    upload->listed = !upload->mains;
    return rc;
}

int orl_scene_upload_multipart(struct orl_scene_upload *upload, struct MHD_Connection *connection,
                               const struct orl_file *body, const struct orl_folders *folders,
                               struct orl_check_call *call, struct orl_error *err)
{
    struct orl_multipart parts = {0};
    int rc = orl_multipart_split(connection, body, folders, &parts, err);
    if (rc)
        return rc;
    upload->bundle = parts.files;
    memset(&parts.files, 0, sizeof parts.files);
    if (parts.mains)
        rc = orl_scene_upload_add_main(upload, parts.mains, err);
    const size_t model = find_model(&upload->bundle, !upload->mains && parts.zips.count == 0);
    if (rc == 0)
        rc = refuse_second_model(&upload->bundle, model, err);
    if (rc == 0 && model < upload->bundle.count)
        rc = add_model(upload, model, folders, call, err);
    if (rc == 0)
        rc = add_zips(upload, &parts.zips, folders, call, err);
    if (rc == 0 && parts.bsdfs) {
        json_t *bsdfs = NULL;
        rc = orl_json_parse("bsdfs", parts.bsdfs, strlen(parts.bsdfs), &bsdfs, err);
        if (rc == 0)
            rc = add_bsdfs(upload, bsdfs, folders, err);
        json_decref(bsdfs);
    }
    orl_multipart_done(&parts);
    return rc ? rc : finish_upload(upload, err);
}

int orl_scene_upload_zip(struct orl_scene_upload *upload, const char *path,
                         const struct orl_folders *folders, struct orl_check_call *call,
                         struct orl_error *err)
{
    const int rc =
        orl_check_client_unzip(call, path, folders, choice_of(upload), &upload->bundle, err);
    upload->listed = upload->guessed = !upload->mains;
    return rc ? rc : finish_upload(upload, err);
}

int orl_scene_upload_json(struct orl_scene_upload *upload, const char *path,
                          const struct orl_folders *folders, struct orl_check_call *call,
                          struct orl_error *err)
{
    json_t *bsdfs = NULL;
    int rc = orl_check_client_document(call, path, folders, choice_of(upload), &upload->bundle,
                                       &bsdfs, err);
    upload->listed = !upload->mains;
    if (rc == 0 && bsdfs)
        rc = add_bsdfs(upload, bsdfs, folders, err);
    json_decref(bsdfs);
    return rc ? rc : finish_upload(upload, err);
}

/* ---- Checking and keeping ------------------------------------------------------------------- */

/* Adds to an error's hint the main files, if they were guessed and not named. */
static void add_mains_hint(const struct orl_scene_upload *upload, struct orl_error *err)
{
    char names[ORL_ERROR_TEXT_MAX / 2] = "", hint[ORL_ERROR_TEXT_MAX];
    list_names(&upload->bundle, true, names, sizeof names);
    snprintf(hint, sizeof hint, "%.*s", (int)sizeof hint - 1, err->hint);
    orl_error_hint(err, "%.*s%sMain files, in this order: %s; use main to name others",
                   (int)sizeof hint / 3, hint, hint[0] ? ". " : "", names);
}

int orl_scene_upload_check(struct orl_scene_upload *upload, struct orl_check_call *call,
                           struct orl_error *err)
{
    const int rc = orl_check_client_scene(
        call, &upload->bundle, upload->listed ? upload->choice : NULL, &upload->summary, err);
    if (rc && upload->guessed && rc != ORL_ERR_NOMEM && rc != ORL_ERR_IO && rc != ORL_ERR_CANCELLED)
        add_mains_hint(upload, err);
    return rc;
}

int orl_scene_upload_store(struct orl_scene_upload *upload, const struct orl_folders *folders,
                           struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < upload->bundle.count && rc == 0; i++) {
        struct orl_bundle_file *file = &upload->bundle.files[i];
        char blob[ORL_PATH_MAX];
        if (!file->temporary)
            continue;
        rc = orl_blob_store(folders, file->path, file->sha, err);
        if (rc)
            break;
        file->temporary = false;
        free(file->path);
        orl_blob_path(folders, file->sha, blob);
        file->path = strdup(blob);
        if (!file->path)
            rc = orl_error_no_memory(err);
    }
    return rc;
}
