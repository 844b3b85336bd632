/*
 * Rooms in which light is rare: deep rooms, corridors, wells, tubes, cups, strips, lenses, doors
 * ajar. Walls reflect .4; each room has five sensors, in the air, on the floor and upright.
 */
#ifndef ORL_TESTS_SUPPORT_RARE_ROOMS_H
#define ORL_TESTS_SUPPORT_RARE_ROOMS_H

#include <stddef.h>

#include <oriel/run.h>

#include "support/path_cells.h"

size_t rare_room_count(void);
const char *rare_room_name(size_t room);

/* The room's scene; pane.xml, which it may name, is path_pane(). */
void rare_room_scene(size_t room, char ret_text[PATH_TEXT],
                     struct orl_sensor ret_sensors[PATH_SENSORS]);

/* A job for a room of that name: with more text in its scene, and with so many caustic photons. */
struct rare_room_job {
    const char *name, *more; /* more: or NULL */
    enum orl_technique technique;
    uint64_t seed, caustic; /* 0: 1, and none */
};

/* Runs it with 200 000 global photons; the result is the caller's, for orl_result_done. */
struct orl_result rare_room_run(const struct rare_room_job *job);

#endif
