/*
 * The scenes of `make paths`: each source of light with each chain of surfaces through which its
 * light enters, or travels in, a room of 4 x 4 x 3 m with walls of reflectance 0.4. A cell is one
 * source with one chain; its sensors are in the air, on the floor and upright.
 */
#ifndef ORL_TESTS_SUPPORT_PATH_CELLS_H
#define ORL_TESTS_SUPPORT_PATH_CELLS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/job/run.h>

#include "support/brute.h"

enum { PATH_SENSORS = 5, PATH_TEXT = 16384 };
extern const struct orl_sensor path_sensors[PATH_SENSORS];

size_t path_source_count(void);
size_t path_chain_count(void);
const char *path_source_name(size_t source);
const char *path_chain_name(size_t chain);

/* Writes a cell's scene, which may name pane.xml, that is path_pane(). Returns false if the source
 * cannot stand on the chain's side (a sun in a closed room). */
bool path_cell_scene(size_t source, size_t chain, char ret_text[PATH_TEXT]);
/* Comparison of a sensor's value with the truth of plain path tracing. */
struct path_verdict {
    bool known; /* true if the truth has an error below a fifth; otherwise nothing below is set */
    bool held;  /* true if the interval holds the truth, allowing for the truth's error */
    double z;   /* difference in joint standard errors of the interval and the truth */
};
struct path_verdict path_judge(double lx, const double interval[2],
                               const struct brute_value *truth);

/* Returns a BSDF that transmits .2/sr in every direction, both ways. */
const char *path_pane(void);

#endif
