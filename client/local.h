/*
 * Jobs in this process: what `oriel run`, `oriel plan` and `oriel study` have in common. Files come
 * from the folder of the job document. A second Ctrl-C or SIGTERM ends the program.
 */
#ifndef ORL_CLIENT_LOCAL_H
#define ORL_CLIENT_LOCAL_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdint.h>

#include <oriel/bsdf_convert.h>
#include <oriel/bsdf_fit.h>
#include <oriel/bsdf_make.h>
#include <oriel/error.h>
#include <oriel/run.h>
#include <oriel/study.h>

#include "annual_json.h"
#include "command.h"

/* The line of a command that computes here: an operand, -o DIR and --threads N. */
struct orl_local_line {
    const char *operand;      /* a document, or a result */
    struct orl_operands all;  /* operands, that one first */
    int most;                 /* beforehand: operands there may be; 0: one */
    const char *output;       /* of -o; NULL: not given */
    const char *threads_text; /* of --threads */
    uint32_t threads;         /* beforehand: without --threads; 0: one per core */
    bool writes;              /* beforehand: there must be a -o */
};

/* orl_options_parse for it. True: from then on Ctrl-C and SIGTERM cancel what those below do. */
bool orl_local_parse(const struct orl_subcommand *self, int argc, char **argv,
                     const struct orl_option *options, size_t n_options,
                     struct orl_local_line *line, int *ret_exit);

/* For most of those commands. */
#define ORL_OPTION_THREADS(target)                                                                 \
    {                                                                                              \
        .name = "threads", .letter = 'j', .metavar = "N",                                          \
        .help = "threads to use (default: one per core); results do not depend on it",             \
        .value = (target)                                                                          \
    }

/* Whom a run is shared with (oriel/pieces.h), and where its pieces and maps are. Borrowed. */
struct orl_local_share {
    const struct orl_pieces *pieces;
    const struct orl_map_store *store;
};

/*
 * The flag that Ctrl-C and SIGTERM set. A run that does not end in 5 s after that is ended, unless
 * it has parts in other processes, which are cancelled first.
 */
const atomic_bool *orl_local_interrupted(void);
void orl_local_has_parts(void);

/* Renders, with progress on stderr; images go to output, maps and loaded BSDFs to output/maps.
 * share: NULL: with nobody; here and below. */
int orl_local_run(const struct orl_job *job, const char *folder, const char *output,
                  uint32_t threads, const struct orl_local_share *share,
                  struct orl_result *ret_result, struct orl_error *err);

/* The same of a job of several skies: <sky>.json, images and errors of each as soon as it is done.
 * *ret_results (skies_result_json.h) is the caller's. */
int orl_local_run_skies(const struct orl_job *job, const char *folder, const char *output,
                        uint32_t threads, const struct orl_local_share *share, json_t **ret_results,
                        struct orl_error *err);

/* Makes the plan, or those under each of its skies, and nothing else; quietly. tell: of
 * orl_plan_skies. */
typedef int orl_local_tell_plan(void *ctx, const char *sky, const struct orl_result *planned,
                                const struct orl_curve *curve, struct orl_error *err);
int orl_local_plan(const struct orl_job *job, const char *folder, uint32_t threads,
                   orl_local_tell_plan *tell, void *ctx, struct orl_error *err);

/* Runs the study, with progress on stderr; its runs keep nothing in output. */
int orl_local_study(const struct orl_study_request *request, const char *folder, const char *output,
                    uint32_t threads, const struct orl_local_share *share,
                    struct orl_study *ret_study, struct orl_error *err);

/* Makes a panel's BSDF, with progress on stderr. */
int orl_local_make_bsdf(const struct orl_bsdf_make_request *request, const char *folder,
                        uint32_t threads, const struct orl_local_share *share,
                        struct orl_bsdf_made *ret_made, struct orl_error *err);

/* The same of one that is converted; its source is what the file says. */
int orl_local_convert_bsdf(const struct orl_bsdf *bsdf, const char *source,
                           const struct orl_bsdf_make_request *to, uint32_t threads,
                           struct orl_bsdf_made *ret_made, struct orl_error *err);
/* And culled as far as it may be (orl_bsdf_convert_within). */
int orl_local_cull_bsdf(const struct orl_bsdf *bsdf, const char *source,
                        const struct orl_bsdf_make_request *to, double within, uint32_t threads,
                        double *ret_unseen, struct orl_bsdf_made *ret_made,
                        struct orl_bsdf_comparison *ret_lost, struct orl_error *err);
/* What two of them differ by. */
int orl_local_compare_bsdfs(const struct orl_bsdf *a, const struct orl_bsdf *b, uint32_t threads,
                            struct orl_bsdf_comparison *ret_comparison, struct orl_error *err);
/* The same of measurements. */
int orl_local_fit_bsdf(const struct orl_bsdf_fit_request *request, const char *folder,
                       uint32_t threads, struct orl_bsdf_fitted *ret_fitted, struct orl_error *err);

/* Runs a year's job, with progress on stderr; all its files but result.json go to output. tell: of
 * annual_job.h, with ctx. cache: a folder, made if need be, where what the year is made of is kept
 * and looked for; NULL: none. */
struct orl_local_tell {
    int (*tell)(void *ctx, const struct orl_annual_result *result,
                const struct orl_annual_report *report, json_t *document, struct orl_error *err);
    void *ctx;
};
int orl_local_annual(struct orl_annual_job *job, const char *folder, const char *output,
                     const char *cache, uint32_t threads, const struct orl_local_share *share,
                     const struct orl_local_tell *tell, struct orl_error *err);

#endif
