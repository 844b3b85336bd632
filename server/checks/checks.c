#include "checks/checks.h"

#include <poll.h>

#include "http/response/reply.h"
#include "process/limits.h"
#include "process/times.h"

/* Runs a check on the pool. */
static void run_check(struct orl_request *request)
{
    struct orl_check *check = request->check;
    atomic_store(&check->started_ms, orl_time_steady_ms());
    check->run(request);
}

void orl_checks_open(struct orl_checks *checks, uv_loop_t *loop)
{
    uv_timer_init(loop, &checks->timer);
    checks->timer.data = checks;
}

void orl_checks_close(struct orl_checks *checks)
{
    uv_close((uv_handle_t *)&checks->timer, NULL);
}

/* Queues the check. The request must be waiting already (orl_request_set_pending). */
static void enqueue_check(struct orl_checks *checks, struct orl_check *check)
{
    check->request->check = check;
    orl_check_enqueue(checks, check);
    orl_checks_start(checks);
}

void orl_check_begin(struct orl_checks *checks, struct orl_check *check,
                     struct orl_request *request, orl_request_step run, orl_request_step then)
{
    if (!orl_request_set_pending(request, run_check, then))
        return;
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    *check = (struct orl_check){.checks = checks, .request = request, .run = run, .then = then};
    atomic_init(&check->cancel, checks->stopping);
    check->call = (struct orl_check_call){.check_pool = checks->check_pool,
                                          .cpu_s = checks->config->check_timeout_s,
                                          .cancel = &check->cancel,
                                          .client_fd = info ? info->connect_fd : -1};
    enqueue_check(checks, check);
}

/* ---- Ends ------------------------------------------------------------------------------------ */

static void refuse_timed_out(const struct orl_check *check, struct orl_error *err)
{
    const long long took_ms = orl_time_steady_ms() - atomic_load(&check->started_ms);
    orl_error_set(err, ORL_ERR_LIMIT,
                  "the check was stopped after %.1f seconds; the limit is %u (--check-timeout)",
                  (double)took_ms / 1000, check->checks->config->check_timeout_s);
    orl_error_hint(err, "Upload fewer surfaces, copies or values, try again when the machine is "
                        "less busy, or start orield with a larger --check-timeout");
}

static void restart_check(struct orl_checks *checks, struct orl_check *check)
{
    if (orl_request_set_pending(check->request, run_check, check->then))
        enqueue_check(checks, check);
}

/* Restarts the check with the largest memory grant if memory ran out. Returns true if it did. */
static bool retry_with_more_memory(struct orl_checks *checks, struct orl_check *check)
{
    const uint64_t most = orl_check_memory_limit(checks);
    if (check->call.met != ORL_CHILD_MEMORY || check->call.memory >= most)
        return false;
    check->has_full_grant = true;
    check->call.memory = most;
    restart_check(checks, check);
    return true;
}

/* Restarts the check from its beginning if it was cancelled to yield. Returns true if it did. */
static bool restart_preempted(struct orl_checks *checks, struct orl_check *check)
{
    if (!check->preempted || check->timed_out || checks->stopping)
        return false;
    check->preempted = false;
    check->is_long = true;
    atomic_store(&check->cancel, false);
    restart_check(checks, check);
    return true;
}

static void reply_cancelled(struct orl_request *request, const struct orl_check *check)
{
    if (check->checks->stopping) {
        orl_reply_stopping(request);
    } else if (check->wait_timed_out) {
        orl_reply_problem(request, 503, "no-memory", "The server is out of memory",
                          "the check of the upload waited %u seconds for %llu MiB of memory; try "
                          "again when jobs have ended",
                          check->checks->config->check_timeout_s,
                          (unsigned long long)(check->call.memory >> 20));
        orl_reply_header(request, "Retry-After", "60");
    } else { /* the client cannot read this reply */
        orl_reply_problem(request, 400, "invalid", "The client has hung up",
                          "the connection was closed before its request was answered");
    }
}

bool orl_check_finish(struct orl_check *check, int *rc, struct orl_error *err)
{
    struct orl_request *request = check->request;
    struct orl_checks *checks = check->checks;
    orl_check_remove_running(checks, check);
    request->check = NULL;
    if ((*rc && retry_with_more_memory(checks, check)) ||
        (*rc == ORL_ERR_CANCELLED && restart_preempted(checks, check)))
        return false;
    orl_checks_start(checks);
    checks->freed(checks->ctx);
    if (*rc != ORL_ERR_CANCELLED)
        return true;
    if (check->timed_out) {
        refuse_timed_out(check, err);
        *rc = ORL_ERR_LIMIT;
        return true;
    }
    reply_cancelled(request, check);
    return false;
}

static bool has_hung_up(const struct orl_check *check)
{
    struct pollfd client = {.fd = check->call.client_fd, .events = POLLRDHUP};
    return client.fd >= 0 && poll(&client, 1, 0) > 0 && client.revents != 0;
}

void orl_checks_sweep(struct orl_checks *checks)
{
    const long long longest_ms = 1000 * (long long)checks->config->check_timeout_s;
    for (struct orl_check *check = checks->running; check; check = check->next) {
        const long long started_ms = atomic_load(&check->started_ms);
        const bool timed_out = started_ms > 0 && orl_time_steady_ms() - started_ms > longest_ms;
        if (!timed_out && !checks->stopping)
            continue;
        check->timed_out = check->timed_out || (timed_out && !checks->stopping);
        atomic_store(&check->cancel, true);
    }
    /* Waiting checks start too; they then find that they are cancelled and end. */
    for (struct orl_check *check = checks->waiting; check; check = check->next) {
        check->wait_timed_out = orl_time_steady_ms() - check->waits_since_ms > longest_ms;
        if (check->wait_timed_out || checks->stopping || has_hung_up(check))
            atomic_store(&check->cancel, true);
    }
    orl_checks_start(checks);
}
