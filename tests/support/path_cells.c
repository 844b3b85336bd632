#include "support/path_cells.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "support/scene_text.h"

const struct orl_sensor path_sensors[PATH_SENSORS] = {
    {{2, 1.4, 0.8}, {0, 0, 1}},      {{2.3, 3.4, 0.8}, {0, 0, 1}}, {{0.5, 2.4, 1e-4}, {0, 0, 1}},
    {{2.1, 2.6, 1.2}, {0, -1, 0.1}}, {{2.2, 2, 1.6}, {0, 0, -1}},
};

#define MATERIALS                                                                                  \
    "void plastic w 0 0 5 .4 .4 .4 0 0\nvoid plastic g 0 0 5 .2 .2 .2 0 0\n"                       \
    "void glass clear 0 0 3 .9 .9 .9\nvoid mirror mirror 0 0 3 .8 .8 .8\n"                         \
    "void BSDF pane 6 0 pane.xml 0 0 1 . 0 0\nvoid dielectric crystal 0 0 5 1 1 1 1.5 0\n"         \
    "void metal rough 0 0 5 .8 .8 .8 1 .1\nvoid metal smooth 0 0 5 .8 .8 .8 1 0\n"                 \
    "void trans milk 0 0 7 .8 .8 .8 0 0 .7 .4\n"
#define WALLS                                                                                      \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"                                             \
    "w polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 4 3 4 4 0\n"                                              \
    "w polygon north 0 0 12 0 4 0 4 4 0 4 4 3 0 4 3\n"
#define CEILING "w polygon ceiling 0 0 12 0 0 3 0 4 3 4 4 3 4 0 3\n"
#define SOUTH_OPEN                                                                                 \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1.2 0 1 2.8 0 1 2.8 0 2.4 1.2 0 2.4 1.2 0 1\n"                                                \
    "g polygon ground 0 0 12 -20 -20 -.2 20 -20 -.2 20 20 -.2 -20 20 -.2\n"
#define SOUTH_SHUT "w polygon south 0 0 12 0 0 0 0 0 3 4 0 3 4 0 0\n"
#define ROOM_OPEN MATERIALS WALLS CEILING SOUTH_OPEN
#define ROOM_SHUT MATERIALS WALLS CEILING SOUTH_SHUT
/* A pane in the opening, or at y behind it. */
#define PANE(material, y)                                                                          \
    material " polygon pane" #y " 0 0 12 1.2 " #y " 1 1.2 " #y " 2.4 2.8 " #y " 2.4 2.8 " #y " 1"  \
             "\n"
#define REVEAL                                                                                     \
    "w polygon sill 0 0 12 1.2 0 1 2.8 0 1 2.8 .1 1 1.2 .1 1\n"                                    \
    "w polygon head 0 0 12 1.2 0 2.4 1.2 .1 2.4 2.8 .1 2.4 2.8 0 2.4\n"                            \
    "w polygon left 0 0 12 1.2 0 1 1.2 .1 1 1.2 .1 2.4 1.2 0 2.4\n"                                \
    "w polygon right 0 0 12 2.8 0 1 2.8 0 2.4 2.8 .1 2.4 2.8 .1 1\n"
#define PATCH(material) material " polygon patch 0 0 12 1 .3 .02 3.2 .3 .02 3.2 3.2 .02 1 3.2 .02\n"

struct source {
    const char *name, *outdoors, *indoors; /* indoors: NULL: none */
};

static const struct source sources[] = {
    {"sun", "void light l 0 0 3 4e3 4e3 4e3\nl source sun 0 0 4 .25 -1 .75 9\n", NULL},
    {"sky", "void glow l 0 0 4 10 10 10 0\nl source sky 0 0 4 0 0 1 180\n", NULL},
    {"small lamp", "void light l 0 0 3 1e4 1e4 1e4\nl sphere lamp 0 0 4 2.3 -1.5 2.6 .12\n",
     "void light l 0 0 3 1e3 1e3 1e3\nl sphere lamp 0 0 4 1.2 1.8 2.2 .12\n"},
    {"large lamp", "void light l 0 0 3 400 400 400\nl sphere lamp 0 0 4 2.3 -1.5 2.6 .5\n",
     "void light l 0 0 3 100 100 100\nl sphere lamp 0 0 4 1.2 1.8 2.3 .3\n"},
    {"spotlight", /* the length of a spotlight's direction is its focus, which changes the inverse
                     square law */
     "void spotlight l 0 0 7 1e4 1e4 1e4 60 0 2e-4 -1.2e-4\n"
     "l ring lamp 0 0 8 2 -1.5 2.6 0 2 -1.2 0 .16\n",
     "void spotlight l 0 0 7 1e3 1e3 1e3 60 2e-4 .5e-4 -1e-4\n"
     "l ring lamp 0 0 8 1.2 1.8 2.6 2 .5 -1 0 .16\n"},
    {"glow", "void glow l 0 0 4 400 400 400 0\nl sphere lamp 0 0 4 2.3 -1.5 2.6 .5\n",
     "void glow l 0 0 4 100 100 100 0\nl sphere lamp 0 0 4 1.2 1.8 2.3 .3\n"},
};

