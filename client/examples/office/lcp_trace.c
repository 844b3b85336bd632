/*
 * Monte Carlo through the panel.
 *
 * A ray that enters through a face is bent to at most asin(1/n) off the normal, 42 degrees for
 * acrylic, and so meets every cut at 48 degrees or more: beyond the critical angle. Cuts are thus
 * perfect mirrors for all light, only turn y around, and the path unfolds into a straight line
 * across equally spaced cuts. How many it crosses on its m-th way through the slab depends on where
 * it entered between two cuts; only the parity matters. The faces are treated with Fresnel's
 * equations, each polarisation for itself.
 */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "lcp.h"

static const double pi = 3.14159265358979323846;

struct vec {
    double x, y, z;
};

/* ---- Random numbers ----------------------------------------------------------------------------
 */

/* SplitMix64 (Steele, Lea and Flood 2014), one stream per incident cell. */
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static double uniform(uint64_t *state)
{
    return (double)(next_bits(state) >> 11) * 0x1p-53;
}

static uint64_t stream_for(uint64_t seed, uint32_t cell)
{
    uint64_t state = seed;
    state = next_bits(&state) + cell;
    return next_bits(&state);
}

/* ---- Square and hemisphere ---------------------------------------------------------------------
 */

/* Square coordinates from -1 to 1 to the unit vector above the disk. */
static struct vec to_hemisphere(double a, double b)
{
    const bool sideways = fabs(a) >= fabs(b);
    const double r = sideways ? a : b, other = sideways ? b : a;
    const double angle = r != 0 ? pi / 4 * other / r : 0;
    const double along = r * cos(angle), across = r * sin(angle);
    const double z = sqrt(fmax(0, (1 - r) * (1 + r)));
    return sideways ? (struct vec){along, across, z} : (struct vec){across, along, z};
}

static uint32_t coordinate(double s, uint32_t side)
{
    const double c = (0.5 + 0.5 * s) * side;
    return c < side ? (uint32_t)fmax(c, 0) : side - 1;
}

/* Spreads 8 bits to the even places. */
static uint32_t spread(uint32_t v)
{
    v = (v | v << 4) & 0x0f0f;
    v = (v | v << 2) & 0x3333;
    return (v | v << 1) & 0x5555;
}

static uint32_t gather(uint32_t v)
{
    v &= 0x5555;
    v = (v | v >> 1) & 0x3333;
    v = (v | v >> 2) & 0x0f0f;
    return (v | v >> 4) & 0x00ff;
}

/* The Morton index of the cell that a direction falls into. */
static uint32_t cell_of(struct vec d, unsigned levels)
{
    const double r = sqrt(d.x * d.x + d.y * d.y);
    const bool sideways = fabs(d.x) >= fabs(d.y);
    const double major = copysign(r, sideways ? d.x : d.y);
    const double minor = r > 0 ? major * (4 / pi) * atan(sideways ? d.y / d.x : d.x / d.y) : 0;
    const uint32_t x = coordinate(sideways ? major : minor, 1U << levels);
    const uint32_t y = coordinate(sideways ? minor : major, 1U << levels);
    return spread(x) | spread(y) << 1;
}

/* ---- Optics ------------------------------------------------------------------------------------
 */

/* Fresnel reflectance of a face for both polarisations; cosines outside and inside. */
static void fresnel(double outside, double inside, double n, double ret_r[2])
{
    const double s = (outside - n * inside) / (outside + n * inside);
    const double p = (n * outside - inside) / (n * outside + inside);
    ret_r[0] = s * s;
    ret_r[1] = p * p;
}

