#include "chart/charts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf_polar.h>
#include <oriel/job/picture.h>

/* Lengths in page units. A row has two maps and a table. Rows: one per file, one of
 * differences, then the findings. */
static const double page_width = 900, head = 62, row_height = 306, radius = 122, rim = 40;
static const double letters = 8, line_height = 14, title = 11, legend_x = 596, table_x = 664;
static const double png_scale = 1.6, foot = 16;
enum { FINDINGS = 6, FINDING_LETTERS = 128 };

static const unsigned char ink[3] = {26, 26, 26}, grey[3] = {96, 96, 96};

struct page {
    const struct orl_bsdf_chart *chart;
    struct orl_canvas *canvas;
    struct orl_bsdf_polar *polar; /* one per file */
    double top;
};

static void write_text(const struct page *p, double x, double y, double size, bool bold,
                       const unsigned char rgb[3], const char *text)
{
    struct orl_canvas_text_style as = {.size = size, .bold = bold};
    memcpy(as.rgb, rgb, 3);
    orl_canvas_text(p->canvas, x, y, &as, text);
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static struct orl_polar_map map_of(const struct page *p, int t, double y)
{
    const struct orl_bsdf_chart *c = p->chart;
    return (struct orl_polar_map){.canvas = p->canvas,
                                  .x = rim + radius + t * (2 * radius + rim),
                                  .y = y + 40 + radius,
                                  .radius = radius,
                                  .top = p->top,
                                  .mark_theta_deg = c->theta_deg,
                                  .mark_phi_deg = c->phi_deg + 180};
}

static void draw_file(const struct page *p, size_t i, double y)
{
    static const char *const parts[2] = {"Reflected", "Transmitted"};
    const struct orl_bsdf_polar *polar = &p->polar[i];
    char text[160];
    snprintf(text, sizeof text, "%.100s", p->chart->files[i].name);
    write_text(p, rim, y + 6, title, true, ink, text);
    for (int t = 0; t < 2; t++) {
        struct orl_polar_map map = map_of(p, t, y);
        map.values = polar->values[t];
        orl_polar_map_draw(&map);
        snprintf(text, sizeof text, "%s %.2f %% of the light", parts[t],
                 100 * (t ? polar->transmitted : polar->reflected));
        write_text(p, map.x - radius, y + 22, letters, false, ink, text);
    }
}

static void write_peak(const struct page *p, double y, const struct orl_bsdf_lobe *peak,
                       bool transmitted)
{
    char cells[5][32];
    snprintf(cells[0], sizeof cells[0], "%s", transmitted ? "transm." : "refl.");
    snprintf(cells[1], sizeof cells[1], "%.1f", peak->theta_deg);
    snprintf(cells[2], sizeof cells[2], "%.1f", peak->phi_deg);
    snprintf(cells[3], sizeof cells[3], peak->f < 999.5 ? "%.3g" : "%.0f", peak->f);
    snprintf(cells[4], sizeof cells[4], "%.2f %%", 100 * peak->share);
    for (int i = 0; i < 5; i++)
        write_text(p, table_x + 44 * i + (i > 0 ? 6 : 0), y, letters, false, ink, cells[i]);
}

static void draw_peaks(const struct page *p, size_t i, double y)
{
    static const char *const heads[] = {"peak", "theta", "phi", "1/sr", "in 5°"};
    const struct orl_bsdf_chart *c = p->chart;
    for (int k = 0; k < 5; k++)
        write_text(p, table_x + 44 * k + (k > 0 ? 6 : 0), y, letters, true, ink, heads[k]);
    for (int t = 1; t >= 0; t--) {
        struct orl_bsdf_lobe peaks[ORL_BSDF_PEAKS];
        const size_t n = orl_bsdf_find_peaks(c->files[i].bsdf, c->front, c->theta_deg, c->phi_deg,
                                             &p->polar[i], t, peaks);
        for (size_t k = 0; k < n; k++)
            write_peak(p, y += line_height, &peaks[k], t);
        if (n == 0) {
            y += line_height;
            write_text(p, table_x, y, letters, false, grey,
                       t ? "no peak in transmission" : "no peak in reflection");
        }
    }
}

/* ---- Differences ----------------------------------------------------------------------------- */

/* Returns half the integral of the absolute difference: the flux that would have to move. */
static double moved_flux(const struct page *p, int t)
{
    const double dtheta = ORL_PI / 2 / ORL_POLAR_THETAS;
    double sum = 0;
    for (int i = 0; i < ORL_POLAR_THETAS; i++) {
        const double low = sin(i * dtheta), high = sin((i + 1) * dtheta);
        const double omega = ORL_PI * (high * high - low * low) / ORL_POLAR_PHIS;
        for (int k = 0; k < ORL_POLAR_PHIS; k++)
            sum += 0.5 * omega * fabs(p->polar[1].values[t][i][k] - p->polar[0].values[t][i][k]);
    }
    return sum;
}

static void draw_difference(const struct page *p, double y)
{
    const struct orl_bsdf_polar *first = &p->polar[0], *second = &p->polar[1];
    write_text(p, rim, y + 6, title, true, ink, "The second minus the first");
    for (int t = 0; t < 2; t++) {
        struct orl_polar_map map = map_of(p, t, y);
        char text[96];
        map.values = first->values[t];
        map.second = second->values[t];
        orl_polar_map_draw(&map);
        snprintf(text, sizeof text, "total %+.2f %%, moved %.2f %% of the light",
                 100 * (t ? p->polar[1].transmitted - p->polar[0].transmitted
                          : p->polar[1].reflected - p->polar[0].reflected),
                 100 * moved_flux(p, t));
        write_text(p, map.x - radius, y + 22, letters, false, ink, text);
    }
}

/* ---- The page -------------------------------------------------------------------------------- */

/* Writes text, broken at spaces into lines. Returns the y below. */
static double write_wrapped(const struct page *p, double x, double y, const char *text)
{
    char line[FINDING_LETTERS + 1];
    while (*text) {
        size_t n = strlen(text);
        if (n > FINDING_LETTERS) {
            n = FINDING_LETTERS;
            while (n > 0 && text[n] != ' ')
                n--;
            n = n > 0 ? n : FINDING_LETTERS;
        }
        snprintf(line, sizeof line, "%.*s", (int)n, text);
        write_text(p, x, y, letters, false, ink, line);
        text += n + (text[n] == ' ');
        y += line_height;
    }
    return y;
}

static size_t findings_of(const struct orl_bsdf_check *check)
{
    return check->n_verdicts < FINDINGS ? check->n_verdicts : FINDINGS;
}

/* Returns an estimate of the lines that a file's findings take when wrapped. */
static size_t lines_of(const struct orl_bsdf_check *check)
{
    size_t lines = 1;
    for (size_t i = 0; i < findings_of(check); i++)
        lines += strlen(check->verdicts[i].text) / (FINDING_LETTERS - 16) + 1;
    return lines;
}

static double draw_findings(const struct page *p, size_t i, double y)
{
    const struct orl_bsdf_check *check = p->chart->files[i].check;
    char text[256];
    snprintf(text, sizeof text, "%.100s: %s, %d directions per side, %zu values",
             p->chart->files[i].name, check->info.kind, check->info.resolution, check->info.values);
    write_text(p, rim, y, letters, true, ink, text);
    y += line_height;
    for (size_t k = 0; k < findings_of(check); k++) {
        const struct orl_bsdf_verdict *v = &check->verdicts[k];
        write_text(p, rim, y, letters, false, grey, orl_bsdf_level_name(v->level));
        y = write_wrapped(p, rim + 52, y, v->text);
    }
    return y;
}

static void draw_page(const struct page *p)
{
    const struct orl_bsdf_chart *c = p->chart;
    char text[128];
    double y = head;
    snprintf(text, sizeof text, "Light from the %s at theta %.4g, phi %.4g",
             c->front ? "inside" : "outside", c->theta_deg, c->phi_deg);
    write_text(p, rim, 24, 14, true, ink, text);
    write_text(p, rim, 42, letters, false, grey,
               "Means over 2.5 by 5 degrees, 1/sr; theta outwards, a ring every 30 degrees; x to "
               "the right, y up; small circle: direct or mirror direction");
    for (size_t i = 0; i < c->n_files; i++) {
        draw_file(p, i, y);
        draw_peaks(p, i, y + 40);
        orl_polar_legend_draw(p->canvas, legend_x, y + 52, 2 * radius - 24, p->top, false);
        y += row_height;
    }
    if (c->n_files == 2) {
        draw_difference(p, y);
        orl_polar_legend_draw(p->canvas, legend_x, y + 52, 2 * radius - 24, p->top, true);
        y += row_height;
    }
    for (size_t i = 0; i < c->n_files; i++)
        y = draw_findings(p, i, y + 8);
}

static double height_of(const struct orl_bsdf_chart *c)
{
    double height = head + (c->n_files == 2 ? 3 : 1) * row_height + foot;
    for (size_t i = 0; i < c->n_files; i++)
        height += 8 + line_height * (double)lines_of(c->files[i].check);
    return height;
}

static double largest_value(const struct orl_bsdf_polar *polar)
{
    double most = 0;
    for (int t = 0; t < 2; t++)
        for (int i = 0; i < ORL_POLAR_THETAS; i++)
            for (int k = 0; k < ORL_POLAR_PHIS; k++)
                most = fmax(most, polar->values[t][i][k]);
    return most;
}

/* Rounds up to 1 or 3 times a power of ten. */
static double round_up(double value)
{
    const double power = value > 0 ? pow(10, floor(log10(value))) : 1;
    return value <= power ? power : value <= 3 * power ? 3 * power : 10 * power;
}

static void compute_polars(const struct orl_bsdf_chart *c, struct orl_bsdf_polar polar[2])
{
    for (size_t i = 0; i < c->n_files; i++)
        orl_bsdf_polar(c->files[i].bsdf, c->front, c->theta_deg, c->phi_deg, &polar[i]);
}

static double top_of(const struct orl_bsdf_chart *c, const struct orl_bsdf_polar polar[2])
{
    double most = 0;
    for (size_t i = 0; i < c->n_files; i++)
        most = fmax(most, largest_value(&polar[i]));
    return c->top > 0 ? c->top : round_up(most);
}

double orl_bsdf_chart_top(const struct orl_bsdf_chart *chart)
{
    struct orl_bsdf_polar *polar = calloc(2, sizeof *polar);
    if (!polar)
        return 1;
    compute_polars(chart, polar);
    const double top = top_of(chart, polar);
    free(polar);
    return top;
}

int orl_bsdf_chart_write(const struct orl_bsdf_chart *chart, enum orl_canvas_kind kind,
                         const char *path, struct orl_error *err)
{
    struct page page = {.chart = chart, .polar = calloc(2, sizeof *page.polar)};
    if (!page.polar)
        return orl_error_no_memory(err);
    compute_polars(chart, page.polar);
    page.top = top_of(chart, page.polar);
    int code =
        orl_canvas_open(kind, path, page_width, height_of(chart), png_scale, &page.canvas, err);
    if (code == 0) {
        draw_page(&page);
        code = orl_canvas_close(page.canvas, 0, err);
    }
    free(page.polar);
    return code;
}
