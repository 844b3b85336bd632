/* oriel glare PICTURE.hdr: computes glare metrics of a picture. */
#include "options/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/files.h>
#include <oriel/job/glare.h>

#include "output/reports.h"
#include "view/view_json.h"

/* Options of the command line, as text. */
struct glare_options {
    const char *view, *mask, *band, *threshold, *task, *radius, *peak, *age, *eye, *directions;
    bool smooth, no_peaks, published, low_light, whole_pixels, json, detail;
};

/* Reads count numbers separated by commas; returns false for any other text. */
static bool read_numbers(const char *text, double *numbers, int count)
{
    for (int i = 0; i < count; i++) {
        char *end;
        numbers[i] = strtod(text, &end);
        if (end == text || !isfinite(numbers[i]) || *end != (i + 1 < count ? ',' : '\0'))
            return false;
        text = end + 1;
    }
    return true;
}

static int read_settings(const struct orl_subcommand *self,
                         const struct glare_options *glare_options,
                         struct orl_glare_settings *ret_settings)
{
    struct orl_glare_settings s = {.smooth = glare_options->smooth,
                                   .no_peaks = glare_options->no_peaks,
                                   .constants = glare_options->published ? ORL_DGP_PUBLISHED
                                                                         : ORL_DGP_EVALGLARE,
                                   .low_light = glare_options->low_light,
                                   .at_whole_pixels = glare_options->whole_pixels};
    double task[3] = {0}, directions[2] = {0};
    const struct {
        const char *name, *text;
        double *numbers;
        int count;
    } options[] = {{"threshold", glare_options->threshold, &s.threshold, 1},
                   {"task", glare_options->task, task, 3},
                   {"radius", glare_options->radius, &s.radius_rad, 1},
                   {"peak", glare_options->peak, &s.peak_cd_m2, 1},
                   {"band", glare_options->band, &s.band_rad, 1},
                   {"age", glare_options->age, &s.age_years, 1},
                   {"illuminance", glare_options->eye, &s.eye_lx, 1},
                   {"directions", glare_options->directions, directions, 2}};
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        if (options[i].text && !read_numbers(options[i].text, options[i].numbers, options[i].count))
            return orl_usage_error(self, "--%s %s: %d number%s wanted here", options[i].name,
                                   options[i].text, options[i].count,
                                   options[i].count == 1 ? " is" : "s, with commas between, are");
    if (!(directions[0] >= 0 && directions[0] <= 360 && directions[0] == floor(directions[0])))
        return orl_usage_error(self, "--directions takes 1 to 360 directions");
    s.task = (struct orl_glare_area){task[0], task[1], task[2]};
    s.directions = (uint32_t)directions[0];
    s.directions_deg = directions[1];
    *ret_settings = s;
    return ORL_EXIT_OK;
}

static void print_sources(const struct orl_glare *glare)
{
    printf("%8s %8s %8s %14s %14s %8s %8s %10s\n", "pixels", "x", "y", "cd/m2", "sr", "P",
           "degrees", "lx");
    for (size_t i = 0; i < glare->n_sources; i++) {
        const struct orl_glare_source *s = &glare->sources[i];
        printf("%8zu %8.1f %8.1f %14.6g %14.6g %8.4f %8.2f %10.5g\n", s->pixels, s->x, s->y,
               s->luminance_cd_m2, s->solid_angle_sr, s->position_index, s->angle_deg,
               s->illuminance_lx);
    }
}

static void print_part(const char *what, const struct orl_glare_part *part)
{
    printf("%s: %zu pixels, %.6g sr, %.6g lx; cd/m2: mean %.6g, median %.6g, deviation %.6g, "
           "75 %% below %.6g, 95 %% below %.6g, from %.6g to %.6g\n",
           what, part->pixels, part->solid_angle_sr, part->illuminance_lx, part->mean, part->median,
           part->deviation, part->percentile_75, part->percentile_95, part->least, part->most);
}

static void print_glare(const struct orl_glare *glare, const struct glare_options *glare_options)
{
    if (glare_options->detail)
        print_sources(glare);
    for (int m = 0; m < ORL_GLARE_METRICS; m++)
        printf("%-28s %.6g\n", orl_glare_metric_name((enum orl_glare_metric)m),
               glare->values[m].value);
    printf("%-28s %s\n", "class", orl_glare_class_name(glare->class_of));
    printf("%-28s %zu above %.6g cd/m2\n", "sources", glare->n_sources, glare->threshold_cd_m2);
    if (glare_options->directions)
        printf("%-28s %.4g degrees to the left\n", "worst line of sight", glare->turned_deg);
    if (glare_options->mask)
        print_part("mask", &glare->masked);
    if (glare_options->band)
        print_part("band", &glare->band);
}