/* Scatters d about itself by a Gaussian of this root mean square angle, on its own side. */
static struct vec blur(struct vec d, double rms_rad, uint64_t *rng)
{
    /* A frame about d, after Duff et al. 2017; z is positive here. */
    const double a = -1 / (1 + d.z), b = d.x * d.y * a;
    const struct vec u = {1 + d.x * d.x * a, b, -d.x}, v = {b, 1 + d.y * d.y * a, -d.y};
    for (int i = 0; i < 100; i++) {
        const double angle = 2 * pi * uniform(rng);
        const double length = rms_rad * sqrt(-log(1 - uniform(rng)));
        const double p = length * cos(angle), q = length * sin(angle);
        const struct vec e = {d.x + p * u.x + q * v.x, d.y + p * u.y + q * v.y,
                              d.z + p * u.z + q * v.z};
        const double scale = 1 / sqrt(e.x * e.x + e.y * e.y + e.z * e.z);
        if (e.z > 0)
            return (struct vec){e.x * scale, e.y * scale, e.z * scale};
    }
    return d;
}

/*
 * Where the i-th ray of a cell starts: within the cell, and between two cuts. An additive
 * recurrence (Roberts 2018) spreads the rays evenly over all three, which keeps the flux that
 * leaves towards each direction even as well, and so the sums over either direction below 1.
 */
static void start_of(uint32_t i, const double shift[3], double ret_u[3])
{
    static const double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    for (int k = 0; k < 3; k++) {
        const double u = shift[k] + i * step[k];
        ret_u[k] = u - floor(u);
    }
}

/* What one incident cell sends to each outgoing cell: shares of the flux that arrived. */
struct tally {
    double *share[2]; /* reflected, transmitted */
    unsigned levels;
};

static void deposit(struct tally *tally, bool transmitted, struct vec d, double weight,
                    const struct lcp_settings *s, uint64_t *rng)
{
    const struct vec out = blur(d, s->blur_deg * pi / 180, rng);
    tally->share[transmitted][cell_of(out, tally->levels)] += weight;
}

/*
 * Follows one ray with all its reflections between the faces; d is where it travels, z > 0, and y
 * its place between two cuts, 0 to 1.
 */
static void follow(struct tally *tally, struct vec d, double y, double flux,
                   const struct lcp_settings *s, uint64_t *rng)
{
    const double n = s->index;
    const double inside = sqrt(1 - (1 - d.z * d.z) / (n * n));
    const double step = s->aspect * (fabs(d.y) / n) / inside; /* cuts met per way through */
    const double survival = exp(-s->absorption / inside);
    double r[2], weight[2];
    fresnel(d.z, inside, n, r);
    for (int p = 0; p < 2; p++)
        weight[p] = 0.5 * flux * (1 - r[p]);
    deposit(tally, false, d, 0.5 * flux * (r[0] + r[1]), s, rng);
    for (bool front = false;; front = !front) {
        double leaving = 0, staying = 0;
        struct vec out = d;
        y += step;
        if ((int64_t)floor(y) & 1)
            out.y = -d.y;
        for (int p = 0; p < 2; p++) {
            leaving += weight[p] * survival * (1 - r[p]);
            weight[p] *= survival * r[p];
            staying += weight[p];
        }
        deposit(tally, !front, out, leaving, s, rng);
        if (staying < 0.02 * flux) { /* roulette: one in ten goes on, for all ten */
            if (uniform(rng) >= 0.1)
                return;
            weight[0] *= 10;
            weight[1] *= 10;
        }
    }
}

/* ---- Cells -------------------------------------------------------------------------------------
 */

static void trace_cell(struct tally *tally, uint32_t cell, const struct lcp_settings *s)
{
    const size_t cells = (size_t)1 << 2 * s->levels;
    const double width = 2.0 / (1U << s->levels);
    uint64_t rng = stream_for(s->seed, cell);
    double shift[3];
    for (int k = 0; k < 3; k++)
        shift[k] = uniform(&rng);
    for (int side = 0; side < 2; side++)
        memset(tally->share[side], 0, cells * sizeof **tally->share);
    for (uint32_t i = 0; i < s->rays; i++) {
        double u[3];
        struct vec d;
        start_of(i, shift, u);
        d = to_hemisphere((gather(cell) + u[0]) * width - 1,
                          (gather(cell >> 1) + u[1]) * width - 1);
        if (d.z > 0)
            follow(tally, d, u[2], 1.0 / s->rays, s, &rng);
    }
}

