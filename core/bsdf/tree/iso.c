#include "bsdf/tree/iso.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

/* Smallest radius of B: below it the azimuth is undefined, so the radius is raised to it. */
static const double radius_min = 1e-9;

struct orl_disk_polar orl_disk_polar_of(struct orl_vec3 d)
{
    const double radius = sqrt(d.x * d.x + d.y * d.y), azimuth = atan2(d.y, d.x);
    return (struct orl_disk_polar){radius > radius_min ? fmin(radius, 1)
                                                       : radius_min, /* also for NaN */
                                   isfinite(azimuth) ? azimuth : 0};
}

/* ---- Building ------------------------------------------------------------------------------- */

enum { CANVAS_SIDE = 1 << ORL_LIMIT_TREE_DEPTH, CANVAS_HALF = CANVAS_SIDE / 2 };

int orl_iso_init(struct orl_iso *iso, struct orl_error *err)
{
    memset(iso, 0, sizeof *iso);
    iso->finest_grid =
        calloc((size_t)CANVAS_HALF * CANVAS_SIDE * CANVAS_SIDE, sizeof *iso->finest_grid);
    if (!iso->finest_grid)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
    return 0;
}

/* Sets a cube of the finest grid to one value; skips the half to which no direction maps. */
static void fill_cube(struct orl_iso *iso, const unsigned low[3], unsigned side, float value)
{
    if (value == 0)
        return;
    for (unsigned a = low[0]; a < low[0] + side && a < CANVAS_HALF; a++)
        for (unsigned x = low[1]; x < low[1] + side; x++) {
            float *row = iso->finest_grid + ((size_t)a * CANVAS_SIDE + x) * CANVAS_SIDE + low[2];
            for (unsigned y = 0; y < side; y++)
                row[y] = value;
        }
}

void orl_iso_fill(struct orl_iso *iso, const unsigned place[3], unsigned level, const float *values,
                  unsigned log2_side)
{
    const unsigned depth = level + log2_side, side = CANVAS_SIDE >> depth;
    for (size_t i = 0; i < (size_t)1 << 3 * log2_side; i++) {
        unsigned low[3];
        for (unsigned axis = 0; axis < 3; axis++) {
            const unsigned within =
                (unsigned)(i >> (2 - axis) * log2_side) & ((1U << log2_side) - 1);
            low[axis] = ((place[axis] << log2_side) + within) * side;
        }
        fill_cube(iso, low, side, values[i]);
    }
    if (iso->depth < depth)
        iso->depth = depth;
}

/* Cells of ring k of the square, by side, counter-clockwise. */
struct ring {
    size_t corner[4]; /* cell where sides 0 and 1 meet, and so on */
    unsigned half, k;
};

static struct ring ring_of(unsigned half, unsigned k)
{
    const size_t n = 2 * (size_t)half, far = half + k, near = half - 1 - k;
    return (struct ring){{far * n + far, near * n + far, near * n + near, far * n + near}, half, k};
}

/* Returns cell m of the 2k cells of a side without its corners. Side 0 is at +x, where m increases
 * with +y. */
static size_t edge_cell(const struct ring *ring, unsigned side, unsigned m)
{
    const size_t n = 2 * (size_t)ring->half, far = ring->half + ring->k, near = n - 1 - far;
    const size_t up = ring->half - ring->k + m, down = n - 1 - up;
    const size_t cells[4] = {far * n + up, down * n + far, near * n + down, up * n + near};
    return cells[side];
}

/* Computes the sums for ring a of A. */
static void add_up_ring(struct orl_iso *iso, unsigned a)
{
    const size_t n = 2 * (size_t)iso->half;
    const float *values = iso->values + a * n * n;
    double sum = 0;
    for (size_t x = 0; x < n; x++) {
        for (size_t y = 0; y < n; y++) {
            sum += (double)values[x * n + y];
            iso->minimum = fminf(iso->minimum, values[x * n + y]);
        }
        iso->rows[a * n + x] = sum;
    }
    for (unsigned k = 0; k < iso->half; k++) {
        const struct ring ring = ring_of(iso->half, k);
        double edges = 0, corners = 0;
        for (unsigned side = 0; side < 4; side++) {
            corners += (double)values[ring.corner[side]];
            for (unsigned m = 0; m < 2 * k; m++)
                edges += (double)values[edge_cell(&ring, side, m)];
        }
        iso->edges[a * iso->half + k] = edges;
        iso->corners[a * iso->half + k] = corners;
    }
}

