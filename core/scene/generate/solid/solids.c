/* Functions that generators of solids share; genblinds and genclock. */
#include "scene/generate/solid/solids.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "base/text/words.h"

int orl_words_name(struct orl_words *words, const char *option, const char **ret_name,
                   struct orl_error *err)
{
    const char *name = words->left > 0 ? words->at[0] : "";
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: a name is missing for %.40s", words->program,
                             option);
    if (*name == '\0' || strchr(name, '\''))
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' is not a valid name for %.40s",
                             words->program, name, option);
    *ret_name = orl_words_take(words);
    return 0;
}

int orl_words_names(struct orl_words *words, const char *thing, const char **ret_material,
                    const char **ret_name, struct orl_error *err)
{
    const int code = orl_words_name(words, "the material", ret_material, err);
    return code < 0 ? code : orl_words_name(words, thing, ret_name, err);
}

void orl_text_add_head(struct orl_text *text, const char *material, const char *type,
                       const char *name, const char *part, size_t n_reals)
{
    orl_text_add(text, "'%s' %s '%s.%s'\n0\n0\n%zu", material, type, name, part, n_reals);
}

void orl_text_add_point(struct orl_text *text, struct orl_vec3 point)
{
    orl_text_add(text, "\n %.12g %.12g %.12g", point.x, point.y, point.z);
}

void orl_text_add_polygon(struct orl_text *text, const char *material, const char *name,
                          const char *part, const struct orl_vec3 *corners, size_t n)
{
    orl_text_add_head(text, material, "polygon", name, part, 3 * n);
    for (size_t i = 0; i < n; i++)
        orl_text_add_point(text, corners[i]);
    orl_text_add(text, "\n");
}

void orl_text_add_sphere(struct orl_text *text, const char *material, const char *name,
                         const char *part, struct orl_vec3 center, double radius)
{
    orl_text_add_head(text, material, "sphere", name, part, 4);
    orl_text_add_point(text, center);
    orl_text_add(text, " %.12g\n", radius);
}

void orl_text_add_cylinder(struct orl_text *text, const char *material, const char *name,
                           const char *part, struct orl_vec3 from, struct orl_vec3 to,
                           double radius)
{
    orl_text_add_head(text, material, "cylinder", name, part, 7);
    orl_text_add_point(text, from);
    orl_text_add_point(text, to);
    orl_text_add(text, " %.12g\n", radius);
}

/*
 * genblinds: slats one above the other. Each is a rectangle or, if bent about a line along it, so
 * many rectangles that two are joined at no more than three degrees.
 */

enum { SLATS_MAX = 20000, PARTS_MAX = 60 };

struct blinds {
    const char *material, *name;
    double depth, width, height, angle_rad;
    int slats;
    double radius; /* bend radius: positive with the middle up, negative with it down; 0: flat */
    int parts;     /* number of rectangles in a slat */
    double x[PARTS_MAX][2],
        z[PARTS_MAX][2]; /* long sides of each rectangle, from the slat's edge */
};

static int read_blinds(struct blinds *blinds, struct orl_words *words, struct orl_error *err)
{
    const struct {
        const char *what;
        double *size;
    } sizes[] = {{"the depth", &blinds->depth},
                 {"the width", &blinds->width},
                 {"the height", &blinds->height}};
    int code = orl_words_names(words, "the blinds", &blinds->material, &blinds->name, err);
    for (int i = 0; i < 3 && code == 0; i++)
        code = orl_words_number(words, sizes[i].what, sizes[i].size, err);
    if (code == 0)
        code = orl_words_int(words, "the number of slats", 1, SLATS_MAX, &blinds->slats, err);
    if (code == 0)
        code = orl_words_angle(words, "the angle", &blinds->angle_rad, err);
    if (code < 0 || words->left == 0)
        return code;
    const char *option = orl_words_take(words);
    if (strcmp(option, "-r") != 0 && strcmp(option, "+r") != 0)
        return orl_words_refuse(words, option, err);
    code = orl_words_number(words, option, &blinds->radius, err);
    if (*option == '+')
        blinds->radius = -blinds->radius;
    if (code == 0 && words->left > 0)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "genblinds: '%.40s' is an extra argument",
                             words->at[0]);
    return code;
}

