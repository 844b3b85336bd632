/* oriel bsdf plot FILE.xml [OTHER.xml] -o PICTURE: plots the scattering of light from one
 * direction. */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/job/picture.h>

#include "chart/charts.h"
#include "commands/local.h"
#include "output/reports.h"

enum { FRAMES = 17, STEP_DEG = 5 };
static const double frame_s = 0.4;

struct plot {
    struct orl_bsdf *bsdfs[2];
    struct orl_bsdf_check *checks[2];
    struct orl_bsdf_chart chart;
    const char *output;
};

/* ---- Pictures -------------------------------------------------------------------------------- */

static bool ends_in(const char *path, const char *end)
{
    const size_t length = strlen(path), n = strlen(end);
    return length > n && strcmp(path + length - n, end) == 0;
}

static int draw_picture(const struct plot *p, struct orl_error *err)
{
    return orl_bsdf_chart_write(&p->chart,
                                ends_in(p->output, ".svg")   ? ORL_CANVAS_SVG
                                : ends_in(p->output, ".pdf") ? ORL_CANVAS_PDF
                                                             : ORL_CANVAS_PNG,
                                p->output, err);
}

/* Draws frames from 0 to 80 degrees with one scale, that of the brightest frame. */
static int draw_frames(struct plot *p, char names[FRAMES][4096], struct orl_error *err)
{
    double top = 0;
    int rc = 0;
    for (int i = 0; i < FRAMES; i++) {
        p->chart.theta_deg = STEP_DEG * i;
        const double here = orl_bsdf_chart_top(&p->chart);
        top = here > top ? here : top;
    }
    p->chart.top = top;
    for (int i = 0; i < FRAMES && rc == 0; i++) {
        p->chart.theta_deg = STEP_DEG * i;
        snprintf(names[i], sizeof names[i], "%.4000s.frame-%02d", p->output, i);
        rc = orl_bsdf_chart_write(&p->chart, ORL_CANVAS_PNG, names[i], err);
    }
    return rc;
}

static int draw_animation(struct plot *p, struct orl_error *err)
{
    char(*names)[4096] = calloc(FRAMES, sizeof *names);
    const char *pictures[FRAMES];
    if (!names)
        return orl_error_no_memory(err);
    int rc = draw_frames(p, names, err);
    for (int i = 0; i < FRAMES; i++)
        pictures[i] = names[i];
    if (rc == 0)
        rc = orl_animation_write(pictures, FRAMES, frame_s, p->output, err);
    for (int i = 0; i < FRAMES; i++)
        if (names[i][0])
            unlink(names[i]);
    free(names);
    return rc;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static int load_files(struct plot *p, const struct orl_operands *operands, struct orl_error *err)
{
    int rc = 0;
    p->chart.n_files = (size_t)operands->count;
    for (int i = 0; i < operands->count && rc == 0; i++) {
        const char *slash = strrchr(operands->items[i], '/');
        rc = orl_bsdf_file_load(operands->items[i], &p->bsdfs[i], err);
        p->checks[i] = rc == 0 ? calloc(1, sizeof *p->checks[i]) : NULL;
        if (rc == 0 && !p->checks[i])
            rc = orl_error_no_memory(err);
        if (rc == 0)
            orl_bsdf_examine(p->bsdfs[i], p->checks[i]);
        p->chart.files[i] = (struct orl_bsdf_chart_file){slash ? slash + 1 : operands->items[i],
                                                         p->bsdfs[i], p->checks[i]};
    }
    return rc;
}

static int run_plot(struct plot *p, const struct orl_operands *operands, bool animated)
{
    struct orl_error err = {0};
    int rc = load_files(p, operands, &err);
    if (rc == 0)
        rc = animated ? draw_animation(p, &err) : draw_picture(p, &err);
    for (int i = 0; i < 2; i++) {
        orl_bsdf_unref(p->bsdfs[i]);
        free(p->checks[i]);
    }
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

static bool read_angle(const char *text, double most, double *angle)
{
    char *end = NULL;
    const double value = text ? strtod(text, &end) : *angle;
    if (text && (end == text || *end || !(value >= 0 && value < most)))
        return false;
    *angle = value;
    return true;
}

int orl_cmd_bsdf_plot(const struct orl_subcommand *self, int argc, char **argv)
{
    struct plot p = {.chart = {.theta_deg = 40, .phi_deg = 90}};
    const char *theta = NULL, *phi = NULL, *from = NULL;
    bool animated = false;
    const struct orl_option options[] = {
        {"output", 'o', "FILE", "picture file: .svg, .png or .pdf", &p.output, NULL},
        {"theta", 0, "DEG", "angle of the light from the normal (40)", &theta, NULL},
        {"phi", 0, "DEG", "azimuth of the light from x to y; 90 is from above (90)", &phi, NULL},
        {"from", 0, "outside|inside", "side of the light (outside)", &from, NULL},
        {"animate", 0, NULL, "draw theta from 0 to 80 as an animated PNG", NULL, &animated},
    };
    struct orl_operands operands;
    int code;
    if (!orl_options_parse(self, argc, argv, options, 5, 1, 2, &operands, &code))
        return code;
    if (!p.output || (animated && !ends_in(p.output, ".png")) ||
        (!ends_in(p.output, ".svg") && !ends_in(p.output, ".png") && !ends_in(p.output, ".pdf")))
        return orl_usage_error(self, "-o names a .png%s", animated ? "" : ", .svg or .pdf");
    if (!read_angle(theta, 90, &p.chart.theta_deg) || !read_angle(phi, 360, &p.chart.phi_deg))
        return orl_usage_error(self, "theta is from 0 to below 90 degrees, phi below 360");
    if (from && strcmp(from, "outside") != 0 && strcmp(from, "inside") != 0)
        return orl_usage_error(self, "light comes from outside or inside, not \"%s\"", from);
    p.chart.front = from && strcmp(from, "inside") == 0;
    return run_plot(&p, &operands, animated);
}
