#include "support/rare_rooms.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/scene_text.h"

#define MATERIALS                                                                                  \
    "void plastic w 0 0 5 .4 .4 .4 0 0\nvoid plastic g 0 0 5 .2 .2 .2 0 0\n"                       \
    "void plastic white 0 0 5 .8 .8 .8 0 0\n"                                                      \
    "void glass clear 0 0 3 .9 .9 .9\nvoid mirror mirror 0 0 3 .9 .9 .9\n"                         \
    "void BSDF pane 6 0 pane.xml 0 0 1 . 0 0\nvoid dielectric crystal 0 0 5 1 1 1 1.5 0\n"         \
    "void metal rough 0 0 5 .8 .8 .8 1 .1\nvoid metal smooth 0 0 5 .9 .9 .9 1 0\n"                 \
    "void trans milk 0 0 7 .8 .8 .8 0 0 .7 .4\n"
#define GROUND "g polygon ground 0 0 12 -30 -30 -.2 30 -30 -.2 30 30 -.2 -30 30 -.2\n"
#define SKY GROUND "void glow l 0 0 4 10 10 10 0\nl source sky 0 0 4 0 0 1 180\n"
#define SUN(direction) GROUND "void light l 0 0 3 4e4 4e4 4e4\nl source sun 0 0 4 " direction " 4\n"

/* A rectangular hole in the plane where the axis has that coordinate, from (u0, v0) to (u1, v1) in
 * the other two coordinates, in the order x, y, z. If the plane is no side of the box, it becomes a
 * partition of the room. */
struct hole {
    char axis;
    double at, u0, v0, u1, v1;
};

enum { HOLES = 4 };
struct room {
    const char *name;
    double size[3]; /* size from the origin */
    struct hole holes[HOLES];
    const char *text;
};

