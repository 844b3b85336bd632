/*
 * Rooms in which light is rare: deep rooms, corridors, wells, tubes, cups, strips, lenses, doors
 * ajar. Walls reflect .4; each room has five sensors, in the air, on the floor and upright.
 */
#ifndef ORL_TESTS_SUPPORT_RARE_ROOMS_H
#define ORL_TESTS_SUPPORT_RARE_ROOMS_H

#include <stddef.h>

#include <oriel/job/run.h>

#include "support/path_cells.h"

size_t rare_room_count(void);
const char *rare_room_name(size_t room);

/* Writes the room's scene, which may name pane.xml, that is path_pane(). */
void rare_room_scene(size_t room, char ret_text[PATH_TEXT],
                     struct orl_sensor ret_sensors[PATH_SENSORS]);

/* A job for the room of that name, with additional scene text and that many caustic photons. */
struct rare_room_job {
    const char *name, *more; /* more: additional scene text, or NULL */
    enum orl_technique technique;
    uint64_t seed, caustic; /* 0: seed 1, and no caustic photons */
};

/* Runs it with 200 000 global photons; release the result with orl_result_done. */
struct orl_result rare_room_run(const struct rare_room_job *job);

#endif
