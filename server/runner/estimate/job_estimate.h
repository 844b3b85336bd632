/*
 * Estimates made before a job is accepted: its memory (job_memory.c), its limits and result bytes
 * by kind (job_kinds.c), and its work (job_work.c).
 */
#ifndef ORL_SERVER_RUNNER_ESTIMATE_JOB_ESTIMATE_H
#define ORL_SERVER_RUNNER_ESTIMATE_JOB_ESTIMATE_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>
#include <oriel/job/plan.h>

#include "job/job_request_json.h"

/*
 * Estimate of a job's memory from its document and its scene.
 *
 * The figures are peaks of jobs that varied one number at a time, measured on one room and rounded
 * up (health/README.md has them). They are the bytes of a surface with its part of the hierarchy, a
 * photon while its map is built, a sensor in the document, a sensor of a file, and a pixel with its
 * error. The figure for a byte of a BSDF file is a bound for files of one-digit numbers, well above
 * ordinary files. Check: in an annual job of 8760 rows the daemon's peak was 89 MB with 57 sensors
 * (estimate 172 MB), and 199 MB with 2000 sensors (estimate 290 MB).
 * Threads: any.
 */

struct orl_job_memory {
    uint64_t surfaces, triangles; /* size of the scene */
    uint64_t bsdf_bytes;          /* size of the scene's XML files */
    uint64_t photons;             /* photons of all maps */
    uint64_t sensors, file_sensors;
    uint64_t pixels;          /* size of the largest view */
    uint64_t year_rows;       /* rows of an annual job's weather; 0: not an annual job */
    uint64_t hour_bytes;      /* bytes of one sensor for an hour with light, in an annual job */
    uint64_t bsdf_made_bytes; /* peak bytes while a panel's BSDF is made */
    uint64_t mask_pixels;     /* size of the largest glare mask */
    uint64_t array_bytes;     /* bytes of one sensor's resulting matrices */
    uint64_t windows;         /* upper bound of windows with phase matrices; 0: not requested */
    uint64_t viewpoints;   /* glare viewpoints of an annual job: the most that are rated together */
    uint64_t matrix_bytes; /* matrices read from files, with their products */
    uint64_t window_groups; /* window groups of an annual job with shades */
    uint64_t sun_nodes;     /* sets of sun nodes of an annual job, beyond the first */
};

/* Files of matrices have this many floats for each value in memory. */
enum { ORL_MATRIX_CHANNELS = 3 };

/* Returns the bytes of windows' phase matrices. There are no more windows than surfaces. */
uint64_t orl_job_memory_windows(const struct orl_job_memory *needs);

/* Returns an upper bound of the hours with light of all sensors of an annual job together. */
uint64_t orl_job_memory_hours(const struct orl_job_memory *needs);

/* Returns the bytes of the glare viewpoints' views, pictures and hours. */
uint64_t orl_job_memory_viewpoints(const struct orl_job_memory *needs);

uint64_t orl_job_memory_estimate(const struct orl_job_memory *needs);

/* Sets ORL_ERR_LIMIT, with the numbers, for a job whose estimate exceeds all memory. */
int orl_job_memory_refuse(const struct orl_job_memory *needs, uint64_t most, struct orl_error *err);

/*
 * Properties of each kind of job that the daemon needs to accept it: limits, and the likely size of
 * its results and memory. worker_run.c has how each kind runs.
 *
 * Threads: any; no state.
 */

/* The contents of an upload, by the summary that its check made. */
struct orl_upload_contents {
    uint64_t sources;       /* distant sources of a scene */
    uint64_t measured_rows; /* above 0: the upload is measurements, not a scene */
};

struct orl_job_kind {
    /* Checks the daemon's limits, if these are below the command's: ORL_ERR_LIMIT. NULL: none. */
    int (*check_limits)(const struct orl_job_request *job_request, struct orl_error *err);
    /* Return the approximate maximum size of the results: the bytes by the document, and the bytes
     * for each sensor of a file, whose number is not in the document. */
    uint64_t (*result_bytes)(const struct orl_job_request *job_request);
    uint64_t (*sensor_bytes)(const struct orl_job_request *job_request);
    /* Returns the result bytes for each sensor and hour with light in an annual job; NULL: not
     * annual. */
    uint64_t (*hour_bytes)(const struct orl_job_request *job_request);
    /* Fills in the request's quantities for the memory estimate; *ret_needs is all zeros before. */
    void (*needs)(const struct orl_job_request *job_request, struct orl_job_memory *ret_needs);
    /* Returns true if some of its files are checked together with the document and the scene. NULL:
     * none. */
    bool (*whole_scene)(const struct orl_job_request *job_request);
    /* Checks that the uploaded contents suit this kind of job. */
    int (*check_contents)(const struct orl_upload_contents *contents, struct orl_error *err);
};

extern const struct orl_job_kind orl_job_kinds[ORL_JOB_KIND_COUNT];

/*
 * Estimate of a job's work from its document, before its scene is loaded. It decides if submitting
 * parts to a Slurm queue is worthwhile. Scenes differ by a factor of several.
 */

enum orl_job_work_class {
    ORL_WORK_INDIVISIBLE, /* this kind of job is not split into parts */
    ORL_WORK_DEADLINE,    /* jobs with a deadline are not split either */
    ORL_WORK_UNKNOWN,     /* the document does not determine the work */
    ORL_WORK_ESTIMATED,
    ORL_WORK_CLASS_COUNT
};

struct orl_job_work {
    enum orl_job_work_class work_class;
    double s; /* seconds of one core, for ORL_WORK_ESTIMATED */
};

/* Estimates the work. files: the files that the job request names. */
struct orl_job_work orl_job_work(const struct orl_job_request *job_request,
                                 const struct orl_files *files);

/* Returns true if the job is split into parts; ret_why is the reason for either. least_s: the least
 * work that is worth splitting. */
bool orl_job_is_split(const struct orl_job_work *work, double least_s, char ret_why[ORL_WHY_MAX]);

#endif
