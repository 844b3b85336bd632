/* Colour of BSDF values (tints), and the colour of one component made of them. */
#include "bsdf/document.h"

#include <stdlib.h>
#include <string.h>

/* Shares of red, green and blue in the luminance; their sum is 1. */
struct shares {
    double r, g, b;
};

enum { STEPS = 65535 };

/* Shares within this distance of white are white: chromaticities are printed with at least four
 * digits. */
static const double gray_tolerance = 2e-5;
/* Colours further outside the triangle are counted; less can come from printing and rounding. */
static const double outside_tolerance = 1e-3;

/* X and Z of a primary of luminance 1. */
struct primary {
    double x, z;
};
#define PRIMARY(cx, cy)                                                                            \
    {                                                                                              \
        (cx) / (cy), (1 - (cx) - (cy)) / (cy)                                                      \
    }
static const struct primary red = PRIMARY(0.640, 0.330), green = PRIMARY(0.290, 0.600),
                            blue = PRIMARY(0.150, 0.060);

static struct orl_tint encode_tint(struct shares s)
{
    const double sum = s.r + s.g + s.b;
    double r = nearbyint(s.r / sum * STEPS), b = nearbyint(s.b / sum * STEPS);
    /* Green has the rest, which is exactly 0 if its share is 0. */
    if (!(s.g > 0))
        b = STEPS - r;
    return (struct orl_tint){(uint32_t)r << 16 | (uint32_t)fmin(b, STEPS - r)};
}

static struct orl_tint tint_of_shares(struct shares s, size_t *outside)
{
    if (fabs(s.r - ORL_LUMA_R) < gray_tolerance && fabs(s.g - ORL_LUMA_G) < gray_tolerance &&
        fabs(s.b - ORL_LUMA_B) < gray_tolerance)
        return orl_tint_gray;
    *outside += fmin(s.r, fmin(s.g, s.b)) < -outside_tolerance;
    return encode_tint((struct shares){fmax(s.r, 0), fmax(s.g, 0), fmax(s.b, 0)});
}

/*
 * Shares of white that the equations below give for X = Y = Z. They differ by 1e-4 from ORL_LUMA_R,
 * _G and _B, which define luma everywhere else. Shares are rescaled so that white is white by
 * those.
 */
static const struct shares white = {0.26510582010582012, 0.67010582010582009, 0.064788359788359784};

/* Solves two equations for red and blue; green's share is 1 minus theirs. */
struct orl_tint orl_tint_of_xyz(double x, double y, double z, size_t *outside)
{
    const double dx = x / y - green.x, dz = z / y - green.z;
    const double rx = red.x - green.x, rz = red.z - green.z;
    const double bx = blue.x - green.x, bz = blue.z - green.z;
    const double d = rx * bz - bx * rz;
    const double r = (dx * bz - bx * dz) / d, b = (rx * dz - dx * rz) / d;
    return tint_of_shares((struct shares){r * (ORL_LUMA_R / white.r),
                                          (1 - r - b) * (ORL_LUMA_G / white.g),
                                          b * (ORL_LUMA_B / white.b)},
                          outside);
}

/* Returns the tint of a chromaticity u', v'. An invalid one (v' not positive) gives grey. */
static struct orl_tint tint_of_uv(double u, double v, size_t *outside)
{
    if (!(v > 0))
        return orl_tint_gray;
    return orl_tint_of_xyz(2.25 * u / v, 1, (3 - 0.75 * u - 5 * v) / v, outside);
}

struct orl_tint orl_tint_of_rgb(struct orl_rgb c)
{
    const double luma = orl_luma(c);
    size_t none = 0;
    return tint_of_shares(
        (struct shares){ORL_LUMA_R * c.r / luma, ORL_LUMA_G * c.g / luma, ORL_LUMA_B * c.b / luma},
        &none);
}

struct orl_rgb orl_tint_rgb(struct orl_tint tint)
{
    const uint32_t r = tint.code >> 16, b = tint.code & 0xffff;
    if (tint.code == orl_tint_gray.code)
        return orl_gray(1);
    return (struct orl_rgb){r / (STEPS * ORL_LUMA_R), (STEPS - r - b) / (STEPS * ORL_LUMA_G),
                            b / (STEPS * ORL_LUMA_B)};
}

