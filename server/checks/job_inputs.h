/*
 * The files of a scene that a job names (job_request_json.h): sensors, weather, and the lists of
 * its views. If they are read with the document, all files of the scene (README.md has the table).
 */
#ifndef ORL_SERVER_CHECKS_JOB_INPUTS_H
#define ORL_SERVER_CHECKS_JOB_INPUTS_H

#include "checks/job_manifest.h"
#include "store/files/scene_bundle.h"

struct orl_job_inputs {
    struct orl_bundle files; /* each file once */
    bool whole_scene;        /* files has the whole scene; read with the document */
    json_t *uses;            /* [name, role, entry or null] for each file to read; NULL: none */
};
void orl_job_inputs_done(struct orl_job_inputs *inputs); /* all zeros are allowed */

/* Findings from reading the files. */
struct orl_job_inputs_found {
    uint64_t sensors;             /* total over all sensor files */
    uint64_t year_rows;           /* rows of a year's weather; 0: no such weather */
    uint64_t surfaces, triangles; /* the largest scene among the combinations of shade states */
    uint64_t matrix_bytes;        /* memory of an annual job by matrices */
};

/* Checks that the scene has the named files. ORL_ERR_NOT_FOUND if not, with the place in the
 * document. */
int orl_job_inputs_check(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                         struct orl_error *err);

/* Collects the files and their uses in *inputs, which must be all zeros. Call it after
 * orl_job_inputs_check. The caller owns the contents of *inputs, even after an error. */
int orl_job_inputs_collect(const struct orl_job_manifest *manifest, const struct orl_bundle *scene,
                           struct orl_job_inputs *inputs, struct orl_error *err);

#endif
