#include "bsdf/document.h"

#include <stdlib.h>
#include <string.h>

enum { REACH = 2, SPAN = 2 * REACH + 1, ISO_SPAN = 2 * REACH + 2, NEIGHBOURS_MAX = 32 };

static const double contrast = 8; /* largest ratio of the peak's mean to the value of a member */
static const double least_surround = 0.2; /* least surround, as a share of the peak's solid angle */
static const double least_share = 5e-4;   /* smallest peak, as a share of the light */

/* The straight cell and its neighbours, all of equal solid angle. */
struct group {
    double value[NEIGHBOURS_MAX]; /* 1/sr; negative: no such cell */
    bool fine[NEIGHBOURS_MAX];    /* true for a leaf of the finest size */
    unsigned count;
    uint32_t middle; /* bit of the straight cell; two bits in rank 3 */
    double cell_sr;
};

/* Sorts the existing cells by value, brightest first, equal ones by number. Returns their count. */
static unsigned sort_by_value(const struct group *g, unsigned char ret_order[NEIGHBOURS_MAX])
{
    unsigned count = 0;
    for (unsigned i = 0; i < g->count; i++) {
        unsigned place = count;
        if (!(g->value[i] >= 0))
            continue;
        for (; place > 0 && g->value[i] > g->value[ret_order[place - 1]]; place--)
            ret_order[place] = ret_order[place - 1];
        ret_order[place] = (unsigned char)i;
        count++;
    }
    return count;
}

/* Finds the members of the peak (document.h). Returns their bits, 0 if there is no peak. */
static uint32_t find_members(const struct group *g, double *ret_surround, double *ret_share)
{
    unsigned char order[NEIGHBOURS_MAX];
    const unsigned count = sort_by_value(g, order);
    uint32_t members = 0;
    double peak = 0, surround = 0;
    unsigned n_peak = 0, n_surround = 0;
    for (unsigned k = 0; k < count; k++) {
        const unsigned i = order[k];
        if (g->fine[i] && peak <= contrast * g->value[i] * n_peak) {
            members |= 1U << i;
            peak += g->value[i];
            n_peak++;
        } else {
            surround += g->value[i];
            n_surround++;
            if (g->middle >> i & 1)
                return 0;
        }
        if (n_peak == 0) /* the brightest cell is not of the finest size */
            return 0;
    }
    if ((members & g->middle) != g->middle || n_surround < least_surround * n_peak)
        return 0;
    *ret_surround = n_surround > 0 ? surround / n_surround : 0;
    *ret_share = (peak - n_peak * *ret_surround) * g->cell_sr;
    return *ret_share >= least_share ? members : 0;
}

static double excess_over(double value, double surround)
{
    return value > surround ? value - surround : 0;
}

/* Temporary sums of the peak's light in double, with colour. */
struct sums {
    struct orl_rgb *color[2]; /* NULL for B of rank 3 */
};

static int begin_peak(struct orl_peak *p, struct sums *sums, size_t cells, bool both)
{
    p->members = calloc(cells, sizeof *p->members);
    p->surround = calloc(cells, sizeof *p->surround);
    bool ok = p->members && p->surround;
    p->cells = cells;
    for (int axis = 0; axis < (both ? 2 : 1); axis++) {
        p->share[axis] = calloc(cells, sizeof *p->share[axis]);
        sums->color[axis] = calloc(cells, sizeof *sums->color[axis]);
        ok = ok && p->share[axis] && sums->color[axis];
    }
    return ok ? 0 : ORL_ERR_NOMEM;
}

