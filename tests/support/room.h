/*
 * A room of 4 x 5 x 3 m with a window in the south and a shelf, sun and a uniform sky: the scene
 * for invariance tests. It has only polygons, so that it can be rotated, moved and scaled.
 */
#ifndef ORL_TESTS_SUPPORT_ROOM_H
#define ORL_TESTS_SUPPORT_ROOM_H

#include "support/scene_text.h"

#define ROOM_GREY "void plastic w 0 0 5 .5 .5 .5 0 0\n"
#define ROOM_CLEAR "void glass p 0 0 3 .9 .9 .9\n"
#define ROOM_BSDF "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"
#define ROOM_SHELL                                                                                 \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"                                           \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"                                             \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"                                                          \
    "w polygon shelf 0 0 12 0 2 1 4 2 1 4 2.4 1 0 2.4 1\n"
#define ROOM_PANE "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
#define ROOM_GROUND                                                                                \
    "void plastic e 0 0 5 .2 .2 .2 0 0\ne polygon ground 0 0 12 -40 -40 -.3 40 -40 -.3 40 40 -.3 " \
    "-40 40 -.3\n"
#define ROOM_SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
#define ROOM_SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"

enum { ROOM_SENSORS = 5 };
extern const struct orl_sensor room_sensors[ROOM_SENSORS];

/* Scene text of the room with all walls facing the other way. */
extern const char room_flipped[];

/* A transform of every vertex, the sensors and the sun. The sky is uniform in all directions. */
struct room_change {
    double scale, turn_deg;
    struct orl_vec3 shift;
};

/* Computes the sensors' lux after that change. */
void room_changed_lx(const struct room_change *change, uint64_t global, uint64_t seed,
                     double ret_lx[ROOM_SENSORS]);

/* Output bytes of a run with a BSDF pane, both maps and a small view. */
struct room_bytes {
    double lx[ROOM_SENSORS];
    struct orl_health health;
    unsigned char *data[3]; /* global map, caustic map, image; owned */
    size_t size[3];
};
struct room_bytes room_run_all(uint32_t threads, uint64_t seed);
void room_free_bytes(struct room_bytes *bytes);
/* Returns true if numbers, health and files are equal. */
bool room_same_bytes(const struct room_bytes *a, const struct room_bytes *b);

#endif
