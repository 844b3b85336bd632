#include "server.h"

#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <sys/socket.h>
#include <sys/un.h>

#include "health/crash.h"
#include "jobs/job_runs.h"
#include "maintenance/scrub.h"
#include "process/limits.h"
#include "process/signals.h"
#include "process/times.h"
#include "runner/checkpoints.h"
#include "store/database/db.h"
#include "store/rows/stored_tokens.h"

/* ---- Notifications to systemd, by its socket alone (sd_notify(3)) ---------------------------- */

/* Sends a state such as "READY=1" or "STOPPING=1". Does nothing if systemd does not listen. */
static void notify(const char *state)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const char *path = getenv("NOTIFY_SOCKET");
    const size_t length = path ? strlen(path) : 0;
    if (length < 2 || length >= sizeof address.sun_path || (*path != '/' && *path != '@'))
        return;
    memcpy(address.sun_path, path, length);
    if (*path == '@')
        address.sun_path[0] = '\0'; /* a name in the abstract namespace */
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return;
    (void)!sendto(fd, state, strlen(state), MSG_NOSIGNAL, (const struct sockaddr *)&address,
                  (socklen_t)(offsetof(struct sockaddr_un, sun_path) + length));
    close(fd);
}

/* Sends "WATCHDOG=1" if systemd expects it. Called every second. */
static void notify_alive(void)
{
    const char *pid = getenv("WATCHDOG_PID");
    if (getenv("WATCHDOG_USEC") && (!pid || strtol(pid, NULL, 10) == (long)getpid()))
        notify("WATCHDOG=1");
}

enum { SAVING_MS = 1000, ANSWERS_MS = 500 };

static void stop_if_quiet(struct orl_server *server);

/* ---- Stopping ------------------------------------------------------------------------------- */

static void close_all(struct orl_server *server)
{
    orl_http_stop(server->http);
    orl_storage_stop(&server->storage);
    orl_checks_close(&server->checks);
    orl_wal_sync_stop(server->wal_sync);
    uv_close((uv_handle_t *)&server->handles.cache_changed, NULL);
    uv_close((uv_handle_t *)&server->stop.timer, NULL);
    uv_close((uv_handle_t *)&server->handles.saving, NULL);
    uv_close((uv_handle_t *)&server->handles.log_lines, NULL);
    orl_signals_stop();
}

static void on_answers_late(uv_timer_t *timer)
{
    struct orl_server *server = timer->data;
    server->stop.answers_late = true;
    stop_if_quiet(server);
}

/* Closes everything once neither jobs nor requests are on the pool. Answers that are not sent yet
 * get a little time, for clients that read them. */
static void stop_if_quiet(struct orl_server *server)
{
    if (!server->context.stopping || !server->stop.jobs_idle || server->context.working > 0 ||
        !orl_wal_sync_is_idle(server->wal_sync))
        return;
    if (!server->stop.answering) {
        server->stop.answering = true;
        uv_timer_start(&server->stop.timer, on_answers_late, ANSWERS_MS, 0);
        orl_events_stop(server->events); /* may send, and so come here again */
        orl_event_broker_stop(server->broker);
    }
    if (!server->stop.closing && (server->context.unanswered == 0 || server->stop.answers_late)) {
        server->stop.closing = true;
        close_all(server);
    }
}

static void on_synced(void *ctx)
{
    stop_if_quiet(ctx);
}

/* Resumes the request's connection. When stopping, this may have been the last work. */
static void on_work_done(struct orl_server *server)
{
    orl_http_kick(server->http);
    stop_if_quiet(server);
}

static void stop_server(struct orl_server *server)
{
    if (server->context.stopping)
        return;
    orl_shutdown_timeout_start();
    server->context.stopping = true;
    server->checks.stopping = true;
    orl_checks_sweep(&server->checks);
    orl_http_quiesce(server->http);
    orl_jobs_stop(server->jobs);
}

static void on_jobs_idle(void *ctx)
{
    struct orl_server *server = ctx;
    server->stop.jobs_idle = true;
    stop_server(server);
    stop_if_quiet(server);
}