/* The key of a pair of cells: their bits in turn, two and two. */
static uint32_t key_of(uint32_t a, uint32_t b, unsigned levels)
{
    uint32_t key = 0;
    for (unsigned l = 0; l < levels; l++)
        key |= (a >> 2 * l & 3) << 4 * l | (b >> 2 * l & 3) << (4 * l + 2);
    return key;
}

static int append(struct lcp_tensor *tensor, struct lcp_cell cell)
{
    if (tensor->count == tensor->capacity) {
        const size_t capacity = tensor->capacity ? 2 * tensor->capacity : 65536;
        struct lcp_cell *cells = realloc(tensor->cells, capacity * sizeof *cells);
        if (!cells)
            return -1;
        tensor->cells = cells;
        tensor->capacity = capacity;
    }
    tensor->cells[tensor->count++] = cell;
    return 0;
}

/*
 * Turns shares into values: a cell of the square spans pi / cells of projected solid angle. The
 * panel is reciprocal and mirror-symmetric, which makes the value of (a, b) that of (b, a), turned
 * into the traced quarter: half goes to each, and their sum is reciprocal to the last bit.
 */
static int collect(struct lcp_tensor *tensor, const double *share, uint32_t a, unsigned levels)
{
    const uint32_t cells = 1U << 2 * levels;
    for (uint32_t b = 0; b < cells; b++) {
        const uint32_t turn = (b >> (2 * levels - 2)) * (0x5555U & (cells - 1));
        const float half = (float)(0.5 * share[b] * cells / pi);
        if (half > 0 &&
            (append(tensor, (struct lcp_cell){key_of(a, b, levels), half}) < 0 ||
             append(tensor, (struct lcp_cell){key_of(b ^ turn, a ^ turn, levels), half}) < 0))
            return -1;
    }
    return 0;
}

static int by_key(const void *left, const void *right)
{
    const uint32_t a = ((const struct lcp_cell *)left)->key;
    const uint32_t b = ((const struct lcp_cell *)right)->key;
    return (a > b) - (a < b);
}

static int by_key_and_value(const void *left, const void *right)
{
    const float a = ((const struct lcp_cell *)left)->value;
    const float b = ((const struct lcp_cell *)right)->value;
    const int order = by_key(left, right);
    return order ? order : (a > b) - (a < b);
}

/* Sorts the cells and adds up those of one key, in an order that depends on nothing else. */
static void merge(struct lcp_tensor *tensor)
{
    size_t kept = 0;
    if (tensor->count == 0)
        return;
    qsort(tensor->cells, tensor->count, sizeof *tensor->cells, by_key_and_value);
    for (size_t i = 1; i < tensor->count; i++) {
        if (tensor->cells[i].key == tensor->cells[kept].key)
            tensor->cells[kept].value += tensor->cells[i].value;
        else
            tensor->cells[++kept] = tensor->cells[i];
    }
    tensor->count = kept + 1;
}

int lcp_trace(const struct lcp_settings *s, struct lcp_tensor *ret_transmission,
              struct lcp_tensor *ret_reflection)
{
    const size_t cells = (size_t)1 << 2 * s->levels;
    struct tally tally = {{calloc(cells, sizeof(double)), calloc(cells, sizeof(double))},
                          s->levels};
    struct lcp_tensor tensor[2] = {{NULL, 0, 0}, {NULL, 0, 0}};
    int code = tally.share[0] && tally.share[1] ? 0 : -1;
    /* The panel looks the same from left and right, from above and below: a quarter will do. */
    for (uint32_t a = 0; a < cells / 4 && code == 0; a++) {
        trace_cell(&tally, a, s);
        for (int side = 0; side < 2 && code == 0; side++)
            code = collect(&tensor[side], tally.share[side], a, s->levels);
    }
    for (int side = 0; side < 2; side++) {
        merge(&tensor[side]);
        free(tally.share[side]);
    }
    if (code < 0) {
        free(tensor[0].cells);
        free(tensor[1].cells);
        return code;
    }
    *ret_reflection = tensor[0];
    *ret_transmission = tensor[1];
    return 0;
}
