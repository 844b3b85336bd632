/*
 * Figures of a BSDF's check, for the data as filed: before values are divided where R + T is above
 * 1. Sums over the data's own cells are exact. Shares of light (reciprocity, redirection) are means
 * over a fixed set of evenly spread samples, accurate to about half a per cent.
 */
#include "bsdf/bsdf_internal.h"

#include <string.h>

#include "bsdf/tree/shirley.h"

enum {
    REDIRECTION_DRAWS = 256, /* samples for each incident direction */
    PATCH_SIDE = 32,
    PEAK_SIDE = 49, /* points across the neighbourhood of the straight direction */
};

/* ---- Hemispherical values -------------------------------------------------------------------- */

/* Adds the totals of a beam. */
static void scatter_beam(const struct orl_bsdf *bsdf, bool front, struct orl_bsdf_hemispherical *h)
{
    struct orl_vec3 beam[ORL_BSDF_BEAM];
    orl_bsdf_spread_beam(orl_bsdf_direction_at(h->theta_deg, h->phi_deg, front), beam);
    for (int k = 0; k < ORL_BSDF_BEAM; k++) {
        double total[2];
        orl_bsdf_filed_totals(bsdf, beam[k], total);
        h->reflected += 0.25 * total[0];
        h->transmitted += 0.25 * total[1];
    }
}

static void fill_directions(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c)
{
    for (int front = 0; front < 2; front++) {
        for (int i = 0; i < ORL_BSDF_CHECK_DIRECTIONS; i++) {
            struct orl_bsdf_hemispherical *h = &c->directions[front][i];
            h->theta_deg = i == 0 ? 0 : 15 * (1 + (i - 1) / 4);
            h->phi_deg = i == 0 ? 0 : 90 * ((i - 1) % 4);
            scatter_beam(bsdf, front, h);
        }
    }
}

static void widen_extremes(struct orl_bsdf_extremes *x, double value, struct orl_vec3 in)
{
    x->least = fmin(x->least, value);
    if (!(value > x->most))
        return;
    x->most = value;
    const struct orl_bsdf_angles angles = orl_bsdf_angles_of(in);
    x->most_theta_deg = angles.theta_deg;
    x->most_phi_deg = angles.phi_deg;
}

/* Updates R + T as filed, and T with the other side's reflection. */
static void add_total(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c, bool front,
                      struct orl_vec3 in)
{
    double own[2], other[2];
    orl_bsdf_filed_totals(bsdf, in, own);
    orl_bsdf_filed_totals(bsdf, orl_v3(in.x, in.y, -in.z), other);
    widen_extremes(&c->total[front], own[0] + own[1], in);
    c->total_exchanged[front] = fmax(c->total_exchanged[front], own[1] + other[0]);
}

/* Means over patches of the square of incident directions. */
struct patches {
    double sum[PATCH_SIDE * PATCH_SIDE];
    unsigned count[PATCH_SIDE * PATCH_SIDE];
};

static void add_to_patch(struct patches *patches, struct orl_vec3 in, double value)
{
    const struct orl_square s = orl_disk_to_square(in.x, in.y);
    const int x = (int)fmin(PATCH_SIDE - 1, (0.5 + 0.5 * s.x) * PATCH_SIDE);
    const int y = (int)fmin(PATCH_SIDE - 1, (0.5 + 0.5 * s.y) * PATCH_SIDE);
    patches->sum[x * PATCH_SIDE + y] += value;
    patches->count[x * PATCH_SIDE + y]++;
}

static double largest_mean(const struct patches *patches)
{
    double largest = 0;
    for (int i = 0; i < PATCH_SIDE * PATCH_SIDE; i++)
        if (patches->count[i] > 0)
            largest = fmax(largest, patches->sum[i] / patches->count[i]);
    return largest;
}