static void check_disk(struct orl_server *server)
{
    if (!orl_disk_reserve_check(&server->disk))
        return;
    server->context.disk_full = server->disk.full;
    orl_jobs_pause(server->jobs, server->disk.full);
}

static void on_saving(uv_timer_t *timer)
{
    struct orl_server *server = timer->data;
    check_disk(server);
    orl_jobs_save(server->jobs);
    orl_crash_record_update(&server->memory, server->checks.count);
    orl_jobs_enforce_limits(server->jobs);
    notify_alive();
    orl_scrub_thread_poll(server->scrub_thread);
    orl_storage_check(&server->storage);
    orl_loop_watchdog_ping(&server->watchdog);
    orl_shared_sweep_step(&server->sweep, &server->loop);
    orl_retention_tick(&server->retention, &server->loop);
}

static void on_drain_over(uv_timer_t *timer)
{
    stop_server(timer->data);
}

static void on_job_changed(void *ctx, const struct orl_jobs_job *job)
{
    struct orl_server *server = ctx;
    orl_events_wake(server->events);
    orl_event_broker_job_changed(server->broker, job);
    server->sweep.wanted = server->sweep.wanted || orl_jobs_ended(job);
    uv_async_send(&server->handles.cache_changed);
}

static void on_job_leaving(void *ctx, const struct orl_jobs_job *job)
{
    struct orl_server *server = ctx;
    orl_events_job_removed(server->events, job);
    orl_event_broker_job_removed(server->broker, job);
}

static void on_signal(int signum, void *ctx)
{
    struct orl_server *server = ctx;
    if (server->context.stopping)
        return;
    orl_log_event(&server->log, ORL_LOG_INFO, "stopping", "i", "signal", (int64_t)signum);
    notify("STOPPING=1");
    if (server->stop.draining || server->config.drain_s == 0) {
        stop_server(server);
        return;
    }
    server->stop.draining = true;
    uv_timer_start(&server->stop.timer, on_drain_over, 1000 * (uint64_t)server->config.drain_s, 0);
    orl_jobs_drain(server->jobs);
}

/* Handles SIGHUP. Tokens need no reload: they are read from the database for every request. */
static void on_reload(int signum, void *ctx)
{
    struct orl_server *server = ctx;
    struct orl_error err;
    (void)signum;
    if (orl_http_reload(server->http, &err))
        orl_log_event(&server->log, ORL_LOG_ERROR, "reload-failed", "s", "why", err.message);
    else
        orl_log_event(&server->log, ORL_LOG_INFO, "reloaded", "");
}

/* ---- Changes of stored data ----------------------------------------------------------------- */

/* Runs on the loop's next turn after maps were built or released, or a job ended. */
static void on_cache_changed(uv_async_t *handle)
{
    struct orl_server *server = handle->data;
    struct orl_error err;
    if (orl_map_cache_flush(server->maps, &err))
        orl_log_event(&server->log, ORL_LOG_ERROR, "map-row-failed", "s", "why", err.message);
    orl_storage_evict(&server->storage);
}

/* Called from a worker. */
static void wake_for_maps(void *ctx)
{
    uv_async_send(ctx);
}

/* ---- The log -------------------------------------------------------------------------------- */

static void write_log(uv_prepare_t *handle)
{
    struct orl_server *server = handle->data;
    orl_log_flush(&server->log);
    orl_loop_watchdog_end_turn(&server->watchdog);
}

/* Buffers the log, so that the lines of one turn of the loop need only one write. */
static void gather_log(struct orl_server *server)
{
    static char lines[1 << 16];
    setvbuf(server->log.stream, lines, _IOFBF, sizeof lines);
    uv_prepare_init(&server->loop, &server->handles.log_lines);
    server->handles.log_lines.data = server;
    uv_prepare_start(&server->handles.log_lines, write_log);
}

/* ---- Callbacks into the daemon -------------------------------------------------------------- */

static void on_memory_freed(void *ctx)
{
    struct orl_server *server = ctx;
    orl_jobs_memory_freed(server->jobs);
}

