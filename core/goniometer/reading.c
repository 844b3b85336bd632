#include "goniometer/reading.h"

#include <math.h>
#include <string.h>

#include "bsdf/shirley.h"

/* Scales beyond that are of light that points between missed: they would not mend it. */
static const double least_scale = 0.5, most_scale = 2;
enum { TURNS = 24, RINGS = 4 }; /* about the axis, and within a ring; of rank 3 */

/* Points along either side of a new cell that has so many of them in a hemisphere's width, for
 * every cell of the old one. */
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

/* The middle of the k-th of n by m parts of a unit square, along the first and the other side. */
struct middle {
    double u, v;
};
static struct middle middle_of(uint32_t k, uint32_t n, uint32_t m)
{
    const uint32_t row = k / n;
    return (struct middle){(k % n + 0.5) / n, (row + 0.5) / m};
}

/* What the light in all comes to: it is the old file's. */
static double scale_for(double albedo, double found)
{
    const double scale = found > 0 ? albedo / found : 1;
    return scale >= least_scale && scale <= most_scale ? scale : 1;
}

/* ---- Trees ----------------------------------------------------------------------------------- */

static uint32_t even_bits(uint32_t v)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 16; i++)
        bits |= (v >> 2 * i & 1) << i;
    return bits;
}

/* Where light leaves to by a cell out, z > 0. */
static struct orl_vec3 leaving(const struct orl_gonio_probe *probe, uint32_t cell, double u,
                               double v)
{
    const double side = 1U << probe->levels;
    return orl_square_to_hemisphere((struct orl_square){2 * (even_bits(cell) + u) / side - 1,
                                                        2 * (even_bits(cell >> 1) + v) / side - 1});
}

/* Turned as what comes is turned from +x. */
static struct orl_vec3 turned(struct orl_vec3 d, struct orl_vec3 towards)
{
    const double r = hypot(towards.x, towards.y);
    if (!(r > 0))
        return d;
    const double c = towards.x / r, s = towards.y / r;
    return orl_v3(c * d.x - s * d.y, s * d.x + c * d.y, d.z);
}

/* Adds a share of the mean over cells out, of light that travels that way. */
static void add_beam(const struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf,
                     struct orl_vec3 towards, uint32_t points, double share,
                     struct orl_gonio_node *nodes)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const struct orl_vec3 in = orl_neg(towards);
    for (size_t i = 0; i < 2 * cells; i++) {
        const bool front = probe->front != (i >= cells);
        double sum = 0;
        for (uint32_t k = 0; k < points * points; k++) {
            const struct middle at = middle_of(k, points, points);
            struct orl_vec3 out = leaving(probe, (uint32_t)(i % cells), at.u, at.v);
            if (probe->rank == 3)
                out = turned(out, towards);
            if (!front)
                out.z = -out.z;
            sum += orl_luma(orl_bsdf_eval(bsdf, in, out));
        }
        nodes[i].value += (float)(share * sum / (points * points));
    }
}

static void settle(struct orl_gonio_probe *probe, const double albedo[2],
                   struct orl_gonio_node *nodes)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    for (size_t t = 0; t < 2; t++) {
        double found = 0;
        for (size_t i = 0; i < cells; i++)
            found += (double)nodes[t * cells + i].value * ORL_PI / (double)cells;
        const double scale = scale_for(albedo[t], found);
        for (size_t i = 0; i < cells; i++)
            nodes[t * cells + i].value *= (float)scale;
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            probe->totals[k][t] += scale * found;
    }
}