void orl_color_xz(struct orl_rgb c, double *ret_x, double *ret_z)
{
    const struct shares s = {white.r * c.r, white.g * c.g, white.b * c.b};
    const double sum = s.r + s.g + s.b, unit = sum > 0 ? orl_luma(c) / sum : 0;
    *ret_x = unit * (s.r * red.x + s.g * green.x + s.b * blue.x);
    *ret_z = unit * (s.r * red.z + s.g * green.z + s.b * blue.z);
}

void orl_color_uv(struct orl_rgb c, double *ret_u, double *ret_v)
{
    const double y = orl_luma(c);
    double x, z;
    orl_color_xz(c, &x, &z);
    *ret_u = y > 0 ? 4 * x / (x + 15 * y + 3 * z) : 4.0 / 19;
    *ret_v = y > 0 ? 9 * y / (x + 15 * y + 3 * z) : 9.0 / 19;
}

static int fail_no_memory(struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF's colour");
}

static struct orl_tint tint_or_gray(struct orl_rgb sum)
{
    return orl_luma(sum) > 0 ? orl_tint_of_rgb(sum) : orl_tint_gray;
}

static void add_tinted(struct orl_rgb *sum, struct orl_tint tint, double luminance)
{
    *sum = orl_rgb_add(*sum, orl_tinted(tint, luminance));
}

/* ---- Matrices -------------------------------------------------------------------------------- */

static int sum_up_matrix(struct orl_chroma *c, const struct orl_matrix *m, enum orl_tree_axis given,
                         struct orl_error *err)
{
    const struct orl_basis *own = &m->basis[given], *other = &m->basis[1 - given];
    const size_t columns = (size_t)m->basis[ORL_AXIS_B].n_cells;
    c->total[given] = malloc((size_t)own->n_cells * sizeof *c->total[given]);
    if (!c->total[given])
        return fail_no_memory(err);
    for (int i = 0; i < own->n_cells; i++) {
        struct orl_rgb sum = orl_gray(0);
        for (int k = 0; k < other->n_cells; k++) {
            const size_t a = (size_t)(given == ORL_AXIS_A ? i : k);
            const size_t b = (size_t)(given == ORL_AXIS_A ? k : i);
            add_tinted(&sum, c->values[a * columns + b],
                       (double)m->values[a * columns + b] * orl_basis_ring(other, k)->omega_sr);
        }
        c->total[given][i] = tint_or_gray(sum);
    }
    return 0;
}

static int finish_matrix(struct orl_chroma *c, const struct orl_matrix *m, size_t *outside,
                         struct orl_error *err)
{
    const size_t count =
        (size_t)m->basis[ORL_AXIS_A].n_cells * (size_t)m->basis[ORL_AXIS_B].n_cells;
    int code = 0;
    if (!orl_matrix_is_alike(m, &c->matrix[0]) || !orl_matrix_is_alike(m, &c->matrix[1]))
        return 0;
    c->values = malloc(count * sizeof *c->values);
    if (!c->values)
        return fail_no_memory(err);
    for (size_t i = 0; i < count; i++)
        c->values[i] = m->values[i] > 0
                           ? orl_tint_of_xyz((double)c->matrix[0].values[i], (double)m->values[i],
                                             (double)c->matrix[1].values[i], outside)
                           : orl_tint_gray;
    for (int given = 0; given < 2 && code == 0; given++)
        code = sum_up_matrix(c, m, (enum orl_tree_axis)given, err);
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++)
        orl_matrix_done(&c->matrix[k]);
    c->present = code == 0;
    c->n_values = count;
    c->cells = (size_t)(m->basis[0].n_cells > m->basis[1].n_cells ? m->basis[0].n_cells
                                                                  : m->basis[1].n_cells);
    return code;
}

/* ---- Trees of rank 4 ------------------------------------------------------------------------- */

/* Traverses the trees of luminance and of both chromaticities together, down to where all have
 * leaves. */
struct joint {
    const struct orl_tree *tree[3];
    struct orl_rgb *sums[2]; /* given A, given B: level after level, 4^level cells each */
    size_t outside;
};

/* A cube of cells at some level: its cell on either square, and the three subtrees. */
struct cube {
    struct orl_tree_ref ref[3];
    unsigned level, x[2], y[2];
};

static size_t level_start(unsigned level)
{
    return (((size_t)1 << 2 * level) - 1) / 3;
}