/* Converts sums to shares and tints; frees the peak if it is empty everywhere. */
static int finish_peak(struct orl_peak *p, struct sums *sums, bool colored, int code)
{
    for (int axis = 0; axis < 2 && code == 0; axis++) {
        if (!sums->color[axis])
            continue;
        if (colored)
            p->tint[axis] = malloc(p->cells * sizeof *p->tint[axis]);
        if (colored && !p->tint[axis])
            code = ORL_ERR_NOMEM;
        for (size_t i = 0; i < p->cells && code == 0; i++) {
            const double luma = orl_luma(sums->color[axis][i]);
            p->share[axis][i] = (float)luma;
            p->greatest[axis] = fmaxf(p->greatest[axis], (float)luma);
            if (colored)
                p->tint[axis][i] = luma > 0 ? orl_tint_of_rgb(sums->color[axis][i]) : orl_tint_gray;
        }
    }
    free(sums->color[0]);
    free(sums->color[1]);
    if (code < 0 || !(p->greatest[ORL_AXIS_A] > 0))
        orl_peak_done(p);
    return code;
}

/* ---- Trees of rank 4 ------------------------------------------------------------------------- */

/* Returns the middle of a cell. sign is -1 for A, whose direction points to where the light comes
 * from. */
static struct orl_square middle_of(unsigned x, unsigned y, unsigned depth, double sign)
{
    const double width = 2.0 / (1U << depth);
    return (struct orl_square){sign * ((x + 0.5) * width - 1), sign * ((y + 0.5) * width - 1)};
}

/* Finds neighbour k of a cell. Returns false beyond the border of the square. */
static bool neighbour(unsigned x, unsigned y, unsigned k, unsigned depth, unsigned *ret_x,
                      unsigned *ret_y)
{
    const int nx = (int)x + (int)(k % SPAN) - REACH, ny = (int)y + (int)(k / SPAN) - REACH;
    const int side = 1 << depth;
    *ret_x = (unsigned)nx;
    *ret_y = (unsigned)ny;
    return nx >= 0 && ny >= 0 && nx < side && ny < side;
}

static void read_neighbours(const struct orl_tree *tree, unsigned x, unsigned y, struct group *g)
{
    *g = (struct group){.count = SPAN * SPAN,
                        .middle = 1U << (REACH * SPAN + REACH),
                        .cell_sr = ORL_PI / (double)((size_t)1 << 2 * tree->depth)};
    const struct orl_tree_window window = {.a_x = x,
                                           .a_y = y,
                                           .low_x = (int)x - REACH,
                                           .low_y = (int)y - REACH,
                                           .side = SPAN,
                                           .values = g->value,
                                           .finest = g->fine};
    for (unsigned k = 0; k < g->count; k++)
        g->value[k] = -1;
    orl_tree_read_window(tree, &window);
}

static void add_tree_cell(struct orl_component *c, struct sums *sums, unsigned x, unsigned y)
{
    const unsigned depth = c->tree.depth;
    const size_t cell = (size_t)x << depth | y;
    struct orl_peak *p = &c->peak;
    struct group g;
    double surround, share;
    /* One look-up excludes straight cells that are coarse or black, which most are. */
    const struct orl_coords a = {.square = middle_of(x, y, depth, -1)};
    unsigned level;
    if (!(orl_tree_eval_level(&c->tree, a.square, middle_of(x, y, depth, 1), &level) > 0) ||
        level < depth)
        return;
    read_neighbours(&c->tree, x, y, &g);
    p->members[cell] = find_members(&g, &surround, &share);
    if (!p->members[cell])
        return;
    p->surround[cell] = (float)surround;
    for (unsigned k = 0; k < g.count; k++) {
        unsigned nx, ny;
        if (!(p->members[cell] >> k & 1) || !neighbour(x, y, k, depth, &nx, &ny))
            continue;
        const struct orl_coords b = {.square = middle_of(nx, ny, depth, 1)};
        const struct orl_rgb part =
            orl_tinted(orl_chroma_tint(ORL_STRUCTURE_TREE4, c, &a, &b),
                       excess_over(g.value[k], (double)p->surround[cell]) * g.cell_sr);
        sums->color[ORL_AXIS_A][cell] = orl_rgb_add(sums->color[ORL_AXIS_A][cell], part);
        struct orl_rgb *other = &sums->color[ORL_AXIS_B][(size_t)nx << depth | ny];
        *other = orl_rgb_add(*other, part);
    }
}

