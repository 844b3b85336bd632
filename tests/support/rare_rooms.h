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

#endif
