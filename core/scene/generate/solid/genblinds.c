/*
 * genblinds: slats one above the other. Each is a rectangle or, if bent about a line along it, so
 * many rectangles that two meet at no more than three degrees.
 */
#include <stdio.h>
#include <string.h>

#include "scene/generate/solid/solids.h"

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

static int read_words(struct blinds *blinds, struct orl_words *words, struct orl_error *err)
{
    int code = orl_words_name(words, "the material", &blinds->material, err);
    if (code == 0)
        code = orl_words_name(words, "the blinds", &blinds->name, err);
    if (code == 0)
        code = orl_words_number(words, "the depth", &blinds->depth, err);
    if (code == 0)
        code = orl_words_number(words, "the width", &blinds->width, err);
    if (code == 0)
        code = orl_words_number(words, "the height", &blinds->height, err);
    if (code == 0)
        code = orl_words_int(words, "the number of slats", 1, SLATS_MAX, &blinds->slats, err);
    if (code == 0)
        code = orl_words_angle(words, "the angle", &blinds->angle_rad, err);
    if (code < 0 || words->left == 0)
        return code;
    const char *option = *words->at++;
    words->left--;
    if (strcmp(option, "-r") != 0 && strcmp(option, "+r") != 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "genblinds: '%.40s' is no option", option);
    code = orl_words_number(words, option, &blinds->radius, err);
    if (*option == '+')
        blinds->radius = -blinds->radius;
    if (code == 0 && words->left > 0)
        code = orl_error_set(err, ORL_ERR_SYNTAX, "genblinds: '%.40s' is one word too many",
                             words->at[0]);
    return code;
}

/* Sets part k, from the edge at (x, z) to the other long side. */
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
                             "genblinds: slats of depth %g cannot be bent about a radius of %g",
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
    char part[32];
    for (int k = 0; k < blinds->parts; k++) {
        snprintf(part, sizeof part, "%d.%d", number, k);
        orl_text_add_head(text, blinds->material, "polygon", blinds->name, part, 12);
        for (int i = 0; i < 4; i++) {
            const double y = i == 1 || i == 2 ? blinds->width : 0;
            orl_text_add_point(text, orl_v3(blinds->x[k][i / 2], y, blinds->z[k][i / 2] + up));
        }
        orl_text_add(text, "\n");
    }
}

int orl_genblinds(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err)
{
    struct blinds blinds = {.parts = 1};
    struct orl_words rest = {"genblinds", words + 1, count - 1};
    int code = read_words(&blinds, &rest, err);
    if (code == 0 && blinds.radius != 0)
        code = bend_slats(&blinds, err);
    else
        place_part(&blinds, 0, 0, 0, blinds.depth, blinds.angle_rad);
    for (int i = 1; i <= blinds.slats && code == 0; i++)
        add_slat(&blinds, i, text);
    return code;
}
