/*
 * Random small rooms for property tests: walls of any reflectance, zero and coloured included;
 * panes of glass or BSDF, or a hole; sun and sky or neither; and objects that are easily missed: a
 * small mirror, a red wall behind a white one, a building opposite, a dim lamp, a block of glass.
 * Each object is absent from about every second room.
 */
#ifndef ORL_TESTS_SUPPORT_RANDOM_SCENE_H
#define ORL_TESTS_SUPPORT_RANDOM_SCENE_H

#include <oriel/job/run.h>

enum { RANDOM_SENSORS = 4 };

struct random_scene {
    char text[8192];
    struct orl_sensor sensors[RANDOM_SENSORS];
    bool sun, sky, bsdf, mirror, red, opposite, lamp, block, glossy, black; /* contents */
};

/*
 * Writes room number `index`, a function of the index only. It may mention the BSDF file pane.xml.
 */
void random_scene(uint32_t index, struct random_scene *ret_scene);

#endif