int orl_iso_finish(struct orl_iso *iso, struct orl_error *err)
{
    const unsigned depth = iso->depth > 0 ? iso->depth : 1, step = CANVAS_SIDE >> depth;
    const size_t half = (size_t)1 << (depth - 1), n = 2 * half;
    iso->half = (unsigned)half;
    iso->values = calloc(half * n * n, sizeof *iso->values);
    if (!iso->eval_only) {
        iso->rows = calloc(half * n, sizeof *iso->rows);
        iso->edges = calloc(half * half, sizeof *iso->edges);
        iso->corners = calloc(half * half, sizeof *iso->corners);
    }
    if (!iso->values || (!iso->eval_only && (!iso->rows || !iso->edges || !iso->corners)))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the tensor tree");
    for (size_t a = 0; a < half; a++)
        for (size_t i = 0; i < n * n; i++) /* the file counts rings from the horizon */
            iso->values[(half - 1 - a) * n * n + i] =
                iso->finest_grid[((a * CANVAS_SIDE + i / n) * CANVAS_SIDE + i % n) * step];
    free(iso->finest_grid);
    iso->finest_grid = NULL;
    iso->minimum = iso->values[0];
    for (unsigned a = 0; a < half && !iso->eval_only; a++)
        add_up_ring(iso, a);
    return 0;
}

void orl_iso_done(struct orl_iso *iso)
{
    free(iso->finest_grid);
    free(iso->values);
    free(iso->rows);
    free(iso->edges);
    free(iso->corners);
    memset(iso, 0, sizeof *iso);
}

size_t orl_iso_bytes(const struct orl_iso *iso)
{
    const size_t half = iso->half;
    return 4 * half * half * half * sizeof *iso->values +
           (iso->eval_only
                ? 0
                : 4 * half * half * sizeof *iso->rows); /* edges and corners: half^2 each */
}

/* ---- Reading -------------------------------------------------------------------------------- */

static unsigned ring_at(const struct orl_iso *iso, double radius)
{
    const double ring = radius * iso->half;
    return ring < iso->half ? (unsigned)ring : iso->half - 1;
}

/* Returns the cell of B, given its radius and its angle from the direction in which A's light
 * travels. */
static size_t cell_at(const struct orl_iso *iso, double radius, double angle)
{
    const unsigned k = ring_at(iso, radius);
    const struct ring ring = ring_of(iso->half, k);
    const double quarters = angle * (2 / ORL_PI), whole = floor(quarters + 0.5);
    const unsigned side = (unsigned)((int)whole & 3);
    const double along = floor(2 * (quarters - whole) * radius * iso->half) + k;
    if (along < 0)
        return ring.corner[(side + 3) & 3];
    if (along >= 2 * k)
        return ring.corner[side];
    return edge_cell(&ring, side, (unsigned)along);
}

static double value_at(const struct orl_iso *iso, unsigned a, size_t cell)
{
    return (double)iso->values[(size_t)a * 4 * iso->half * iso->half + cell];
}

unsigned orl_iso_ring(const struct orl_iso *iso, struct orl_disk_polar a)
{
    return ring_at(iso, a.radius);
}

size_t orl_iso_cell(const struct orl_iso *iso, struct orl_disk_polar a, struct orl_disk_polar b,
                    unsigned *ret_ring)
{
    *ret_ring = ring_at(iso, a.radius);
    return cell_at(iso, b.radius, b.azimuth - a.azimuth - ORL_PI);
}

