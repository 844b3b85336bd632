#include "support/year_room.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/year.h"

const char year_room_scene[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;

char *year_room_read(const char *path, size_t *ret_size)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    fseek(file, 0, SEEK_END);
    *ret_size = (size_t)ftell(file);
    rewind(file);
    char *text = calloc(1, *ret_size + 1);
    assert_non_null(text);
    assert_int_equal(fread(text, 1, *ret_size, file), *ret_size);
    fclose(file);
    return text;
}

void year_room_desks(char *text, size_t size)
{
    size_t at = 0;
    for (int i = 0; i < 24; i++)
        at += (size_t)snprintf(text + at, size - at, "%g %g 0.8 0 0 1\n", 0.5 + 0.5 * (i % 6),
                               0.5 + 0.75 * (double)(i / 6));
}

char *year_room_weather(int units)
{
    static const int days[12] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    static const struct year_site site = {47, 8, 1};
    enum { SIZE = 1 << 19 };
    char *text = calloc(1, SIZE), day[2048];
    assert_non_null(text);
    size_t at = (size_t)snprintf(text, SIZE,
                                 "place made_up\nlatitude 47\nlongitude -8\ntime_zone -15\n"
                                 "site_elevation 0\nweather_data_file_units %d\n",
                                 units);
    for (int month = 1; month <= 12; month++)
        for (int d = 1; d <= days[month - 1]; d++) {
            day[0] = '\0';
            year_day(&site, month, d, day, sizeof day);
            at += (size_t)snprintf(text + at, SIZE - at, "%s", day);
        }
    return text;
}

int year_room_set_up(void **state)
{
    static struct year_room room;
    static char desks[2048];
    struct reply reply;
    size_t size;
    char *epw = year_room_read("tests/fixtures/weather.epw", &size), *whole = year_room_weather(1);
    char *other = year_room_weather(2);
    year_room_desks(desks, sizeof desks);
    const char *bad = "place x\nlatitude 1\nlongitude 1\ntime_zone 0\nsite_elevation 0\n"
                      "weather_data_file_units 1\n3 21 11.5 0 ?\n";
    const struct upload_file files[] = {
        {"room.rad", year_room_scene, strlen(year_room_scene), false},
        {"place.epw", epw, size, true},
        {"whole.wea", whole, strlen(whole), true},
        {"other.wea", other, strlen(other), true},
        {"desks.pts", desks, strlen(desks), true},
        {"bad.pts", "0 0 1 0 0 1\n0 0 x 0 0 1\n", 24, true},
        {"bad.wea", bad, strlen(bad), true},
        {"use.csv", "1\n0\n1\n", 6, true},
    };
    assert_non_null(epw);
    daemon_start(&room.daemon, NULL);
    daemon_upload(&room.daemon, files, sizeof files / sizeof *files, NULL, &reply);
    if (reply.status != 201)
        fail_msg("%s", reply.body);
    snprintf(room.scene, sizeof room.scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    free(epw);
    free(whole);
    free(other);
    *state = &room;
    return 0;
}

int year_room_tear_down(void **state)
{
    daemon_remove(&((struct year_room *)*state)->daemon);
    return 0;
}

void year_room_post(struct year_room *room, const char *members, struct reply *ret_reply)
{
    const size_t size = strlen(members) + 256;
    char *text = malloc(size);
    assert_non_null(text);
    snprintf(text, size, "{\"kind\":\"annual\",\"scene\":\"%s\",%s}", room->scene, members);
    daemon_post_json(&room->daemon, "/v1/jobs", text, ret_reply);
    free(text);
}

void year_room_submit(struct year_room *room, const char *members, char ret_path[80])
{
    struct reply reply;
    year_room_post(room, members, &reply);
    if (reply.status != 202)
        fail_msg("the year was refused: %s", reply.body);
    assert_string_equal(reply_text(&reply, "kind"), "annual");
    snprintf(ret_path, 80, "%s", reply_text(&reply, "links.self"));
    reply_done(&reply);
}

void year_room_expect(struct year_room *room, const char *job, const char *state, int attempts,
                      struct reply *ret_reply)
{
    daemon_wait(&room->daemon, job, 240, ret_reply);
    if (strcmp(reply_text(ret_reply, "state"), state) != 0 ||
        reply_number(ret_reply, "attempts") != attempts)
        fail_msg("%s: %s", job, ret_reply->body);
}
