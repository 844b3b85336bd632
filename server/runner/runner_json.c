#include "runner/runner_json.h"

#include <math.h>

#include "json/encode.h"

json_t *orl_parts_to_json(const struct orl_parts_count *count)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:o, s:i, s:I}", "waiting", (json_int_t)count->waiting,
                     "running", (json_int_t)count->running, "done", (json_int_t)count->done,
                     "again", (json_int_t)count->again, "lost_s",
                     orl_json_from_real(round(10 * count->lost_s) / 10), "waves",
                     (int)count->rounds, "held", (json_int_t)count->held);
}

json_t *orl_runner_to_json(bool in_parts, const char *why, const struct orl_parts_count *count)
{
    json_t *runner = json_pack("{s:s, s:s}", "name", in_parts ? "slurm" : "local", "why", why);
    if (!runner || !count || json_object_set_new(runner, "parts", orl_parts_to_json(count)) == 0)
        return runner;
    json_decref(runner);
    return NULL;
}
