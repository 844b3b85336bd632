#include "store/rows/scenes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>

#include "process/times.h"

static int insert_files(struct orl_db *db, const char *id, const struct orl_bundle *bundle,
                        struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < bundle->count && rc == 0; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        rc = orl_db_run(db, err, NULL,
                        "INSERT INTO scene_files (scene, position, name, resource, blob, bytes) "
                        "VALUES (?, ?, ?, ?, ?, ?)",
                        "sisisi", id, (int64_t)i, file->name, (int64_t)file->resource, file->sha,
                        (int64_t)file->bytes);
    }
    return rc;
}

int orl_scene_insert(struct orl_db *db, const char *id, const struct orl_bundle *bundle,
                     const char *summary, bool *ret_created, struct orl_error *err)
{
    int changes = 0;
    int rc = orl_db_begin(db, err);
    if (rc)
        return rc;
    rc = orl_db_run(db, err, &changes,
                    "INSERT OR IGNORE INTO scenes (id, created_ms, bytes, summary) "
                    "VALUES (?, ?, ?, ?)",
                    "siis", id, orl_time_now_ms(), (int64_t)orl_bundle_bytes(bundle), summary);
    if (rc == 0 && changes > 0)
        rc = insert_files(db, id, bundle, err);
    rc = orl_db_end(db, rc, err);
    if (rc == 0)
        *ret_created = changes > 0;
    return rc;
}

static int find_item(struct orl_db *db, const char *sql, const char *id,
                     struct orl_stored_item *ret_item, bool *ret_found, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, sql, "s", id);
    const bool found = orl_db_next_row(stmt);
    int rc = 0;
    if (found && ret_item) {
        struct orl_stored_item item = {.created_ms = sqlite3_column_int64(stmt, 0),
                                       .bytes = (uint64_t)sqlite3_column_int64(stmt, 1),
                                       .summary = strdup(orl_db_text(stmt, 2))};
        if (item.summary)
            *ret_item = item;
        else
            rc = orl_error_no_memory(err);
    }
    rc = orl_db_finish(db, stmt, rc, "cannot read", err);
    if (rc == 0)
        *ret_found = found;
    return rc;
}

int orl_scene_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_scene,
                   bool *ret_found, struct orl_error *err)
{
    return find_item(db, "SELECT created_ms, bytes, summary FROM scenes WHERE id = ?", id,
                     ret_scene, ret_found, err);
}

int orl_scene_files(struct orl_db *db, const struct orl_folders *folders, const char *id,
                    struct orl_bundle *ret_bundle, struct orl_error *err)
{
    struct orl_bundle bundle = {0};
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err,
        "SELECT name, resource, blob, bytes FROM scene_files WHERE scene = ? ORDER BY position",
        "s", id);
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        char path[ORL_PATH_MAX];
        const char *sha = orl_db_text(stmt, 2);
        orl_blob_path(folders, sha, path);
        rc = orl_bundle_add(&bundle, orl_db_text(stmt, 0), sqlite3_column_int(stmt, 1) != 0, path,
                            (uint64_t)sqlite3_column_int64(stmt, 3), sha, false, err);
    }
    rc = orl_db_finish(db, stmt, rc, "cannot read the files of a scene", err);
    if (rc)
        orl_bundle_done(&bundle);
    else
        *ret_bundle = bundle;
    return rc;
}

int orl_bsdf_insert(struct orl_db *db, const char *id, const char *name, uint64_t bytes,
                    const char *summary, bool *ret_created, struct orl_error *err)
{
    int changes = 0;
    const int rc = orl_db_run(db, err, &changes,
                              "INSERT OR IGNORE INTO bsdfs (id, created_ms, name, bytes, summary) "
                              "VALUES (?, ?, ?, ?, ?)",
                              "sisis", id, orl_time_now_ms(), name, (int64_t)bytes, summary);
    if (rc == 0)
        *ret_created = changes > 0;
    return rc;
}

