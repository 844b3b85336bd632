#include "photon/map/normal_code.h"

#include <string.h>

uint16_t orl_normal_encode(struct orl_vec3 n)
{
    const double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    /* Values that would round to zero become +0, so that the downward axis has only one code. */
    double u = fabs(n.x) < sum / 512 ? 0.0 : n.x / sum, v = fabs(n.y) < sum / 512 ? 0.0 : n.y / sum;
    if (n.z < 0) {
        const double fold = (1 - fabs(v)) * copysign(1.0, u);
        v = (1 - fabs(u)) * copysign(1.0, v);
        u = fold;
    }
    return (uint16_t)((unsigned)lrint(127 * u + 127) | (unsigned)lrint(127 * v + 127) << 8);
}

struct orl_vec3 orl_normal_decode(uint16_t code)
{
    double u = ((code & 255) - 127) / 127.0, v = ((code >> 8) - 127) / 127.0;
    const double z = 1 - fabs(u) - fabs(v);
    if (z < 0) {
        const double fold = (1 - fabs(v)) * copysign(1.0, u);
        v = (1 - fabs(u)) * copysign(1.0, v);
        u = fold;
    }
    return orl_normalize(orl_v3(u, v, z));
}

/* Codes are sampled with this step. A bin is 51 codes wide, and the margin covers the codes
 * between. */
enum { STEP = 3 };
static const double margin_rad = 0.04;

void orl_normal_bins_init(struct orl_normal_bins *normal_bins)
{
    double angle[ORL_NORMAL_BINS] = {0};
    memset(normal_bins, 0, sizeof *normal_bins);
    for (uint32_t v = 0; v < 256; v += STEP) {
        for (uint32_t u = 0; u < 256; u += STEP) {
            const uint16_t code = (uint16_t)(u | v << 8);
            struct orl_vec3 *axis = &normal_bins->axis[orl_normal_bin(code)];
            *axis = orl_add(*axis, orl_normal_decode(code));
        }
    }
    for (int i = 0; i < ORL_NORMAL_BINS; i++)
        normal_bins->axis[i] = orl_normalize(normal_bins->axis[i]);
    for (uint32_t v = 0; v < 256; v += STEP) {
        for (uint32_t u = 0; u < 256; u += STEP) {
            const uint16_t code = (uint16_t)(u | v << 8);
            const uint32_t bin = orl_normal_bin(code);
            const double cosine = orl_dot(normal_bins->axis[bin], orl_normal_decode(code));
            angle[bin] = fmax(angle[bin], acos(fmin(cosine, 1)));
        }
    }
    for (int i = 0; i < ORL_NORMAL_BINS; i++)
        normal_bins->least_cosine[i] = cos(fmin(angle[i] + margin_rad + ORL_PI / 6, ORL_PI));
}

uint32_t orl_normal_bins_mask(const struct orl_normal_bins *normal_bins, struct orl_vec3 normal)
{
    uint32_t mask = 0;
    for (uint32_t i = 0; i < ORL_NORMAL_BINS; i++)
        mask |= (uint32_t)(orl_dot(normal_bins->axis[i], normal) >= normal_bins->least_cosine[i])
                << i;
    return mask;
}
