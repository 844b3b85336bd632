/* Reads a BSDF's file in place of measuring a panel: values of light from an incident cell, as
 * means over cells out. */
#include "bsdf/make/make_bsdf.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf/tree/shirley.h"

/* Largest correction of the total: a larger one means that points missed light, which scaling
 * cannot restore. */
static const double most_scale = 2;
enum { TURNS = 24, RINGS = 4 }; /* rank 3: points about the axis, and within a ring */

/* Returns the points along a side of a new cell, one for each old cell. side: new cells a side. */
static uint32_t points_for(const struct orl_bsdf *bsdf, uint32_t side, uint32_t least)
{
    enum { KLEMS_SIDE = 32, MOST_POINTS = 16 };
    struct orl_bsdf_info info;
    orl_bsdf_describe(bsdf, &info);
    const bool tree = info.kind[0] == 'T';
    const uint32_t old = tree ? (uint32_t)info.resolution : KLEMS_SIDE;
    const uint32_t points = tree ? old / side : 2;
    return points < least ? least : points > MOST_POINTS ? MOST_POINTS : points;
}

/* Returns the middle of the k-th of n by m parts of a unit square. */
struct stratum {
    double u, v;
};
static struct stratum stratum_middle(uint32_t k, uint32_t n, uint32_t m)
{
    const uint32_t row = k / n;
    return (struct stratum){(k % n + 0.5) / n, (row + 0.5) / m};
}

/* Returns the factor that makes the total equal to the old file's. */
static double scale_for(double albedo, double found)
{
    const double scale = found > 0 ? albedo / found : 1;
    return scale <= most_scale ? scale : 1;
}

/* ---- Trees ----------------------------------------------------------------------------------- */

/* Returns d turned about the axis by the azimuth of towards. */
static struct orl_vec3 rotate_azimuth(struct orl_vec3 d, struct orl_vec3 towards)
{
    const double r = hypot(towards.x, towards.y);
    if (!(r > 0))
        return d;
    const double c = towards.x / r, s = towards.y / r;
    return orl_v3(c * d.x - s * d.y, s * d.x + c * d.y, d.z);
}

/* Adds a share of the means over cells out, for light that travels along towards. */
static void add_beam(const struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf,
                     struct orl_vec3 towards, uint32_t points, double share,
                     struct orl_gonio_cells to)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const struct orl_vec3 in = orl_neg(towards);
    for (size_t i = 0; i < 2 * cells; i++) {
        const bool front = probe->front != (i >= cells);
        const double unit = share / (points * points);
        struct orl_rgb sum = orl_gray(0);
        for (uint32_t k = 0; k < points * points; k++) {
            const struct stratum at = stratum_middle(k, points, points);
            struct orl_vec3 out =
                orl_morton_direction((uint32_t)(i % cells), probe->levels, at.u, at.v);
            if (probe->rank == 3)
                out = rotate_azimuth(out, towards);
            if (!front)
                out.z = -out.z;
            sum = orl_rgb_add(sum, orl_bsdf_eval(bsdf, in, out));
        }
        to.nodes[i].value += (float)(unit * orl_luma(sum));
        if (!to.colors)
            continue;
        to.colors[i].value[0] += (float)(unit * sum.r);
        to.colors[i].value[1] += (float)(unit * sum.g);
        to.colors[i].value[2] += (float)(unit * sum.b);
    }
}

static void scale_to_albedo(struct orl_gonio_probe *probe, const double albedo[2],
                            struct orl_gonio_cells of)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    for (size_t t = 0; t < 2; t++) {
        double found = 0;
        for (size_t i = 0; i < cells; i++)
            found += (double)of.nodes[t * cells + i].value * ORL_PI / (double)cells;
        const double scale = scale_for(albedo[t], found);
        for (size_t i = t * cells; i < (t + 1) * cells; i++) {
            of.nodes[i].value *= (float)scale;
            for (int c = 0; of.colors && c < ORL_GONIO_COLORS; c++)
                of.colors[i].value[c] *= (float)scale;
        }
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            probe->totals[k][t] += scale * found;
    }
}

