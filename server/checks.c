#include "checks.h"

#include "limits.h"
#include "reply.h"
#include "server.h"
#include "times.h"

static long long now_ms(void)
{
    return (long long)(1000 * orl_time_steady_s());
}

/* On the pool. */
static void run_check(struct orl_request *request)
{
    struct orl_check *check = request->check;
    atomic_store(&check->started_ms, now_ms());
    check->run(request);
}

static void start(struct orl_checks *checks, struct orl_check *check)
{
    check->next = checks->running;
    checks->running = check;
    checks->count++;
    orl_request_queue(check->request);
}

static void prepare(struct orl_check *check)
{
    const struct orl_request *request = check->request;
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    atomic_init(&check->cancel, request->server->stopping);
    check->asking = (struct orl_asking){.lanes = request->server->lanes,
                                        .memory = request->server->config.check_memory,
                                        .cpu_s = request->server->config.check_timeout_s,
                                        .cancel = &check->cancel,
                                        .client_fd = info ? info->connect_fd : -1};
}

void orl_check_begin(struct orl_check *check, struct orl_request *request, orl_request_step run,
                     orl_request_step then)
{
    struct orl_checks *checks = &request->server->checks;
    struct orl_check **last = &checks->waiting;
    *check = (struct orl_check){.request = request};
    prepare(check);
    check->run = run;
    request->check = check;
    orl_request_wait(request, run_check, then);
    if (checks->count < ORL_SERVER_CHECKS) {
        start(checks, check);
        return;
    }
    while (*last)
        last = &(*last)->next;
    check->next = NULL;
    *last = check;
}

static void unlink_check(struct orl_checks *checks, struct orl_check *check)
{
    struct orl_check **at = &checks->running;
    while (*at != check)
        at = &(*at)->next;
    *at = check->next;
    checks->count--;
}

static void refuse_late(const struct orl_server *server, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_LIMIT, "checking the upload took longer than %u seconds",
                  server->config.check_timeout_s);
    orl_error_hint(err,
                   "Fewer surfaces, copies or values take less; --check-timeout sets the bound");
}

bool orl_check_ended(struct orl_check *check, int *rc, struct orl_error *err)
{
    struct orl_request *request = check->request;
    struct orl_checks *checks = &request->server->checks;
    unlink_check(checks, check);
    request->check = NULL;
    struct orl_check *next = checks->waiting;
    if (next) {
        checks->waiting = next->next;
        start(checks, next);
    }
    if (*rc != ORL_ERR_CANCELLED)
        return true;
    if (check->late) {
        refuse_late(request->server, err);
        *rc = ORL_ERR_LIMIT;
        return true;
    }
    if (request->server->stopping)
        orl_reply_stopping(request);
    else /* nobody is there to read it */
        orl_reply_problem(request, 400, "hung-up", "The client has hung up",
                          "the connection was closed before its request was answered");
    return false;
}

void orl_checks_sweep(struct orl_server *server)
{
    const long long longest_ms = 1000 * (long long)server->config.check_timeout_s;
    for (struct orl_check *check = server->checks.running; check; check = check->next) {
        const long long started_ms = atomic_load(&check->started_ms);
        const bool late = started_ms > 0 && now_ms() - started_ms > longest_ms;
        if (!late && !server->stopping)
            continue;
        check->late = check->late || (late && !server->stopping);
        atomic_store(&check->cancel, true);
    }
    /* Those that wait begin, and find that they are to end. */
    for (struct orl_check *check = server->checks.waiting; check && server->stopping;
         check = check->next)
        atomic_store(&check->cancel, true);
}
