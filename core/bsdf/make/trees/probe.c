/* Light from one finest incident cell of a tensor tree, counted by the finest cells out. */
#include "bsdf/make/trees/measure_subtrees.h"

#include <stdlib.h>
#include <string.h>

#include "bsdf/tree/shirley.h"

static size_t planes(const struct orl_gonio_probe *probe)
{
    return probe->color ? 1 + ORL_GONIO_COLORS : 1;
}

int orl_gonio_probe_init(struct orl_gonio_probe *probe, struct orl_error *err)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe) * planes(probe);
    probe->sums = calloc(ORL_GONIO_BATCHES * cells, sizeof *probe->sums);
    probe->pilot = calloc(cells, sizeof *probe->pilot);
    probe->max_weight = calloc(cells, sizeof *probe->max_weight);
    return probe->sums && probe->pilot && probe->max_weight
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the panel's BSDF");
}

void orl_gonio_probe_done(struct orl_gonio_probe *probe)
{
    free(probe->sums);
    free(probe->pilot);
    free(probe->max_weight);
    probe->sums = probe->pilot = NULL;
    probe->max_weight = NULL;
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static uint32_t cell_of(const struct orl_gonio_probe *probe, double x, double y)
{
    const struct orl_square s = orl_disk_to_square(x, y);
    const uint32_t side = 1U << probe->levels;
    return orl_morton_spread(orl_square_index(s.x, side)) |
           orl_morton_spread(orl_square_index(s.y, side)) << 1;
}

struct orl_vec3 orl_gonio_probe_direction(const struct orl_gonio_probe *probe, uint32_t a,
                                          const double u[2])
{
    const double side = 1U << probe->levels;
    if (probe->rank == 4)
        return orl_morton_direction(a, probe->levels, u[0], u[1]);
    const double outer = 1 - 2 * a / side, inner = 1 - 2 * (a + 1) / side;
    const double r2 = inner * inner + u[0] * (outer * outer - inner * inner), r = sqrt(r2);
    return orl_v3(r * cos(2 * ORL_PI * u[1]), r * sin(2 * ORL_PI * u[1]), sqrt(1 - r2));
}

/* ---- Counting -------------------------------------------------------------------------------- */

/* Least distance below the axis, so that rounding cannot move a direction across it. */
static const double least_away = 1e-9;

struct probe_path {
    struct orl_gonio_probe *probe;
    size_t batch;
    double cosine, sine; /* rotation of the incident light to +x; rank 3 */
};

/* Adds a share of the light that left on a side. */
static void add_share(const struct probe_path *probe_path, bool transmitted, uint32_t cell,
                      double share, struct orl_rgb color)
{
    const struct orl_gonio_probe *p = probe_path->probe;
    const size_t cells = orl_gonio_probe_cells(p), at = transmitted * cells + cell;
    const double weights[] = {orl_luma(color), color.r, color.g, color.b};
    for (size_t k = 0; k < planes(p); k++) {
        p->sums[(k * ORL_GONIO_BATCHES + probe_path->batch) * 2 * cells + at] += share * weights[k];
    }
    p->max_weight[at] = fmaxf(p->max_weight[at], (float)(share * weights[0]));
}

static void count_exit(void *ctx, const struct orl_gonio_exit *exit)
{
    const struct probe_path *probe_path = ctx;
    struct orl_gonio_probe *p = probe_path->probe;
    const double weight = orl_luma(exit->weight);
    const struct orl_vec3 d = exit->direction;
    if (exit->end == ORL_GONIO_PATH_CUT || !isfinite(weight)) {
        p->lost += isfinite(weight) ? weight : 1;
        return;
    }
    const bool transmitted = exit->front != p->front;
    if (p->rank == 4) {
        add_share(probe_path, transmitted, cell_of(p, d.x, d.y), 1, exit->weight);
        return;
    }
    /* Straight light lies on the border of two cells; each receives half of it. */
    const double x = probe_path->cosine * d.x + probe_path->sine * d.y;
    const double y = probe_path->cosine * d.y - probe_path->sine * d.x;
    add_share(probe_path, transmitted, cell_of(p, x, fabs(y)), 0.5, exit->weight);
    add_share(probe_path, transmitted, cell_of(p, x, -fmax(fabs(y), least_away)), 0.5,
              exit->weight);
}

static void send_path(struct orl_gonio_probe *p, uint32_t a, size_t batch, uint32_t index)
{
    const uint64_t set = (p->pilot_paths > 0 ? 2U : 0U) + p->front;
    const uint64_t item = set * (uint64_t)orl_gonio_probe_cells(p) + a;
    const uint64_t stream = item * ORL_GONIO_BATCHES + batch;
    struct probe_path probe_path = {p, batch, 1, 0};
    double u[4];
    struct orl_gonio_sampler sampler = orl_gonio_sampler_at(p->measurement, stream, index, u);
    const struct orl_vec3 towards = orl_gonio_probe_direction(p, a, u);
    const double r = hypot(towards.x, towards.y);
    if (p->rank == 3 && r > 0) {
        probe_path.cosine = towards.x / r;
        probe_path.sine = towards.y / r;
    }
    orl_gonio_trace(p->measurement->sample, p->front, towards, u + 2, &sampler, count_exit,
                    &probe_path);
}

void orl_gonio_probe_trace(struct orl_gonio_probe *probe, uint32_t a, uint32_t from, uint32_t to)
{
    enum { CHUNK = 1024 };
    for (size_t batch = 0; batch < ORL_GONIO_BATCHES; batch++)
        for (uint32_t index = from; index < to; index++) {
            if (index % CHUNK == 0 && orl_is_cancelled(probe->measurement->env->cancel))
                return;
            send_path(probe, a, batch, index);
        }
}

/* ---- Results -------------------------------------------------------------------------------- */

/* Returns the mean of a cell's counts in a plane, including those of the pilot; ret_batches: counts
 * of the present batches. */
static double counted(const struct orl_gonio_probe *probe, size_t plane, size_t i,
                      double ret_batches[ORL_GONIO_BATCHES])
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe);
    double sum = probe->pilot[plane * cells + i];
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        ret_batches[k] = probe->sums[(plane * ORL_GONIO_BATCHES + k) * cells + i];
        sum += ret_batches[k];
    }
    return sum / ORL_GONIO_BATCHES;
}