void orl_gonio_resample_cell(struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf, uint32_t a,
                             struct orl_gonio_cells ret_cells)
{
    const uint32_t points = points_for(bsdf, 1U << probe->levels, 1);
    const uint32_t across = probe->rank == 3 ? TURNS : points;
    const uint32_t along = probe->rank == 3 && points < RINGS ? RINGS : points;
    const double share = 1.0 / (along * across);
    double albedo[2] = {0, 0};
    for (size_t i = 0; i < 2 * orl_gonio_probe_cells(probe); i++) {
        ret_cells.nodes[i] = (struct orl_gonio_node){.value = 0};
        if (ret_cells.colors)
            ret_cells.colors[i] = (struct orl_gonio_color){.value = {0}};
    }
    for (uint32_t k = 0; k < along * across; k++) {
        const struct stratum at = stratum_middle(k, along, across);
        const double u[2] = {at.u, at.v};
        struct orl_vec3 towards = orl_gonio_probe_direction(probe, a, u);
        if (probe->front)
            towards.z = -towards.z;
        add_beam(probe, bsdf, towards, points, share, ret_cells);
        for (int t = 0; t < 2; t++)
            albedo[t] +=
                share * orl_luma(orl_bsdf_albedo(bsdf, orl_neg(towards),
                                                 t ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT));
    }
    scale_to_albedo(probe, albedo, ret_cells);
}

/* ---- Matrices -------------------------------------------------------------------------------- */

/* Cells out that overlap a cell of the grid on the square of directions, with shares. */
enum { MAX_OVERLAPS = 4, SUBDIVISIONS = 4 };
struct overlap {
    int cell[MAX_OVERLAPS];
    double share[MAX_OVERLAPS];
};

/* Parameters for reading a file: incident directions per cell; for a tree a grid on the square of
 * directions out, for a matrix points in each cell out. */
struct matrix_resampler {
    struct orl_gonio_histogram *histogram;
    const struct orl_bsdf *bsdf;
    size_t item;
    uint32_t points, side;    /* side: cells a side of the grid; 0: a matrix */
    struct overlap *overlaps; /* by cell of the grid; owned */
};

static void add_overlap(struct overlap *s, int cell, double share)
{
    int i = 0;
    while (i < MAX_OVERLAPS - 1 && s->share[i] > 0 && s->cell[i] != cell)
        i++;
    s->cell[i] = cell;
    s->share[i] += share;
}

static bool overlap_square(struct matrix_resampler *r)
{
    const size_t n = (size_t)r->side * r->side;
    r->overlaps = calloc(n, sizeof *r->overlaps);
    for (size_t i = 0; r->overlaps && i < n; i++)
        for (uint32_t k = 0; k < SUBDIVISIONS * SUBDIVISIONS; k++) {
            const struct stratum at = stratum_middle(k, SUBDIVISIONS, SUBDIVISIONS);
            const struct stratum of = stratum_middle((uint32_t)i, r->side, r->side);
            const struct orl_vec3 d = orl_square_to_hemisphere((struct orl_square){
                2 * (of.u + (at.u - 0.5) / r->side) - 1, 2 * (of.v + (at.v - 0.5) / r->side) - 1});
            const int cell = orl_basis_cell(&r->histogram->basis, orl_polar_of(d), 0);
            if (cell >= 0)
                add_overlap(&r->overlaps[i], cell, 1.0 / (SUBDIVISIONS * SUBDIVISIONS));
        }
    return r->overlaps != NULL;
}

/* Adds the shares of light from the direction in that are scattered to the cells on one side, by
 * the grid. */
static void add_by_squares(const struct matrix_resampler *r, struct orl_vec3 in, bool front,
                           struct orl_rgb *of)
{
    const uint32_t n = r->side * r->side;
    for (uint32_t i = 0; i < n; i++) {
        const struct stratum at = stratum_middle(i, r->side, r->side);
        struct orl_vec3 out =
            orl_square_to_hemisphere((struct orl_square){2 * at.u - 1, 2 * at.v - 1});
        if (!front)
            out.z = -out.z;
        const struct orl_rgb f = orl_bsdf_eval(r->bsdf, in, out);
        for (int k = 0; k < MAX_OVERLAPS && r->overlaps[i].share[k] > 0 && orl_rgb_max(f) > 0; k++)
            of[r->overlaps[i].cell[k]] = orl_rgb_add(
                of[r->overlaps[i].cell[k]], orl_rgb_scale(f, r->overlaps[i].share[k] * ORL_PI / n));
    }
}