/* Sets rectangle k, from the edge at (x, z) to the other long side. */
static void place_part(struct blinds *blinds, int k, double x, double z, double length,
                       double slope_rad)
{
    blinds->x[k][0] = x;
    blinds->z[k][0] = z;
    blinds->x[k][1] = length * cos(slope_rad) + x;
    blinds->z[k][1] = length * sin(slope_rad) + z;
}

/* The order of these sums and differences determines the signs of zeros that the program prints. */
static int bend_slats(struct blinds *blinds, struct orl_error *err)
{
    const double degree = ORL_PI / 180.0, step_deg = 3.0, r = fabs(blinds->radius);
    const double sweep = 2 * asin(blinds->depth / (2 * r));
    if (!(sweep > 0))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "genblinds: slats of depth %g cannot be bent to a radius of %g",
                             blinds->depth, r);
    const bool up = blinds->radius > 0;
    blinds->parts = (int)(sweep / (degree * step_deg) + 0.99999);
    const double part_deg = 180.0 / ORL_PI * sweep / blinds->parts;
    const double length = 2 * r * sin(degree * (part_deg / 2));
    const double half = degree * ((180.0 - part_deg) / 2);
    const double first = (ORL_PI - sweep) / 2 - blinds->angle_rad + (up ? sweep : 0);
    const double side = up ? 1 : -1;
    const double x0 = side * r * cos(first), z0 = -side * r * sin(first);
    for (int k = 0; k < blinds->parts; k++) {
        const double turn = k * degree * part_deg, at = up ? first - turn : first + turn;
        const double slope = up ? ORL_PI - first + turn - half : half - at;
        place_part(blinds, k, side * r * cos(at) - x0, -side * r * sin(at) - z0, length, slope);
    }
    return 0;
}

static void add_slat(const struct blinds *blinds, int number, struct orl_text *text)
{
    const double up = blinds->height * (number - .5) / blinds->slats;
    struct orl_vec3 corners[4];
    char part[32];
    for (int k = 0; k < blinds->parts; k++) {
        for (int i = 0; i < 4; i++) {
            const double y = i == 1 || i == 2 ? blinds->width : 0;
            corners[i] = orl_v3(blinds->x[k][i / 2], y, blinds->z[k][i / 2] + up);
        }
        snprintf(part, sizeof part, "%d.%d", number, k);
        orl_text_add_polygon(text, blinds->material, blinds->name, part, corners, 4);
    }
}

int orl_genblinds(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err)
{
    struct blinds blinds = {.parts = 1};
    struct orl_words rest = {"genblinds", words + 1, count - 1};
    int code = read_blinds(&blinds, &rest, err);
    if (code == 0 && blinds.radius != 0)
        code = bend_slats(&blinds, err);
    else
        place_part(&blinds, 0, 0, 0, blinds.depth, blinds.angle_rad);
    for (int i = 1; i <= blinds.slats && code == 0; i++)
        add_slat(&blinds, i, text);
    return code;
}

/*
 * genclock: a clock of radius 1.1 about the x axis, facing along it, with its materials. The
 * figures on its face are a text pattern.
 */

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
                                "genclock: '%.40s' is not a time: write 10:35 or 10.58", word);
}

static int read_clock(struct clock *clock, struct orl_words *words, struct orl_error *err)
{
    int code = 0;
    while (code == 0 && words->left > 1) {
        const char *option = orl_words_take(words);
        const char **name = strcmp(option, "-f") == 0   ? &clock->face
                            : strcmp(option, "-c") == 0 ? &clock->case_
                            : strcmp(option, "-n") == 0 ? &clock->name
                                                        : NULL;
        code =
            name ? orl_words_name(words, option, name, err) : orl_words_refuse(words, option, err);
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
    struct orl_vec3 corners[4];
    for (int i = 0; i < 4; i++) {
        const double z = i < 2 ? tail[1] : tip[1];
        corners[i] = orl_v3(x, y[i] * c - z * s, z * c + y[i] * s);
    }
    orl_text_add_polygon(text, "hand_paint", clock->name, part, corners, 4);
}

int orl_genclock(const char *const *words, size_t count, struct orl_text *text,
                 struct orl_error *err)
{
    struct clock clock = {.name = "clock"};
    struct orl_words rest = {"genclock", words + 1, count - 1};
    const int code = read_clock(&clock, &rest, err);
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
