/* cmocka's set-ups and tear-downs for tests that use a daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/daemon.h"
#include "support/scene_text.h"

int daemon_set_up(void **state)
{
    static struct daemon daemon;
    daemon_start(&daemon, NULL);
    *state = &daemon;
    return 0;
}

int daemon_tear_down(void **state)
{
    daemon_remove(*state);
    return 0;
}

int daemon_room_set_up(void **state)
{
    static struct daemon_room room;
    daemon_start(&room.daemon, NULL);
    daemon_upload_room(&room.daemon, room.scene);
    *state = &room;
    return 0;
}

int daemon_weather_set_up(void **state)
{
    static struct daemon_room room;
    struct reply reply;
    size_t size;
    char *wea = (char *)scene_read_bytes("tests/fixtures/weather.wea", &size);
    const struct upload_file files[2] = {{"room.rad", room_scene, strlen(room_scene), false},
                                         {"place.wea", wea, size, true}};
    daemon_start(&room.daemon, NULL);
    daemon_upload(&room.daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(room.scene, sizeof room.scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(wea);
    *state = &room;
    return 0;
}

int daemon_room_tear_down(void **state)
{
    daemon_remove(&((struct daemon_room *)*state)->daemon);
    return 0;
}
