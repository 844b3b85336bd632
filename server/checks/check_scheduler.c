#include "checks/checks.h"

#include "health/crash.h"
#include "process/limits.h"
#include "process/times.h"

static bool is_cancelled(const struct orl_check *check)
{
    return atomic_load(&check->cancel);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static uint64_t lesser(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

uint64_t orl_check_memory_limit(const struct orl_checks *checks)
{
    const uint64_t most = orl_memory_limit(checks->memory);
    const uint64_t others = lesser(most / 4, ORL_SERVER_CHECK_FIRST);
    const uint64_t granted = lesser(most - others, checks->config->check_memory);
    return granted > ORL_SERVER_CHECK_LEAST ? granted : ORL_SERVER_CHECK_LEAST;
}

/* Returns the first memory grant: a size that every free slot can have. */
static uint64_t first_grant(const struct orl_checks *checks)
{
    const unsigned count = checks->count;
    const unsigned slots = count < ORL_SERVER_CHECKS ? ORL_SERVER_CHECKS - count : 1;
    const uint64_t share = orl_memory_available(checks->memory) / slots;
    const uint64_t granted =
        lesser(lesser(share, ORL_SERVER_CHECK_FIRST), orl_check_memory_limit(checks));
    return granted > ORL_SERVER_CHECK_LEAST ? granted : ORL_SERVER_CHECK_LEAST;
}

/* ---- Running checks ------------------------------------------------------------------------- */

/* Returns true if the check may still be preempted. */
static bool is_preemptible(const struct orl_check *check)
{
    return !check->has_full_grant && !check->is_long;
}

static bool is_long(const struct orl_check *check)
{
    const long long started_ms = atomic_load(&check->started_ms);
    return !is_preemptible(check) ||
           (started_ms > 0 && orl_time_steady_ms() - started_ms > ORL_SERVER_CHECK_QUICK_MS);
}

static unsigned count_long(const struct orl_checks *checks)
{
    unsigned count = 0;
    for (const struct orl_check *check = checks->running; check; check = check->next)
        count += is_long(check);
    return count;
}

static unsigned count_of(const struct orl_checks *checks, const struct orl_client *client)
{
    unsigned count = 0;
    for (const struct orl_check *check = checks->running; check; check = check->next)
        count += check->request->client == client;
    return count;
}

/* ---- Waiting checks ------------------------------------------------------------------------- */

/* Returns true if one more check would give this client all the slots, and others may exist. */
static bool has_full_share(const struct orl_checks *checks, const struct orl_check *check)
{
    return checks->config->needs_token &&
           count_of(checks, check->request->client) + 1 >= ORL_SERVER_CHECKS;
}

/*
 * Returns true if the check may start now. A check that waits for the larger grant does not delay
 * others. One quick check may always run; any check may run if no other does.
 */
static bool may_start(const struct orl_checks *checks, const struct orl_check *check)
{
    const struct orl_memory *memory = checks->memory;
    const unsigned n_long = count_long(checks);
    if (checks->count >= ORL_SERVER_CHECKS || has_full_share(checks, check))
        return false;
    if (!is_preemptible(check) && n_long + 1 >= ORL_SERVER_CHECKS)
        return false;
    if (check->has_full_grant)
        return (memory->jobs == 0 && checks->count == 0) ||
               orl_memory_available(memory) >= check->call.memory + memory->wanted;
    return (is_preemptible(check) ? n_long : 0) == checks->count ||
           orl_memory_available(memory) >= first_grant(checks);
}

static struct orl_check *choose_next(const struct orl_checks *checks)
{
    struct orl_check *first = NULL;
    unsigned least = 0;
    for (struct orl_check *check = checks->waiting; check; check = check->next) {
        if (!may_start(checks, check))
            continue;
        const unsigned count = count_of(checks, check->request->client);
        if (!first || count < least) {
            first = check;
            least = count;
        }
    }
    return first;
}

static void start_check(struct orl_checks *checks, struct orl_check *check)
{
    struct orl_check **at = &checks->waiting;
    while (*at != check)
        at = &(*at)->next;
    *at = check->next;
    if (!check->has_full_grant)
        check->call.memory = first_grant(checks);
    check->next = checks->running;
    checks->running = check;
    checks->count++;
    checks->memory->checks += check->call.memory;
    orl_crash_record_update(checks->memory, checks->count);
    orl_request_queue(check->request);
}

static void start_cancelled(struct orl_checks *checks)
{
    for (struct orl_check *check = checks->waiting, *next; check; check = next) {
        next = check->next;
        if (is_cancelled(check))
            start_check(checks, check);
    }
}

/* ---- Yielding -------------------------------------------------------------------------------- */

/* Returns true if a check waits only because all slots are taken. */
static bool has_blocked_check(const struct orl_checks *checks)
{
    for (const struct orl_check *check = checks->waiting; check; check = check->next)
        if (is_preemptible(check) && !has_full_share(checks, check))
            return true;
    return false;
}

/* Cancels one running check so that it yields, if a waiting check needs its slot. The list of
 * running checks starts with the last one started. */
static void preempt_check(struct orl_checks *checks)
{
    struct orl_check *last = NULL;
    if (checks->count < ORL_SERVER_CHECKS || !has_blocked_check(checks))
        return;
    for (struct orl_check *check = checks->running; check; check = check->next) {
        if (!is_long(check) || is_cancelled(check))
            return; /* its slot will soon be free */
        if (!last && is_preemptible(check))
            last = check;
    }
    if (!last)
        return;
    last->preempted = true;
    atomic_store(&last->cancel, true);
}

/* ---- Starting checks ------------------------------------------------------------------------- */

static void on_timer(uv_timer_t *timer)
{
    struct orl_checks *checks = timer->data;
    orl_checks_start(checks);
    preempt_check(checks);
}

void orl_checks_start(struct orl_checks *checks)
{
    enum { TIMER_MS = 50 };
    struct orl_check *check;
    start_cancelled(checks);
    while ((check = choose_next(checks)) != NULL)
        start_check(checks, check);
    if (!checks->waiting)
        uv_timer_stop(&checks->timer);
    else if (!uv_is_active((uv_handle_t *)&checks->timer))
        uv_timer_start(&checks->timer, on_timer, TIMER_MS, TIMER_MS);
}

void orl_check_enqueue(struct orl_checks *checks, struct orl_check *check)
{
    struct orl_check **last = &checks->waiting;
    while (*last)
        last = &(*last)->next;
    check->next = NULL;
    *last = check;
    check->waits_since_ms = orl_time_steady_ms();
    atomic_store(&check->started_ms, 0);
}

void orl_check_remove_running(struct orl_checks *checks, struct orl_check *check)
{
    struct orl_check **at = &checks->running;
    while (*at != check)
        at = &(*at)->next;
    *at = check->next;
    checks->count--;
    checks->memory->checks -= check->call.memory;
    orl_crash_record_update(checks->memory, checks->count);
}