/* Adds these shares by points in cells. */
static void add_points(const struct matrix_resampler *r, struct orl_vec3 in, bool front,
                       struct orl_rgb *of)
{
    const struct orl_basis *basis = &r->histogram->basis;
    const uint32_t n = r->points * r->points;
    for (int cell = 0; cell < basis->n_cells; cell++)
        for (uint32_t k = 0; k < n; k++) {
            const struct stratum at = stratum_middle(k, r->points, r->points);
            struct orl_vec3 out = orl_basis_direction(basis, cell, at.u, at.v);
            if (!front)
                out.z = -out.z;
            of[cell] =
                orl_rgb_add(of[cell], orl_rgb_scale(orl_bsdf_eval(r->bsdf, in, out),
                                                    orl_basis_ring(basis, cell)->omega_sr / n));
        }
}

/* Adds a share of the light from the direction in to the sums of all cells on one side. */
static void add_side(const struct matrix_resampler *r, struct orl_vec3 in, bool transmitted,
                     double share)
{
    const struct orl_gonio_histogram *histogram = r->histogram;
    const size_t cells = (size_t)histogram->basis.n_cells;
    double *sums = orl_gonio_histogram_sums(histogram, r->item, 0, transmitted);
    const bool front = (r->item >= cells) != transmitted;
    struct orl_rgb of[ORL_BASIS_CELLS_MAX];
    double found = 0;
    memset(of, 0, cells * sizeof *of);
    if (r->side > 0)
        add_by_squares(r, in, front, of);
    else
        add_points(r, in, front, of);
    for (size_t c = 0; c < cells; c++)
        found += orl_luma(of[c]);
    const double scale =
        share * scale_for(orl_luma(orl_bsdf_albedo(
                              r->bsdf, in, transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT)),
                          found);
    for (size_t c = 0; c < cells; c++) {
        double *sum = sums + c * histogram->channels;
        const struct orl_rgb f = orl_rgb_scale(of[c], scale);
        sum[0] += histogram->channels == 1 ? orl_luma(f) : f.r;
        if (histogram->channels > 1) {
            sum[1] += f.g;
            sum[2] += f.b;
        }
    }
}

/* Returns the cells a side of the grid: as many as a tree of rank 4 has, twice as many in rank 3,
 * whose cells turn with the incident light. */
static uint32_t side_of(const struct orl_bsdf *bsdf)
{
    struct orl_bsdf_info info;
    orl_bsdf_describe(bsdf, &info);
    return info.kind[0] != 'T'                     ? 0
           : strcmp(info.kind, "TensorTree4") == 0 ? (uint32_t)info.resolution
                                                   : 2 * (uint32_t)info.resolution;
}

int orl_gonio_resample_item(struct orl_gonio_histogram *histogram, const struct orl_bsdf *bsdf,
                            size_t item)
{
    enum { INS_OF_TREES = 6, POINTS = 3, LEAST_SIDE = 32 };
    const size_t cells = (size_t)histogram->basis.n_cells;
    struct matrix_resampler r = {.histogram = histogram,
                                 .bsdf = bsdf,
                                 .item = item,
                                 .points = POINTS,
                                 .side = side_of(bsdf)};
    if (r.side > 0 && r.side < LEAST_SIDE)
        r.side = LEAST_SIDE;
    const uint32_t ins = r.side > 0 ? INS_OF_TREES : POINTS;
    if (r.side > 0 && !overlap_square(&r))
        return ORL_ERR_NOMEM;
    for (uint32_t k = 0; k < ins * ins; k++) {
        const struct stratum at = stratum_middle(k, ins, ins);
        struct orl_vec3 towards =
            orl_basis_direction(&histogram->basis, (int)(item % cells), at.u, at.v);
        if (item >= cells)
            towards.z = -towards.z;
        for (int t = 0; t < 2; t++)
            add_side(&r, orl_neg(towards), t, 1.0 / (ins * ins));
    }
    for (int t = 0; t < 2; t++)
        for (size_t k = 1; k < ORL_GONIO_BATCHES; k++)
            memcpy(orl_gonio_histogram_sums(histogram, item, k, t),
                   orl_gonio_histogram_sums(histogram, item, 0, t),
                   cells * histogram->channels * sizeof(double));
    histogram->paths[item] = 1;
    free(r.overlaps);
    return 0;
}
