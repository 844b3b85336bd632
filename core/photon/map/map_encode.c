#include "photon/map/write_map.h"

#include <stdlib.h>
#include <string.h>

#include "base/multiversion.h"
#include "base/sampling/sampling.h"
#include "photon/map/quantization.h"

/* Bounding box of all photons, in units, and the brightest flux of the new ones. */
struct bounds {
    double low[3], high[3];
    double brightest; /* brightest channel */
};

/* Bounds of the new photons, chunk by chunk. */
struct bounds_task {
    const struct orl_map_encoder *encoder;
    struct bounds *chunks;
};

enum { CHUNK = 1 << 15 };

static const struct bounds nothing = {
    {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0};

/*
 * Returns the position of an earlier map's photon: its cell's corner, which lies in the
 * corresponding larger cell. This is exact, because the map's cells begin at multiples of their
 * edge, a power of two.
 */
static void earlier_corner(const struct orl_map_encoder *p, size_t index, double ret_at[3])
{
    const struct orl_map_header *h = p->earlier->header;
    const uint32_t *leaf = p->earlier->places + index / ORL_MAP_LEAF * ORL_LEAF_WORDS;
    uint32_t cell[3];
    orl_position_unpack(leaf[index % ORL_MAP_LEAF], leaf[index % ORL_MAP_LEAF + ORL_MAP_LEAF],
                        cell);
    for (int k = 0; k < 3; k++)
        ret_at[k] = (rint(h->low[k] / h->cell) + cell[k]) * (h->cell / p->unit);
}

/* Returns the position in units. */
static void position_of(const struct orl_map_encoder *p, size_t index, double ret_at[3])
{
    if (index < p->n_earlier) {
        earlier_corner(p, index, ret_at);
        return;
    }
    for (int k = 0; k < 3; k++)
        ret_at[k] = p->photons[index - p->n_earlier].position[k] / p->unit;
}

/* Positions are finite. */
static void include_point(struct bounds *b, const double at[3])
{
    for (int k = 0; k < 3; k++) {
        b->low[k] = at[k] < b->low[k] ? at[k] : b->low[k];
        b->high[k] = at[k] > b->high[k] ? at[k] : b->high[k];
    }
}

static size_t new_photons(const struct orl_map_encoder *p)
{
    return p->count - p->n_earlier;
}

static void bound_chunk(void *arg, size_t chunk, uint32_t member)
{
    const struct bounds_task *bounds_task = arg;
    const struct orl_map_encoder *p = bounds_task->encoder;
    const size_t end = (chunk + 1) * CHUNK;
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    float brightest[3] = {0, 0, 0};
    (void)member;
    for (size_t i = chunk * CHUNK; i < end && i < new_photons(p); i++) {
        const struct orl_photon *photon = &p->photons[i];
        for (int k = 0; k < 3; k++) {
            const float at = photon->position[k], flux = photon->flux[k];
            low[k] = at < low[k] ? at : low[k];
            high[k] = at > high[k] ? at : high[k];
            brightest[k] = flux > brightest[k] ? flux : brightest[k];
        }
    }
    struct bounds b = nothing;
    for (int k = 0; k < 3; k++) {
        b.low[k] = (double)low[k];
        b.high[k] = (double)high[k];
        b.brightest = fmax(b.brightest, (double)brightest[k]);
    }
    bounds_task->chunks[chunk] = b;
}

/* Computes the bounds. Returns 0, ORL_ERR_NOMEM or an error of orl_parallel_try. */
static int bound_photons(const struct orl_map_encoder *p, struct orl_thread_pool *pool,
                         struct bounds *ret_bounds)
{
    const size_t chunks = (new_photons(p) + CHUNK - 1) / CHUNK;
    struct bounds_task bounds_task = {p, malloc((chunks + 1) * sizeof *bounds_task.chunks)};
    struct bounds b = nothing;
    if (!bounds_task.chunks)
        return ORL_ERR_NOMEM;
    const int code = orl_parallel_try(pool, chunks, bound_chunk, &bounds_task);
    for (size_t i = 0; i < chunks && code == 0; i++) {
        include_point(&b, bounds_task.chunks[i].low);
        include_point(&b, bounds_task.chunks[i].high);
        b.brightest = fmax(b.brightest, bounds_task.chunks[i].brightest);
    }
    free(bounds_task.chunks);
    if (code < 0)
        return code;
    for (int k = 0; k < 3; k++) { /* division keeps the order of the bounds */
        b.low[k] /= p->unit;
        b.high[k] /= p->unit;
    }
    for (size_t i = 0; i < p->n_earlier; i++) {
        double at[3];
        earlier_corner(p, i, at);
        include_point(&b, at);
    }
    if (p->count == 0)
        b = (struct bounds){{0, 0, 0}, {0, 0, 0}, 0};
    *ret_bounds = b;
    return 0;
}

static bool fits(const struct bounds *b, double step)
{
    bool fit = true;
    for (int k = 0; k < 3; k++)
        fit = fit && floor(b->high[k] / step) - floor(b->low[k] / step) < ORL_POSITION_CELLS;
    return fit;
}

static void choose_cells(struct orl_map_encoder *p, const struct bounds *b)
{
    p->step = 0x1p-32;
    if (p->n_earlier > 0)
        p->step = fmax(p->step, p->earlier->header->cell / p->unit);
    while (!fits(b, p->step) && isfinite(p->step))
        p->step *= 2;
    p->steps = 1 / p->step;
    p->cell = p->step * p->unit;
    for (int k = 0; k < 3; k++) {
        /* Adding zero turns -0 into +0: the sign could depend on the order of the photons. */
        p->first[k] = floor(b->low[k] / p->step) + 0.0;
        p->low[k] = p->first[k] * p->cell;
    }
}

static void choose_exponent(struct orl_map_encoder *p, double brightest)
{
    p->flux_exponent = orl_flux_least(brightest);
    if (p->n_earlier > 0 && p->earlier->header->flux_exponent > p->flux_exponent)
        p->flux_exponent = p->earlier->header->flux_exponent;
}

int orl_map_encode_init(struct orl_map_encoder *encoder, const struct orl_photon_map *earlier,
                        const struct orl_photon *photons, size_t n, uint64_t seed, double extent,
                        struct orl_thread_pool *pool)
{
    struct bounds bounds;
    *encoder = (struct orl_map_encoder){.earlier = earlier,
                                        .photons = photons,
                                        .n_earlier = earlier ? earlier->header->count : 0,
                                        .seed = seed,
                                        .unit = extent > 0 ? extent : 1};
    encoder->count = encoder->n_earlier + n;
    const int code = bound_photons(encoder, pool, &bounds);
    if (code < 0)
        return code;
    choose_cells(encoder, &bounds);
    choose_exponent(encoder, bounds.brightest);
    return 0;
}

/* floor() without a function call, for machines that have no instruction for it. */
static inline double floor_of(double x)
{
    if (!(fabs(x) < 0x1p62))
        return floor(x);
    const double whole = (double)(int64_t)x;
    return whole > x ? whole - 1 : whole;
}

static inline void cell_at(const struct orl_map_encoder *encoder, const double at[3],
                           uint32_t ret_cell[3])
{
    for (int k = 0; k < 3; k++)
        ret_cell[k] = (uint32_t)(int64_t)(floor_of(at[k] * encoder->steps) - encoder->first[k]);
}

void orl_map_encode_cell(const struct orl_map_encoder *encoder, size_t index, uint32_t ret_cell[3])
{
    double at[3];
    position_of(encoder, index, at);
    cell_at(encoder, at, ret_cell);
}

/* Rounds up or down at random, so that sums keep their means. The random number depends on the
 * photon only. */
static uint32_t new_flux(const struct orl_map_encoder *p, size_t index)
{
    const float *flux = p->photons[index - p->n_earlier].flux;
    struct orl_random random = orl_random_stream(p->seed, ORL_PURPOSE_DITHER, index);
    return orl_flux_pack_from((struct orl_rgb){flux[0], flux[1], flux[2]}, p->flux_exponent,
                              orl_random_uniform(&random));
}

struct orl_photon_words orl_map_encode_words(const struct orl_map_encoder *encoder, size_t index)
{
    const struct orl_photon_map *map = encoder->earlier;
    struct orl_photon_words words = {
        .normal = index < encoder->n_earlier ? encoder->earlier->normals[index]
                                             : encoder->photons[index - encoder->n_earlier].normal};
    uint32_t batch, cell[3];
    if (index < encoder->n_earlier) {
        const uint64_t word = index / ORL_MAP_LEAF * ORL_LEAF_WORDS + index % ORL_MAP_LEAF;
        const int coarser = encoder->flux_exponent - map->header->flux_exponent;
        batch = map->places[word] >> 20 & 15U;
        words.flux = orl_flux_coarsen(map->fluxes[index], coarser);
        words.tag = map->tags[index];
    } else {
        const struct orl_photon *photon = &encoder->photons[index - encoder->n_earlier];
        batch = photon->batch & 15U;
        words.flux = new_flux(encoder, index);
        words.tag = photon->tag;
    }
    orl_map_encode_cell(encoder, index, cell);
    words.a = cell[0] | batch << 20 | (cell[2] >> 12) << 24;
    words.b = cell[1] | (cell[2] & 0xfffU) << 20;
    return words;
}

/* Encoding of many photons at once: each step loops over all of them, so that it can be
 * vectorised. */

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