struct chain {
    const char *name, *text;
    bool indoors;
};

static const struct chain chains[] = {
    {"opening", ROOM_OPEN, false},
    {"glass", ROOM_OPEN PANE("clear", 0), false},
    {"BSDF", ROOM_OPEN PANE("pane", 0), false},
    {"glass then BSDF", ROOM_OPEN REVEAL PANE("clear", 0) PANE("pane", .1), false},
    {"BSDF then glass", ROOM_OPEN REVEAL PANE("pane", 0) PANE("clear", .1), false},
    {"two BSDFs", ROOM_OPEN REVEAL PANE("pane", 0) PANE("pane", .1), false},
    {"two glasses", ROOM_OPEN REVEAL PANE("clear", 0) PANE("clear", .1), false},
    {"BSDF behind opening", ROOM_OPEN PANE("pane", .1), false},
    {"glass behind opening", ROOM_OPEN PANE("clear", .1), false},
    {"half open window", ROOM_OPEN "clear polygon pane 0 0 12 1.2 0 1 1.2 0 2.4 2 0 2.4 2 0 1\n",
     false},
    {"half open BSDF", ROOM_OPEN "pane polygon pane 0 0 12 1.2 0 1 1.2 0 2.4 2 0 2.4 2 0 1\n",
     false},
    {"mirror on floor, open", ROOM_OPEN PATCH("mirror"), false},
    {"mirror on floor, glazed", ROOM_OPEN PANE("clear", 0) PATCH("mirror"), false},
    {"metal on floor, glazed", ROOM_OPEN PANE("clear", 0) PATCH("smooth"), false},
    {"glass on floor, glazed", ROOM_OPEN PANE("clear", 0) PATCH("clear"), false},
    {"rough reflector", ROOM_OPEN PANE("clear", 0) PATCH("rough"), false},
    {"mirror then BSDF",
     ROOM_OPEN PANE("pane", 0) "mirror polygon out 0 0 12 0 -3 -.1 4 -3 -.1 4 0 -.1 0 0 -.1\n",
     false},
    {"curved mirror", ROOM_OPEN PANE("clear", 0) "smooth sphere ball 0 0 4 2 1 .6 .4\n", false},
    {"slab",
     ROOM_OPEN PANE("crystal", 0) "crystal polygon b 0 0 12 1.2 .1 1 2.8 .1 1 2.8 .1 2.4 1.2 .1 "
                                  "2.4\n"
                                  "crystal polygon c 0 0 12 1.2 0 1 2.8 0 1 2.8 .1 1 1.2 .1 1\n"
                                  "crystal polygon d 0 0 12 1.2 0 2.4 1.2 .1 2.4 2.8 .1 2.4 2.8 0 "
                                  "2.4\n"
                                  "crystal polygon e 0 0 12 1.2 0 1 1.2 .1 1 1.2 .1 2.4 1.2 0 "
                                  "2.4\n"
                                  "crystal polygon f 0 0 12 2.8 0 1 2.8 0 2.4 2.8 .1 2.4 2.8 .1 "
                                  "1\n",
     false},
    {"lens", ROOM_OPEN "crystal sphere ball 0 0 4 2 .5 1.6 .4\n", false},
    {"lens, glazed", ROOM_OPEN PANE("clear", 0) "crystal sphere ball 0 0 4 2 .5 1.6 .4\n", false},
    {"trans", ROOM_OPEN PANE("milk", 0), false},
    {"glass then trans", ROOM_OPEN REVEAL PANE("clear", 0) PANE("milk", .1), false},
    {"door ajar",
     ROOM_OPEN PANE("clear", 0) "w polygon door 0 0 12 .1 .8 0 4 .8 0 4 .8 3 .1 .8 3\n", false},
    {"light tube",
     MATERIALS WALLS SOUTH_SHUT
     "w polygon ceiling 0 0 30 0 0 3 4 0 3 4 4 3 0 4 3 0 0 3 "
     "1.8 1.3 3 1.8 1.7 3 2.2 1.7 3 2.2 1.3 3 1.8 1.3 3\n"
     "smooth polygon a 0 0 12 1.8 1.3 3 2.2 1.3 3 2.2 1.3 3.8 1.8 1.3 3.8\n"
     "smooth polygon b 0 0 12 1.8 1.7 3 2.2 1.7 3 2.2 1.7 3.8 1.8 1.7 3.8\n"
     "smooth polygon c 0 0 12 1.8 1.3 3 1.8 1.7 3 1.8 1.7 3.8 1.8 1.3 3.8\n"
     "smooth polygon d 0 0 12 2.2 1.3 3 2.2 1.7 3 2.2 1.7 3.8 2.2 1.3 3.8\n"
     "clear polygon lid 0 0 12 1.8 1.3 3 2.2 1.3 3 2.2 1.7 3 1.8 1.7 3\n",
     false},
    {"direct", ROOM_SHUT, true},
    {"mirror wall",
     ROOM_SHUT "mirror polygon m 0 0 12 3.98 .1 .1 3.98 .1 2.9 3.98 3.9 2.9 3.98 "
               "3.9 .1\n",
     true},
    {"metal wall",
     ROOM_SHUT "smooth polygon m 0 0 12 3.98 .1 .1 3.98 .1 2.9 3.98 3.9 2.9 3.98 "
               "3.9 .1\n",
     true},
    {"rough wall",
     ROOM_SHUT "rough polygon m 0 0 12 3.98 .1 .1 3.98 .1 2.9 3.98 3.9 2.9 3.98 "
               "3.9 .1\n",
     true},
    {"glass partition", ROOM_SHUT "clear polygon m 0 0 12 1.8 0 0 1.8 4 0 1.8 4 3 1.8 0 3\n", true},
    {"BSDF partition", ROOM_SHUT "pane polygon m 0 0 12 1.8 0 0 1.8 4 0 1.8 4 3 1.8 0 3\n", true},
    {"trans partition", ROOM_SHUT "milk polygon m 0 0 12 1.8 0 0 1.8 4 0 1.8 4 3 1.8 0 3\n", true},
    {"partition ajar", ROOM_SHUT "w polygon m 0 0 12 1.8 .2 0 1.8 4 0 1.8 4 3 1.8 .2 3\n", true},
    {"ball of glass", ROOM_SHUT "crystal sphere ball 0 0 4 1.8 2 1.5 .4\n", true},
    {"ball of metal", ROOM_SHUT "smooth sphere ball 0 0 4 2.9 2.9 1.1 .3\n", true},
    {"cup",
     ROOM_SHUT "w ring bottom 0 0 8 1.2 1.8 1.8 0 0 1 0 .4\n"
               "w cylinder side 0 0 7 1.2 1.8 1.8 1.2 1.8 2.75 .4\n",
     true},
    {"cup of metal",
     ROOM_SHUT "smooth ring bottom 0 0 8 1.2 1.8 1.8 0 0 1 0 .4\n"
               "smooth cylinder side 0 0 7 1.2 1.8 1.8 1.2 1.8 2.75 .4\n",
     true},
};

