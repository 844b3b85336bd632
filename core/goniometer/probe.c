#include "goniometer/probe.h"

#include <stdlib.h>
#include <string.h>

#include "bsdf/shirley.h"

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe);
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

/* So little below the axis is below it, whatever rounding does. */
static const double least_away = 1e-9;

struct shot {
    struct orl_gonio_probe *probe;
    size_t batch;
    double cosine, sine; /* what turns the light that comes to +x; rank 3 */
};

static void add(double *sums, float *heaviest, uint32_t cell, double weight)
{
    sums[cell] += weight;
    heaviest[cell] = fmaxf(heaviest[cell], (float)weight);
}

static void count(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct shot *shot = ctx;
    struct orl_gonio_probe *p = shot->probe;
    const double weight = orl_luma(exit->weight);
    const struct orl_vec3 d = exit->direction;
    if (exit->end == ORL_GONIO_GIVEN_UP || !isfinite(weight)) {
        p->lost += isfinite(weight) ? weight : 1;
        return;
    }
    const size_t part = (exit->front != p->front) * orl_gonio_probe_cells(p);
    double *sums = p->sums + shot->batch * 2 * orl_gonio_probe_cells(p) + part;
    float *heaviest = p->heaviest + part;
    if (p->rank == 4) {
        add(sums, heaviest, cell_of(p, d.x, d.y), weight);
        return;
    }
    /* What is straight lies on the border of two cells: both have half of it. */
    const double x = shot->cosine * d.x + shot->sine * d.y;
    const double y = shot->cosine * d.y - shot->sine * d.x;
    add(sums, heaviest, cell_of(p, x, fabs(y)), 0.5 * weight);
    add(sums, heaviest, cell_of(p, x, -fmax(fabs(y), least_away)), 0.5 * weight);
}

static void send(struct orl_gonio_probe *p, uint32_t a, size_t batch, uint32_t index)
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
        &numbers, count, &shot);
}

void orl_gonio_probe_send(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to)
{
    enum { AT_ONCE = 1024 };
    for (size_t batch = 0; batch < ORL_GONIO_BATCHES; batch++)
        for (uint32_t index = from; index < to; index++) {
            if (index % AT_ONCE == 0 && orl_is_cancelled(probe->cancel))
                return;
            send(probe, a, batch, index);
        }
}

/* ---- Telling --------------------------------------------------------------------------------- */

void orl_gonio_probe_tell(const struct orl_gonio_probe *probe, uint32_t paths,
                          struct orl_gonio_node *ret_nodes)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const double all = (double)paths + probe->paths_before;
    const double unit = (double)cells / ORL_PI / all, told = paths / all;
    for (size_t i = 0; i < 2 * cells; i++) {
        const double before = probe->before[i] / ORL_GONIO_BATCHES;
        double sum = 0, squares = 0;
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            sum += probe->sums[k * 2 * cells + i];
        ret_nodes[i] = (struct orl_gonio_node){.path = (float)(unit / ORL_GONIO_BATCHES)};
        if (sum + before == 0)
            continue;
        const double mean = sum / ORL_GONIO_BATCHES;
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
            const double off = probe->sums[k * 2 * cells + i] - mean;
            squares += off * off;
        }
        /* As many in each batch as in all sets, of which these are a part. */
        ret_nodes[i].value = (float)((mean + before) * unit);
        ret_nodes[i].variance =
            (float)(squares / told * unit * unit / (ORL_GONIO_BATCHES * (ORL_GONIO_BATCHES - 1.0)));
        ret_nodes[i].path *= probe->heaviest[i];
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
        for (size_t i = 0; i < 2 * cells; i++)
            probe->before[i] += sums[i];
    }
    memset(probe->sums, 0, 2 * cells * ORL_GONIO_BATCHES * sizeof *probe->sums);
    probe->paths_before += paths;
}

void orl_gonio_probe_drop(struct orl_gonio_probe *probe)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe);
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
