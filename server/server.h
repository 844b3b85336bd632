/*
 * The daemon: the loop, and everything that runs on it.
 *
 * Start: data folder -> database -> blobs, map cache -> jobs -> HTTP. Stop, on SIGTERM or SIGINT:
 * it first drains. It accepts and starts no jobs, but still answers requests about those it has,
 * until none runs, the time limit is over, or a second signal comes. Then it accepts no new
 * connections, stops jobs that still run and queues them again, sends the pending answers, and
 * closes everything in the opposite order. Further signals change nothing (process/signals.h). A
 * stop that takes longer than health/crash.h allows ends the process at once.
 */
#ifndef ORL_SERVER_SERVER_H
#define ORL_SERVER_SERVER_H

#include <stdbool.h>
#include <uv.h>

#include "cache/map_cache.h"
#include "checks/checks.h"
#include "guide/guide.h"
#include "handlers/events/events.h"
#include "handlers/jobs/job_status.h"
#include "health/crash.h"
#include "health/machine_memory.h"
#include "health/metrics.h"
#include "http/context.h"
#include "http/http_server.h"
#include "jobs/jobs.h"
#include "maintenance/retention.h"
#include "maintenance/storage.h"
#include "process/config.h"
#include "process/log.h"
#include "store/database/db.h"
#include "store/durability/wal.h"
#include "store/files/folders.h"
#include "store/files/stored_files.h"

/* Handles of the loop that are the daemon's own. */
struct orl_server_handles {
    uv_async_t cache_changed;
    uv_timer_t saving;
    uv_prepare_t log_lines; /* writes buffered lines before the loop sleeps */
};

/* The progress of a stop. */
struct orl_server_stop {
    uv_timer_t timer; /* the limit for draining, then for the last answers */
    bool draining, jobs_idle;
    bool answering, answers_late; /* only answers are left to send; they have had their time */
    bool closing;                 /* the loop's handles are being closed */
};

struct orl_server {
    struct orl_config config;
    struct orl_log log;
    uv_loop_t loop;
    struct orl_server_handles handles;
    struct orl_server_stop stop;
    char program[ORL_SHA_HEX]; /* checkpoints.h */
    struct orl_folders folders;
    struct orl_db db;
    struct orl_retention retention;
    struct orl_wal_checkpointer *checkpointer; /* checkpoints of the database's log */
    struct orl_wal_sync *wal_sync;             /* syncs of the database's commits */
    struct orl_blobs *blobs;
    struct orl_map_cache *maps;
    struct orl_slurm_config slurm; /* shared folder of jobs in parts */
    struct orl_shared_sweep sweep;
    struct orl_memory_cache *memory_cache;
    struct orl_disk_reserve disk;
    struct orl_storage storage;
    struct orl_verified_files verified;
    struct orl_scrub_thread *scrub_thread; /* scrub.h; or NULL */
    struct orl_jobs *jobs;
    struct orl_status_cache *statuses;
    struct orl_http_context context; /* state of the HTTP layer */
    struct orl_http_server *http;
    struct orl_events *events;
    struct orl_event_broker *broker; /* events of all jobs */
    struct orl_metrics metrics;
    struct orl_loop_watchdog watchdog;
    struct orl_checks checks;
    struct orl_guide *guide; /* the user guide; NULL until it is first requested */
    struct orl_memory memory;
    struct orl_previous_exit previous_exit;
    double started_s;
};

/*
 * Serves until a signal stops it. UV_THREADPOOL_SIZE must have been set already. announce is called
 * with "http://127.0.0.1:8423" once connections are accepted.
 */
int orl_server_run(const struct orl_config *config, const struct orl_routes *routes,
                   void (*announce)(const char *url), struct orl_error *err);

#endif
