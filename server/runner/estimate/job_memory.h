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
#ifndef ORL_SERVER_RUNNER_ESTIMATE_JOB_MEMORY_H
#define ORL_SERVER_RUNNER_ESTIMATE_JOB_MEMORY_H

#include <stdint.h>

#include <oriel/base/error.h>

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

/* Returns the bytes for window groups: an annual job sums light by group for at least eight sensors
 * at a time. */
uint64_t orl_job_memory_groups(const struct orl_job_memory *needs);

/* Returns the bytes of the glare viewpoints' views, pictures and hours. */
uint64_t orl_job_memory_viewpoints(const struct orl_job_memory *needs);

uint64_t orl_job_memory_estimate(const struct orl_job_memory *needs);

/* Sets ORL_ERR_LIMIT, with the numbers, for a job whose estimate exceeds all memory. */
int orl_job_memory_refuse(const struct orl_job_memory *needs, uint64_t most, struct orl_error *err);

#endif
