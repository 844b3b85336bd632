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

enum { PATH_SENSORS = 5, PATH_TEXT = 16384 };
extern const struct orl_sensor path_sensors[PATH_SENSORS];

size_t path_source_count(void);
size_t path_chain_count(void);
const char *path_source_name(size_t source);
const char *path_chain_name(size_t chain);

/* A cell's scene; pane.xml, which it may name, is path_pane(). False where the source cannot stand
 * on the chain's side (a sun in a closed room). */
bool path_cell_scene(size_t source, size_t chain, char ret_text[PATH_TEXT]);
/* A BSDF that transmits .2/sr in every direction, both ways. */
const char *path_pane(void);

#endif
