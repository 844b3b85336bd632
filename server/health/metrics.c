#include "health/metrics.h"

#include "process/times.h"

const double orl_metrics_http_s[ORL_METRICS_BUCKETS] = {
    0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 5, 30, 300};
const double orl_metrics_stage_s[ORL_METRICS_BUCKETS] = {0.001, 0.01, 0.05, 0.1, 0.25, 0.5, 1,
                                                         2.5,   5,    10,   30,  60,   300, 1800};

static void add_observation(struct orl_histogram *histogram,
                            const double bounds[ORL_METRICS_BUCKETS], double seconds)
{
    size_t i = 0;
    while (i < ORL_METRICS_BUCKETS && seconds > bounds[i])
        i++;
    histogram->buckets[i]++;
    histogram->sum += seconds;
}

void orl_metrics_request(struct orl_metrics *metrics, size_t route, unsigned status, double seconds)
{
    const size_t hundreds = status / 100;
    if (route < ORL_METRICS_ROUTES && hundreds < ORL_METRICS_CLASSES)
        add_observation(&metrics->http[route][hundreds], orl_metrics_http_s, seconds);
}

void orl_metrics_job(struct orl_metrics *metrics, enum orl_job_state state,
                     const struct orl_job_tally *tally)
{
    metrics->ended[state]++;
    for (int i = 0; i < ORL_STAGE_COUNT; i++)
        if (tally->stages_s[i] > 0)
            add_observation(&metrics->stages[i], orl_metrics_stage_s, tally->stages_s[i]);
    orl_health_add(&metrics->health, &tally->health);
}

void orl_metrics_parts(struct orl_parts_count *sum, const struct orl_parts_count *parts)
{
    sum->waiting += parts->waiting;
    sum->running += parts->running;
    sum->done += parts->done;
    sum->again += parts->again;
    sum->lost_s += parts->lost_s;
    sum->rounds += parts->rounds;
}

/* ---- The watchdog ---------------------------------------------------------------------------- */

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
        add_observation(&watchdog->turns, orl_metrics_http_s, busy_s);
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
