#include "checks.h"

#include <poll.h>

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

/* ---- Whose turn it is ------------------------------------------------------------------------ */

/* What one check may be granted, if it is to have all it can. */
static uint64_t most_of_one(const struct orl_server *server)
{
    const uint64_t most = orl_memory_most(&server->memory);
    const uint64_t asked = server->config.check_memory;
    const uint64_t granted = most < asked ? most : asked;
    return granted > ORL_SERVER_CHECK_LEAST ? granted : ORL_SERVER_CHECK_LEAST;
}

/* Among several clients none has all checks that go on at once. */
static bool has_its_share(const struct orl_server *server, const struct orl_client *client)
{
    unsigned count = 0;
    for (const struct orl_check *check = server->checks.running; check; check = check->next)
        count += check->request->client == client;
    return server->config.needs_token && count + 1 >= ORL_SERVER_CHECKS;
}

/*
 * Most checks take little: at first none is granted more than that, and one that meets the bound is
 * done again with all that it may have. Whoever waits for memory does not keep small ones from
 * going on, and one of them goes on whatever else there is; any does when there is nothing else.
 */
static bool may_start(const struct orl_server *server, const struct orl_check *check)
{
    if (has_its_share(server, check->request->client))
        return false;
    const struct orl_checks *checks = &server->checks;
    const bool small = check->asking.memory <= ORL_SERVER_CHECK_FIRST;
    const uint64_t others = small ? 0 : server->memory.wanted;
    if (checks->count >= ORL_SERVER_CHECKS)
        return false;
    return ((small || server->memory.jobs == 0) && checks->count == 0) ||
           orl_memory_free(&server->memory) >= check->asking.memory + others;
}

static void start(struct orl_server *server, struct orl_check *check)
{
    struct orl_checks *checks = &server->checks;
    check->next = checks->running;
    checks->running = check;
    checks->count++;
    server->memory.checks += check->asking.memory;
    orl_blame_note(&server->memory, checks->count);
    orl_request_queue(check->request);
}

static void start_waiting(struct orl_server *server)
{
    struct orl_check **at = &server->checks.waiting;
    while (*at) {
        struct orl_check *check = *at;
        if (!atomic_load(&check->cancel) && !may_start(server, check)) {
            at = &check->next;
            continue;
        }
        *at = check->next;
        start(server, check);
    }
}

static void unlink_check(struct orl_server *server, struct orl_check *check)
{
    struct orl_check **at = &server->checks.running;
    while (*at != check)
        at = &(*at)->next;
    *at = check->next;
    server->checks.count--;
    server->memory.checks -= check->asking.memory;
    orl_blame_note(&server->memory, server->checks.count);
}

static void wait_for_turn(struct orl_server *server, struct orl_check *check)
{
    struct orl_check **last = &server->checks.waiting;
    while (*last)
        last = &(*last)->next;
    check->next = NULL;
    *last = check;
    check->waits_since_ms = now_ms();
    atomic_store(&check->started_ms, 0);
    orl_request_wait(check->request, run_check, check->then);
    start_waiting(server);
}

void orl_check_begin(struct orl_check *check, struct orl_request *request, orl_request_step run,
                     orl_request_step then)
{
    struct orl_server *server = request->server;
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(request->connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    const uint64_t most = most_of_one(server);
    *check = (struct orl_check){.request = request, .run = run, .then = then};
    atomic_init(&check->cancel, server->stopping);
    check->asking =
        (struct orl_asking){.lanes = server->lanes,
                            .memory = most < ORL_SERVER_CHECK_FIRST ? most : ORL_SERVER_CHECK_FIRST,
                            .cpu_s = server->config.check_timeout_s,
                            .cancel = &check->cancel,
                            .client_fd = info ? info->connect_fd : -1};
    request->check = check;
    wait_for_turn(server, check);
}

/* ---- Ends ------------------------------------------------------------------------------------ */

static void refuse_late(const struct orl_server *server, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_LIMIT, "checking the upload took longer than %u seconds",
                  server->config.check_timeout_s);
    orl_error_hint(err,
                   "Fewer surfaces, copies or values take less; --check-timeout sets the bound");
}

/* Once more, with all the memory that one may have? */
static bool goes_again(struct orl_server *server, struct orl_check *check)
{
    const uint64_t most = most_of_one(server);
    if (check->asking.met != ORL_CHILD_MEMORY || check->asking.memory >= most)
        return false;
    check->asking.memory = most;
    check->request->check = check;
    wait_for_turn(server, check);
    return true;
}

static void reply_given_up(struct orl_request *request, const struct orl_check *check)
{
    if (request->server->stopping) {
        orl_reply_stopping(request);
    } else if (check->starved) {
        orl_reply_problem(request, 503, "no-memory", "The server is out of memory",
                          "for %u seconds there were not %llu MiB for the check of the upload; "
                          "try again when jobs have ended",
                          request->server->config.check_timeout_s,
                          (unsigned long long)(check->asking.memory >> 20));
        orl_reply_header(request, "Retry-After", "60");
    } else { /* nobody is there to read it */
        orl_reply_problem(request, 400, "invalid", "The client has hung up",
                          "the connection was closed before its request was answered");
    }
}

bool orl_check_ended(struct orl_check *check, int *rc, struct orl_error *err)
{
    struct orl_request *request = check->request;
    struct orl_server *server = request->server;
    unlink_check(server, check);
    request->check = NULL;
    if (*rc && goes_again(server, check))
        return false;
    start_waiting(server);
    orl_jobs_memory_freed(server->jobs);
    if (*rc != ORL_ERR_CANCELLED)
        return true;
    if (check->late) {
        refuse_late(server, err);
        *rc = ORL_ERR_LIMIT;
        return true;
    }
    reply_given_up(request, check);
    return false;
}

static bool has_hung_up(const struct orl_check *check)
{
    struct pollfd client = {.fd = check->asking.client_fd, .events = POLLRDHUP};
    return client.fd >= 0 && poll(&client, 1, 0) > 0 && client.revents != 0;
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
    for (struct orl_check *check = server->checks.waiting; check; check = check->next) {
        check->starved = now_ms() - check->waits_since_ms > longest_ms;
        if (check->starved || server->stopping || has_hung_up(check))
            atomic_store(&check->cancel, true);
    }
    start_waiting(server);
}
