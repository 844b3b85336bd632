/* oriel bsdf make PANEL.rad ... -o FILE.xml: computes a panel's BSDF from its geometry and
 * materials. */
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

/* The command line, which is turned into a document. */
struct line {
    struct orl_local_line local;
    struct orl_member_options member_options;
    const char *cell, *report, *errors;
    bool color;
    struct orl_distributed_options distributed;
    bool shared; /* true if it asks for parts */
};

static const struct orl_member_option member_options[] = {
    {"basis", "klems_full|klems_half|klems_quarter|tensor_tree_3|tensor_tree_4",
     "basis of the XML (klems_full)", true},
    {"resolution", "N", "for tensor trees: cells per side, a power of two up to 128 (64)", false},
    {"cull", "SHARE",
     "for tensor trees: merge cells that differ from their mean by at most this fraction (0.05)",
     false},
    {"name", "NAME", "name of the material in the XML (default: the file's)", true},
    {"symmetry", "auto|none|left_right|up_down|both",
     "mirror symmetry; auto imposes it as found, for trees of rank 4 (auto)", true},
    {"paths", "N", "paths per incident direction (16384; tensor_tree_3 32768, tensor_tree_4 4096)",
     false},
    {"accuracy", "SHARE",
     "0.02: double the paths of a direction until no standard error exceeds 2 % of its value (for "
     "values from 1 % of the peak on); use a quarter of the largest error you can accept",
     false},
    {"seed", "N", "the same seed gives the same file (1)", false},
};
enum { MEMBER_OPTIONS = sizeof member_options / sizeof *member_options };

/* ---- The document ---------------------------------------------------------------------------- */

static json_t *cell_of(const char *text)
{
    double v[4] = {0};
    const char *at = text;
    for (int i = 0; i < 4; i++) {
        char *end = NULL;
        v[i] = strtod(at, &end);
        if (end == at)
            return json_string(text);
        at = end;
    }
    if (at[strspn(at, " ")] != '\0')
        return json_string(text);
    return json_pack("{s:[f, f], s:[f, f]}", "x", v[0], v[1], "y", v[2], v[3]);
}

static json_t *document_of(const struct line *line)
{
    json_t *doc =
        orl_member_options_document(&line->member_options, "bsdf_make", "scene", &line->local.all);
    int failed = 0;
    if (line->cell)
        failed = json_object_set_new(doc, "cell", cell_of(line->cell));
    if (line->color)
        failed |= json_object_set_new(doc, "color", json_true());
    return orl_json_checked(doc, failed);
}

/* Returns true if the line has options that belong in the document. */
static bool has_other_options(const struct line *line)
{
    return line->cell || line->color || line->local.all.count > 1 ||
           orl_member_options_any(&line->member_options);
}

