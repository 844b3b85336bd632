#include "distributed/distributed_job.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/sha256.h>
#include <oriel/base/version.h>

#include "distributed/atomic_files.h"
#include "json/decode.h"

/* ---- Creation -------------------------------------------------------------------------------- */

static int copy_file(const char *from, const char *to, struct orl_error *err)
{
    char buffer[1 << 16], folder[8400];
    struct orl_atomic_file file;
    long long size;
    FILE *stream;
    size_t got;
    snprintf(folder, sizeof folder, "%s", to);
    *strrchr(folder, '/') = '\0';
    int rc = orl_make_folder(folder, err);
    if (rc == 0)
        rc = orl_open_for_reading(from, &stream, &size, err);
    if (rc)
        return rc;
    rc = orl_atomic_file_open(&file, to, err);
    if (rc == 0) {
        while ((got = fread(buffer, 1, sizeof buffer, stream)) > 0)
            fwrite(buffer, 1, got, file.stream);
        rc = orl_atomic_file_commit(&file, err);
    }
    fclose(stream);
    return rc;
}

static int write_in(const char *folder, const char *name, const json_t *json, struct orl_error *err)
{
    char path[4200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return orl_write_json(path, json, err);
}

/* Copies the files to FOLDER/files and collects their digests. */
static int copy_files(const char *folder, const struct orl_shared_file *files, size_t n_files,
                      json_t *digests, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < n_files && rc == 0; i++) {
        char to[8400], digest[ORL_DIGEST_TEXT];
        snprintf(to, sizeof to, "%s/files/%s", folder, files[i].name);
        rc = copy_file(files[i].path, to, err);
        if (rc == 0)
            rc = orl_digest_file(to, digest, err);
        if (rc == 0 && json_object_set_new(digests, files[i].name, json_string(digest)))
            rc = orl_error_no_memory(err);
    }
    return rc;
}

static int make_folder(const char *path, struct orl_error *err)
{
    return mkdir(path, 0700) == 0 ? 0
                                  : orl_error_set(err, orl_err_of_errno(errno),
                                                  "cannot make '%s': %s", path, strerror(errno));
}

static int create_folder(const char *folder, const json_t *doc, const struct orl_shared_file *files,
                         size_t n_files, struct orl_error *err)
{
    char store[4200];
    json_t *digests = json_object();
    int rc = make_folder(folder, err);
    snprintf(store, sizeof store, "%s/store", folder);
    if (rc == 0)
        rc = make_folder(store, err);
    if (rc == 0)
        rc = copy_files(folder, files, n_files, digests, err);
    if (rc == 0)
        rc = write_in(folder, "job.json", doc, err);
    if (rc == 0)
        rc = write_in(folder, "files.json", digests, err);
    json_decref(digests);
    return rc;
}

/* ---- Existing folder ------------------------------------------------------------------------- */

/* Returns true if the folder was created by a run. */
static bool is_ours(const char *folder)
{
    char store[8400], files[8400];
    struct stat st;
    snprintf(store, sizeof store, "%s/store", folder);
    snprintf(files, sizeof files, "%s/files.json", folder);
    return stat(store, &st) == 0 && stat(files, &st) == 0;
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

void orl_shared_folder_refresh(const char *folder)
{
    count_files(folder);
}

/* ---- Reading --------------------------------------------------------------------------------- */

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

int orl_shared_folder_verify(const char *folder, char ret_job[ORL_JOB_TASK_KEY], json_t **ret_doc,
                             struct orl_error *err)
{
    unsigned char digest[ORL_SHA256_BYTES];
    struct orl_sha256 hash;
    json_t *digests = NULL, *wanted;
    const char *name;
    *ret_doc = NULL;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, ORL_VERSION, sizeof ORL_VERSION);
    int rc = read_json(folder, "job.json", ret_doc, &hash, err);
    if (rc == 0)
        rc = read_json(folder, "files.json", &digests, &hash, err);
    json_object_foreach(digests, name, wanted)
    {
        char path[8400], found[ORL_DIGEST_TEXT];
        snprintf(path, sizeof path, "%.4000s/files/%.4000s", folder, name);
        rc = rc ? rc : orl_digest_file(path, found, err);
        const char *text = json_string_value(wanted);
        if (rc == 0 && (!text || strcmp(found, text) != 0))
            rc = orl_error_set(err, ORL_ERR_CORRUPT, "'%.300s' has changed since the job began",
                               path);
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

/* ---- Replacement ----------------------------------------------------------------------------- */

static void remove_aside(const char *path)
{
    char aside[4200];
    snprintf(aside, sizeof aside, "%s.oriel-old", path);
    orl_remove_folder(aside);
    if (rename(path, aside) == 0)
        orl_remove_folder(aside);
}

/* Moves the folder fresh to path, unless path has the same job; then path is kept. */
static int install_folder(const char *fresh, const char *path, const char *job, size_t *ret_earlier,
                          struct orl_error *err)
{
    char there[ORL_JOB_TASK_KEY] = "", store[4200];
    json_t *doc = NULL;
    struct stat st;
    *ret_earlier = 0;
    snprintf(store, sizeof store, "%s/store", path);
    if (is_ours(path) && orl_shared_folder_verify(path, there, &doc, NULL) == 0 &&
        strcmp(there, job) == 0) {
        json_decref(doc);
        *ret_earlier = count_files(store);
        orl_remove_folder(fresh);
        return 0;
    }
    json_decref(doc);
    if (is_ours(path)) /* renamed first, so that the next run never sees it half removed */
        remove_aside(path);
    else if (stat(path, &st) == 0)
        return orl_error_set(
            err, ORL_ERR_INVALID,
            "'%.300s' exists, but is not the folder of a job in parts: move it away", path);
    return rename(fresh, path) == 0 ? 0
                                    : orl_error_set(err, orl_err_of_errno(errno),
                                                    "cannot make '%s': %s", path, strerror(errno));
}

int orl_shared_folder_make(const char *path, const json_t *doc, const struct orl_shared_file *files,
                           size_t n_files, char ret_job[ORL_JOB_TASK_KEY], size_t *ret_earlier,
                           struct orl_error *err)
{
    char fresh[4096];
    json_t *read = NULL;
    if (snprintf(fresh, sizeof fresh, "%s.oriel-new", path) >= (int)sizeof fresh)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path '%.100s...' is too long", path);
    orl_remove_folder(fresh);
    int rc = create_folder(fresh, doc, files, n_files, err);
    if (rc == 0)
        rc = orl_shared_folder_verify(fresh, ret_job, &read, err);
    json_decref(read);
    if (rc == 0)
        rc = install_folder(fresh, path, ret_job, ret_earlier, err);
    if (rc)
        orl_remove_folder(fresh);
    return rc;
}
