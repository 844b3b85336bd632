/*
 * Radiance's programs on the office: the same files, photon counts, view and sensors. They are
 * searched on PATH, and need their library on RAYPATH.
 */
#ifndef ORL_TESTS_BENCH_RADIANCE_H
#define ORL_TESTS_BENCH_RADIANCE_H

#include "bench/office.h"

enum radiance_map { RADIANCE_GLOBAL, RADIANCE_CAUSTIC, RADIANCE_PRECOMPUTED, RADIANCE_MAPS };

struct radiance {
    const struct office *office;
    char folder[BENCH_PATH + 16]; /* the scene's files, maps and results */
};

/* Returns the name of a missing program; NULL if all exist. */
const char *radiance_missing(void);

/* Returns true if the program is on PATH. */
bool radiance_has(const char *program);

/* Copies the office with its panel into a subfolder of the office's folder, called name. */
void radiance_open(struct radiance *radiance, const struct office *office, const char *name);

/* Builds NAME.oct from the scene's files; the last one, for the panel's panes, is `panes`. */
void radiance_octree(const struct radiance *radiance, const char *panes, const char *name);

/*
 * Runs a command, split at blanks, without a shell. Input and output are files of the folder, as
 * for bench_spawn.
 */
struct bench_use radiance_run(const struct radiance *radiance, const char *input,
                              const char *output, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Shoots photons of a kind from the panes as photon ports; the map stores a quarter of them. */
struct bench_use radiance_make_map(const struct radiance *radiance, enum radiance_map map,
                                   uint64_t photons);

/* Returns the options that read those maps, each after a blank. */
void radiance_use_maps(const bool uses[RADIANCE_MAPS], char ret_options[256]);

/* Compute the sensors by rtrace, in lux, and the view by rpict, in cd/m2; the caller frees the
 * latter. */
struct bench_use radiance_sensors(const struct radiance *radiance, const char *options,
                                  double ret_lx[OFFICE_SENSORS]);
struct bench_use radiance_image(const struct radiance *radiance, const char *options,
                                uint32_t width, uint32_t height, double **ret_luminances);

#endif