/* Fills the extremes of one component, and updates those of R + T. */
static void fill_extremes_of(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c, bool front,
                             bool transmitted)
{
    const struct orl_component_view *view = &bsdf->views[front][transmitted];
    const size_t cells = orl_view_cells(bsdf, view);
    struct orl_bsdf_extremes *x = &c->extremes[front][transmitted];
    struct patches patches = {{0}, {0}};
    double sum = 0, omega;
    x->least = cells > 0 ? INFINITY : 0;
    for (size_t i = 0; i < cells; i++) {
        const struct orl_vec3 in = orl_view_incident(bsdf, view, i, front, &omega);
        double total[2];
        orl_bsdf_filed_totals(bsdf, in, total);
        widen_extremes(x, total[transmitted], in);
        add_to_patch(&patches, in, total[transmitted]);
        sum += total[transmitted] * omega;
        add_total(bsdf, c, front, in);
    }
    x->mean = sum / ORL_PI;
    x->even = ORL_PI * orl_luma(orl_bsdf_diffuse(bsdf, front, transmitted));
    x->most_coarse =
        bsdf->document.structure == ORL_STRUCTURE_MATRIX ? x->most : largest_mean(&patches);
}

static void fill_extremes(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c)
{
    for (int front = 0; front < 2; front++) {
        c->total[front].least = INFINITY;
        for (int transmitted = 0; transmitted < 2; transmitted++)
            fill_extremes_of(bsdf, c, front, transmitted);
        c->total[front].least = fmin(c->total[front].least, c->total[front].most);
        c->total[front].mean = c->extremes[front][0].mean + c->extremes[front][1].mean;
    }
}

/* ---- Reciprocity ----------------------------------------------------------------------------- */

static void fill_reciprocity(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c)
{
    for (int front = 0; front < 2; front++)
        c->irreciprocal_reflection[front] = orl_bsdf_irreciprocal_reflection(bsdf, front);
    c->irreciprocal_transmission = bsdf->info.has[0][1] && bsdf->info.has[1][1]
                                       ? orl_bsdf_irreciprocal_transmission(bsdf)
                                       : -1;
}

/* ---- Straight through ------------------------------------------------------------------------ */

/*
 * Radii in units of the cell's radius. The peak may cover several cells, because the straight
 * direction may lie in a corner of its cell. The peak is compared with the ring beyond.
 */
#define INNER 2.6
#define RING 3.0
#define OUTER 4.5

/* Values around the straight direction, on a grid of the disk seen along the axis. */
struct surroundings {
    double value[PEAK_SIDE * PEAK_SIDE];  /* 1/sr; negative outside the disk */
    double radius[PEAK_SIDE * PEAK_SIDE]; /* from the middle, in radii of the cell */
    double point_sr;                      /* projected solid angle of one point, sr */
    double peak;                          /* the largest value within INNER */
};

static void sample_surroundings(const struct orl_bsdf *bsdf, struct orl_vec3 in, double omega_sr,
                                struct surroundings *s)
{
    const double cell = sqrt(omega_sr / ORL_PI), step = 2 * OUTER / PEAK_SIDE;
    s->peak = 0;
    s->point_sr = step * cell * step * cell;
    for (int i = 0; i < PEAK_SIDE * PEAK_SIDE; i++) {
        const int row = i / PEAK_SIDE, column = i % PEAK_SIDE;
        const double dx = (column + 0.5) * step - OUTER, dy = (row + 0.5) * step - OUTER;
        const double x = -in.x + dx * cell, y = -in.y + dy * cell, z2 = 1 - x * x - y * y;
        s->radius[i] = sqrt(dx * dx + dy * dy);
        s->value[i] = -1;
        if (!(z2 > 0))
            continue;
        s->value[i] =
            orl_luma(orl_bsdf_eval(bsdf, in, orl_v3(x, y, in.z > 0 ? -sqrt(z2) : sqrt(z2))));
        if (s->radius[i] < INNER)
            s->peak = fmax(s->peak, s->value[i]);
    }
}

/*
 * Returns the peak's share of the transmitted light. Points near the middle within a factor of
 * eight of the brightest form the peak. Only their light above the mean of the ring counts.
 * Radiance's aBSDF finds its peak in much the same way.
 */
static double peak_share(const struct surroundings *s, double transmitted)
{
    double inside = 0, ring = 0;
    int n_inside = 0, n_ring = 0;
    for (int i = 0; i < PEAK_SIDE * PEAK_SIDE; i++) {
        if (s->value[i] < 0)
            continue;
        if (s->radius[i] < INNER && s->value[i] * 8 > s->peak) {
            inside += s->value[i];
            n_inside++;
        } else if (s->radius[i] >= RING && s->radius[i] < OUTER) {
            ring += s->value[i];
            n_ring++;
        }
    }
    if (n_ring == 0) /* the cell is as wide as the hemisphere */
        return 0;
    inside -= n_inside * (ring / n_ring);
    return fmin(1, fmax(0, inside * s->point_sr / transmitted));
}