static void join_trees(struct joint *j, const struct cube *cube)
{
    bool leaves = true;
    for (int t = 0; t < 3; t++)
        leaves = leaves && orl_tree_is_leaf(cube->ref[t]);
    if (leaves) {
        const double y = (double)orl_tree_leaf_value(cube->ref[0]);
        const double share = ldexp(y, -2 * (int)cube->level);
        if (!(y > 0))
            return;
        const struct orl_tint tint =
            tint_of_uv((double)orl_tree_leaf_value(cube->ref[1]),
                       (double)orl_tree_leaf_value(cube->ref[2]), &j->outside);
        for (int axis = 0; axis < 2; axis++)
            add_tinted(&j->sums[axis][level_start(cube->level) +
                                      ((size_t)cube->x[axis] << cube->level | cube->y[axis])],
                       tint, share);
        return;
    }
    if (orl_tree_is_leaf(cube->ref[0]) && !(orl_tree_leaf_value(cube->ref[0]) > 0))
        return;
    for (unsigned i = 0; i < ORL_TREE_FANOUT; i++) {
        struct cube part = {.level = cube->level + 1,
                            .x = {2 * cube->x[0] + (i & 1), 2 * cube->x[1] + (i >> 2 & 1)},
                            .y = {2 * cube->y[0] + (i >> 1 & 1), 2 * cube->y[1] + (i >> 3)}};
        for (int t = 0; t < 3; t++)
            part.ref[t] = orl_tree_is_leaf(cube->ref[t])
                              ? cube->ref[t]
                              : orl_tree_child(j->tree[t], cube->ref[t], i);
        join_trees(j, &part);
    }
}

/* Adds each cell's sum to its four quarters at the next level. Quarters are not weighted: the
 * integral is over the other direction. */
static void push_down(struct orl_rgb *sums, unsigned depth)
{
    for (unsigned level = 0; level < depth; level++)
        for (unsigned x = 0; x < 2U << level; x++)
            for (unsigned y = 0; y < 2U << level; y++) {
                struct orl_rgb *child =
                    &sums[level_start(level + 1) + ((size_t)x << (level + 1) | y)];
                *child = orl_rgb_add(
                    *child, sums[level_start(level) + ((size_t)(x >> 1) << level | y >> 1)]);
            }
}

static int finish_tree(struct orl_chroma *c, const struct orl_tree *tree, size_t *outside,
                       struct orl_error *err)
{
    struct joint j = {.tree = {tree, &c->tree[0], &c->tree[1]}};
    struct cube whole = {.level = 0};
    int code = 0;
    for (int t = 0; t < 3; t++) {
        c->depth = j.tree[t]->depth > c->depth ? j.tree[t]->depth : c->depth;
        whole.ref[t] = j.tree[t]->root;
    }
    const size_t cells = (size_t)1 << 2 * c->depth;
    for (int axis = 0; axis < 2; axis++) {
        j.sums[axis] = calloc(level_start(c->depth + 1), sizeof *j.sums[axis]);
        c->total[axis] = malloc(cells * sizeof *c->total[axis]);
    }
    if (!j.sums[0] || !j.sums[1] || !c->total[0] || !c->total[1]) {
        code = fail_no_memory(err);
        goto done;
    }
    join_trees(&j, &whole);
    for (int axis = 0; axis < 2; axis++) {
        push_down(j.sums[axis], c->depth);
        for (size_t i = 0; i < cells; i++)
            c->total[axis][i] = tint_or_gray(j.sums[axis][level_start(c->depth) + i]);
    }
    *outside += j.outside;
    c->cells = cells;
    c->present = true;
done:
    free(j.sums[0]);
    free(j.sums[1]);
    return code;
}

/* ---- Trees of rank 3 ------------------------------------------------------------------------- */

/* Returns the value of a grid at cell (a, x, y) of a finer grid of `half` rings. */
static double value_at_cell(const struct orl_iso *iso, unsigned half, size_t a, size_t x, size_t y)
{
    const size_t step = half / iso->half, n = 2 * (size_t)iso->half;
    return (double)iso->values[(a / step * n + x / step) * n + y / step];
}

