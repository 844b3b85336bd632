#include "scene_upload.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/limits.h>
#include <oriel/run.h>

#include "decode.h"
#include "multipart.h"
#include "scene_json.h"
#include "unzip.h"

void orl_scene_upload_done(struct orl_scene_upload *upload)
{
    orl_bundle_done(&upload->bundle);
    free(upload->mains);
    free(upload->summary);
    upload->mains = upload->summary = NULL;
}

int orl_scene_upload_add_main(struct orl_scene_upload *upload, const char *names,
                              struct orl_error *err)
{
    const size_t before = upload->mains ? strlen(upload->mains) : 0, size = strlen(names);
    char *grown = realloc(upload->mains, before + size + 2);
    if (!grown)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (before > 0)
        grown[before] = '\n';
    memcpy(grown + before + (before > 0), names, size + 1);
    upload->mains = grown;
    return 0;
}

/* One entry of "bsdfs": a BSDF uploaded before, under the name the scene calls it by. */
static int add_bsdf(struct orl_scene_upload *upload, const char *name, const json_t *id,
                    const struct orl_folders *folders, struct orl_error *err)
{
    char where[ORL_JSON_PATH_MAX], path[ORL_PATH_MAX];
    struct stat st;
    snprintf(where, sizeof where, "bsdfs.%.120s", name);
    const char *sha = json_string_value(id);
    if (!sha || !orl_is_sha256(sha))
        return orl_json_fail(err, ORL_ERR_INVALID, where,
                             "a BSDF's id is wanted: 64 hexadecimal digits");
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
                             "an object is wanted: {\"name.xml\": \"id\"}");
    json_object_foreach(bsdfs, name, id)
    {
        const int rc = add_bsdf(upload, name, id, folders, err);
        if (rc)
            return rc;
    }
    return 0;
}

