/*
 * A daemon that has a room with weather and sensors, valid and invalid, for annual jobs. Everything
 * here fails the running test on error.
 */
#ifndef ORL_TESTS_SUPPORT_YEAR_ROOM_H
#define ORL_TESTS_SUPPORT_YEAR_ROOM_H

#include "support/daemon.h"

/* Members of an annual document: a grid of 24 sensors and a single one; weather and seed. */
#define YEAR_ROOM_GRIDS                                                                            \
    "\"grids\":[{\"name\":\"the desks\",\"sensors\":{\"file\":\"desks.pts\"}},"                    \
    "{\"sensors\":[[2,2,1.2,0,-1,0]]}],"
#define YEAR_ROOM_SEEDED "\"weather\":\"place.epw\",\"seed\":3,"

struct year_room {
    struct daemon daemon; /* first: *state also serves as a struct daemon_room */
    char scene[65];
};

/* cmocka's fixtures; *state is a struct year_room. */
int year_room_set_up(void **state);
int year_room_tear_down(void **state);

/* Posts an annual job of the room with additional members. */
void year_room_post(struct year_room *room, const char *members, struct reply *ret_reply);
/* Posts it, expects acceptance, and returns the job's path. */
void year_room_submit(struct year_room *room, const char *members, char ret_path[80]);
/* Waits for its end; expects that state and that number of attempts. */
void year_room_expect(struct year_room *room, const char *job, const char *state, int attempts,
                      struct reply *ret_reply);

/* The room alone, desks.pts, and all hours of a made-up year as a WEA file in those units. */
extern const char year_room_scene[];
void year_room_desks(char *ret_text, size_t size);
char *year_room_weather(int units); /* owned */

/* Returns a file's text, owned, NUL-terminated; NULL if the file is missing. */
char *year_room_read(const char *path, size_t *ret_size);

#endif
