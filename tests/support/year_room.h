/*
 * A daemon that has a room, with weather and sensors, good and bad, for years of it. Everything
 * here fails the running test when it does not succeed.
 */
#ifndef ORL_TESTS_SUPPORT_YEAR_ROOM_H
#define ORL_TESTS_SUPPORT_YEAR_ROOM_H

#include "support/daemon.h"

/* Members of a year's document: a table of 24 sensors and one by itself; weather and seed. */
#define YEAR_ROOM_GRIDS                                                                            \
    "\"grids\":[{\"name\":\"the desks\",\"sensors\":{\"file\":\"desks.pts\"}},"                    \
    "{\"sensors\":[[2,2,1.2,0,-1,0]]}],"
#define YEAR_ROOM_SEEDED "\"weather\":\"place.epw\",\"seed\":3,"

struct year_room {
    struct daemon daemon; /* first: as of struct daemon_room */
    char scene[65];
};

/* cmocka's; *state is a struct year_room. */
int year_room_set_up(void **state);
int year_room_tear_down(void **state);

/* A year of the room with those members more. */
void year_room_post(struct year_room *room, const char *members, struct reply *ret_reply);
/* The same, taken; the job's path. */
void year_room_submit(struct year_room *room, const char *members, char ret_path[80]);
/* Waits for its end, in that state, by so many starts. */
void year_room_expect(struct year_room *room, const char *job, const char *state, int attempts,
                      struct reply *ret_reply);

/* The room by itself, desks.pts, and all hours of a year as a WEA file of those units, made up. */
extern const char year_room_scene[];
void year_room_desks(char *ret_text, size_t size);
char *year_room_weather(int units); /* owned */

/* A file's text, owned, NUL added; NULL: there is none. */
char *year_room_read(const char *path, size_t *ret_size);

#endif