int orl_bsdf_find(struct orl_db *db, const char *id, struct orl_stored_item *ret_bsdf,
                  bool *ret_found, struct orl_error *err)
{
    return find_item(db, "SELECT created_ms, bytes, summary FROM bsdfs WHERE id = ?", id, ret_bsdf,
                     ret_found, err);
}

/* ---- Removal -------------------------------------------------------------------------------- */

static int read_blobs(struct orl_db *db, const char *id, char (**ret_blobs)[ORL_SHA_HEX],
                      size_t *ret_count, struct orl_error *err)
{
    char(*blobs)[ORL_SHA_HEX] = NULL;
    size_t count = 0, capacity = 0;
    int rc = 0;
    sqlite3_stmt *stmt =
        orl_db_prepare(db, err, "SELECT blob FROM scene_files WHERE scene = ?", "s", id);
    while (rc == 0 && orl_db_next_row(stmt)) {
        if (orl_array_reserve(&blobs, &capacity, count, sizeof *blobs))
            snprintf(blobs[count++], sizeof *blobs, "%s", orl_db_text(stmt, 0));
        else
            rc = orl_error_no_memory(err);
    }
    rc = orl_db_finish(db, stmt, rc, "cannot read the files of a scene", err);
    if (rc) {
        free(blobs);
        return rc;
    }
    *ret_blobs = blobs;
    *ret_count = count;
    return 0;
}

int orl_scene_drop(struct orl_db *db, const char *id, char (**ret_blobs)[ORL_SHA_HEX],
                   size_t *ret_count, bool *ret_removed, struct orl_error *err)
{
    char(*blobs)[ORL_SHA_HEX] = NULL;
    size_t count = 0;
    int changes = 0, rc = read_blobs(db, id, &blobs, &count, err);
    if (rc == 0) /* cascades to the rows of its files */
        rc = orl_db_run(db, err, &changes, "DELETE FROM scenes WHERE id = ?", "s", id);
    if (rc) {
        free(blobs);
        return rc;
    }
    *ret_blobs = blobs;
    *ret_count = count;
    *ret_removed = changes > 0;
    return 0;
}

int orl_bsdf_drop(struct orl_db *db, const char *id, bool *ret_removed, struct orl_error *err)
{
    int changes = 0;
    const int rc = orl_db_run(db, err, &changes, "DELETE FROM bsdfs WHERE id = ?", "s", id);
    if (rc == 0)
        *ret_removed = changes > 0;
    return rc;
}

/* Runs a statement that yields one number for a digest; *ret_true is true if it is not 0. */
static int query_bool(struct orl_db *db, const char *sql, const char *sha, bool *ret_true,
                      struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, sql, "s", sha);
    if (orl_db_next_row(stmt))
        *ret_true = sqlite3_column_int(stmt, 0) != 0;
    return orl_db_finish(db, stmt, 0, "cannot look for a file", err);
}

int orl_blob_is_referenced(struct orl_db *db, const char *sha, bool *ret_named,
                           struct orl_error *err)
{
    return query_bool(db,
                      "SELECT EXISTS (SELECT 1 FROM scene_files WHERE blob = ?1) OR "
                      "EXISTS (SELECT 1 FROM bsdfs WHERE id = ?1) OR "
                      "EXISTS (SELECT 1 FROM jobs WHERE document = ?1)",
                      sha, ret_named, err);
}

int orl_blob_in_scene(struct orl_db *db, const char *sha, bool *ret_named, struct orl_error *err)
{
    return query_bool(db, "SELECT EXISTS (SELECT 1 FROM scene_files WHERE blob = ?1)", sha,
                      ret_named, err);
}

/* ---- Lists ----------------------------------------------------------------------------------- */

static const char cannot_list[] = "cannot list what is stored";

static struct orl_list_position read_position(sqlite3_stmt *stmt)
{
    struct orl_list_position position = {.created_ms = sqlite3_column_int64(stmt, 1)};
    snprintf(position.id, sizeof position.id, "%s", orl_db_text(stmt, 0));
    return position;
}

