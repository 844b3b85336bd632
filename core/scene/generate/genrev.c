/*
 * genrev: a surface of revolution about the z axis, of cones, cylinders and rings along a curve of
 * heights and radii. Where the curve goes down it is seen from within.
 */
#include <stdio.h>

#include "scene/generate/curve.h"

/* The change from one step to the next: -1, 0 or 1. */
static int direction(double from, double to)
{
    const double tiny = 1e-9;
    return to < from - tiny ? -1 : to > from + tiny ? 1 : 0;
}

static void add_segment(const struct orl_generator_curve *curve, int number, const double from[2],
                        const double to[2], struct orl_text *text)
{
    const int up = direction(from[0], to[0]), out = direction(from[1], to[1]);
    const char *type = up == 0    ? "ring"
                       : out == 0 ? (up < 0 ? "tube" : "cylinder")
                                  : (up < 0 ? "cup" : "cone");
    char part[24];
    if (up == 0 && out == 0)
        return;
    snprintf(part, sizeof part, "%d", number);
    orl_text_add_head(text, curve->material, type, curve->name, part, up != 0 && out == 0 ? 7 : 8);
    orl_text_add_point(text, orl_v3(0, 0, up == 0 ? to[0] : from[0]));
    orl_text_add_point(text, orl_v3(0, 0, up == 0 ? -out : to[0]));
    if (up == 0 || out != 0)
        orl_text_add(text, "\n %.12g", from[1]);
    orl_text_add(text, " %.12g\n", to[1]);
}

int orl_genrev(const char *const *words, size_t count, const struct orl_generator_files *files,
               struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"genrev", words + 1, count - 1};
    struct orl_generator_curve curve = {0};
    double from[ORL_CURVE_MOST], to[ORL_CURVE_MOST];
    int code = orl_curve_read(&curve, &rest, 2, files, err);
    if (code == 0)
        code = orl_curve_at(&curve, 0, from, err);
    for (int i = 1; i <= curve.segments && code == 0; i++) {
        code = orl_curve_at(&curve, i, to, err);
        if (code == 0)
            add_segment(&curve, i, from, to, text);
        from[0] = to[0];
        from[1] = to[1];
    }
    orl_curve_done(&curve);
    return code;
}
