#include "store/rows/scene_lists.h"

#include <stdio.h>

/* Prepares the statement of a page. */
static sqlite3_stmt *prepare_page(struct orl_db *db, const char *sql,
                                  const struct orl_list_position *after, size_t limit,
                                  struct orl_error *err)
{
    return orl_db_prepare(db, err, sql, "isi", after->created_ms, after->id, (int64_t)limit);
}

static struct orl_list_position read_position(sqlite3_stmt *stmt)
{
    struct orl_list_position position = {.created_ms = sqlite3_column_int64(stmt, 1)};
    snprintf(position.id, sizeof position.id, "%s", orl_db_text(stmt, 0));
    return position;
}

/* Ends the iteration after the last step. Returns visit's code, or the database's error. */
static int end_rows(struct orl_db *db, sqlite3_stmt *stmt, int rc, int step, struct orl_error *err)
{
    if (rc == 0 && step != SQLITE_DONE)
        rc = orl_db_error(db, "cannot list what is stored", err);
    sqlite3_finalize(stmt);
    return rc;
}

int orl_scene_rows(struct orl_db *db, const struct orl_list_position *after, size_t limit,
                   int (*visit)(void *ctx, const struct orl_listed_scene *scene), void *ctx,
                   struct orl_error *err)
{
    sqlite3_stmt *stmt = prepare_page(
        db,
        "SELECT id, created_ms, bytes, max(created_ms, last_used_ms), "
        "(SELECT count(*) FROM jobs WHERE scene = s.id AND state IN ('queued', 'running')), "
        "(SELECT count(*) FROM jobs WHERE scene = s.id) "
        "FROM scenes s WHERE (created_ms, id) < (?, ?) ORDER BY created_ms DESC, id DESC LIMIT ?",
        after, limit, err);
    int rc = 0, step = SQLITE_DONE;
    if (!stmt)
        return ORL_ERR_IO;
    while (rc == 0 && (step = sqlite3_step(stmt)) == SQLITE_ROW) {
        const struct orl_listed_scene scene = {.position = read_position(stmt),
                                               .bytes = (uint64_t)sqlite3_column_int64(stmt, 2),
                                               .last_used_ms = sqlite3_column_int64(stmt, 3),
                                               .jobs_under_way =
                                                   (uint64_t)sqlite3_column_int64(stmt, 4),
                                               .all_jobs = (uint64_t)sqlite3_column_int64(stmt, 5)};
        rc = visit(ctx, &scene);
    }
    return end_rows(db, stmt, rc, step, err);
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
    int rc = 0, step = SQLITE_DONE;
    if (!stmt)
        return ORL_ERR_IO;
    while (rc == 0 && (step = sqlite3_step(stmt)) == SQLITE_ROW) {
        const struct orl_listed_bsdf bsdf = {.position = read_position(stmt),
                                             .name = orl_db_text(stmt, 2),
                                             .bytes = (uint64_t)sqlite3_column_int64(stmt, 3),
                                             .by_itself = sqlite3_column_int(stmt, 4) != 0,
                                             .last_used_ms = sqlite3_column_int64(stmt, 5),
                                             .n_scenes = (uint64_t)sqlite3_column_int64(stmt, 6),
                                             .scenes = orl_db_text(stmt, 7)};
        rc = visit(ctx, &bsdf);
    }
    return end_rows(db, stmt, rc, step, err);
}

int orl_scene_bsdf_find(struct orl_db *db, const char *id, struct orl_scene_bsdf *ret_bsdf,
                        bool *ret_found, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err, "SELECT created_ms, name, bytes FROM listed_bsdfs WHERE id = ? AND own = 0", "s",
        id);
    int step;
    *ret_found = false;
    if (!stmt)
        return ORL_ERR_IO;
    while ((step = sqlite3_step(stmt)) == SQLITE_ROW) {
        *ret_found = true;
        ret_bsdf->created_ms = sqlite3_column_int64(stmt, 0);
        ret_bsdf->bytes = (uint64_t)sqlite3_column_int64(stmt, 2);
        snprintf(ret_bsdf->name, sizeof ret_bsdf->name, "%s", orl_db_text(stmt, 1));
    }
    return end_rows(db, stmt, 0, step, err);
}
