#include "health/metrics.h"

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

void orl_metrics_observe(struct orl_histogram *histogram, double seconds)
{
    add_observation(histogram, orl_metrics_http_s, seconds);
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
