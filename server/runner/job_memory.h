/*
 * What a job is likely to take in memory: by what its document asks for and what its scene has.
 *
 * The figures are peaks of jobs by one number at a time, measured on one room and rounded up
 * (README.md has them): of a surface with its place in the hierarchy, a photon while its map is
 * built, a sensor as it stands in the document, a sensor of a file, a pixel with its error. That of
 * a byte of a BSDF's file is a bound for files of numbers of one digit, well above ordinary ones.
 * Of a year of 8760 rows the daemon's peak was 89 MB with 57 sensors, where 172 were foreseen, and
 * 199 MB with 2000, where 290 were.
 * Threads: any.
 */
#ifndef ORL_SERVER_RUNNER_JOB_MEMORY_H
#define ORL_SERVER_RUNNER_JOB_MEMORY_H

#include <stdint.h>

#include <oriel/error.h>

struct orl_job_memory {
    uint64_t surfaces, triangles; /* the scene's */
    uint64_t bsdf_bytes;          /* of its XML files */
    uint64_t photons;             /* of all maps */
    uint64_t sensors, file_sensors;
    uint64_t pixels;          /* of the largest view */
    uint64_t year_rows;       /* of the weather of a year; 0: it is none */
    uint64_t hour_bytes;      /* ... that each of its sensors takes for an hour with light */
    uint64_t bsdf_made_bytes; /* of a panel's BSDF that is made: all of it at once, at most */
    uint64_t mask_pixels;     /* of the largest mask of glare */
    uint64_t array_bytes;     /* of a sensor, of matrices that are results */
    uint64_t windows;         /* at most, that have matrices of phases; 0: they are not asked for */
    uint64_t seats;           /* of glare, in a year: the most that are rated together */
    uint64_t matrix_bytes;    /* of others' matrices, with their products */
    uint64_t window_groups;   /* of a year, with shades */
    uint64_t sun_nodes;       /* of a year: sets of as many as there are by default, beyond one */
};

/* Files of matrices have so many floats for each value in memory. */
enum { ORL_MATRIX_CHANNELS = 3 };

/* In memory, of windows' matrices of phases: no more windows than surfaces. */
uint64_t orl_job_memory_windows(const struct orl_job_memory *needs);

/* Hours with light of all sensors of a year together, at most. */
uint64_t orl_job_memory_hours(const struct orl_job_memory *needs);

/* Bytes for window groups: a year sums light by group for at least eight sensors at a time. */
uint64_t orl_job_memory_groups(const struct orl_job_memory *needs);

/* In memory, of seats' views, pictures and hours. */
uint64_t orl_job_memory_seats(const struct orl_job_memory *needs);

uint64_t orl_job_memory_estimate(const struct orl_job_memory *needs);

/* ORL_ERR_LIMIT, with the numbers: it takes more than there ever is. */
int orl_job_memory_refuse(const struct orl_job_memory *needs, uint64_t most, struct orl_error *err);

#endif
