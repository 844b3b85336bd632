/*
 * Radiance's programs on the office: the same files, photon counts, view and sensors. They are
 * looked for on PATH, and need their library on RAYPATH.
 */
#ifndef ORL_TESTS_BENCH_RADIANCE_H
#define ORL_TESTS_BENCH_RADIANCE_H

#include "bench/office.h"

enum radiance_map { RADIANCE_GLOBAL, RADIANCE_CAUSTIC, RADIANCE_PRECOMPUTED, RADIANCE_MAPS };

struct radiance {
    const struct office *office;
    char folder[BENCH_PATH + 16]; /* the scene's files, maps and results */
};

/* A program that is missing; NULL: all are there. */
const char *radiance_missing(void);

/* Whether another one is on PATH. */
bool radiance_has(const char *program);

/* Copies the office, with its panel, to a folder in the office's, called name. */
void radiance_open(struct radiance *radiance, const struct office *office, const char *name);

/* An octree of the scene's files, ending in that one for the panel's panes, as NAME.oct. */
void radiance_octree(const struct radiance *radiance, const char *panes, const char *name);

/*
 * A command in words, none of which holds a blank; no shell reads it. Input and output as
 * bench_spawn takes them, in the folder.
 */
struct bench_use radiance_run(const struct radiance *radiance, const char *input,
                              const char *output, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Photons of a kind (records are a quarter of them) from the panes as ports. */
struct bench_use radiance_make_map(const struct radiance *radiance, enum radiance_map map,
                                   uint64_t photons);

/* The options that read those maps, each after a blank. */
void radiance_use_maps(const bool uses[RADIANCE_MAPS], char ret_options[256]);

/* The sensors by rtrace, in lux; the view by rpict, as cd/m2, for the caller to free. */
struct bench_use radiance_sensors(const struct radiance *radiance, const char *options,
                                  double ret_lx[OFFICE_SENSORS]);
struct bench_use radiance_image(const struct radiance *radiance, const char *options,
                                uint32_t width, uint32_t height, double **ret_luminances);

#endif
