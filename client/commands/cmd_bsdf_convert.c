/* oriel bsdf convert FILE.xml -o OTHER.xml: converts a BSDF to another basis. oriel bsdf
 * compare A.xml B.xml: prints the differences. */
#include "options/command.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf_json/bsdf_json.h"
#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "options/job_options.h"
#include "output/reports.h"

/* ---- Differences ----------------------------------------------------------------------------- */

static void print_place(const struct orl_bsdf_angles *p)
{
    printf(" (%.0f, %.0f)", p->theta_deg, p->phi_deg);
}

/* Prints the worst colour differences over all components, in red, green or blue. */
static void print_colors(const struct orl_bsdf_comparison *c)
{
    double albedo = 0, cone = 0;
    for (int i = 0; i < 4; i++) {
        const struct orl_bsdf_color_difference *d = &c->of[i / 2][i % 2].color;
        albedo = fabs(d->albedo_worst) > fabs(albedo) ? d->albedo_worst : albedo;
        cone = fabs(d->cone_worst) > fabs(cone) ? d->cone_worst : cone;
    }
    if (c->colored[0] != c->colored[1])
        printf("only the %s file has colour\n", c->colored[0] ? "first" : "second");
    if (c->colored[0] || c->colored[1])
        printf("worst difference of a single channel (red, green or blue): %+.3f in all, %+.3f in "
               "a cone\n",
               100 * albedo, 100 * cone);
}

static void print_comparison(const struct orl_bsdf_comparison *c)
{
    static const char *const sides[2] = {"outside", "inside"};
    static const char *const parts[2] = {"reflected", "transmitted"};
    printf("%-22s %24s %40s %22s\n", "per cent of the light", "in all", "in a cone of 2 degrees",
           "elsewhere");
    printf("%-22s %9s %14s %9s %30s %9s %12s\n", "", "rms", "worst (from)", "worst", "(from) (to)",
           "mean", "worst");
    for (int front = 0; front < 2; front++)
        for (int t = 0; t < 2; t++) {
            const struct orl_bsdf_difference *d = &c->of[front][t];
            printf("%-9s %-12s %9.3f %+9.3f", sides[front], parts[t], 100 * d->albedo_rms,
                   100 * d->albedo_worst);
            print_place(&d->albedo_from);
            printf(" %+9.3f", 100 * d->cone_worst);
            print_place(&d->cone_from);
            print_place(&d->cone_to);
            printf(" %9.3f %9.3f\n", 100 * d->moved_mean, 100 * d->moved_worst);
        }
    print_colors(c);
}

static int write_comparison(const char *path, const struct orl_bsdf_comparison *c,
                            struct orl_error *err)
{
    json_t *json = orl_bsdf_comparison_to_json(c);
    const int rc = orl_write_json(path, json, err);
    json_decref(json);
    return rc;
}