void orl_gonio_read_cell(struct orl_gonio_probe *probe, const struct orl_bsdf *bsdf, uint32_t a,
                         struct orl_gonio_node *ret_nodes)
{
    const uint32_t points = points_for(bsdf, 1U << probe->levels, 1);
    const uint32_t across = probe->rank == 3 ? TURNS : points;
    const uint32_t along = probe->rank == 3 && points < RINGS ? RINGS : points;
    const double share = 1.0 / (along * across);
    double albedo[2] = {0, 0};
    for (size_t i = 0; i < 2 * orl_gonio_probe_cells(probe); i++)
        ret_nodes[i] = (struct orl_gonio_node){.value = 0};
    for (uint32_t k = 0; k < along * across; k++) {
        const struct middle at = middle_of(k, along, across);
        const double u[2] = {at.u, at.v};
        struct orl_vec3 towards = orl_gonio_probe_travel(probe, a, u);
        if (probe->front)
            towards.z = -towards.z;
        add_beam(probe, bsdf, towards, points, share, ret_nodes);
        for (int t = 0; t < 2; t++)
            albedo[t] +=
                share * orl_luma(orl_bsdf_albedo(bsdf, orl_neg(towards),
                                                 t ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT));
    }
    settle(probe, albedo, ret_nodes);
}

/* ---- Matrices -------------------------------------------------------------------------------- */

/* The mean of f from a direction to a cell out. */
static struct orl_rgb cell_mean(const struct orl_basis *basis, const struct orl_bsdf *bsdf,
                                struct orl_vec3 in, bool front, int cell, uint32_t points)
{
    struct orl_rgb sum = orl_gray(0);
    for (uint32_t k = 0; k < points * points; k++) {
        const struct middle at = middle_of(k, points, points);
        struct orl_vec3 out = orl_basis_direction(basis, cell, at.u, at.v);
        if (!front)
            out.z = -out.z;
        sum = orl_rgb_add(sum, orl_bsdf_eval(bsdf, in, out));
    }
    return orl_rgb_scale(sum, 1.0 / (points * points));
}

/* Adds what a beam of so much light sends to all cells on one side. */
static void add_side(struct orl_gonio_sheet *sheet, const struct orl_bsdf *bsdf, size_t item,
                     struct orl_vec3 in, bool transmitted, uint32_t points, double share)
{
    const size_t cells = (size_t)sheet->basis.n_cells;
    double *sums = orl_gonio_sheet_sums(sheet, item, 0, transmitted);
    const bool front = (item >= cells) != transmitted;
    double found = 0;
    struct orl_rgb of[ORL_BASIS_CELLS_MAX];
    for (int c = 0; c < (int)cells; c++) {
        of[c] = orl_rgb_scale(cell_mean(&sheet->basis, bsdf, in, front, c, points),
                              share * orl_basis_ring(&sheet->basis, c)->omega_sr);
        found += orl_luma(of[c]);
    }
    const double albedo =
        share *
        orl_luma(orl_bsdf_albedo(bsdf, in, transmitted ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT));
    const double scale = scale_for(albedo, found);
    for (size_t c = 0; c < cells; c++) {
        double *sum = sums + c * sheet->channels;
        const struct orl_rgb f = orl_rgb_scale(of[c], scale);
        sum[0] += sheet->channels == 1 ? orl_luma(f) : f.r;
        if (sheet->channels > 1) {
            sum[1] += f.g;
            sum[2] += f.b;
        }
    }
}

void orl_gonio_read_item(struct orl_gonio_sheet *sheet, const struct orl_bsdf *bsdf, size_t item)
{
    enum { IN_LEAST = 3, OUT_LEAST = 3, WIDTH = 8 };
    const size_t cells = (size_t)sheet->basis.n_cells;
    const uint32_t ins = points_for(bsdf, WIDTH, IN_LEAST),
                   outs = points_for(bsdf, WIDTH, OUT_LEAST);
    for (uint32_t k = 0; k < ins * ins; k++) {
        const struct middle at = middle_of(k, ins, ins);
        struct orl_vec3 towards =
            orl_basis_direction(&sheet->basis, (int)(item % cells), at.u, at.v);
        if (item >= cells)
            towards.z = -towards.z;
        for (int t = 0; t < 2; t++)
            add_side(sheet, bsdf, item, orl_neg(towards), t, outs, 1.0 / (ins * ins));
    }
    for (int t = 0; t < 2; t++)
        for (size_t k = 1; k < ORL_GONIO_BATCHES; k++)
            memcpy(orl_gonio_sheet_sums(sheet, item, k, t), orl_gonio_sheet_sums(sheet, item, 0, t),
                   cells * sheet->channels * sizeof(double));
    sheet->paths[item] = 1;
}