static void open_checks(struct orl_server *server)
{
    server->checks.config = &server->config;
    server->checks.memory = &server->memory;
    server->checks.freed = on_memory_freed;
    server->checks.ctx = server;
    orl_checks_open(&server->checks, &server->loop);
}

static bool reserve_body_bytes(struct orl_server *server, struct orl_reservation *reservation,
                               uint64_t bytes)
{
    return orl_storage_reserve_body(&server->storage, reservation, bytes);
}

static bool reserve_storage_bytes(struct orl_server *server,
                                  const struct orl_reservation *reservation, uint64_t bytes)
{
    return orl_storage_admit(&server->storage, reservation, bytes);
}

static struct orl_quota *get_upload_quota(struct orl_server *server)
{
    return &server->storage.upload_quota;
}

static uint64_t storage_budget(const struct orl_server *server)
{
    return server->storage.budget;
}

static uint64_t jobs_of(const struct orl_server *server, const char *owner)
{
    return orl_jobs_of_owner(server->jobs, owner);
}

static void on_http_tick(struct orl_server *server)
{
    orl_checks_sweep(&server->checks);
}

static void open_context(struct orl_server *server, const struct orl_routes *routes)
{
    static const struct orl_http_calls calls = {
        .reserve_body = reserve_body_bytes,
        .reserve_storage = reserve_storage_bytes,
        .upload_quota = get_upload_quota,
        .budget = storage_budget,
        .jobs_of = jobs_of,
        .on_tick = on_http_tick,
        .work_done = on_work_done,
        .on_served = stop_if_quiet,
    };
    server->context = (struct orl_http_context){
        .server = server,
        .calls = &calls,
        .loop = &server->loop,
        .config = &server->config,
        .routes = routes,
        .log = &server->log,
        .folders = &server->folders,
        .db = &server->db,
        .metrics = &server->metrics,
    };
}

/* ---- Starting ------------------------------------------------------------------------------- */

static int open_storage(struct orl_server *server, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    int rc = orl_folders_open(&server->folders, server->config.data, err);
    if (rc)
        return rc;
    orl_disk_reserve_open(&server->disk, &server->folders, &server->log);
    server->context.disk_full = server->disk.full;
    orl_crash_record_open(server->config.data, server->config.log_json, &server->previous_exit);
    orl_folders_path(&server->folders, path, "oriel.db");
    rc = orl_link_key_open(&server->folders, server->context.link_key, err);
    if (rc == 0)
        rc = orl_store_open(&server->folders,
                            server->config.set_orphans_aside ? ORL_LOST_DATABASE_SET_ASIDE
                                                             : ORL_LOST_DATABASE_REFUSE,
                            &server->db, err);
    if (rc == 0)
        rc = orl_db_serve(&server->db, err);
    if (rc == ORL_ERR_FULL)
        orl_error_hint(err,
                       "Free some MiB on the disk; photon maps (%.200s/maps) can be removed, since "
                       "they are rebuilt",
                       server->config.data);
    if (rc == 0)
        orl_disk_reserve_wal(&server->disk);
    if (rc == 0)
        rc = orl_retention_open(&server->retention, &server->db, &server->folders, &server->log,
                                server->config.keep_orphans_days, err);
    if (rc == 0)
        rc = orl_wal_checkpointer_open(&server->db, path, &server->checkpointer, err);
    if (rc == 0)
        rc = orl_wal_sync_open(&server->loop, &server->db, path, on_synced, server,
                               &server->wal_sync, err);
    server->context.wal_sync = server->wal_sync;
    if (rc == 0)
        rc = orl_blobs_open(&server->loop, &server->folders, &server->db, server->wal_sync,
                            &server->blobs, err);
    if (rc == 0)
        rc = orl_map_cache_open(&server->loop, &server->folders, &server->db, wake_for_maps,
                                &server->handles.cache_changed, &server->maps, err);
    if (rc == 0) {
        server->checks.check_pool = orl_check_pool_new();
        rc = server->checks.check_pool ? 0 : orl_error_no_memory(err);
    }
    orl_memory_open(&server->memory, server->config.memory_bytes);
    server->memory_cache =
        orl_memory_cache_new(server->config.memory_cache_bytes); /* NULL: jobs are slower */
    return rc;
}