int orl_cmd_bsdf_compare(const struct orl_subcommand *self, int argc, char **argv)
{
    struct orl_local_line line = {.most = 2};
    const char *report = NULL;
    const struct orl_option options[] = {
        {"report", 0, "FILE", "also write a JSON file", &report, NULL},
        ORL_OPTION_THREADS(&line.threads_text),
    };
    struct orl_bsdf *bsdfs[2] = {NULL, NULL};
    struct orl_bsdf_comparison comparison;
    struct orl_error err = {0};
    int code, rc = 0;
    if (!orl_local_parse(self, argc, argv, options, 2, &line, &code))
        return code;
    if (line.all.count != 2)
        return orl_usage_error(self, "compare takes two files");
    for (int i = 0; i < 2 && rc == 0; i++)
        rc = orl_bsdf_file_load(line.all.items[i], &bsdfs[i], &err);
    if (rc == 0)
        rc = orl_local_compare_bsdfs(bsdfs[0], bsdfs[1], line.threads, &comparison, &err);
    if (rc == 0)
        print_comparison(&comparison);
    if (rc == 0 && report)
        rc = write_comparison(report, &comparison, &err);
    orl_bsdf_unref(bsdfs[0]);
    orl_bsdf_unref(bsdfs[1]);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

/* ---- Conversion ------------------------------------------------------------------------------ */

struct line {
    struct orl_local_line local;
    struct orl_member_options member_options;
    const char *report, *within_text;
    double within; /* largest allowed loss by culling; 0: not limited */
    bool color;
};

static const struct orl_member_option member_options[] = {
    {"basis", "klems_full|klems_half|klems_quarter|tensor_tree_3|tensor_tree_4",
     "basis of the XML (klems_full)", true},
    {"resolution", "N", "for tensor trees: cells per side, a power of two up to 128 (64)", false},
    {"cull", "SHARE",
     "for tensor trees: merge cells that differ from their mean by at most this fraction (0.05)",
     false},
    {"symmetry", "left_right|up_down|both", "mirror symmetry to impose (none)", true},
    {"name", "NAME", "name of the material in the XML (default: unchanged)", true},
};
enum { MEMBER_OPTIONS = sizeof member_options / sizeof *member_options };

/* Decodes the options as a document that requests a BSDF. */
static int request_of(const struct line *line, struct orl_bsdf_make_request *ret_request,
                      struct orl_error *err)
{
    json_t *doc = json_pack("{s:s, s:{s:[s]}, s:b}", "kind", "bsdf_make", "scene", "files",
                            line->local.operand, "color", (int)line->color);
    const int failed = !doc || orl_member_options_apply(&line->member_options, doc);
    const int rc = failed ? orl_error_set(err, ORL_ERR_INVALID, "options must be UTF-8 text")
                          : orl_bsdf_make_from_json(doc, ORL_JOB_LOCAL, ret_request, NULL, err);
    json_decref(doc);
    return rc;
}

/* Converts the BSDF and computes the loss. */
static int convert_and_compare(const struct line *line, const struct orl_bsdf *before,
                               const struct orl_bsdf_make_request *to,
                               struct orl_bsdf_make_result *ret_made,
                               struct orl_bsdf_comparison *ret_lost, struct orl_error *err)
{
    struct orl_bsdf *after = NULL;
    char source[512];
    double cull_fraction;
    int rc = orl_bsdf_file_source(line->local.operand, source, err);
    if (rc == 0 && line->within > 0) {
        rc = orl_local_cull_bsdf(before, source, to, line->within, line->local.threads,
                                 &cull_fraction, ret_made, ret_lost, err);
        if (rc == 0)
            printf("cells are merged if that moves less than %.2g of the light\n", cull_fraction);
        return rc;
    }
    if (rc == 0)
        rc = orl_local_convert_bsdf(before, source, to, line->local.threads, ret_made, err);
    const struct orl_bsdf_xml xml = {.name = line->local.output,
                                     .data = ret_made->xml,
                                     .size = ret_made->xml_size,
                                     .cancel = orl_local_interrupted()};
    if (rc == 0)
        rc = orl_bsdf_load(&xml, &after, err);
    if (rc == 0)
        rc = orl_local_compare_bsdfs(before, after, line->local.threads, ret_lost, err);
    orl_bsdf_unref(after);
    return rc;
}

static int run_convert(const struct line *line)
{
    struct orl_bsdf_make_request request = {0};
    struct orl_bsdf_make_result made = {0};
    struct orl_bsdf *before = NULL;
    struct orl_bsdf_comparison comparison;
    struct orl_error err = {0};
    int rc = request_of(line, &request, &err);
    if (rc == 0)
        rc = orl_bsdf_file_load(line->local.operand, &before, &err);
    if (rc == 0)
        rc = convert_and_compare(line, before, &request, &made, &comparison, &err);
    if (rc == 0)
        rc = orl_write_text(line->local.output, made.xml, made.xml_size, &err);
    if (rc == 0)
        print_comparison(&comparison);
    if (rc == 0 && line->report)
        rc = write_comparison(line->report, &comparison, &err);
    orl_bsdf_unref(before);
    orl_bsdf_make_result_done(&made);
    orl_bsdf_make_request_done(&request);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

static bool read_share(const char *text, double *ret_share)
{
    char *end = NULL;
    *ret_share = strtod(text, &end);
    return end != text && *end == '\0' && *ret_share > 0 && *ret_share < 1;
}

int orl_cmd_bsdf_convert(const struct orl_subcommand *self, int argc, char **argv)
{
    enum { OTHERS = 5 };
    struct line line = {.local = {.most = 1},
                        .member_options = {member_options, MEMBER_OPTIONS, {NULL}}};
    struct orl_option options[OTHERS + MEMBER_OPTIONS] = {
        {"output", 'o', "FILE", "XML file to write", &line.local.output, NULL},
        {"color", 0, NULL,
         "include colour: X and Z beside Y; for tensor trees u' and v' (default: grey)", NULL,
         &line.color},
        {"report", 0, "FILE", "write a JSON file with the loss", &line.report, NULL},
        {"within", 0, "SHARE",
         "for tensor trees: cull as far as this fraction of the light is lost at most, in "
         "total or in a cone of two degrees, for any incident direction",
         &line.within_text, NULL},
        ORL_OPTION_THREADS(&line.local.threads_text),
    };
    int code;
    orl_member_options_fill(&line.member_options, options + OTHERS);
    if (!orl_local_parse(self, argc, argv, options, OTHERS + MEMBER_OPTIONS, &line.local, &code))
        return code;
    if (!line.local.output)
        return orl_usage_error(self, "-o FILE is missing");
    if (line.within_text && !read_share(line.within_text, &line.within))
        return orl_usage_error(self, "--within takes a fraction above 0 and below 1: 0.01 is 1 %%");
    return run_convert(&line);
}
