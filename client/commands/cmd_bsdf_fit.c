/* oriel bsdf fit FILE ... -o FILE.xml: fits a BSDF to goniophotometer measurements. */
#include "options/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf_json/bsdf_json.h"
#include "commands/local.h"
#include "distributed/atomic_files.h"
#include "input/job_file.h"
#include "options/job_options.h"
#include "output/reports.h"
#include "json/encode.h"

enum { FLAGS = 2 };

/* The command line, which is turned into a document. */
struct line {
    struct orl_local_line local;
    struct orl_member_options member_options;
    bool flags[FLAGS];
    bool as_json;
};

static const struct orl_member_option member_options[] = {
    {"basis", "klems_full|klems_half|klems_quarter|tensor_tree_3|tensor_tree_4",
     "basis of the XML (default: tensor_tree_3 if isotropic, or else tensor_tree_4)", true},
    {"symmetry", "isotropic|quadrilateral|left_right|up_down|half_turn|none",
     "symmetry of the material (default: from the incident azimuths)", true},
    {"resolution", "N", "for tensor trees: cells per side, a power of two up to 128 (64)", false},
    {"cull", "SHARE",
     "for tensor trees: merge cells that differ from their mean by at most this fraction (0.02)",
     false},
    {"name", "NAME", "name of the material in the XML (default: the data's, or the first file's)",
     true},
    {"grazing", "DEGREES", "leave out rows measured within this angle of the surface (0)", false},
};
enum { MEMBER_OPTIONS = sizeof member_options / sizeof *member_options };
static const struct {
    const char *option, *member, *help;
} flags[FLAGS] = {
    {"reversed", "reversed", "theta is measured from the outside's normal"},
    {"keep-outliers", "keep_outliers", "do not leave out isolated rows"},
};

/* ---- The document ---------------------------------------------------------------------------- */

static json_t *document_of(const struct line *line)
{
    json_t *doc = orl_member_options_document(&line->member_options, "bsdf_fit", "measurements",
                                              &line->local.all);
    int failed = 0;
    for (int i = 0; i < FLAGS && !failed; i++)
        if (line->flags[i])
            failed = json_object_set_new(doc, flags[i].member, json_true());
    return orl_json_checked(doc, failed);
}

/* Returns true if the line has options that belong in the document. */
static bool has_other_options(const struct line *line)
{
    bool more = line->local.all.count > 1 || orl_member_options_any(&line->member_options);
    for (int i = 0; i < FLAGS; i++)
        more = more || line->flags[i];
    return more;
}

/* Makes the request from the options, or from the document that the line names. */
static int request_of(const struct line *line, struct orl_job_file *file,
                      struct orl_bsdf_fit_request *ret_request, struct orl_error *err)
{
    const char *first = line->local.operand;
    json_t *doc;
    int rc;
    if (orl_is_document_name(first)) {
        rc = orl_job_file_read(first, file, err);
        if (rc == 0)
            rc = orl_bsdf_fit_from_json(file->doc, ORL_JOB_LOCAL, ret_request, NULL, err);
        if (rc)
            orl_error_at(err, first, 0, NULL);
        return rc;
    }
    doc = document_of(line);
    rc = doc ? orl_bsdf_fit_from_json(doc, ORL_JOB_LOCAL, ret_request, NULL, err)
             : orl_error_no_memory(err);
    json_decref(doc);
    return rc;
}

/* ---- Result ---------------------------------------------------------------------------------- */

static void print_scans(const struct orl_bsdf_fit_result *f)
{
    printf("%-8s %-12s %6s %6s %7s %5s %8s %8s %9s %7s %7s %10s %9s\n", "light", "", "theta", "phi",
           "rows", "seen", "total", "+-", "left out", "peak at", "", "1/sr", "astray");
    for (size_t i = 0; i < f->n_scans; i++) {
        const struct orl_bsdf_fit_scan *s = &f->scans[i];
        printf("%-8s %-12s %6.1f %6.1f %7zu %4.0f%% %8.5f %8.1e ", s->front ? "inside" : "outside",
               s->transmitted ? "transmitted" : "reflected", s->theta_deg, s->phi_deg, s->rows,
               100 * s->covered, s->total, s->total_error);
        if (s->left_out)
            printf("%9.5f", s->predicted);
        else
            printf("%9s", "-");
        printf(" %7.1f %7.1f %10.4g", s->peak_theta_deg, s->peak_phi_deg, s->peak);
        if (s->left_out)
            printf(" %8.2f%%", 100 * s->misplaced);
        printf("\n");
    }
}