static const struct room rooms[] = {
    {"deep room, window 1.2 m", {8, 12, 3}, {{'y', 0, 3.4, 1, 4.6, 2.2}}, SKY},
    {"deep room, window .3 m", {8, 12, 3}, {{'y', 0, 3.9, 1.5, 4.2, 1.8}}, SKY},
    {"deep room, glass, sun",
     {8, 12, 3},
     {{'y', 0, 3.4, 1, 4.6, 2.2}},
     SUN(".3 -1 .6") "clear polygon p 0 0 12 3.4 0 1 3.4 0 2.2 4.6 0 2.2 4.6 0 1\n"},
    {"deep room, BSDF, sun",
     {6, 9, 3},
     {{'y', 0, 2.4, 1, 3.6, 2.2}},
     SUN(".3 -1 .6") "pane polygon p 0 0 12 2.4 0 1 2.4 0 2.2 3.6 0 2.2 3.6 0 1\n"},
    {"corridor", {2, 15, 2.5}, {{'y', 0, .6, .8, 1.4, 2}}, SKY},
    {"corridor, glass, sun",
     {2, 15, 2.5},
     {{'y', 0, .6, .8, 1.4, 2}},
     SUN(".2 -1 .4") "clear polygon p 0 0 12 .6 0 .8 .6 0 2 1.4 0 2 1.4 0 .8\n"},
    {"second room by a door",
     {4, 8, 3},
     {{'y', 0, 1, 1, 3, 2.4}, {'y', 4, 3, 0, 3.8, 2.1}},
     SKY "clear polygon p 0 0 12 1 0 1 1 0 2.4 3 0 2.4 3 0 1\n"},
    {"door ajar, 8 cm",
     {4, 8, 3},
     {{'y', 0, 1, 1, 3, 2.4}, {'y', 4, 3.9, 0, 3.98, 2.1}},
     SKY "clear polygon p 0 0 12 1 0 1 1 0 2.4 3 0 2.4 3 0 1\n"},
    {"gap under a door, sun",
     {4, 8, 3},
     {{'y', 0, 1, 1, 3, 2.4}, {'y', 4, 3, 0, 3.8, .06}},
     SUN(".3 -1 .8") "clear polygon p 0 0 12 1 0 1 1 0 2.4 3 0 2.4 3 0 1\n"},
    {"third room in a row",
     {4, 9, 3},
     {{'y', 0, 1, 1, 3, 2.4}, {'y', 3, 3, 0, 3.8, 2.1}, {'y', 6, .2, 0, 1, 2.1}},
     SKY},
    {"well, sky", {3, 3, 12}, {{'z', 12, .2, .2, 2.8, 2.8}}, SKY},
    {"well, glass, sun",
     {3, 3, 12},
     {{'z', 12, .2, .2, 2.8, 2.8}},
     SUN(".5 -.3 1") "clear polygon p 0 0 12 .2 .2 12 .2 2.8 12 2.8 2.8 12 2.8 .2 12\n"},
    {"room beside a well",
     {4, 6, 6},
     {{'z', 6, 1, .4, 3, 1.8}, {'y', 2, 1, .8, 3, 2}},
     SKY "w polygon m 0 0 12 0 2 3 4 2 3 4 6 3 0 6 3\n"},
    {"tube of mirrors, sky",
     {4, 4, 3},
     {{'z', 3, 1.8, 1.3, 2.2, 1.7}},
     SKY "!genbox smooth tube .4 .4 2 | xform -t 1.8 1.3 3.001\n"},
    {"lens before a hole, sun",
     {4, 4, 3},
     {{'y', 0, 1.8, 1.2, 2.2, 1.6}},
     SUN(".1 -1 .7") "crystal sphere ball 0 0 4 2 -.16 1.4 .15\n"},
    {"rod of glass before a slit",
     {4, 4, 3},
     {{'y', 0, 1, 1.4, 3, 1.6}},
     SKY "crystal cylinder rod 0 0 7 .9 -.2 1.5 3.1 -.2 1.5 .12\n"
         "crystal ring a 0 0 8 .9 -.2 1.5 -1 0 0 0 .12\ncrystal ring b 0 0 8 3.1 -.2 1.5 1 0 0 0 "
         ".12\n"},
    {"strip of mirrored sun",
     {4, 5, 3},
     {{'y', 0, .4, 2.5, 3.6, 2.8}},
     SUN(".1 -1 .8") "clear polygon p 0 0 12 .4 0 2.5 .4 0 2.8 3.6 0 2.8 3.6 0 2.5\n"
                     "mirror polygon m 0 0 12 .4 .1 2.45 3.6 .1 2.45 3.6 .35 2.45 .4 .35 2.45\n"},
    {"light shelf of metal, sun",
     {4, 6, 3},
     {{'y', 0, .4, 1, 3.6, 2.8}},
     SUN(".1 -1 1") "clear polygon p 0 0 12 .4 0 1 .4 0 2.8 3.6 0 2.8 3.6 0 1\n"
                    "rough polygon m 0 0 12 .4 -.6 2.2 3.6 -.6 2.2 3.6 .3 2.2 .4 .3 2.2\n"},
    {"strip of BSDF, 10 cm, sky",
     {4, 5, 3},
     {{'y', 0, .4, 2.7, 3.6, 2.8}},
     SKY "pane polygon p 0 0 12 .4 0 2.7 .4 0 2.8 3.6 0 2.8 3.6 0 2.7\n"},
    {"strip of BSDF, 10 cm, sun",
     {4, 5, 3},
     {{'y', 0, .4, 2.7, 3.6, 2.8}},
     SUN(".1 -1 .6") "pane polygon p 0 0 12 .4 0 2.7 .4 0 2.8 3.6 0 2.8 3.6 0 2.7\n"},
    {"open window, sun",
     {4, 6, 3},
     {{'y', 0, 1, 1, 3, 2.2}},
     SUN("-.4 -1 .6") "clear polygon p 0 0 12 1 0 1 1 0 2.2 2 0 2.2 2 0 1\n"},
    {"pane set back, sky",
     {4, 6, 3},
     {{'y', 0, .2, .9, 3.8, 2.2}},
     SKY "clear polygon p 0 0 12 1 .05 .9 1 .05 2.2 3 .05 2.2 3 .05 .9\n"},
    {"panes that overlap, sky",
     {4, 6, 3},
     {{'y', 0, 1, 1, 3, 2.2}},
     SKY "clear polygon p 0 0 12 1 0 1 1 0 2.2 2.2 0 2.2 2.2 0 1\n"
         "clear polygon q 0 0 12 1.8 .03 1 1.8 .03 2.2 3 .03 2.2 3 .03 1\n"},
    {"partition of trans, sky",
     {4, 8, 3},
     {{'y', 0, 1, 1, 3, 2.4}, {'y', 4, 1, .5, 3, 2.5}},
     SKY "milk polygon p 0 0 12 1 4 .5 1 4 2.5 3 4 2.5 3 4 .5\n"},
    {"blinds of mirrors, sun",
     {4, 5, 3},
     {{'y', 0, 1, 1, 3, 2}},
     SUN(".1 -1 .8") "smooth polygon a 0 0 12 1 .02 1.2 3 .02 1.2 3 .3 1.2 1 .3 1.2\n"
                     "smooth polygon b 0 0 12 1 .02 1.4 3 .02 1.4 3 .3 1.4 1 .3 1.4\n"
                     "smooth polygon c 0 0 12 1 .02 1.6 3 .02 1.6 3 .3 1.6 1 .3 1.6\n"
                     "smooth polygon d 0 0 12 1 .02 1.8 3 .02 1.8 3 .3 1.8 1 .3 1.8\n"},
    {"arc of metal, sun",
     {4, 5, 3},
     {{'y', 0, 1, .6, 3, 1.8}},
     SUN(".2 -1 .7") "smooth cylinder arc 0 0 7 1 1.2 .5 3 1.2 .5 .45\n"
                     "w ring e 0 0 8 1 1.2 .5 -1 0 0 0 .45\nw ring f 0 0 8 3 1.2 .5 1 0 0 0 .45\n"},
    {"pinhole, 5 cm, sky", {2, 3, 2.5}, {{'y', 0, .98, 1.2, 1.03, 1.25}}, SKY},
    {"uplights in cups",
     {5, 5, 3},
     {{0}},
     "void light l 0 0 3 1e3 1e3 1e3\nl sphere a 0 0 4 1 1 1.6 .06\nl sphere b 0 0 4 4 4 1.6 .06\n"
     "white ring c 0 0 8 1 1 1.5 0 0 1 0 .15\nwhite cylinder d 0 0 7 1 1 1.5 1 1 2 .15\n"
     "white ring e 0 0 8 4 4 1.5 0 0 1 0 .15\nwhite cylinder f 0 0 7 4 4 1.5 4 4 2 .15\n"},
    {"lamp in a side room, door ajar",
     {4, 8, 3},
     {{'y', 4, 1, 0, 1.05, 2.1}},
     "void light l 0 0 3 1e3 1e3 1e3\nl sphere a 0 0 4 2.4 6 2.2 .15\n"},
    {"cove",
     {5, 5, 3},
     {{0}},
     "void light l 0 0 3 200 200 200\nl polygon a 0 0 12 .05 .2 2.6 .15 .2 2.6 .15 4.8 2.6 .05 4.8 "
     "2.6\nwhite polygon b 0 0 12 0 0 2.5 .4 0 2.5 .4 5 2.5 0 5 2.5\n"
     "white polygon c 0 0 12 .4 0 2.5 .4 0 2.8 .4 5 2.8 .4 5 2.5\n"},
};
enum { ROOMS = sizeof rooms / sizeof *rooms };