static int make_tree(struct orl_component *c)
{
    const unsigned side = 1U << c->tree.depth;
    struct sums sums = {{NULL, NULL}};
    const int code = begin_peak(&c->peak, &sums, (size_t)side * side, true);
    for (unsigned x = 0; x < side && code == 0; x++)
        for (unsigned y = 0; y < side; y++)
            add_tree_cell(c, &sums, x, y);
    return finish_peak(&c->peak, &sums, c->chroma.present, code);
}

/* ---- Trees of rank 3 ------------------------------------------------------------------------- */

/*
 * Returns the bit of a cell of B for ring a of A, or -1. The straight direction lies on the +x axis
 * of the square, between two cells. Bit dy * SPAN + dx is column half + a - REACH + dx, row half -
 * 1 - REACH + dy.
 */
static int iso_bit(const struct orl_iso *iso, unsigned a, size_t cell)
{
    const int n = 2 * (int)iso->half, half = (int)iso->half;
    const int dx = (int)cell / n - (half + (int)a) + REACH, dy = (int)cell % n - half + 1 + REACH;
    return dx >= 0 && dx < SPAN && dy >= 0 && dy < ISO_SPAN ? dy * SPAN + dx : -1;
}

static bool iso_cell(const struct orl_iso *iso, unsigned a, unsigned bit, size_t *ret_cell)
{
    const int n = 2 * (int)iso->half, half = (int)iso->half;
    const int x = half + (int)a - REACH + (int)bit % SPAN, y = half - 1 - REACH + (int)bit / SPAN;
    *ret_cell = (size_t)x * (size_t)n + (size_t)y;
    return x >= 0 && y >= 0 && x < n && y < n;
}

/* Coordinates of B in the middle of a cell, for A's light travelling along +x. */
static struct orl_coords iso_coords(const struct orl_iso *iso, size_t cell)
{
    const size_t n = 2 * (size_t)iso->half, x = cell / n, y = cell % n;
    const struct orl_square middle = {((double)x + 0.5) / iso->half - 1,
                                      ((double)y + 0.5) / iso->half - 1};
    return (struct orl_coords){.disk = orl_disk_polar_of(orl_square_to_hemisphere(middle))};
}

static void add_ring(struct orl_component *c, struct sums *sums, unsigned a)
{
    const struct orl_iso *iso = &c->iso;
    const size_t n = 2 * (size_t)iso->half;
    struct orl_peak *p = &c->peak;
    struct group g = {.count = SPAN * ISO_SPAN,
                      .middle = 1U << (REACH * SPAN + REACH) | 1U << ((REACH + 1) * SPAN + REACH),
                      .cell_sr = ORL_PI / (double)(n * n)};
    double surround, share;
    size_t cell;
    for (unsigned k = 0; k < g.count; k++) {
        g.fine[k] = true;
        g.value[k] = iso_cell(iso, a, k, &cell) ? (double)iso->values[a * n * n + cell] : -1;
    }
    p->members[a] = find_members(&g, &surround, &share);
    if (!p->members[a])
        return;
    p->surround[a] = (float)surround;
    for (unsigned k = 0; k < g.count; k++) {
        if (!(p->members[a] >> k & 1) || !iso_cell(iso, a, k, &cell))
            continue;
        const struct orl_coords from = {.disk = {(a + 0.5) / iso->half, ORL_PI}};
        const struct orl_coords b = iso_coords(iso, cell);
        sums->color[ORL_AXIS_A][a] =
            orl_rgb_add(sums->color[ORL_AXIS_A][a],
                        orl_tinted(orl_chroma_tint(ORL_STRUCTURE_TREE3, c, &from, &b),
                                   excess_over(g.value[k], (double)p->surround[a]) * g.cell_sr));
    }
}