double orl_iso_eval(const struct orl_iso *iso, struct orl_disk_polar a, struct orl_disk_polar b)
{
    unsigned ring;
    const size_t cell = orl_iso_cell(iso, a, b, &ring);
    return value_at(iso, ring, cell);
}

/* Shares of B's circle in an edge cell and in half a corner, in eighths of the circle. */
struct shares {
    double edge, corner;
};

static struct shares shares_of(const struct orl_iso *iso, double radius, unsigned k)
{
    const double in_cells = radius * iso->half;
    return (struct shares){1 / in_cells, k > 0 ? fmax(0, in_cells - k) / in_cells : 1};
}

/* Half the difference of squared sines over ring a: projected solid angle per unit of azimuth. */
static double ring_weight(const struct orl_iso *iso, unsigned a)
{
    return (a + 0.5) / ((double)iso->half * iso->half);
}

/* Returns the integral over ring a of A for a given B, without the factor of an eighth of a
 * circle. */
static double ring_integral(const struct orl_iso *iso, unsigned a, unsigned k, struct shares shares)
{
    const size_t i = (size_t)a * iso->half + k;
    return ring_weight(iso, a) *
           (shares.edge * iso->edges[i] + 2 * shares.corner * iso->corners[i]);
}

double orl_iso_total(const struct orl_iso *iso, enum orl_tree_axis given,
                     struct orl_disk_polar place)
{
    const unsigned ring = ring_at(iso, place.radius);
    const size_t n = 2 * (size_t)iso->half;
    const struct shares shares = shares_of(iso, place.radius, ring);
    double sum = 0;
    if (given == ORL_AXIS_A)
        return ORL_PI / (double)(n * n) * iso->rows[ring * n + n - 1];
    for (unsigned a = 0; a < iso->half; a++)
        sum += ring_integral(iso, a, ring, shares);
    return ORL_PI / 4 * sum;
}

static const double margin = 0x1p-30; /* distance of samples from borders, as in tree.c */

static double keep_inside(double u)
{
    return margin + fmin(1, fmax(0, u)) * (1 - 2 * margin);
}

static struct orl_vec3 rotate_azimuth(struct orl_vec3 d, double angle)
{
    const double c = cos(angle), s = sin(angle);
    return orl_v3(d.x * c - d.y * s, d.x * s + d.y * c, d.z);
}

/* Samples B for a given A: a row by its running sum, then a cell of it by linear search. */
static double draw_b(const struct orl_iso *iso, struct orl_disk_polar a, const double u[2],
                     struct orl_vec3 *ret_b)
{
    const unsigned ring = ring_at(iso, a.radius);
    const size_t n = 2 * (size_t)iso->half;
    const double *rows = iso->rows + ring * n;
    double t = u[0] * rows[n - 1], value = 0;
    size_t x = 0, last = 0;
    while (x + 1 < n && !(t < rows[x]))
        x++;
    t -= x > 0 ? rows[x - 1] : 0;
    for (size_t y = 0; y < n; y++) { /* if rounding leaves t at the end: the last lit cell */
        const double v = value_at(iso, ring, x * n + y);
        if (!(v > 0))
            continue;
        t -= value; /* value of the previous cell */
        value = v;
        last = y;
        if (t < v)
            break;
    }
    *ret_b = rotate_azimuth(orl_square_to_hemisphere((struct orl_square){
                                2 * ((double)x + keep_inside(t / value)) / (double)n - 1,
                                2 * ((double)last + keep_inside(u[1])) / (double)n - 1}),
                            a.azimuth + ORL_PI);
    return value;
}

/* Part of the ring of B: an edge cell, or one side's part of a corner cell. */
struct piece {
    double value, start, length; /* start and length along the side, which runs from -1 to 1 */
    unsigned side;
    size_t cell;
};

