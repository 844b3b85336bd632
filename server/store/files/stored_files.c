#include "store/files/stored_files.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/array.h>
#include <oriel/base/json_read.h>
#include <oriel/base/sha256.h>

#include "store/rows/scenes.h"

/* Names, one per row: two columns, of which the second may be empty. */
struct names {
    struct name {
        char a[ORL_SHA_HEX], b[ORL_SHA_HEX];
    } * names;
    size_t count, capacity;
};

static int add_name(struct names *names, const char *a, const char *b, struct orl_error *err)
{
    if (!orl_array_reserve(&names->names, &names->capacity, names->count, sizeof *names->names))
        return orl_error_no_memory(err);
    struct name *name = &names->names[names->count++];
    snprintf(name->a, sizeof name->a, "%s", a);
    snprintf(name->b, sizeof name->b, "%s", b);
    return 0;
}

static int gather_names(struct orl_db *db, const char *sql, struct names *names,
                        struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, sql, "");
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt))
        rc = add_name(names, orl_db_text(stmt, 0), orl_db_text(stmt, 1), err);
    return orl_db_finish(db, stmt, rc, "cannot list the stored files", err);
}

static int visit_blob(const struct name *name, orl_stored_file_visit visit, void *ctx,
                      struct orl_error *err)
{
    struct orl_stored_file file = {.kind = ORL_STORED_FILE_BLOB};
    snprintf(file.path, sizeof file.path, "blobs/%.2s/%s", name->a, name->a);
    memcpy(file.sha, name->a, sizeof file.sha);
    return visit(ctx, &file, err);
}

static int visit_map(const struct name *name, orl_stored_file_visit visit, void *ctx,
                     struct orl_error *err)
{
    struct orl_stored_file file = {.kind = ORL_STORED_FILE_MAP};
    snprintf(file.map_kind, sizeof file.map_kind, "%.15s", name->a);
    memcpy(file.map_key, name->b, sizeof file.map_key);
    snprintf(file.path, sizeof file.path, "maps/%s-%s.opm", file.map_kind, file.map_key);
    return visit(ctx, &file, err);
}

/* Reads the list of a job's files; NULL if the job was removed meanwhile. */
static int read_outcome(struct orl_db *db, const char *job, json_t **ret_outcome,
                        struct orl_error *err)
{
    const char *text = NULL;
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT outcome FROM jobs WHERE id = ? AND evicted_ms IS NULL", "s", job);
    int rc = stmt ? 0 : ORL_ERR_INTERNAL;
    if (orl_db_next_row(stmt))
        text = orl_db_text(stmt, 0);
    *ret_outcome = orl_json_read_stored(text);
    if (text && !*ret_outcome)
        rc = orl_error_no_memory(err);
    sqlite3_finalize(stmt);
    return rc;
}

static int visit_results(struct orl_db *db, const struct name *name, orl_stored_file_visit visit,
                         void *ctx, struct orl_error *err)
{
    json_t *outcome = NULL;
    const json_t *entry;
    size_t i;
    int rc = read_outcome(db, name->a, &outcome, err);
    json_array_foreach(json_object_get(outcome, "files"), i, entry)
    {
        const char *one = json_string_value(json_object_get(entry, "name"));
        const char *sha = json_string_value(json_object_get(entry, "sha256"));
        struct orl_stored_file file = {.kind = ORL_STORED_FILE_RESULT};
        if (rc || !one || !sha)
            break;
        memcpy(file.job, name->a, sizeof file.job);
        snprintf(file.sha, sizeof file.sha, "%.64s", sha);
        snprintf(file.path, sizeof file.path, "results/%s/%.255s", name->a, one);
        rc = visit(ctx, &file, err);
    }
    json_decref(outcome);
    return rc;
}

