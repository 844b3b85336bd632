#include "store/rows/stored_jobs.h"

#include <stdio.h>
#include <string.h>

static const char *const state_names[ORL_JOB_STATE_COUNT] = {"queued", "running", "succeeded",
                                                             "failed", "cancelled"};

const char *orl_job_state_name(enum orl_job_state state)
{
    return state < ORL_JOB_STATE_COUNT ? state_names[state] : "unknown";
}

enum orl_job_state orl_job_state_from_name(const char *name)
{
    unsigned state = 0;
    while (state < ORL_JOB_STATE_COUNT && strcmp(state_names[state], name) != 0)
        state++;
    return (enum orl_job_state)state;
}

int orl_job_row_insert(struct orl_db *db, const struct orl_job_row *row, const char *request_key,
                       int64_t *ret_seq, struct orl_error *err)
{
    const int rc = orl_db_run(
        db, err, NULL,
        "INSERT INTO jobs (id, kind, scene, document, state, created_ms, "
        "priority, client, request_key, identity, result_bytes, memory_bytes, name, tags, owner) "
        "VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        "sssssiisssiisss", row->id, orl_job_request_kind_name(row->kind), row->scene, row->document,
        orl_job_state_name(row->state), row->created_ms, (int64_t)row->priority, row->client,
        request_key, row->identity, (int64_t)row->result_bytes, (int64_t)row->memory_bytes,
        row->name, row->tags, row->owner);
    if (rc == 0)
        *ret_seq = sqlite3_last_insert_rowid(db->handle);
    return rc;
}

int orl_job_row_by_key(struct orl_db *db, const char *client, const char *owner,
                       const char *request_key, int64_t since_ms, char ret_id[ORL_JOB_ID],
                       struct orl_error *err)
{
    sqlite3_stmt *stmt =
        orl_db_prepare(db, err,
                       "SELECT id FROM jobs WHERE client = ? AND request_key = ? "
                       "AND owner = ? AND created_ms > ? ORDER BY seq DESC LIMIT 1",
                       "sssi", client, request_key, owner, since_ms);
    snprintf(ret_id, ORL_JOB_ID, "%s", orl_db_next_row(stmt) ? orl_db_text(stmt, 0) : "");
    return orl_db_finish(db, stmt, 0, "cannot look for a job", err);
}

int orl_job_row_update(struct orl_db *db, const struct orl_job_row *row, struct orl_error *err)
{
    return orl_db_run(db, err, NULL,
                      "UPDATE jobs SET state = ?, attempts = ?, started_ms = nullif(?, 0), "
                      "finished_ms = nullif(?, 0), outcome = ?, problem = ?, result_bytes = ?, "
                      "fetched_ms = nullif(?, 0), evicted_ms = nullif(?, 0), strikes = ?, "
                      "retained_ms = nullif(?, 0) "
                      "WHERE seq = ?",
                      "siiissiiiiii", orl_job_state_name(row->state), (int64_t)row->attempts,
                      row->started_ms, row->finished_ms, row->outcome, row->problem,
                      (int64_t)row->result_bytes, row->fetched_ms, row->evicted_ms,
                      (int64_t)row->crashes, row->retained_ms, row->seq);
}

int orl_job_row_drop(struct orl_db *db, int64_t seq, struct orl_error *err)
{
    return orl_db_run(db, err, NULL, "DELETE FROM jobs WHERE seq = ?", "i", seq);
}

static struct orl_job_row read_row(sqlite3_stmt *stmt)
{
    struct orl_job_row row = {
        .seq = sqlite3_column_int64(stmt, 0),
        .state = orl_job_state_from_name(orl_db_text(stmt, 4)),
        .attempts = sqlite3_column_int(stmt, 5),
        .created_ms = sqlite3_column_int64(stmt, 6),
        .started_ms = sqlite3_column_int64(stmt, 7),
        .finished_ms = sqlite3_column_int64(stmt, 8),
        .outcome = (const char *)sqlite3_column_text(stmt, 9),
        .problem = (const char *)sqlite3_column_text(stmt, 10),
        .kind = orl_job_request_kind_from_name(orl_db_text(stmt, 11)),
        .priority = sqlite3_column_int(stmt, 12),
        .result_bytes = (uint64_t)sqlite3_column_int64(stmt, 15),
        .fetched_ms = sqlite3_column_int64(stmt, 16),
        .evicted_ms = sqlite3_column_int64(stmt, 17),
        .memory_bytes = (uint64_t)sqlite3_column_int64(stmt, 18),
        .crashes = sqlite3_column_int(stmt, 19),
        .name = (const char *)sqlite3_column_text(stmt, 20),
        .tags = (const char *)sqlite3_column_text(stmt, 21),
        .retained_ms = sqlite3_column_int64(stmt, 23),
    };
    snprintf(row.id, sizeof row.id, "%s", orl_db_text(stmt, 1));
    snprintf(row.scene, sizeof row.scene, "%s", orl_db_text(stmt, 2));
    snprintf(row.document, sizeof row.document, "%s", orl_db_text(stmt, 3));
    snprintf(row.identity, sizeof row.identity, "%s", orl_db_text(stmt, 14));
    snprintf(row.client, sizeof row.client, "%s", orl_db_text(stmt, 13));
    snprintf(row.owner, sizeof row.owner, "%s", orl_db_text(stmt, 22));
    return row;
}

int orl_job_rows(struct orl_db *db, int (*visit)(void *ctx, const struct orl_job_row *row),
                 void *ctx, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(
        db, err,
        "SELECT seq, id, scene, document, state, attempts, created_ms, started_ms, finished_ms, "
        "outcome, problem, kind, priority, client, identity, result_bytes, fetched_ms, evicted_ms, "
        "memory_bytes, strikes, name, tags, owner, coalesce(retained_ms, finished_ms) "
        "FROM jobs ORDER BY seq",
        "");
    int rc = 0;
    while (rc == 0 && orl_db_next_row(stmt)) {
        const struct orl_job_row row = read_row(stmt);
        rc = visit(ctx, &row);
    }
    return orl_db_finish(db, stmt, rc, "cannot read the jobs", err);
}
