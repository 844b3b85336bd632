/*
 * Rows of jobs. Loop thread only. The state machine is in jobs/jobs.h; this file only stores rows.
 */
#ifndef ORL_SERVER_STORE_ROWS_STORED_JOBS_H
#define ORL_SERVER_STORE_ROWS_STORED_JOBS_H

#include <stdint.h>

#include "job/job_request_json.h"
#include "store/database/db.h"
#include "store/files/folders.h"

enum { ORL_JOB_ID = 33, ORL_JOB_CLIENT = 80, ORL_JOB_OWNER = 17 };

enum orl_job_state {
    ORL_JOB_QUEUED,
    ORL_JOB_RUNNING,
    ORL_JOB_SUCCEEDED,
    ORL_JOB_FAILED,
    ORL_JOB_CANCELLED,
    ORL_JOB_STATE_COUNT
};
const char *orl_job_state_name(enum orl_job_state state);
/* Returns ORL_JOB_STATE_COUNT if there is no such state. */
enum orl_job_state orl_job_state_from_name(const char *name);

struct orl_job_row {
    int64_t seq;
    char id[ORL_JOB_ID];
    enum orl_job_request_kind kind;
    char scene[ORL_SHA_HEX], document[ORL_SHA_HEX];
    enum orl_job_state state;
    int attempts;
    int priority;
    char client[ORL_JOB_CLIENT]; /* handle_jobs.c */
    char owner[ORL_JOB_OWNER];   /* id of the token that submitted it; "": none */
    char identity[ORL_SHA_HEX];  /* job_document.h; "" for jobs from before identities existed */
    int64_t created_ms, started_ms, finished_ms; /* 0: not yet */
    int64_t retained_ms;                         /* time of its end, by removal.h */
    const char *outcome, *problem;               /* JSON text, borrowed; NULL: none */
    const char *name, *tags;                     /* job_json.h, borrowed; NULL: none */
    uint64_t result_bytes; /* bytes of its results; expected bytes while it waits or runs */
    uint64_t memory_bytes; /* estimated: job_estimate.h */
    int crashes;           /* times that the daemon ended because of the job: crash.h */
    int64_t fetched_ms, evicted_ms; /* last fetch and eviction of the results; 0: never */
};

/*
 * Inserts a row. request_key: the client's Idempotency-Key (NULL: none). *ret_seq is its place in
 * the order of arrival.
 */
int orl_job_row_insert(struct orl_db *db, const struct orl_job_row *row, const char *request_key,
                       int64_t *ret_seq, struct orl_error *err);
/* Returns the id of the newest job that client and owner submitted with the key since since_ms; ""
 * if there is none. */
int orl_job_row_by_key(struct orl_db *db, const char *client, const char *owner,
                       const char *request_key, int64_t since_ms, char ret_id[ORL_JOB_ID],
                       struct orl_error *err);
/* Writes all fields that change: state, attempts, times, outcome, problem, and those of results. */
int orl_job_row_update(struct orl_db *db, const struct orl_job_row *row, struct orl_error *err);
int orl_job_row_drop(struct orl_db *db, int64_t seq, struct orl_error *err);
/* Calls visit for every job, oldest first. Stops when visit returns non-zero, and returns that. */
int orl_job_rows(struct orl_db *db, int (*visit)(void *ctx, const struct orl_job_row *row),
                 void *ctx, struct orl_error *err);

#endif