/* Makes the file of that name a main one, behind those that are. */
static int make_main(struct orl_bundle *bundle, size_t place, const char *name,
                     struct orl_error *err)
{
    size_t i = place;
    while (i < bundle->count && strcmp(bundle->files[i].name, name) != 0)
        i++;
    if (i == bundle->count) {
        orl_error_set(err, ORL_ERR_INVALID,
                      "'%.200s' is to be a main file, but was not sent, or is "
                      "named twice",
                      name);
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

/* What all forms end with: at least one main file, none of them empty; the order and the id. */
static int finish(struct orl_scene_upload *upload, struct orl_error *err)
{
    const int rc = choose_mains(upload, err);
    if (rc)
        return rc;
    if (orl_bundle_main_count(&upload->bundle) == 0) {
        orl_error_set(err, ORL_ERR_INVALID, "no scene file was sent");
        orl_error_hint(err, "Send at least one part with a file name, other than an .xml; of a zip "
                            "whose .rad files lie in several folders, say which by main");
        return ORL_ERR_INVALID;
    }
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
                    const struct orl_folders *folders, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < zips->count && rc == 0; i++) {
        struct orl_file archive;
        rc = orl_map_file(zips->files[i].path, &archive, err);
        if (rc)
            return rc;
        rc = orl_unzip(&archive, folders, !upload->mains, &upload->bundle, err);
        orl_unmap_file(&archive);
    }
    return rc;
}

int orl_scene_upload_multipart(struct orl_scene_upload *upload, struct MHD_Connection *connection,
                               const struct orl_file *body, const struct orl_folders *folders,
                               struct orl_error *err)
{
    struct orl_multipart parts = {0};
    int rc = orl_multipart_split(connection, body, folders, &parts, err);
    if (rc)
        return rc;
    upload->bundle = parts.files;
    memset(&parts.files, 0, sizeof parts.files);
    if (parts.mains)
        rc = orl_scene_upload_add_main(upload, parts.mains, err);
    if (rc == 0)
        rc = add_zips(upload, &parts.zips, folders, err);
    if (rc == 0 && parts.bsdfs) {
        json_t *bsdfs = NULL;
        rc = orl_json_parse("bsdfs", parts.bsdfs, strlen(parts.bsdfs), &bsdfs, err);
        if (rc == 0)
            rc = add_bsdfs(upload, bsdfs, folders, err);
        json_decref(bsdfs);
    }
    orl_multipart_done(&parts);
    return rc ? rc : finish(upload, err);
}

int orl_scene_upload_zip(struct orl_scene_upload *upload, const struct orl_file *body,
                         const struct orl_folders *folders, struct orl_error *err)
{
    const int rc = orl_unzip(body, folders, !upload->mains, &upload->bundle, err);
    return rc ? rc : finish(upload, err);
}

/* ---- JSON ----------------------------------------------------------------------------------- */

/* The bytes of one file object; *ret_data is owned. */
static int decode_content(const json_t *file, const char *where, unsigned char **ret_data,
                          size_t *ret_size, struct orl_error *err)
{
    const json_t *text = json_object_get(file, "text");
    const json_t *base64 = json_object_get(file, "base64");
    const json_t *source = text ? text : base64;
    if (!json_is_string(source) || (text && base64))
        return orl_json_fail(err, ORL_ERR_INVALID, where,
                             "either \"text\" or \"base64\" is wanted, as a string");
    const size_t length = json_string_length(source);
    unsigned char *data = malloc(length + 1);
    size_t size = length;
    if (!data)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(data, json_string_value(source), length);
    if (!text && sodium_base642bin(data, length + 1, json_string_value(source), length, " \r\n",
                                   &size, NULL, sodium_base64_VARIANT_ORIGINAL) != 0) {
        free(data);
        return orl_json_fail(err, ORL_ERR_INVALID, where, "the base64 does not decode");
    }
    *ret_data = data;
    *ret_size = size;
    return 0;
}

static int store_content(struct orl_scene_upload *upload, const char *name, bool resource,
                         const unsigned char *data, size_t size, const struct orl_folders *folders,
                         struct orl_error *err)
{
    char path[ORL_PATH_MAX], sha[ORL_SHA_HEX];
    if (size > ORL_LIMIT_FILE_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "'%s' is larger than %lu MiB", name,
                             ORL_LIMIT_FILE_BYTES >> 20);
    orl_folders_temporary(folders, path);
    orl_sha256_hex(data, size, sha);
    const int rc = orl_bundle_add(&upload->bundle, name, resource, path, size, sha, true, err);
    return rc ? rc : orl_write_file(path, data, size, err);
}

static int add_json_file(struct orl_scene_upload *upload, const json_t *file, size_t index,
                         const struct orl_folders *folders, struct orl_error *err)
{
    static const char *const allowed[] = {"name", "text", "base64", "resource", NULL};
    char where[ORL_JSON_PATH_MAX];
    char *name = NULL;
    unsigned char *data = NULL;
    size_t size = 0;
    snprintf(where, sizeof where, "files[%zu]", index);
    int rc = orl_json_object(file, where, allowed, err);
    if (rc == 0) {
        snprintf(where, sizeof where, "files[%zu].name", index);
        rc = orl_json_string(json_object_get(file, "name"), where, 255, &name, err);
    }
    bool resource = rc == 0 && orl_is_xml_name(name);
    if (rc == 0 && json_object_get(file, "resource")) {
        snprintf(where, sizeof where, "files[%zu].resource", index);
        rc = orl_json_bool(json_object_get(file, "resource"), where, &resource, err);
    }
    snprintf(where, sizeof where, "files[%zu]", index);
    if (rc == 0)
        rc = decode_content(file, where, &data, &size, err);
    if (rc == 0)
        rc = store_content(upload, name, resource, data, size, folders, err);
    free(data);
    free(name);
    return rc;
}

int orl_scene_upload_json(struct orl_scene_upload *upload, const struct orl_file *body,
                          const struct orl_folders *folders, struct orl_error *err)
{
    static const char *const allowed[] = {"files", "bsdfs", NULL};
    json_t *doc = NULL;
    int rc = orl_json_parse(NULL, body->data, body->size, &doc, err);
    if (rc)
        return rc;
    const json_t *files = json_object_get(doc, "files");
    rc = orl_json_object(doc, "", allowed, err);
    if (rc == 0)
        rc = orl_json_array(files, "files", ORL_LIMIT_SCENE_FILES, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(files); i++)
        rc = add_json_file(upload, json_array_get(files, i), i, folders, err);
    if (rc == 0 && json_object_get(doc, "bsdfs"))
        rc = add_bsdfs(upload, json_object_get(doc, "bsdfs"), folders, err);
    json_decref(doc);
    return rc ? rc : finish(upload, err);
}

/* ---- Checking and keeping ------------------------------------------------------------------- */

int orl_scene_upload_check(struct orl_scene_upload *upload, const atomic_bool *cancel,
                           struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    struct orl_scene_summary summary;
    const size_t count = orl_bundle_main_count(&upload->bundle); /* sorted: they come first */
    for (size_t i = 0; i < count; i++)
        names[i] = upload->bundle.files[i].name;
    const struct orl_files files = orl_bundle_provider(&upload->bundle);
    const int rc = orl_scene_check(names, count, &files, cancel, &summary, err);
    if (rc)
        return rc;
    json_t *json = orl_scene_summary_to_json(&summary);
    upload->summary = json ? json_dumps(json, JSON_COMPACT) : NULL;
    json_decref(json);
    orl_scene_summary_done(&summary);
    return upload->summary ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

int orl_scene_upload_keep(struct orl_scene_upload *upload, const struct orl_folders *folders,
                          struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < upload->bundle.count && rc == 0; i++) {
        struct orl_bundle_file *file = &upload->bundle.files[i];
        if (!file->temporary)
            continue;
        rc = orl_blob_keep(folders, file->path, file->sha, err);
        if (rc == 0)
            file->temporary = false;
    }
    return rc;
}
