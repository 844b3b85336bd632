#include "health/loop_watchdog.h"

#include "process/times.h"

void orl_loop_watchdog_open(struct orl_loop_watchdog *watchdog, uv_loop_t *loop)
{
    watchdog->loop = loop;
    watchdog->ping.data = watchdog;
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
}

void orl_loop_watchdog_end_turn(struct orl_loop_watchdog *watchdog)
{
    const uint64_t now_ns = uv_hrtime(), idle_ns = uv_metrics_idle_time(watchdog->loop);
    const uint64_t all_ns = now_ns - watchdog->turn_ns, waited_ns = idle_ns - watchdog->idle_ns;
    const double busy_s = all_ns > waited_ns ? 1e-9 * (double)(all_ns - waited_ns) : 0;
    if (watchdog->turn_ns > 0) {
        orl_metrics_observe(&watchdog->turns, busy_s);
        watchdog->longest_s = busy_s > watchdog->longest_s ? busy_s : watchdog->longest_s;
    }
    watchdog->turn_ns = now_ns;
    watchdog->idle_ns = idle_ns;
}

static void run_ping(uv_work_t *work)
{
    (void)work;
}

static void end_ping(uv_work_t *work, int status)
{
    struct orl_loop_watchdog *watchdog = work->data;
    (void)status;
    watchdog->pending = false;
    watchdog->latency_s = orl_time_steady_s() - watchdog->sent_s;
}

void orl_loop_watchdog_ping(struct orl_loop_watchdog *watchdog)
{
    if (watchdog->pending)
        return;
    watchdog->sent_s = orl_time_steady_s();
    watchdog->pending = uv_queue_work(watchdog->loop, &watchdog->ping, run_ping, end_ping) == 0;
}

double orl_loop_watchdog_pool_s(const struct orl_loop_watchdog *watchdog)
{
    const double waits_s = watchdog->pending ? orl_time_steady_s() - watchdog->sent_s : 0;
    return waits_s > watchdog->latency_s ? waits_s : watchdog->latency_s;
}
