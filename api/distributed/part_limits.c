#include "distributed/part_limits.h"

#include <math.h>
#include <sys/resource.h>

/* Factors for time and memory. Time estimates may be wrong by several times, and a cluster's
 * slowest node takes twice as long as the others. */
static const double time_margin = 8, memory_margin = 1.5;
/* Overhead of any part: until its files are read, and until its output is visible. */
static const double start_s = 120;
/* Factor for the load time on a busy node. */
static const double load_margin = 4;
enum { MIB_STEP = 64, MOST_MINUTES = 60 * 24 * 365 };

static uint64_t resident_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

static uint32_t minutes_of(const struct orl_part_needs *needs,
                           const struct orl_part_limits_input *input)
{
    const double work_s = fmax(input->time_ratio, 1) * needs->core_s / fmax(input->threads, 1);
    const double all_s = start_s + load_margin * input->load_s + time_margin * work_s;
    if (!(needs->core_s > 0))
        return 0;
    return (uint32_t)fmin(fmax(ceil(all_s / 60), ORL_PART_LEAST_MINUTES), MOST_MINUTES);
}

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_part_limits_input *input)
{
    const uint64_t bytes =
        input->memory_bytes > 0 ? input->memory_bytes : resident_bytes() + needs->bytes;
    const double steps = ceil(memory_margin * (double)bytes / (MIB_STEP * 1048576.0));
    return (struct orl_part_limits){
        .minutes = minutes_of(needs, input),
        .mib = (uint32_t)fmin(fmax(MIB_STEP * steps, ORL_PART_LEAST_MIB), UINT32_MAX / 2)};
}

struct orl_part_limits orl_part_limits_raised(struct orl_part_limits limits, enum orl_part_end end)
{
    if (end == ORL_PART_OUT_OF_TIME && limits.minutes <= MOST_MINUTES)
        limits.minutes *= 2;
    if (end == ORL_PART_OUT_OF_MEMORY && limits.mib < UINT32_MAX / 2)
        limits.mib *= 2;
    return limits;
}
