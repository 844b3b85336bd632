#include "parts/limits.h"

#include <math.h>
#include <sys/resource.h>

/* A guess of seconds is right within a factor of several; the slowest node of a cluster takes twice
 * as long as the others. */
static const double time_margin = 8, memory_margin = 1.5;
/* Of any part: until it has its files, and until what it has written is seen. */
static const double start_s = 120;
/* Of a load on a node that has much else to do. */
static const double load_margin = 4;
enum { MIB_STEP = 64, MOST_MINUTES = 60 * 24 * 365 };

static uint64_t resident_bytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

static uint32_t minutes_of(const struct orl_part_needs *needs, const struct orl_limit_basis *basis)
{
    const double work_s = fmax(basis->pace, 1) * needs->core_s / fmax(basis->threads, 1);
    const double all_s = start_s + load_margin * basis->load_s + time_margin * work_s;
    if (!(needs->core_s > 0))
        return 0;
    return (uint32_t)fmin(fmax(ceil(all_s / 60), ORL_PART_LEAST_MINUTES), MOST_MINUTES);
}

struct orl_part_limits orl_part_limits(const struct orl_part_needs *needs,
                                       const struct orl_limit_basis *basis)
{
    const uint64_t bytes =
        basis->memory_bytes > 0 ? basis->memory_bytes : resident_bytes() + needs->bytes;
    const double steps = ceil(memory_margin * (double)bytes / (MIB_STEP * 1048576.0));
    return (struct orl_part_limits){
        .minutes = minutes_of(needs, basis),
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