/* value: factor from counts to values. final_share: share of the paths in the present batches,
 * which alone give the errors. */
struct unit {
    double value, final_share;
};

static struct orl_gonio_color node_color_of(const struct orl_gonio_probe *probe, size_t i,
                                            struct unit unit, double luma,
                                            const double lumas[ORL_GONIO_BATCHES])
{
    struct orl_gonio_color node_color = {.value = {0}};
    for (size_t c = 0; c < ORL_GONIO_COLORS; c++) {
        double off[ORL_GONIO_BATCHES];
        const double mean = counted(probe, 1 + c, i, off);
        for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
            off[k] -= mean / luma * lumas[k];
        node_color.value[c] = (float)(mean * unit.value);
        node_color.noise[c] =
            (float)(orl_gonio_batch_variance(off) / unit.final_share * unit.value * unit.value);
    }
    return node_color;
}

void orl_gonio_probe_estimate(const struct orl_gonio_probe *probe, uint32_t paths,
                              struct orl_gonio_cells ret_cells)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const double all = (double)paths + probe->pilot_paths;
    const struct unit unit = {(double)cells / ORL_PI / all, paths / all};
    for (size_t i = 0; i < 2 * cells; i++) {
        double batches[ORL_GONIO_BATCHES];
        const double mean = counted(probe, 0, i, batches);
        struct orl_gonio_node *node = &ret_cells.nodes[i];
        *node = (struct orl_gonio_node){.path = (float)(unit.value / ORL_GONIO_BATCHES)};
        if (mean > 0) {
            node->value = (float)(mean * unit.value);
            node->variance = (float)(orl_gonio_batch_variance(batches) / unit.final_share *
                                     unit.value * unit.value);
            node->path *= probe->max_weight[i];
        }
        if (ret_cells.colors)
            ret_cells.colors[i] = mean > 0 ? node_color_of(probe, i, unit, mean, batches)
                                           : (struct orl_gonio_color){.value = {0}};
    }
}

static double sum_of(const double *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    return sum;
}

void orl_gonio_probe_end_pilot(struct orl_gonio_probe *probe, uint32_t paths)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++) {
        double *sums = probe->sums + k * 2 * cells;
        for (size_t part = 0; part < 2; part++)
            probe->pilot_totals[k][part] += sum_of(sums + part * cells, cells);
        for (size_t plane = 0; plane < planes(probe); plane++)
            for (size_t i = 0; i < 2 * cells; i++)
                probe->pilot[plane * 2 * cells + i] +=
                    sums[plane * ORL_GONIO_BATCHES * 2 * cells + i];
    }
    memset(probe->sums, 0, 2 * cells * planes(probe) * ORL_GONIO_BATCHES * sizeof *probe->sums);
    probe->pilot_paths += paths;
}

void orl_gonio_probe_clear(struct orl_gonio_probe *probe)
{
    const size_t cells = 2 * orl_gonio_probe_cells(probe) * planes(probe);
    memset(probe->sums, 0, ORL_GONIO_BATCHES * cells * sizeof *probe->sums);
    memset(probe->pilot, 0, cells * sizeof *probe->pilot);
    memset(probe->max_weight, 0, cells * sizeof *probe->max_weight);
    memset(probe->pilot_totals, 0, sizeof probe->pilot_totals);
    probe->pilot_paths = 0;
}

void orl_gonio_probe_finish_cell(struct orl_gonio_probe *probe, uint32_t paths)
{
    const size_t cells = orl_gonio_probe_cells(probe);
    const double all = (double)paths + probe->pilot_paths;
    for (size_t k = 0; k < ORL_GONIO_BATCHES; k++)
        for (size_t part = 0; part < 2; part++)
            probe->totals[k][part] += (probe->pilot_totals[k][part] +
                                       sum_of(probe->sums + (2 * k + part) * cells, cells)) /
                                      all;
    orl_gonio_probe_clear(probe);
}
