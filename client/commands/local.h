/*
 * Runs jobs in this process, for `oriel run`, `oriel plan`, `oriel study` and others. Files are
 * read from the folder of the job document. A second Ctrl-C or SIGTERM ends the program.
 */
#ifndef ORL_CLIENT_COMMANDS_LOCAL_H
#define ORL_CLIENT_COMMANDS_LOCAL_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_convert.h>
#include <oriel/bsdf/bsdf_fit.h>
#include <oriel/bsdf/bsdf_make.h>
#include <oriel/job/run.h>
#include <oriel/job/study.h>

#include "annual_job/annual_json.h"
#include "input/job_file.h"
#include "options/job_options.h"

/* The command line of a local command: an operand, -o DIR and --threads N. */
struct orl_local_line {
    const char *operand;      /* a document, or a result */
    struct orl_operands all;  /* all operands, including that one */
    int most;                 /* input: most operands allowed; 0: one */
    bool may_be_bare;         /* input: true if there may be no operand; it is NULL then */
    const char *output;       /* value of -o; NULL: absent */
    const char *threads_text; /* value of --threads */
    uint32_t threads;         /* input: default for --threads; 0: one per core */
    bool writes;              /* input: true if -o is required */
};

/* Parses the line (orl_options_parse). If it returns true, Ctrl-C and SIGTERM then cancel the
 * functions below. */
bool orl_local_parse(const struct orl_subcommand *self, int argc, char **argv,
                     const struct orl_option *options, size_t n_options,
                     struct orl_local_line *line, int *ret_exit);

/* The --threads option of most local commands. */
#define ORL_OPTION_THREADS(target)                                                                 \
    {                                                                                              \
        .name = "threads", .letter = 'j', .metavar = "N",                                          \
        .help = "threads (default: one per core); same results", .value = (target)                 \
    }

/*
 * Returns the flag that Ctrl-C and SIGTERM set. A run that does not end within 5 s after that
 * is killed, unless it has parts in other processes (orl_local_has_parts), which are cancelled
 * first.
 */
const atomic_bool *orl_local_interrupted(void);
void orl_local_has_parts(void);

/* Renders with progress on stderr. Images are written to output, maps and loaded BSDFs to
 * output/maps. Here and below, distribution is NULL if the run is not shared. */
int orl_local_run(const struct orl_job *job, const char *folder, const char *output,
                  uint32_t threads, const struct orl_local_distribution *distribution,
                  struct orl_result *ret_result, struct orl_error *err);

/* Renders a job with several skies: writes <sky>.json, images and errors of each sky as soon as
 * it is done. *ret_results (result_json.h) is owned by the caller. */
int orl_local_run_skies(const struct orl_job *job, const char *folder, const char *output,
                        uint32_t threads, const struct orl_local_distribution *distribution,
                        json_t **ret_results, struct orl_error *err);

/* Makes only the plan, or the plan under each sky, without output. on_result: callback of
 * orl_plan_skies. */
typedef int orl_local_plan_callback(void *ctx, const char *sky, const struct orl_result *planned,
                                    const struct orl_accuracy_curve *curve, struct orl_error *err);
int orl_local_plan(const struct orl_job *job, const char *folder, uint32_t threads,
                   orl_local_plan_callback *on_result, void *ctx, struct orl_error *err);

/* Runs the study with progress on stderr; its runs write nothing to output. */
int orl_local_study(const struct orl_study_request *request, const char *folder, const char *output,
                    uint32_t threads, const struct orl_local_distribution *distribution,
                    struct orl_study *ret_study, struct orl_error *err);

/* Computes a panel's BSDF with progress on stderr. */
int orl_local_make_bsdf(const struct orl_bsdf_make_request *request, const char *folder,
                        uint32_t threads, const struct orl_local_distribution *distribution,
                        struct orl_bsdf_make_result *ret_made, struct orl_error *err);

/* Converts a BSDF likewise. source: description of the input, which the new XML states. */
int orl_local_convert_bsdf(const struct orl_bsdf *bsdf, const char *source,
                           const struct orl_bsdf_make_request *to, uint32_t threads,
                           struct orl_bsdf_make_result *ret_made, struct orl_error *err);
/* Converts a BSDF and culls it as far as within allows (orl_bsdf_convert_within). */
int orl_local_cull_bsdf(const struct orl_bsdf *bsdf, const char *source,
                        const struct orl_bsdf_make_request *to, double within, uint32_t threads,
                        double *ret_unseen, struct orl_bsdf_make_result *ret_made,
                        struct orl_bsdf_comparison *ret_lost, struct orl_error *err);
/* Compares two BSDFs. */
int orl_local_compare_bsdfs(const struct orl_bsdf *a, const struct orl_bsdf *b, uint32_t threads,
                            struct orl_bsdf_comparison *ret_comparison, struct orl_error *err);
/* Fits a BSDF to measurements, with progress on stderr. */
int orl_local_fit_bsdf(const struct orl_bsdf_fit_request *request, const char *folder,
                       uint32_t threads, struct orl_bsdf_fit_result *ret_fitted,
                       struct orl_error *err);

/* Runs a year's job with progress on stderr; writes all its files but result.json to output.
 * on_result: callback of annual_job.h, called with ctx. cache: folder for the year's intermediate
 * results, created if absent; NULL: none. */
struct orl_local_callback {
    int (*on_result)(void *ctx, const struct orl_annual_result *result,
                     const struct orl_annual_report *report, json_t *document,
                     struct orl_error *err);
    void *ctx;
};
int orl_local_annual(struct orl_annual_job *job, const char *folder, const char *output,
                     const char *cache, uint32_t threads,
                     const struct orl_local_distribution *distribution,
                     const struct orl_local_callback *on_result, struct orl_error *err);

/* Loads the file at path. *ret_bsdf: to be released by orl_bsdf_unref. */
int orl_bsdf_file_load(const char *path, struct orl_bsdf **ret_bsdf, struct orl_error *err);
/* Formats the source of a BSDF: "panel.xml, SHA-256 0123..." */
int orl_bsdf_file_source(const char *path, char ret_source[512], struct orl_error *err);

/* Computes a year of a project, as `oriel annual` does. distributed: NULL if not in parts. Returns
 * an exit code. */
int orl_run_project_year(const struct orl_local_line *line, const struct orl_project_line *project,
                         const struct orl_distributed_options *distributed);

#endif