int orl_stored_files_visit(struct orl_db *db, orl_stored_file_visit visit, void *ctx,
                           struct orl_error *err)
{
    struct names blobs = {0}, jobs = {0}, maps = {0};
    int rc = gather_names(db,
                          "SELECT blob, '' FROM scene_files UNION SELECT id, '' FROM bsdfs UNION "
                          "SELECT document, '' FROM jobs",
                          &blobs, err);
    if (rc == 0)
        rc =
            gather_names(db,
                         "SELECT id, '' FROM jobs WHERE outcome IS NOT NULL AND evicted_ms IS NULL "
                         "AND state IN ('succeeded', 'cancelled')",
                         &jobs, err);
    if (rc == 0)
        rc = gather_names(db, "SELECT kind, key FROM maps", &maps, err);
    for (size_t i = 0; i < blobs.count && rc == 0; i++)
        rc = visit_blob(&blobs.names[i], visit, ctx, err);
    for (size_t i = 0; i < jobs.count && rc == 0; i++)
        rc = visit_results(db, &jobs.names[i], visit, ctx, err);
    for (size_t i = 0; i < maps.count && rc == 0; i++)
        rc = visit_map(&maps.names[i], visit, ctx, err);
    free(blobs.names);
    free(jobs.names);
    free(maps.names);
    return rc;
}

static int is_there(struct orl_db *db, sqlite3_stmt *stmt, bool *ret_there, struct orl_error *err)
{
    *ret_there = orl_db_next_row(stmt);
    return orl_db_finish(db, stmt, 0, "cannot look", err);
}

int orl_stored_file_is_referenced(struct orl_db *db, const struct orl_stored_file *file,
                                  bool *ret_named, struct orl_error *err)
{
    if (file->kind == ORL_STORED_FILE_BLOB)
        return orl_blob_is_referenced(db, file->sha, ret_named, err);
    if (file->kind == ORL_STORED_FILE_RESULT)
        return is_there(db,
                        orl_db_prepare(db, err,
                                       "SELECT 1 FROM jobs WHERE id = ? AND evicted_ms IS NULL",
                                       "s", file->job),
                        ret_named, err);
    return is_there(db,
                    orl_db_prepare(db, err, "SELECT 1 FROM maps WHERE kind = ? AND key = ?", "ss",
                                   file->map_kind, file->map_key),
                    ret_named, err);
}

/* ---- Verified files -------------------------------------------------------------------------- */

static size_t place_of(const struct stat *st)
{
    return (size_t)(((uint64_t)st->st_ino * 0x9E3779B97F4A7C15U) >> 32) % ORL_VERIFIED_FILES;
}

bool orl_verified_files_has(const struct orl_verified_files *verified, const struct stat *st)
{
    const struct orl_verified_file *file = &verified->files[place_of(st)];
    return file->inode == st->st_ino && file->device == st->st_dev && file->size == st->st_size &&
           file->changed.tv_sec == st->st_ctim.tv_sec &&
           file->changed.tv_nsec == st->st_ctim.tv_nsec;
}

void orl_verified_files_add(struct orl_verified_files *verified, const struct stat *st)
{
    verified->files[place_of(st)] = (struct orl_verified_file){
        .device = st->st_dev, .inode = st->st_ino, .size = st->st_size, .changed = st->st_ctim};
}

/* Uses read, not mmap: a file truncated meanwhile then ends early instead of raising SIGBUS. */
static int digest_of(int fd, char ret_sha[ORL_SHA_HEX], struct orl_error *err)
{
    enum { CHUNK = 1 << 18 };
    struct orl_sha256 hash;
    unsigned char *chunk = malloc(CHUNK);
    off_t at = 0;
    ssize_t n = 0;
    if (!chunk)
        return orl_error_no_memory(err);
    orl_sha256_init(&hash);
    while ((n = pread(fd, chunk, CHUNK, at)) > 0 || (n < 0 && errno == EINTR)) {
        if (n < 0)
            continue;
        orl_sha256_add(&hash, chunk, (size_t)n);
        at += n;
    }
    free(chunk);
    if (n < 0)
        return orl_error_set(err, ORL_ERR_IO, "a result file cannot be read: %s", strerror(errno));
    orl_sha256_finish_hex(&hash, ret_sha);
    return 0;
}

int orl_verify_file(int fd, const char sha[ORL_SHA_HEX], struct orl_error *err)
{
    char found[ORL_SHA_HEX];
    const int rc = digest_of(fd, found, err);
    if (rc || strcmp(found, sha) == 0)
        return rc;
    orl_error_set(err, ORL_ERR_CORRUPT, "the result file is damaged in the store");
    orl_error_hint(err, "Submit the same document again to compute it again");
    return ORL_ERR_CORRUPT;
}