static void print_warnings(const char *name, const struct orl_glare *glare, bool measured)
{
    static const double hemisphere = 2 * 3.14159265358979323846, almost = 0.98;
    if (glare->field_sr < almost * hemisphere && !measured)
        fprintf(stderr,
                "oriel glare: %s shows only %.0f %% of the hemisphere; the rest of the light is "
                "missing (give the total with --illuminance)\n",
                name, 100 * glare->field_sr / hemisphere);
    uint32_t percent;
    if (orl_glare_is_blurred(glare, 100, &percent))
        fprintf(stderr,
                "oriel glare: the pixels of %s are too wide for a bright source of %zu pixels, "
                "such as the sun, so DGP is too low: %.2f, and at least %.2f by the brightest of "
                "them; make the picture %u times as wide\n",
                name, glare->blurred_pixels, glare->values[ORL_GLARE_DGP].value, glare->sharper_dgp,
                percent / 100);
}

static int evaluate_picture(const char *name, const struct glare_options *glare_options,
                            const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                            struct orl_error *err)
{
    struct orl_files files = orl_files_from_folder(".");
    struct orl_file picture, mask;
    int rc = files.open(files.ctx, name, &picture, err);
    if (rc < 0)
        return rc;
    if (glare_options->mask)
        rc = files.open(files.ctx, glare_options->mask, &mask, err);
    if (rc == 0) {
        const struct orl_picture_bytes of_picture = {name, picture.data, picture.size};
        struct orl_picture_bytes of_mask = {glare_options->mask, NULL, 0};
        if (glare_options->mask) {
            of_mask.data = mask.data;
            of_mask.size = mask.size;
        }
        rc = orl_glare_of_picture(&of_picture, glare_options->view,
                                  glare_options->mask ? &of_mask : NULL, settings, ret_glare, err);
        if (glare_options->mask)
            files.close(files.ctx, &mask);
    }
    files.close(files.ctx, &picture);
    return rc;
}

int orl_cmd_glare(const struct orl_subcommand *self, int argc, char **argv)
{
    struct glare_options a = {0};
    const struct orl_option options[] = {
        {"detail", 'd', NULL, "also list the glare sources", NULL, &a.detail},
        {"json", 0, NULL, "print everything as JSON", NULL, &a.json},
        {"view", 0, "OPTIONS", "view options in place of the picture's VIEW line", &a.view, NULL},
        {"threshold", 'b', "NUMBER",
         "threshold of sources in cd/m2; up to 100, a multiple of the task's or mean luminance",
         &a.threshold, NULL},
        {"task", 'T', "X,Y,ANGLE",
         "task area: pixels from the left and from below, diameter in radians", &a.task, NULL},
        {"radius", 'r', "RADIANS", "search radius for the pixels of a source (0.2)", &a.radius,
         NULL},
        {"smooth", 's', NULL, "add pixels surrounded by a source to it", NULL, &a.smooth},
        {"peak", 'Y', "CD_M2", "make brighter pixels separate sources (50000)", &a.peak, NULL},
        {"no-peaks", 'x', NULL, "do not make bright pixels separate sources", NULL, &a.no_peaks},
        {"mask", 'A', "FILE", "report luminances where this picture is above 0.1", &a.mask, NULL},
        {"band", 'B', "RADIANS",
         "report luminances up to this angle above and below the picture's middle row", &a.band,
         NULL},
        {"illuminance", 'i', "LX", "vertical illuminance measured at the eye", &a.eye, NULL},
        {"published", 0, NULL, "DGP with its paper's constants, not evalglare's", NULL,
         &a.published},
        {"low-light", 0, NULL, "DGP with the correction below 1000 lx", NULL, &a.low_light},
        {"age", 0, "YEARS", "DGP for people of that age", &a.age, NULL},
        {"whole-pixels", 0, NULL, "take position indices where evalglare takes them", NULL,
         &a.whole_pixels},
        {"directions", 0, "N,SPAN", "report the worst of N lines of sight over SPAN degrees",
         &a.directions, NULL},
    };
    struct orl_glare_settings settings = {.threshold = 0};
    struct orl_operands operands;
    struct orl_glare glare = {0};
    struct orl_error err = {0};
    int rc;
    if (!orl_options_parse(self, argc, argv, options, sizeof options / sizeof *options, 1, 1,
                           &operands, &rc))
        return rc;
    rc = read_settings(self, &a, &settings);
    if (rc != ORL_EXIT_OK)
        return rc;
    if (evaluate_picture(operands.items[0], &a, &settings, &glare, &err) < 0)
        return orl_report_error(&err);
    print_warnings(operands.items[0], &glare, settings.eye_lx > 0);
    if (a.json)
        rc = orl_print_json(orl_glare_to_json(&glare, (1U << ORL_GLARE_METRICS) - 1), 9, &err);
    else
        print_glare(&glare, &a);
    orl_glare_done(&glare);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}