int orl_scene_rows(struct orl_db *db, const struct orl_list_position *after, size_t limit,
                   int (*visit)(void *ctx, const struct orl_listed_scene *scene), void *ctx,
                   struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err,
        "SELECT id, created_ms, bytes, max(created_ms, last_used_ms), "
        "(SELECT count(*) FROM jobs WHERE scene = s.id AND state IN ('queued', 'running')), "
        "(SELECT count(*) FROM jobs WHERE scene = s.id) "
        "FROM scenes s WHERE (created_ms, id) < (?, ?) ORDER BY created_ms DESC, id DESC LIMIT ?",
        "isi", after->created_ms, after->id, (int64_t)limit);
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const struct orl_listed_scene scene = {.position = read_position(stmt),
                                               .bytes = (uint64_t)sqlite3_column_int64(stmt, 2),
                                               .last_used_ms = sqlite3_column_int64(stmt, 3),
                                               .jobs_under_way =
                                                   (uint64_t)sqlite3_column_int64(stmt, 4),
                                               .all_jobs = (uint64_t)sqlite3_column_int64(stmt, 5)};
        rc = visit(ctx, &scene);
    }
    return orl_db_finish(db, stmt, rc, cannot_list, err);
}

/* The table has one row per BSDF with its uses (migrations/0013_bsdf_list.sql), so a page reads no
 * other rows. */
#define BSDF_ROWS                                                                                  \
    "SELECT id, created_ms, name, bytes, own, last_used_ms, scenes, (SELECT group_concat(scene) "  \
    "FROM (SELECT DISTINCT scene FROM scene_files WHERE blob = b.id ORDER BY scene LIMIT ?1)) "    \
    "FROM listed_bsdfs b WHERE (created_ms, id) < (?2, ?3) "
#define IN_SCENE "AND id IN (SELECT blob FROM scene_files WHERE scene = ?5) "
#define LATEST_FIRST "ORDER BY created_ms DESC, id DESC LIMIT ?4"

int orl_bsdf_rows(struct orl_db *db, const struct orl_list_position *after, const char *scene,
                  size_t limit, int (*visit)(void *ctx, const struct orl_listed_bsdf *bsdf),
                  void *ctx, struct orl_error *err)
{
    sqlite3_stmt *stmt =
        orl_db_prepare(db, err, scene ? BSDF_ROWS IN_SCENE LATEST_FIRST : BSDF_ROWS LATEST_FIRST,
                       scene ? "iisis" : "iisi", (int64_t)ORL_LISTED_SCENES, after->created_ms,
                       after->id, (int64_t)limit, scene);
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const struct orl_listed_bsdf bsdf = {.position = read_position(stmt),
                                             .name = orl_db_text(stmt, 2),
                                             .bytes = (uint64_t)sqlite3_column_int64(stmt, 3),
                                             .by_itself = sqlite3_column_int(stmt, 4) != 0,
                                             .last_used_ms = sqlite3_column_int64(stmt, 5),
                                             .n_scenes = (uint64_t)sqlite3_column_int64(stmt, 6),
                                             .scenes = orl_db_text(stmt, 7)};
        rc = visit(ctx, &bsdf);
    }
    return orl_db_finish(db, stmt, rc, cannot_list, err);
}

int orl_scene_bsdf_find(struct orl_db *db, const char *id, struct orl_scene_bsdf *ret_bsdf,
                        bool *ret_found, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT created_ms, name, bytes FROM listed_bsdfs WHERE id = ? AND own = 0", "s",
        id);
    *ret_found = false;
    while (orl_db_next_row(stmt)) {
        *ret_found = true;
        ret_bsdf->created_ms = sqlite3_column_int64(stmt, 0);
        ret_bsdf->bytes = (uint64_t)sqlite3_column_int64(stmt, 2);
        snprintf(ret_bsdf->name, sizeof ret_bsdf->name, "%s", orl_db_text(stmt, 1));
    }
    return orl_db_finish(db, stmt, 0, cannot_list, err);
}