/* Makes the request from the options, or from the document that the line names. */
static int request_of(const struct line *line, struct orl_job_file *file,
                      struct orl_bsdf_make_request *ret_request, struct orl_error *err)
{
    const char *first = line->local.operand;
    int rc;
    if (orl_is_document_name(first)) {
        rc = orl_job_file_read(first, file, err);
        if (rc == 0)
            rc = orl_bsdf_make_from_json(file->doc, ORL_JOB_LOCAL, ret_request, NULL, err);
        if (rc)
            orl_error_at(err, first, 0, NULL);
        return rc;
    }
    snprintf(file->folder, sizeof file->folder, ".");
    file->doc = document_of(line);
    return file->doc ? orl_bsdf_make_from_json(file->doc, ORL_JOB_LOCAL, ret_request, NULL, err)
                     : orl_error_no_memory(err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

static void print_made(const struct orl_bsdf_make_result *made)
{
    static const char *const sides[2] = {"outside", "inside"};
    printf("cell x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g; %.3g million paths\n",
           made->cell[0], made->cell[1], made->cell[2], made->cell[3], made->depth[0],
           made->depth[1], 1e-6 * (double)made->paths);
    printf("%-20s %10s %10s %10s %10s\n", "diffuse light from", "transmit.", "+-", "reflected",
           "+-");
    for (int front = 0; front < 2; front++) {
        const struct orl_bsdf_share *s = made->diffuse[front];
        printf("%-20s %10.5f %10.1e %10.5f %10.1e\n", sides[front], s[1].value, s[1].error,
               s[0].value, s[0].error);
    }
    printf("largest standard error %.2g of a value (from 1 %% of the peak on)\n", made->worst);
    if (made->merge_error > 0)
        printf("error of merged cells: at most %.2g of the cell's value (rms)\n",
               made->merge_error);
    if (made->lost > 0)
        printf("cut off inside the panel: %.2g of the light\n", made->lost);
}

static int write_report(const char *path, const struct orl_bsdf_make_result *made,
                        struct orl_error *err)
{
    json_t *json = orl_bsdf_made_to_json(made);
    const int rc = orl_write_json(path, json, err);
    json_decref(json);
    return rc;
}

/* Computes the BSDF, in parts if the command line asks for that. Their folder is beside the XML. */
static int compute_bsdf(const struct line *line, const struct orl_job_file *file,
                        const struct orl_bsdf_make_request *request,
                        struct orl_bsdf_make_result *ret_made, struct orl_error *err)
{
    struct orl_local_distributed shared;
    const char *slash = strrchr(line->local.output, '/');
    char beside[4096];
    snprintf(beside, sizeof beside, "%.*s", slash ? (int)(slash - line->local.output) + 1 : 1,
             slash ? line->local.output : ".");
    int rc = orl_local_distributed_open(&shared, line->shared ? &line->distributed : NULL,
                                        file->doc, file->folder, beside, line->local.threads, err);
    if (rc == 0)
        rc = orl_local_make_bsdf(request, file->folder, line->local.threads, shared.distribution,
                                 ret_made, err);
    orl_local_distributed_done(&shared, rc == 0);
    return rc;
}

static int run_make(const struct line *line)
{
    struct orl_job_file file = {0};
    struct orl_bsdf_make_request request = {0};
    struct orl_bsdf_make_result made = {0};
    struct orl_error err = {0};
    int rc = request_of(line, &file, &request, &err);
    request.want_errors = line->errors != NULL;
    if (rc == 0)
        rc = compute_bsdf(line, &file, &request, &made, &err);
    if (rc == 0)
        rc = orl_write_text(line->local.output, made.xml, made.xml_size, &err);
    if (rc == 0 && line->errors)
        rc = orl_write_text(line->errors, made.errors_xml, made.errors_xml_size, &err);
    if (rc == 0 && line->report)
        rc = write_report(line->report, &made, &err);
    if (rc == 0)
        print_made(&made);
    if (rc == 0)
        orl_print_warnings(orl_bsdf_made_warnings(&made, &request));
    orl_bsdf_make_result_done(&made);
    orl_bsdf_make_request_done(&request);
    orl_job_file_done(&file);
    return rc ? orl_report_error(&err) : ORL_EXIT_OK;
}

int orl_cmd_bsdf_make(const struct orl_subcommand *self, int argc, char **argv)
{
    enum { OTHERS = 6 + ORL_DISTRIBUTED_OPTIONS };
    struct line line = {.local = {.most = 64},
                        .member_options = {member_options, MEMBER_OPTIONS, {NULL}}};
    struct orl_option options[OTHERS + MEMBER_OPTIONS] = {
        {"output", 'o', "FILE", "XML file to write", &line.local.output, NULL},
        {"cell", 0, "\"X0 X1 Y0 Y1\"",
         "part of the panel that is repeated (default: its bounding box)", &line.cell, NULL},
        {"color", 0, NULL, "include colour: X and Z beside Y; for tensor trees u' and v'", NULL,
         &line.color},
        {"report", 0, "FILE",
         "write a JSON file with fractions by direction and standard errors of all values",
         &line.report, NULL},
        {"errors", 0, "FILE.xml", "write the same XML with standard errors in place of values",
         &line.errors, NULL},
        ORL_OPTION_THREADS(&line.local.threads_text),
        ORL_OPTIONS_DISTRIBUTED(&line.distributed),
    };
    int code;
    orl_member_options_fill(&line.member_options, options + OTHERS);
    if (!orl_local_parse(self, argc, argv, options, OTHERS + MEMBER_OPTIONS, &line.local, &code))
        return code;
    if (!line.local.output)
        return orl_usage_error(self, "-o FILE is missing");
    if (orl_is_document_name(line.local.operand) && has_other_options(&line))
        return orl_usage_error(
            self, "the document \"%s\" takes no further files and options of the panel",
            line.local.operand);
    line.shared = orl_distributed_is_requested(self, &line.distributed, &code);
    return code ? code : run_make(&line);
}