static int record_any_token(void *ctx, const struct orl_token_row *row)
{
    (void)row;
    *(bool *)ctx = true;
    return 0;
}

/* Prepares the lookup of tokens. Reports a daemon without any tokens, which cannot be used. */
static int open_tokens(struct orl_server *server, struct orl_error *err)
{
    bool any = false;
    if (!server->config.needs_token)
        return 0;
    int rc = orl_token_rows(&server->db, record_any_token, &any, err);
    if (rc == 0) {
        server->context.token_statement = orl_token_find_statement(&server->db, err);
        rc = server->context.token_statement ? 0 : ORL_ERR_IO;
    }
    if (rc == 0 && !any) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "there are no access tokens yet");
        orl_error_hint(err, "Make one: orield token add NAME --data %.200s", server->config.data);
    }
    return rc;
}

static void close_storage(struct orl_server *server)
{
    orl_check_pool_free(server->checks.check_pool);
    orl_map_cache_close(server->maps);
    orl_memory_cache_free(server->memory_cache);
    orl_blobs_close(server->blobs);
    sqlite3_finalize(server->context.token_statement);
    orl_wal_sync_free(server->wal_sync);
    orl_wal_checkpointer_close(server->checkpointer);
    orl_db_close(&server->db);
    orl_disk_reserve_close(&server->disk);
    orl_crash_record_close();
    orl_folders_close(&server->folders);
}

static void open_handles(struct orl_server *server)
{
    uv_async_init(&server->loop, &server->handles.cache_changed, on_cache_changed);
    server->handles.cache_changed.data = server;
    uv_timer_init(&server->loop, &server->stop.timer);
    server->stop.timer.data = server;
    uv_timer_init(&server->loop, &server->handles.saving);
    server->handles.saving.data = server;
    uv_timer_init(&server->loop, &server->storage.fetch_timer);
    server->storage.fetch_timer.data = &server->storage;
}

static void watch_signals(struct orl_server *server)
{
    uv_timer_start(&server->handles.saving, on_saving, SAVING_MS, SAVING_MS);
    orl_signal_handle(&server->loop, SIGHUP, on_reload, server);
    static const int numbers[2] = {SIGTERM, SIGINT};
    for (int i = 0; i < 2; i++) {
        orl_signal_handle(&server->loop, numbers[i], on_signal, server);
        orl_shutdown_timeout_watch(numbers[i], server->config.drain_s);
    }
}

static int open_jobs(struct orl_server *server, struct orl_error *err)
{
    server->statuses = orl_status_cache_new();
    if (!server->statuses)
        return orl_error_no_memory(err);
    struct orl_jobs_env env = {
        .loop = &server->loop,
        .db = &server->db,
        .wal_sync = server->wal_sync,
        .folders = &server->folders,
        .blobs = server->blobs,
        .maps = server->maps,
        .memory_cache = server->memory_cache,
        .slurm = server->config.runner.slurm ? &server->slurm : NULL,
        .memory = &server->memory,
        .previous_exit = &server->previous_exit,
        .log = &server->log,
        .metrics = &server->metrics,
        .threads = server->config.threads,
        .max_running = server->config.jobs,
        .job_timeout_s = server->config.job_timeout_s,
        .keep_jobs = server->config.keep_jobs,
        .keep_days = server->config.keep_days,
        .paused = server->disk.full,
        .clock = &server->retention.clock,
        .changed = on_job_changed,
        .removing = on_job_leaving,
        .idle = on_jobs_idle,
        .ctx = server,
    };
    memcpy(env.program, server->program, sizeof env.program);
    const int rc = orl_jobs_open(&env, &server->jobs, err);
    server->sweep = (struct orl_shared_sweep){
        .slurm = env.slurm, .jobs = server->jobs, .log = &server->log, .wanted = true};
    return rc;
}

