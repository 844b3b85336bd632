/* orl_map_encode_words for many photons: each step loops over all of them, so that it can be
 * vectorised. */
#include "photon/map/map_encode.h"

#include <string.h>

#include "base/multiversion.h"
#include "base/sampling/random.h"
#include "photon/map/flux.h"

enum { N = ORL_ENCODED_AT_ONCE };

/* Adding and subtracting this rounds doubles below 2^51 to integers. */
static const double rounding = 0x1.8p52;

static inline uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double double_of(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

bool orl_map_encode_is_near(const struct orl_map_encoder *encoder)
{
    const double far = 0x1p50;
    return fabs(encoder->first[0]) < far && fabs(encoder->first[1]) < far &&
           fabs(encoder->first[2]) < far;
}

/* Computes cells as cell_at does. */
static inline void find_cells(const struct orl_map_encoder *p, const struct orl_photon *photons,
                              uint32_t ret_cells[3][N])
{
    const double unit = p->unit, steps = p->steps;
    for (int k = 0; k < 3; k++) {
        const double first = p->first[k];
        double at[N];
        for (int i = 0; i < N; i++)
            at[i] = (double)photons[i].position[k];
        for (int i = 0; i < N; i++) {
            const double x = at[i] / unit * steps, near = (x + rounding) - rounding;
            ret_cells[k][i] = (uint32_t)(int32_t)((near > x ? near - 1 : near) - first);
        }
    }
}

/* Computes orl_random_uniform of the photons' streams: converts 53 bits to a double in two exact
 * halves. */
static inline void find_dithers(uint64_t seed, uint64_t first, double ret_dithers[N])
{
    for (uint64_t i = 0; i < N; i++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_DITHER, first + i);
        const uint64_t bits = orl_random_bits(&random) >> 11;
        const double low = double_of((bits & 0xffffffffU) | bits_of(0x1p52));
        const double high = double_of(bits >> 32 | bits_of(0x1p84));
        ret_dithers[i] = ((high - (0x1p84 + 0x1p52)) + low) * 0x1p-53;
    }
}

/* Computes orl_flux_pack_from. */
static inline void pack_fluxes(const struct orl_photon *photons, int least, const double *dithers,
                               uint32_t ret_fluxes[N])
{
    double flux[3][N], scale[N];
    int32_t exponent[N], out[N];
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < 3; k++)
            flux[k][i] = (double)photons[i].flux[k];
        ret_fluxes[i] = 0;
    }
    for (int i = 0; i < N; i++) {
        double most = flux[0][i] > flux[1][i] ? flux[0][i] : flux[1][i];
        most = most > flux[2][i] ? most : flux[2][i];
        most = most > 0 ? most : 1;
        const int32_t e = (int32_t)(bits_of(most * (1 + 0x1p-9)) >> 52) - 1022;
        scale[i] = double_of((uint64_t)(ORL_FLUX_MANTISSA_BITS - e + 1023) << 52);
        exponent[i] = e - least;
    }
    for (int i = 0; i < N; i++) {
        const int32_t less = exponent[i] < 0 ? -exponent[i] : 0;
        out[i] = less < ORL_FLUX_MANTISSA_BITS ? less : ORL_FLUX_MANTISSA_BITS;
        exponent[i] = exponent[i] > 0 ? exponent[i] : 0;
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < N; i++) {
            const double m = flux[k][i] * scale[i] + dithers[i], most = 511;
            ret_fluxes[i] |=
                (uint32_t)(int32_t)(m < most ? m : most) >> out[i] << k * ORL_FLUX_MANTISSA_BITS;
        }
    for (int i = 0; i < N; i++) {
        const bool dark = !(flux[0][i] > 0) && !(flux[1][i] > 0) && !(flux[2][i] > 0);
        ret_fluxes[i] =
            dark ? 0 : ret_fluxes[i] | (uint32_t)exponent[i] << 3 * ORL_FLUX_MANTISSA_BITS;
    }
}

ORL_FOR_WIDE_VECTORS
void orl_map_encode_words_many(const struct orl_map_encoder *encoder, size_t first,
                               struct orl_photon_words ret_words[ORL_ENCODED_AT_ONCE])
{
    const struct orl_photon *photons = encoder->photons + (first - encoder->n_earlier);
    uint32_t cells[3][N], fluxes[N];
    double dithers[N];
    find_cells(encoder, photons, cells);
    find_dithers(encoder->seed, first, dithers);
    pack_fluxes(photons, encoder->flux_exponent, dithers, fluxes);
    for (int i = 0; i < N; i++) {
        const uint32_t batch = photons[i].batch & 15U, z = cells[2][i];
        ret_words[i] = (struct orl_photon_words){.a = cells[0][i] | batch << 20 | (z >> 12) << 24,
                                                 .b = cells[1][i] | (z & 0xfffU) << 20,
                                                 .flux = fluxes[i],
                                                 .normal = photons[i].normal,
                                                 .tag = photons[i].tag};
    }
}