/* Returns piece i of 4 (2k + 2), counter-clockwise. */
static struct piece piece_at(const struct orl_iso *iso, unsigned a, const struct ring *ring,
                             struct shares shares, unsigned i)
{
    const unsigned per_side = 2 * ring->k + 2, side = i / per_side, m = i % per_side;
    struct piece piece = {0, 0, 0, side, 0};
    if (m == 0 || m == per_side - 1) {
        piece.cell = ring->corner[m == 0 ? (side + 3) & 3 : side];
        piece.start = m == 0 ? -1 : 1 - shares.corner;
        piece.length = shares.corner;
    } else {
        piece.cell = edge_cell(ring, side, m - 1);
        piece.start = ((double)m - 1 - ring->k) * shares.edge;
        piece.length = shares.edge;
    }
    piece.value = value_at(iso, a, piece.cell);
    return piece;
}

double orl_iso_integral_near(const struct orl_iso *iso, struct orl_disk_polar b, unsigned reach,
                             orl_iso_part part, const void *ctx)
{
    const struct ring ring = ring_of(iso->half, ring_at(iso, b.radius));
    const struct shares shares = shares_of(iso, b.radius, ring.k);
    const unsigned first = ring.k > reach ? ring.k - reach : 0;
    const unsigned last = ring.k + reach < iso->half ? ring.k + reach : iso->half - 1;
    /* Further out only the middle of side 0 is near; its cells m are pieces m + 1. */
    const bool all = ring.k <= reach;
    const unsigned low = all ? 0 : ring.k - reach;
    const unsigned high = all ? 4 * (2 * ring.k + 2) : ring.k + reach + 2;
    double sum = 0;
    for (unsigned a = first; a <= last; a++)
        for (unsigned i = low; i < high; i++) {
            const struct piece piece = piece_at(iso, a, &ring, shares, i);
            sum += ring_weight(iso, a) * piece.length * part(ctx, a, piece.cell, piece.value);
        }
    return ORL_PI / 4 * sum;
}

/* Samples A for a given B: its ring, then the piece that contains B, which gives A's azimuth. */
static double draw_a(const struct orl_iso *iso, struct orl_disk_polar b, const double u[2],
                     struct orl_vec3 *ret_a)
{
    const struct ring ring = ring_of(iso->half, ring_at(iso, b.radius));
    const struct shares shares = shares_of(iso, b.radius, ring.k);
    struct piece piece = {0, 0, 0, 0, 0};
    double t = u[0] * orl_iso_total(iso, ORL_AXIS_B, b) / (ORL_PI / 4), whole = 0, s, sine2, angle;
    unsigned chosen = 0;
    for (unsigned a = 0; a < iso->half; a++) {
        const double integral = ring_integral(iso, a, ring.k, shares);
        if (!(integral > 0))
            continue;
        t -= whole; /* integral of the previous ring */
        whole = integral;
        chosen = a;
        if (t < whole)
            break;
    }
    t = fmin(1, t / whole) * (whole / ring_weight(iso, chosen));
    for (unsigned i = 0; i < 4 * (2 * ring.k + 2); i++) {
        const struct piece next = piece_at(iso, chosen, &ring, shares, i);
        if (!(next.value * next.length > 0))
            continue;
        t -= piece.value * piece.length;
        piece = next;
        if (t < next.value * next.length)
            break;
    }
    s = piece.start + piece.length * keep_inside(t / (piece.value * piece.length));
    angle = b.azimuth - (ORL_PI / 2 * piece.side + ORL_PI / 4 * s) - ORL_PI;
    sine2 = ((double)chosen * chosen + keep_inside(u[1]) * (2.0 * chosen + 1)) /
            ((double)iso->half * iso->half);
    *ret_a = orl_v3(sqrt(sine2) * cos(angle), sqrt(sine2) * sin(angle), sqrt(1 - sine2));
    return piece.value;
}

double orl_iso_sample(const struct orl_iso *iso, enum orl_tree_axis given,
                      struct orl_disk_polar place, const double u[2],
                      struct orl_vec3 *ret_direction)
{
    return given == ORL_AXIS_A ? draw_b(iso, place, u, ret_direction)
                               : draw_a(iso, place, u, ret_direction);
}