static void open_budget(struct orl_server *server)
{
    struct orl_storage *storage = &server->storage;
    storage->db = &server->db;
    storage->maps = server->maps;
    storage->jobs = server->jobs;
    storage->blobs = server->blobs;
    storage->log = &server->log;
    storage->clock = &server->retention.clock;
    storage->budget = server->config.storage_bytes;
    if (storage->budget == 0)
        storage->budget = orl_storage_default(server->config.data, orl_storage_total(storage));
    orl_storage_evict(storage); /* the budget may be smaller than in the last run */
}

static void announce_address(struct orl_server *server, void (*announce)(const char *url))
{
    struct sockaddr_storage address;
    char text[80], url[96];
    orl_http_address(server->http, &address);
    orl_address_format((const struct sockaddr *)&address, text, sizeof text);
    snprintf(url, sizeof url, "%s://%s", server->config.tls_cert ? "https" : "http", text);
    orl_log_event(&server->log, ORL_LOG_INFO, "started", "ssii", "url", url, "data",
                  server->config.data, "threads", (int64_t)server->config.threads, "jobs",
                  (int64_t)server->config.jobs);
    announce(url);
    notify("READY=1");
}

int orl_server_run(const struct orl_config *config, const struct orl_routes *routes,
                   void (*announce)(const char *url), struct orl_error *err)
{
    struct orl_server server;
    memset(&server, 0, sizeof server);
    server.config = *config;
    server.log = (struct orl_log){stderr, config->log_level, config->log_json};
    server.folders.lock_fd = -1;
    server.started_s = orl_time_steady_s();
    if (uv_loop_init(&server.loop) != 0)
        return orl_error_set(err, ORL_ERR_INTERNAL, "cannot start the event loop");
    orl_shutdown_timeout_open();
    orl_program_digest(server.program);
    orl_uv_pool_prepare(&server.loop, config->threads + ORL_SERVER_IO_THREADS);
    orl_loop_watchdog_open(&server.watchdog, &server.loop);
    open_handles(&server);
    open_checks(&server);
    open_context(&server, routes);
    gather_log(&server);
    /* Starts HTTP before the jobs: nothing is served until the loop runs, and a port in use is
     * found before a job starts. */
    int rc = open_storage(&server, err);
    if (rc == 0 && config->runner.slurm)
        rc = orl_slurm_config_open(&config->runner, &server.slurm, err);
    if (rc == 0)
        rc = open_tokens(&server, err);
    if (rc == 0)
        rc = orl_events_open(&server, &server.events, err);
    if (rc == 0)
        rc = orl_event_broker_open(&server, &server.broker, err);
    if (rc == 0)
        rc = orl_http_start(&server.context, &server.config.address.any, &server.http, err);
    if (rc == 0)
        rc = open_jobs(&server, err);
    if (rc == 0) {
        orl_retention_log_orphans(&server.retention);
        orl_retention_tick(&server.retention, &server.loop);
        orl_missing_files_log(&server.db, &server.folders, &server.log);
        open_budget(&server);
        server.scrub_thread = orl_scrub_thread_start(&server.folders, &server.log, server.maps,
                                                     config->scrub_bytes_per_s);
        watch_signals(&server);
        announce_address(&server, announce);
    } else {
        orl_events_stop(server.events);
        orl_event_broker_stop(server.broker);
        close_all(&server);
    }
    uv_run(&server.loop, UV_RUN_DEFAULT);
    orl_scrub_thread_stop(server.scrub_thread);
    orl_http_free(server.http);
    orl_events_free(server.events);
    orl_event_broker_free(server.broker);
    if (server.maps)
        orl_map_cache_flush(server.maps, NULL);
    orl_status_cache_free(server.statuses);
    orl_guide_close(server.guide);
    orl_jobs_close(server.jobs);
    orl_retention_close(&server.retention);
    orl_shared_sweep_done(&server.sweep);
    close_storage(&server);
    uv_loop_close(&server.loop);
    uv_library_shutdown(); /* ends the pool's threads before the data they use is freed */
    orl_shutdown_timeout_close();
    if (rc == 0)
        orl_log_event(&server.log, ORL_LOG_INFO, "stopped", "");
    return rc;
}