static struct orl_bsdf_peak peak_at(const struct orl_bsdf *bsdf,
                                    const struct orl_bsdf_hemispherical *h)
{
    const double radius = 0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD;
    const double sun_sr = ORL_PI * radius * radius;
    const struct orl_vec3 in = orl_bsdf_direction_at(h->theta_deg, h->phi_deg, false);
    const double omega_sr = orl_view_omega(bsdf, &bsdf->views[0][1], in, orl_neg(in));
    struct orl_bsdf_peak p = {h->theta_deg, h->phi_deg, 0, 1, 0, 0, 0};
    struct surroundings around;
    double total[2];
    if (!(h->transmitted > 0) || !(omega_sr > 0))
        return p;
    p.cell_sr = omega_sr / fabs(in.z);
    p.smear = fmax(1, p.cell_sr / sun_sr);
    p.straight = orl_luma(orl_bsdf_straight(bsdf, in));
    sample_surroundings(bsdf, in, omega_sr, &around);
    orl_bsdf_filed_totals(bsdf, in, total);
    p.share = peak_share(&around, h->transmitted / fmax(1, total[0] + total[1]));
    if (p.share > 0.01)
        p.dgp_loss = 0.0918 * log10(p.smear);
    return p;
}

static void fill_peaks(const struct orl_bsdf *bsdf, struct orl_bsdf_check *c)
{
    double most;
    c->normal = c->strongest = peak_at(bsdf, &c->directions[0][0]);
    most = c->normal.share * c->directions[0][0].transmitted;
    for (int i = 1; i < ORL_BSDF_CHECK_DIRECTIONS; i++) {
        const struct orl_bsdf_hemispherical *h = &c->directions[0][i];
        const struct orl_bsdf_peak peak = peak_at(bsdf, h);
        /* Ranked by amount of light: a large share of very little light causes no glare. */
        if (peak.share * h->transmitted > 1.001 * most) {
            c->strongest = peak;
            most = peak.share * h->transmitted;
        }
    }
}

/* ---- Which way is up ------------------------------------------------------------------------- */

static struct orl_bsdf_redirection measure_redirection(const struct orl_bsdf *bsdf, bool front,
                                                       bool above)
{
    struct orl_bsdf_redirection result = {0, 0};
    double sum = 0, upward = 0;
    for (int k = 0; k < 9; k++) { /* elevations 30, 45, 60 at azimuths -30, 0, 30 of the facade */
        const int row = k / 3, column = k % 3;
        const double elevation = (30 + 15 * row) * ORL_DEG_TO_RAD;
        const double azimuth = (30 * column - 30) * ORL_DEG_TO_RAD;
        const double level = cos(elevation), rise = sin(elevation);
        const struct orl_vec3 in = orl_v3(level * sin(azimuth), above ? rise : -rise,
                                          front ? level * cos(azimuth) : -level * cos(azimuth));
        int rising = 0, drawn = 0;
        for (unsigned i = 0; i < REDIRECTION_DRAWS; i++) {
            double u[4], pdf;
            struct orl_vec3 out;
            struct orl_rgb weight;
            orl_r_sequence_point(i, u);
            if (!orl_bsdf_sample(bsdf, in, ORL_BSDF_TRANSMIT, u, &out, &weight, &pdf))
                break;
            drawn++;
            rising += out.y > 0;
        }
        if (drawn > 0) {
            double total[2];
            orl_bsdf_filed_totals(bsdf, in, total);
            sum += total[1];
            upward += total[1] * rising / drawn;
        }
    }
    result.transmitted = sum / 9;
    result.upward = sum > 0 ? upward / sum : 0;
    return result;
}

void orl_bsdf_examine(const struct orl_bsdf *bsdf, struct orl_bsdf_check *ret_check)
{
    memset(ret_check, 0, sizeof *ret_check);
    orl_bsdf_describe(bsdf, &ret_check->info);
    fill_directions(bsdf, ret_check);
    fill_extremes(bsdf, ret_check);
    fill_reciprocity(bsdf, ret_check);
    fill_peaks(bsdf, ret_check);
    for (int front = 0; front < 2; front++)
        for (int above = 0; above < 2; above++)
            ret_check->redirection[front][above] = measure_redirection(bsdf, front, above);
    orl_bsdf_set_verdicts(ret_check);
}
