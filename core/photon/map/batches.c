#include "photon/map/batches.h"

#include <math.h>

double orl_batches_third_cumulant(const struct orl_batches *batches)
{
    static const double n = ORL_MAP_BATCHES;
    double mean = 0, cube = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        mean += batches->luma[i] / n;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        cube += pow(batches->luma[i] - mean, 3);
    return cube * n * n / ((n - 1) * (n - 2));
}

double orl_batches_shrink(const struct orl_batches *difference)
{
    const double scatter2 = orl_batches_variance(difference);
    double sum = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum += difference->luma[i];
    return sum * sum > scatter2 ? sum - scatter2 / sum : 0;
}

void orl_batches_pack(const struct orl_batches *batches, uint8_t ret_shares[ORL_MAP_BATCHES])
{
    double most = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        most = fmax(most, batches->luma[i]);
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        ret_shares[i] = most > 0 ? (uint8_t)lround(255 * fmax(batches->luma[i], 0) / most) : 0;
}

struct orl_batches orl_batches_unpack(const uint8_t shares[ORL_MAP_BATCHES], double luma)
{
    struct orl_batches batches = {{0}};
    uint32_t sum = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        sum += shares[i];
    for (int i = 0; i < ORL_MAP_BATCHES && sum > 0; i++)
        batches.luma[i] = shares[i] * (luma / sum);
    return batches;
}