size_t rare_room_count(void)
{
    return ROOMS;
}

const char *rare_room_name(size_t room)
{
    return rooms[room].name;
}

/* ---- Walls ----------------------------------------------------------------------------------- */

struct text {
    char *at;
    size_t left;
    int n; /* rectangles so far */
};

static void append(struct text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void append(struct text *text, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    const int n = vsnprintf(text->at, text->left, format, list);
    va_end(list);
    assert_in_range(n, 0, text->left - 1);
    text->at += n;
    text->left -= (size_t)n;
}

static void add_corner(struct text *text, char axis, double at, double u, double v)
{
    if (axis == 'x')
        append(text, " %g %g %g", at, u, v);
    else if (axis == 'y')
        append(text, " %g %g %g", u, at, v);
    else
        append(text, " %g %g %g", u, v, at);
}

static void add_rectangle(struct text *text, const struct hole *r)
{
    if (!(r->u1 > r->u0 && r->v1 > r->v0))
        return;
    append(text, "w polygon r%d 0 0 12", text->n++);
    add_corner(text, r->axis, r->at, r->u0, r->v0);
    add_corner(text, r->axis, r->at, r->u1, r->v0);
    add_corner(text, r->axis, r->at, r->u1, r->v1);
    add_corner(text, r->axis, r->at, r->u0, r->v1);
    append(text, "\n");
}

/* Writes four rectangles around the hole. */
static void add_wall(struct text *text, const struct room *room, const struct hole *h)
{
    const double width = room->size[h->axis == 'x' ? 1 : 0],
                 height = room->size[h->axis == 'z' ? 1 : 2];
    add_rectangle(text, &(struct hole){h->axis, h->at, 0, 0, h->u0, height});
    add_rectangle(text, &(struct hole){h->axis, h->at, h->u1, 0, width, height});
    add_rectangle(text, &(struct hole){h->axis, h->at, h->u0, 0, h->u1, h->v0});
    add_rectangle(text, &(struct hole){h->axis, h->at, h->u0, h->v1, h->u1, height});
}

static void add_sides(struct text *text, const struct room *room)
{
    for (int side = 0; side < 6; side++) {
        const char axis = "xyz"[side / 2];
        const double at = side % 2 ? room->size[side / 2] : 0;
        bool holed = false;
        for (int i = 0; i < HOLES; i++)
            holed = holed || (room->holes[i].axis == axis && room->holes[i].at == at);
        if (!holed)
            add_rectangle(text, &(struct hole){axis, at, 0, 0, room->size[axis == 'x' ? 1 : 0],
                                               room->size[axis == 'z' ? 1 : 2]});
    }
    for (int i = 0; i < HOLES; i++)
        if (room->holes[i].axis)
            add_wall(text, room, &room->holes[i]);
}

void rare_room_scene(size_t room, char ret_text[PATH_TEXT],
                     struct orl_sensor ret_sensors[PATH_SENSORS])
{
    static const struct {
        double u, v, z; /* shares of the floor; height in metres */
        struct orl_vec3 towards;
    } places[PATH_SENSORS] = {{.5, .3, .8, {0, 0, 1}},
                              {.55, .85, .8, {0, 0, 1}},
                              {.2, .7, 1e-4, {0, 0, 1}},
                              {.53, .65, 1.2, {0, -1, .1}},
                              {.45, .6, 1.3, {0, 0, -1}}};
    const struct room *r = &rooms[room];
    struct text text = {ret_text, PATH_TEXT, 0};
    append(&text, "%s", MATERIALS);
    add_sides(&text, r);
    append(&text, "%s", r->text);
    for (int i = 0; i < PATH_SENSORS; i++)
        ret_sensors[i] = (struct orl_sensor){
            {places[i].u * r->size[0], places[i].v * r->size[1], places[i].z}, places[i].towards};
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

static size_t find_room(const char *name)
{
    for (size_t i = 0; i < ROOMS; i++)
        if (strcmp(rooms[i].name, name) == 0)
            return i;
    fail_msg("there is no room '%s'", name);
    return 0;
}

struct orl_result rare_room_run(const struct rare_room_job *job)
{
    char text[PATH_TEXT];
    struct orl_sensor sensors[PATH_SENSORS];
    rare_room_scene(find_room(job->name), text, sensors);
    if (job->more) {
        assert_true(strlen(text) + strlen(job->more) < sizeof text);
        strcat(text, job->more);
    }
    return scene_run(&(struct scene_run){.scene = text,
                                         .resource_name = "pane.xml",
                                         .resource_text = path_pane(),
                                         .sensors = sensors,
                                         .n_sensors = PATH_SENSORS,
                                         .seed = job->seed,
                                         .technique = job->technique,
                                         .by_plan = true,
                                         .global = 200000,
                                         .caustic = job->caustic,
                                         .threads = 2});
}
