/*
 * genclock: a clock of radius 1.1 about the x axis, facing along it, with its materials. The
 * figures on its face are a text pattern.
 */
#include <ctype.h>
#include <string.h>

#include "base/text/number.h"
#include "scene/generate/solid/solids.h"

struct clock {
    const char *face, *case_, *name; /* materials; NULL: the program's own */
    double hour;
};

/* Reads "HH:MM", or hours with a fraction. */
static int read_hour(const char *word, double *ret_hour, struct orl_error *err)
{
    const size_t digits = strspn(word, "0123456789"), length = strlen(word);
    double minutes = 0;
    bool good = digits > 0 && digits < 7;
    if (good && word[digits] == ':') {
        good = orl_number_read(word, digits, ret_hour) == ORL_NUMBER_OK &&
               orl_number_read(word + digits + 1, length - digits - 1, &minutes) == ORL_NUMBER_OK &&
               isdigit((unsigned char)word[digits + 1]) && minutes < 60;
        *ret_hour += minutes / 60.0;
    } else {
        good = good && (word[digits] == '\0' || word[digits] == '.') &&
               orl_number_read(word, length, ret_hour) == ORL_NUMBER_OK;
    }
    return good ? 0
                : orl_error_set(err, ORL_ERR_SYNTAX,
                                "genclock: '%.40s' is no time: write 10:35 or 10.58", word);
}

static int read_words(struct clock *clock, struct orl_words *words, struct orl_error *err)
{
    int code = 0;
    while (code == 0 && words->left > 1) {
        const char *option = *words->at++;
        words->left--;
        const char **name = strcmp(option, "-f") == 0   ? &clock->face
                            : strcmp(option, "-c") == 0 ? &clock->case_
                            : strcmp(option, "-n") == 0 ? &clock->name
                                                        : NULL;
        code = name ? orl_words_name(words, option, name, err)
                    : orl_error_set(err, ORL_ERR_SYNTAX, "genclock: '%.40s' is no option", option);
    }
    if (code == 0 && words->left != 1)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "genclock: the time is missing");
    return code < 0 ? code : read_hour(words->at[0], &clock->hour, err);
}

static void add_materials(struct clock *clock, struct orl_text *text)
{
    if (!clock->face) {
        clock->face = "white_plastic";
        orl_text_add(text, "void plastic white_plastic 0 0 5 .85 .85 .85 0 0\n");
    }
    if (!clock->case_) {
        clock->case_ = "black_plastic";
        orl_text_add(text, "void plastic black_plastic 0 0 5 .08 .08 .08 .03 .04\n");
    }
    orl_text_add(text,
                 "'%s' brighttext clock_face_paint 2 hexbit4x1.fnt clockface.hex 0\n"
                 "11 0 -1 1 0 .0185 0 0 0 -.00463 .02 1\n",
                 clock->face);
    orl_text_add(text, "void glass clock_crystal 0 0 3 .95 .95 .95\n"
                       "void plastic hand_paint 0 0 5 .03 .03 .03 0 0\n");
}

static void add_ring(const struct clock *clock, const char *material, const char *part,
                     const char *numbers, struct orl_text *text)
{
    orl_text_add_head(text, material, "ring", clock->name, part, 8);
    orl_text_add(text, " %s\n", numbers);
}

static void add_body(const struct clock *clock, struct orl_text *text)
{
    add_ring(clock, clock->case_, "case_back", "0 0 0 -1 0 0 0 1.1", text);
    orl_text_add_cylinder(text, clock->case_, clock->name, "case_outer", orl_v3(0, 0, 0),
                          orl_v3(.12, 0, 0), 1.1);
    add_ring(clock, clock->case_, "case_front", ".12 0 0 1 0 0 1 1.1", text);
    orl_text_add_cylinder(text, clock->case_, clock->name, "case_inner", orl_v3(.05, 0, 0),
                          orl_v3(.12, 0, 0), 1);
    add_ring(clock, "clock_crystal", "crystal", ".10 0 0 1 0 0 0 1", text);
    add_ring(clock, "clock_face_paint", "face", ".05 0 0 1 0 0 0 1", text);
}

/* Adds a hand from tail to tip in a plane of constant x; the first two corners are at the tail. */
static void add_hand(const struct clock *clock, const char *part, double x, const double tail[2],
                     const double tip[2], double angle_rad, struct orl_text *text)
{
    const double y[4] = {-tail[0], tail[0], tip[0], -tip[0]};
    const double s = sin(-angle_rad), c = cos(-angle_rad);
    orl_text_add_head(text, "hand_paint", "polygon", clock->name, part, 12);
    for (int i = 0; i < 4; i++) {
        const double z = i < 2 ? tail[1] : tip[1];
        orl_text_add_point(text, orl_v3(x, y[i] * c - z * s, z * c + y[i] * s));
    }
    orl_text_add(text, "\n");
}

int orl_genclock(const char *const *words, size_t count, struct orl_text *text,
                 struct orl_error *err)
{
    struct clock clock = {.name = "clock"};
    struct orl_words rest = {"genclock", words + 1, count - 1};
    const int code = read_words(&clock, &rest, err);
    if (code < 0)
        return code;
    add_materials(&clock, text);
    add_body(&clock, text);
    add_hand(&clock, "hour_hand", .06, (const double[]){.03, -.06}, (const double[]){.025, .5},
             2 * ORL_PI / 12 * clock.hour, text);
    add_hand(&clock, "minute_hand", .07, (const double[]){.02, -.1}, (const double[]){.01, .9},
             2 * ORL_PI * (clock.hour - floor(clock.hour)), text);
    return 0;
}
