#include "checks.h"

#include "limits.h"
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

void orl_check_begin(struct orl_check *check, struct orl_request *request, orl_request_step run,
                     orl_request_step then)
{
    struct orl_checks *checks = &request->server->checks;
    struct orl_check **last = &checks->waiting;
    check->request = request;
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

int orl_check_ended(struct orl_check *check, int rc, struct orl_error *err)
{
    const struct orl_server *server = check->request->server;
    struct orl_checks *checks = &check->request->server->checks;
    unlink_check(checks, check);
    check->request->check = NULL;
    struct orl_check *next = checks->waiting;
    if (next) {
        checks->waiting = next->next;
        start(checks, next);
    }
    if (rc != ORL_ERR_CANCELLED || !check->late)
        return rc;
    orl_error_set(err, ORL_ERR_LIMIT, "checking the upload took longer than %u seconds",
                  server->config.check_timeout_s);
    orl_error_hint(err,
                   "Fewer surfaces, copies or values take less; --check-timeout sets the bound");
    return ORL_ERR_LIMIT;
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