static int finish_iso(struct orl_chroma *c, const struct orl_iso *iso, size_t *outside,
                      struct orl_error *err)
{
    unsigned half = iso->half;
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++)
        half = c->iso[k].half > half ? c->iso[k].half : half;
    c->total[ORL_AXIS_A] = malloc(half * sizeof *c->total[ORL_AXIS_A]);
    if (!c->total[ORL_AXIS_A])
        return fail_no_memory(err);
    const size_t side = 2 * (size_t)half;
    for (size_t a = 0; a < half; a++) {
        struct orl_rgb sum = orl_gray(0);
        for (size_t i = 0; i < side * side; i++) {
            const size_t x = i / side, y = i % side;
            const double luminance = value_at_cell(iso, half, a, x, y);
            if (luminance > 0)
                add_tinted(&sum,
                           tint_of_uv(value_at_cell(&c->iso[0], half, a, x, y),
                                      value_at_cell(&c->iso[1], half, a, x, y), outside),
                           luminance);
        }
        c->total[ORL_AXIS_A][a] = tint_or_gray(sum);
    }
    c->cells = c->rings = half;
    c->present = true;
    return 0;
}

/* ---- The whole ------------------------------------------------------------------------------- */

int orl_chroma_finish(enum orl_structure structure, struct orl_component *component,
                      size_t *outside, struct orl_error *err)
{
    struct orl_chroma *c = &component->chroma;
    int code = 0;
    if (!c->given[0] && !c->given[1])
        return 0;
    if (c->given[0] && c->given[1]) {
        if (structure == ORL_STRUCTURE_TREE4)
            code = finish_tree(c, &component->tree, outside, err);
        else if (structure == ORL_STRUCTURE_TREE3)
            code = finish_iso(c, &component->iso, outside, err);
        else
            code = finish_matrix(c, &component->matrix, outside, err);
    }
    if (!c->present) {
        const bool given[ORL_CHROMA_CHANNELS] = {c->given[0], c->given[1]};
        orl_chroma_done(c);
        memcpy(c->given, given, sizeof given);
    }
    return code;
}

void orl_chroma_done(struct orl_chroma *chroma)
{
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++) {
        orl_tree_done(&chroma->tree[k]);
        orl_iso_done(&chroma->iso[k]);
        orl_matrix_done(&chroma->matrix[k]);
        free(chroma->total[k]);
    }
    free(chroma->values);
    memset(chroma, 0, sizeof *chroma);
}

size_t orl_chroma_bytes(const struct orl_chroma *chroma)
{
    size_t bytes = chroma->n_values * sizeof *chroma->values;
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++) {
        bytes += chroma->tree[k].n_lines * sizeof *chroma->tree[k].lines +
                 orl_iso_bytes(&chroma->iso[k]);
        if (chroma->total[k])
            bytes += chroma->cells * sizeof **chroma->total;
    }
    return bytes;
}

struct orl_tint orl_chroma_tint(enum orl_structure structure, const struct orl_component *component,
                                const struct orl_coords *a, const struct orl_coords *b)
{
    const struct orl_chroma *c = &component->chroma;
    size_t counted = 0;
    ptrdiff_t index;
    if (!c->present)
        return orl_tint_gray;
    if (structure == ORL_STRUCTURE_TREE4)
        return tint_of_uv(orl_tree_eval(&c->tree[0], a->square, b->square),
                          orl_tree_eval(&c->tree[1], a->square, b->square), &counted);
    if (structure == ORL_STRUCTURE_TREE3)
        return tint_of_uv(orl_iso_eval(&c->iso[0], a->disk, b->disk),
                          orl_iso_eval(&c->iso[1], a->disk, b->disk), &counted);
    index = orl_matrix_index(&component->matrix, a->polar, b->polar);
    return index < 0 ? orl_tint_gray : c->values[index];
}

struct orl_tint orl_chroma_total(enum orl_structure structure,
                                 const struct orl_component *component, enum orl_tree_axis given,
                                 const struct orl_coords *coords)
{
    const struct orl_chroma *c = &component->chroma;
    if (!c->present)
        return orl_tint_gray;
    if (structure == ORL_STRUCTURE_TREE4)
        return c->total[given][orl_square_cell(given, coords->square, c->depth)];
    if (structure == ORL_STRUCTURE_TREE3) {
        const double ring = coords->disk.radius * c->rings;
        return c->total[ORL_AXIS_A][ring < c->rings ? (size_t)ring : c->rings - 1];
    }
    const int cell = orl_matrix_cell(&component->matrix, given, coords->polar);
    return cell < 0 ? orl_tint_gray : c->total[given][cell];
}