static void print_outliers(const struct orl_bsdf_fit_request *request,
                           const struct orl_bsdf_fit_result *f)
{
    enum { TOLD = 8 };
    if (f->n_outliers == 0)
        return;
    printf("\n%zu isolated rows are left out:\n", f->n_outliers);
    for (size_t i = 0; i < f->n_outliers && i < TOLD; i++)
        printf("  %s:%u: %.4g among %.4g\n", request->files[f->outliers[i].file],
               f->outliers[i].line, f->outliers[i].value, f->outliers[i].around);
    if (f->n_outliers > TOLD)
        printf("  ...\n");
}

static void print_fitted(const struct orl_bsdf_fit_request *request,
                         const struct orl_bsdf_fit_result *f)
{
    printf("%zu rows, symmetry %s, basis %s\n\n", f->rows, orl_bsdf_fit_symmetry_name(f->symmetry),
           orl_bsdf_basis_name(f->basis));
    print_scans(f);
    printf("\n%-21s %9s %9s %9s %s\n", "diffuse light", "total", "+-", "astray", "measured to");
    for (int i = 0; i < 4; i++) {
        const int front = i / 2, t = i % 2;
        if (!f->has[front][t])
            continue;
        printf("%-8s %-12s %9.5f", front ? "inside" : "outside", t ? "transmitted" : "reflected",
               f->diffuse[front][t].value);
        if (f->misplaced[front][t] >= 0)
            printf(" %9.1e %8.2f%%", f->diffuse[front][t].error, 100 * f->misplaced[front][t]);
        else
            printf(" %9s %9s", "-", "-");
        printf(" theta %.4g\n", f->theta_most_deg[front][t]);
    }
    print_outliers(request, f);
}

static int run_fit(const struct line *line)
{
    struct orl_job_file file = {0};
    struct orl_bsdf_fit_request request = {0};
    struct orl_bsdf_fit_result fitted = {0};
    struct orl_error err = {0};
    int rc = request_of(line, &file, &request, &err);
    if (rc == 0)
        rc = orl_local_fit_bsdf(&request, file.folder[0] ? file.folder : ".", line->local.threads,
                                &fitted, &err);
    if (rc == 0)
        rc = orl_write_text(line->local.output, fitted.xml, fitted.xml_size, &err);
    if (rc == 0 && line->as_json)
        rc = orl_print_json(orl_bsdf_fitted_to_json(&request, &fitted), 9, &err);
    else if (rc == 0)
        print_fitted(&request, &fitted);
    if (rc == 0)
        orl_print_warnings(orl_bsdf_fitted_warnings(&fitted));
    orl_bsdf_fit_result_done(&fitted);
    orl_bsdf_fit_request_done(&request);
    orl_job_file_done(&file);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

int orl_cmd_bsdf_fit(const struct orl_subcommand *self, int argc, char **argv)
{
    enum { OTHERS = 3 };
    struct line line = {.local = {.most = 512},
                        .member_options = {member_options, MEMBER_OPTIONS, {NULL}}};
    struct orl_option options[OTHERS + MEMBER_OPTIONS + FLAGS] = {
        {"output", 'o', "FILE", "XML file to write", &line.local.output, NULL},
        {"json", 0, NULL, "print the result as JSON", NULL, &line.as_json},
        ORL_OPTION_THREADS(&line.local.threads_text),
    };
    int code;
    orl_member_options_fill(&line.member_options, options + OTHERS);
    for (int i = 0; i < FLAGS; i++)
        options[OTHERS + MEMBER_OPTIONS + i] = (struct orl_option){
            .name = flags[i].option, .help = flags[i].help, .flag = &line.flags[i]};
    if (!orl_local_parse(self, argc, argv, options, OTHERS + MEMBER_OPTIONS + FLAGS, &line.local,
                         &code))
        return code;
    if (!line.local.output)
        return orl_usage_error(self, "-o FILE is missing");
    if (orl_is_document_name(line.local.operand) && has_other_options(&line))
        return orl_usage_error(self,
                               "the document \"%s\" takes no further files and options of the fit",
                               line.local.operand);
    return run_fit(&line);
}