#define COUNT(array) (sizeof(array) / sizeof *(array))

size_t path_source_count(void)
{
    return COUNT(sources);
}

size_t path_chain_count(void)
{
    return COUNT(chains);
}

const char *path_source_name(size_t source)
{
    return sources[source].name;
}

const char *path_chain_name(size_t chain)
{
    return chains[chain].name;
}

bool path_cell_scene(size_t source, size_t chain, char ret_text[PATH_TEXT])
{
    const struct source *s = &sources[source];
    const struct chain *c = &chains[chain];
    const char *const light = c->indoors ? s->indoors : s->outdoors;
    if (!light)
        return false;
    const int length = snprintf(ret_text, PATH_TEXT, "%s%s", c->text, light);
    assert_in_range(length, 1, PATH_TEXT - 1);
    return true;
}

struct path_verdict path_judge(double lx, const double interval[2], const struct brute_value *truth)
{
    static const double two_sided = 1.96; /* standard errors of a 95 % interval */
    const double t = truth->mean, se = truth->standard_error;
    const double margin = t > lx ? interval[1] - lx : lx - interval[0];
    if (!(se < 0.2 * t))
        return (struct path_verdict){.known = false};
    return (struct path_verdict){.known = true,
                                 .held = interval[0] - two_sided * se <= t &&
                                         t <= interval[1] + two_sided * se,
                                 .z = (lx - t) / fmax(hypot(margin / two_sided, se), 1e-9)};
}

const char *path_pane(void)
{
    static char xml[2048];
    if (!xml[0])
        scene_uniform_bsdf(0.2, xml);
    return xml;
}
