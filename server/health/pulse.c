#include "health/pulse.h"

#include "process/times.h"

void orl_pulse_open(struct orl_pulse *pulse, uv_loop_t *loop)
{
    pulse->loop = loop;
    pulse->ping.data = pulse;
    uv_loop_configure(loop, UV_METRICS_IDLE_TIME);
}

void orl_pulse_turn(struct orl_pulse *pulse)
{
    const uint64_t now_ns = uv_hrtime(), idle_ns = uv_metrics_idle_time(pulse->loop);
    const uint64_t all_ns = now_ns - pulse->turn_ns, waited_ns = idle_ns - pulse->idle_ns;
    const double busy_s = all_ns > waited_ns ? 1e-9 * (double)(all_ns - waited_ns) : 0;
    if (pulse->turn_ns > 0) {
        orl_metrics_observe(&pulse->turns, busy_s);
        pulse->longest_s = busy_s > pulse->longest_s ? busy_s : pulse->longest_s;
    }
    pulse->turn_ns = now_ns;
    pulse->idle_ns = idle_ns;
}

static void run_ping(uv_work_t *work)
{
    (void)work;
}

static void end_ping(uv_work_t *work, int status)
{
    struct orl_pulse *pulse = work->data;
    (void)status;
    pulse->asked = false;
    pulse->last_s = orl_time_steady_s() - pulse->at_s;
}

void orl_pulse_ask(struct orl_pulse *pulse)
{
    if (pulse->asked)
        return;
    pulse->at_s = orl_time_steady_s();
    pulse->asked = uv_queue_work(pulse->loop, &pulse->ping, run_ping, end_ping) == 0;
}

double orl_pulse_pool_s(const struct orl_pulse *pulse)
{
    const double waits_s = pulse->asked ? orl_time_steady_s() - pulse->at_s : 0;
    return waits_s > pulse->last_s ? waits_s : pulse->last_s;
}