static int make_iso(struct orl_component *c)
{
    struct sums sums = {{NULL, NULL}};
    const int code = begin_peak(&c->peak, &sums, c->iso.half, false);
    for (unsigned a = 0; a < c->iso.half && code == 0; a++)
        add_ring(c, &sums, a);
    return finish_peak(&c->peak, &sums, c->chroma.present, code);
}

/* ---- Matrices -------------------------------------------------------------------------------- */

/* Returns the mean over cells near the straight one, weighted by solid angle; negative if there are
 * too few. */
static double mean_about(const struct orl_matrix *m, int cell, double reach)
{
    const struct orl_basis *basis = &m->basis[ORL_AXIS_B];
    const struct orl_vec3 middle = orl_basis_direction(basis, cell, 0.5, 0.5);
    double sum = 0, omega = 0;
    for (int k = 0; k < basis->n_cells; k++) {
        const struct orl_vec3 d = orl_basis_direction(basis, k, 0.5, 0.5);
        const double one = orl_basis_ring(basis, k)->omega_sr;
        if (k == cell || hypot(d.x - middle.x, d.y - middle.y) > reach)
            continue;
        sum += one * (double)m->values[(ptrdiff_t)cell * basis->n_cells + k];
        omega += one;
    }
    return omega > least_surround * orl_basis_ring(basis, cell)->omega_sr ? sum / omega : -1;
}

static int make_matrix(struct orl_component *c)
{
    const struct orl_matrix *m = &c->matrix;
    const int cells = m->basis[ORL_AXIS_A].n_cells;
    struct orl_peak *p = &c->peak;
    struct sums sums = {{NULL, NULL}};
    if (!orl_matrix_is_square(m))
        return 0;
    const int code = begin_peak(p, &sums, (size_t)cells, true);
    for (int i = 0; i < cells && code == 0; i++) {
        const double omega = orl_basis_ring(&m->basis[ORL_AXIS_B], i)->omega_sr;
        const ptrdiff_t index = (ptrdiff_t)i * cells + i;
        const double value = (double)m->values[index];
        const double surround = mean_about(m, i, 2.4 * sqrt(omega));
        if (surround < 0 || !(value > contrast * surround) ||
            !((value - surround) * omega >= least_share))
            continue;
        p->members[i] = 1;
        p->surround[i] = (float)surround;
        const struct orl_tint tint = c->chroma.present ? c->chroma.values[index] : orl_tint_gray;
        sums.color[ORL_AXIS_A][i] = sums.color[ORL_AXIS_B][i] =
            orl_tinted(tint, excess_over(value, (double)p->surround[i]) * omega);
    }
    return finish_peak(p, &sums, c->chroma.present, code);
}

/* ---- The whole ------------------------------------------------------------------------------- */

int orl_peak_make(enum orl_structure structure, struct orl_component *component,
                  struct orl_error *err)
{
    int code;
    if (structure == ORL_STRUCTURE_TREE4)
        code = make_tree(component);
    else
        code = structure == ORL_STRUCTURE_TREE3 ? make_iso(component) : make_matrix(component);
    return code < 0 ? orl_error_set(err, code, "out of memory for the BSDF's peak") : 0;
}

void orl_peak_done(struct orl_peak *peak)
{
    free(peak->members);
    free(peak->surround);
    for (int axis = 0; axis < 2; axis++) {
        free(peak->share[axis]);
        free(peak->tint[axis]);
    }
    memset(peak, 0, sizeof *peak);
}

size_t orl_peak_bytes(const struct orl_peak *peak)
{
    size_t each = sizeof *peak->members + sizeof *peak->surround;
    for (int axis = 0; axis < 2; axis++)
        each += (peak->share[axis] ? sizeof *peak->share[axis] : 0) +
                (peak->tint[axis] ? sizeof *peak->tint[axis] : 0);
    return peak->cells * each;
}

