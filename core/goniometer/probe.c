#include "goniometer/probe.h"

#include <stdlib.h>
#include <string.h>

#include "bsdf/shirley.h"

static size_t planes(const struct orl_gonio_probe *probe)
{
    return probe->color ? 1 + ORL_GONIO_HUES : 1;
}

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe) * planes(probe);
    probe->sums = calloc(ORL_GONIO_BATCHES * cells, sizeof *probe->sums);
    probe->before = calloc(cells, sizeof *probe->before);
    probe->heaviest = calloc(cells, sizeof *probe->heaviest);
    return probe->sums && probe->before && probe->heaviest
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
}

void orl_gonio_probe_done(struct orl_gonio_probe *probe)
{
    free(probe->sums);
    free(probe->before);
    free(probe->heaviest);
    probe->sums = probe->before = NULL;
    probe->heaviest = NULL;
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static uint32_t even_bits(uint32_t v)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 16; i++)
        bits |= (v >> 2 * i & 1) << i;
    return bits;
}

static uint32_t spread_bits(uint32_t v)
{
    uint32_t bits = 0;
    for (unsigned i = 0; i < 16; i++)
        bits |= (v >> i & 1) << 2 * i;
    return bits;
}

static uint32_t coordinate(double s, uint32_t side)
{
    const double c = (0.5 + 0.5 * s) * side;
    return c > 0 ? (c < side ? (uint32_t)c : side - 1) : 0;
}

static uint32_t cell_of(const struct orl_gonio_probe *probe, double x, double y)
{
    const struct orl_square s = orl_disk_to_square(x, y);
    const uint32_t side = 1U << probe->levels;
    return spread_bits(coordinate(s.x, side)) | spread_bits(coordinate(s.y, side)) << 1;
}

struct orl_vec3 orl_gonio_probe_travel(const struct orl_gonio_probe *probe, uint32_t a,
                                       const double u[2])
{
    const double side = 1U << probe->levels;
    if (probe->rank == 4) {
        const double x = (even_bits(a) + u[0]) / side, y = (even_bits(a >> 1) + u[1]) / side;
        return orl_square_to_hemisphere((struct orl_square){2 * x - 1, 2 * y - 1});
    }
    const double outer = 1 - 2 * a / side, inner = 1 - 2 * (a + 1) / side;
    const double r2 = inner * inner + u[0] * (outer * outer - inner * inner), r = sqrt(r2);
    return orl_v3(r * cos(2 * ORL_PI * u[1]), r * sin(2 * ORL_PI * u[1]), sqrt(1 - r2));
}

/* ---- Counting -------------------------------------------------------------------------------- */

/* Least distance below the axis, so that rounding cannot move a direction across it. */
static const double least_away = 1e-9;

struct shot {
    struct orl_gonio_probe *probe;
    size_t batch;
    double cosine, sine; /* rotation of the incident light to +x; rank 3 */
};

/* Adds a share of the light that left on a side. */
static void add_share(const struct shot *shot, bool transmitted, uint32_t cell, double share,
                      struct orl_rgb color)
{
    const struct orl_gonio_probe *p = shot->probe;
    const size_t cells = orl_gonio_probe_cells(p), at = transmitted * cells + cell;
    const double weights[] = {orl_luma(color), color.r, color.g, color.b};
    for (size_t k = 0; k < planes(p); k++) {
        p->sums[(k * ORL_GONIO_BATCHES + shot->batch) * 2 * cells + at] += share * weights[k];
    }
    p->heaviest[at] = fmaxf(p->heaviest[at], (float)(share * weights[0]));
}

static void count_exit(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct shot *shot = ctx;
    struct orl_gonio_probe *p = shot->probe;
    const double weight = orl_luma(exit->weight);
    const struct orl_vec3 d = exit->direction;
    if (exit->end == ORL_GONIO_GIVEN_UP || !isfinite(weight)) {
        p->lost += isfinite(weight) ? weight : 1;
        return;
    }
    const bool transmitted = exit->front != p->front;
    if (p->rank == 4) {
        add_share(shot, transmitted, cell_of(p, d.x, d.y), 1, exit->weight);
        return;
    }
    /* Straight light lies on the border of two cells; each counts half of it. */
    const double x = shot->cosine * d.x + shot->sine * d.y;
    const double y = shot->cosine * d.y - shot->sine * d.x;
    add_share(shot, transmitted, cell_of(p, x, fabs(y)), 0.5, exit->weight);
    add_share(shot, transmitted, cell_of(p, x, -fmax(fabs(y), least_away)), 0.5, exit->weight);
}

static void send_path(struct orl_gonio_probe *p, uint32_t a, size_t batch, uint32_t index)
{
    const uint64_t set = (p->paths_before > 0 ? 2U : 0U) + p->front;
    const uint64_t item = set * (uint64_t)orl_gonio_probe_cells(p) + a;
    const uint64_t stream = item * ORL_GONIO_BATCHES + batch;
    struct orl_gonio_numbers numbers = {
        .sobol = p->sobol,
        .index = index,
        .seed = (uint32_t)orl_mix64(p->seed ^ orl_mix64(stream + 1)),
        .random =
            orl_random_stream(p->seed, ORL_PURPOSE_GONIOMETER, stream << 32 | (uint64_t)index)};
    struct shot shot = {p, batch, 1, 0};
    double u[4];
    orl_sobol_point(p->sobol, index, numbers.seed, 4, u);
    struct orl_vec3 towards = orl_gonio_probe_travel(p, a, u);
    const double r = hypot(towards.x, towards.y);
    if (p->rank == 3 && r > 0) {
        shot.cosine = towards.x / r;
        shot.sine = towards.y / r;
    }
    if (p->front)
        towards.z = -towards.z;
    orl_gonio_follow(
        p->sample, orl_path_from(orl_gonio_cell_place(&p->sample->cell, p->front, u + 2), towards),
        &numbers, count_exit, &shot);
}

