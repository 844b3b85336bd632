/*
 * The scenes of `make paths`: each source of light by each chain of surfaces that its light may
 * take into, or through, a room of 4 x 4 x 3 m whose walls reflect .4. A cell is one of each; its
 * sensors stand in the air, on the floor and upright.
 */
#ifndef ORL_TESTS_SUPPORT_PATH_CELLS_H
#define ORL_TESTS_SUPPORT_PATH_CELLS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/run.h>

#include "support/brute.h"

enum { PATH_SENSORS = 5, PATH_TEXT = 16384 };
extern const struct orl_sensor path_sensors[PATH_SENSORS];

size_t path_source_count(void);
size_t path_chain_count(void);
const char *path_source_name(size_t source);
const char *path_chain_name(size_t chain);

/* A cell's scene; pane.xml, which it may name, is path_pane(). False where the source cannot stand
 * on the chain's side (a sun in a closed room). */
bool path_cell_scene(size_t source, size_t chain, char ret_text[PATH_TEXT]);
/* A sensor's value beside the truth of plain path tracing. */
struct path_verdict {
    bool known; /* the truth, to a fifth; else nothing below is set */
    bool held;  /* the interval holds it, allowing for its own error */
    double z;   /* difference in joint standard errors: of the interval's side, and the truth's */
};
struct path_verdict path_judge(double lx, const double interval[2],
                               const struct brute_value *truth);

/* A BSDF that transmits .2/sr in every direction, both ways. */
const char *path_pane(void);

#endif