/* Returns the bit of B's cell and sets the cell of A; -1 if the pair is not near straight. */
static int bit_of(enum orl_structure structure, const struct orl_component *c,
                  const struct orl_coords *a, const struct orl_coords *b, size_t *ret_cell)
{
    if (structure == ORL_STRUCTURE_TREE4) {
        const unsigned depth = c->tree.depth;
        const size_t cell = orl_square_cell(ORL_AXIS_A, a->square, depth);
        const size_t other = orl_square_cell(ORL_AXIS_B, b->square, depth);
        const size_t mask = ((size_t)1 << depth) - 1;
        const int dx = (int)(other >> depth) - (int)(cell >> depth) + REACH;
        const int dy = (int)(other & mask) - (int)(cell & mask) + REACH;
        *ret_cell = cell;
        return dx >= 0 && dy >= 0 && dx < SPAN && dy < SPAN ? dy * SPAN + dx : -1;
    }
    if (structure == ORL_STRUCTURE_TREE3) {
        unsigned ring;
        const size_t cell = orl_iso_cell(&c->iso, a->disk, b->disk, &ring);
        *ret_cell = ring;
        return iso_bit(&c->iso, ring, cell);
    }
    const int cell = orl_matrix_cell(&c->matrix, ORL_AXIS_A, a->polar);
    *ret_cell = (size_t)cell;
    return cell >= 0 && cell == orl_matrix_cell(&c->matrix, ORL_AXIS_B, b->polar) ? 0 : -1;
}

double orl_peak_part(enum orl_structure structure, const struct orl_component *component,
                     const struct orl_coords *a, const struct orl_coords *b, double value)
{
    const struct orl_peak *p = &component->peak;
    size_t cell;
    if (p->cells == 0)
        return 0;
    const int bit = bit_of(structure, component, a, b, &cell);
    if (bit < 0 || !(p->members[cell] >> bit & 1))
        return 0;
    return excess_over(value, (double)p->surround[cell]);
}

/* Returns the peak's part of a value of rank 3, for the integral given B. */
static double iso_part(const void *ctx, unsigned ring, size_t cell, double value)
{
    const struct orl_component *c = ctx;
    const int bit = iso_bit(&c->iso, ring, cell);
    if (bit < 0 || !(c->peak.members[ring] >> bit & 1))
        return 0;
    return excess_over(value, (double)c->peak.surround[ring]);
}

/* Returns the index of a given direction in share; negative if it has none. */
static ptrdiff_t share_index(enum orl_structure structure, const struct orl_component *c,
                             enum orl_tree_axis given, const struct orl_coords *coords)
{
    if (structure == ORL_STRUCTURE_TREE4)
        return (ptrdiff_t)orl_square_cell(given, coords->square, c->tree.depth);
    if (structure == ORL_STRUCTURE_TREE3)
        return (ptrdiff_t)orl_iso_ring(&c->iso, coords->disk);
    return orl_matrix_cell(&c->matrix, given, coords->polar);
}

double orl_peak_total(enum orl_structure structure, const struct orl_component *component,
                      enum orl_tree_axis given, const struct orl_coords *coords)
{
    const struct orl_peak *p = &component->peak;
    if (p->cells == 0)
        return 0;
    if (structure == ORL_STRUCTURE_TREE3 && given == ORL_AXIS_B)
        return orl_iso_integral_near(&component->iso, coords->disk, REACH, iso_part, component);
    const ptrdiff_t index = share_index(structure, component, given, coords);
    return index < 0 ? 0 : (double)p->share[given][index];
}

struct orl_rgb orl_peak_color(enum orl_structure structure, const struct orl_component *component,
                              enum orl_tree_axis given, const struct orl_coords *coords)
{
    const struct orl_peak *p = &component->peak;
    if (p->cells == 0)
        return orl_gray(0);
    const ptrdiff_t index = share_index(structure, component, given, coords);
    if (index < 0)
        return orl_gray(0);
    return orl_tinted(p->tint[given] ? p->tint[given][index] : orl_tint_gray,
                      (double)p->share[given][index]);
}