void orl_gonio_probe_send(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to)
{
    enum { AT_ONCE = 1024 };
    for (size_t batch = 0; batch < ORL_GONIO_BATCHES; batch++)
        for (uint32_t index = from; index < to; index++) {
            if (index % AT_ONCE == 0 && orl_is_cancelled(probe->cancel))
                return;
            send_path(probe, a, batch, index);
        }
}

/* ---- Results -------------------------------------------------------------------------------- */

/* Returns the variance of the mean of a set of batches. */
static double variance_of(const double values[ORL_GONIO_BATCHES])
{
    double sum = 0, squares = 0;
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        sum += values[k];
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        const double off = values[k] - sum / ORL_GONIO_BATCHES;
        squares += off * off;
    }
    return squares / (ORL_GONIO_BATCHES * (ORL_GONIO_BATCHES - 1.0));
}

/* Returns the mean of a cell's counts in a plane, including those put aside; ret_batches: counts of
 * the present batches. */
static double counted(const struct orl_gonio_probe *probe, size_t plane, size_t i,
                      double ret_batches[ORL_GONIO_BATCHES])
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe);
    double sum = probe->before[plane * cells + i];
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        ret_batches[k] = probe->sums[(plane * ORL_GONIO_BATCHES + k) * cells + i];
        sum += ret_batches[k];
    }
    return sum / ORL_GONIO_BATCHES;
}

/* value: factor from counts to values. told: share of the paths in the present batches, which alone
 * give the errors. */
struct unit {
    double value, told;
};

static struct orl_gonio_hue hue_of(const struct orl_gonio_probe *probe, size_t i, struct unit unit,
                                   double luma, const double lumas[ORL_GONIO_BATCHES])
{
    struct orl_gonio_hue hue = {.value = {0}};
    for (size_t c = 0; c < ORL_GONIO_HUES; c++) {
        double off[ORL_GONIO_BATCHES];
        const double mean = counted(probe, 1 + c, i, off);
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            off[k] -= mean / luma * lumas[k];
        hue.value[c] = (float)(mean * unit.value);
        hue.noise[c] = (float)(variance_of(off) / unit.told * unit.value * unit.value);
    }
    return hue;
}

void orl_gonio_probe_tell(const struct orl_gonio_probe *probe, uint32_t paths,
                          struct orl_gonio_cells ret_cells)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const double all = (double)paths + probe->paths_before;
    const struct unit unit = {(double)cells / ORL_PI / all, paths / all};
    for (size_t i = 0; i < 2 * cells; i++) {
        double batches[ORL_GONIO_BATCHES];
        const double mean = counted(probe, 0, i, batches);
        struct orl_gonio_node *node = &ret_cells.nodes[i];
        *node = (struct orl_gonio_node){.path = (float)(unit.value / ORL_GONIO_BATCHES)};
        if (mean > 0) {
            node->value = (float)(mean * unit.value);
            node->variance = (float)(variance_of(batches) / unit.told * unit.value * unit.value);
            node->path *= probe->heaviest[i];
        }
        if (ret_cells.hues)
            ret_cells.hues[i] = mean > 0 ? hue_of(probe, i, unit, mean, batches)
                                         : (struct orl_gonio_hue){.value = {0}};
    }
}

static double sum_of(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    return sum;
}

void orl_gonio_probe_put_aside(struct orl_gonio_probe *probe, uint32_t paths)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        double *sums = probe->sums + k * 2 * cells;
        for (size_t part = 0; part < 2; part++)
            probe->totals_before[k][part] += sum_of(sums + part * cells, cells);
        for (size_t plane = 0; plane < planes(probe); plane++)
            for (size_t i = 0; i < 2 * cells; i++)
                probe->before[plane * 2 * cells + i] +=
                    sums[plane * ORL_GONIO_BATCHES * 2 * cells + i];
    }
    memset(probe->sums, 0, 2 * cells * planes(probe) * ORL_GONIO_BATCHES * sizeof *probe->sums);
    probe->paths_before += paths;
}

void orl_gonio_probe_drop(struct orl_gonio_probe *probe)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe) * planes(probe);
    memset(probe->sums, 0, ORL_GONIO_BATCHES * cells * sizeof *probe->sums);
    memset(probe->before, 0, cells * sizeof *probe->before);
    memset(probe->heaviest, 0, cells * sizeof *probe->heaviest);
    memset(probe->totals_before, 0, sizeof probe->totals_before);
    probe->paths_before = 0;
}

void orl_gonio_probe_settle(struct orl_gonio_probe *probe, uint32_t paths)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const double all = (double)paths + probe->paths_before;
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        for (size_t part = 0; part < 2; part++)
            probe->totals[k][part] += (probe->totals_before[k][part] +
                                       sum_of(probe->sums + (2 * k + part) * cells, cells)) /
                                      all;
    orl_gonio_probe_drop(probe);
}
