/*
 * genworm: spheres along a curve in space, and between them cones or cylinders tangent to both.
 */
#include <stdio.h>

#include "scene/generate/curved/swept_curve.h"

static void add_joint(const struct orl_generator_curve *curve, int number, const double from[4],
                      const double to[4], struct orl_text *text)
{
    const struct orl_vec3 a = orl_v3(from[0], from[1], from[2]), b = orl_v3(to[0], to[1], to[2]);
    const struct orl_vec3 way = orl_sub(b, a);
    const double change = from[3] - to[3];
    char part[24];
    snprintf(part, sizeof part, "c%d", number);
    if (fabs(change) <= 1e-6) {
        orl_text_add_cylinder(text, curve->material, curve->name, part, a, b, to[3]);
        return;
    }
    /* The cone touches each sphere on a circle that is offset from its centre by the sine of its
     * slope. */
    const double slope = change / orl_dot(way, way), cosine2 = 1 - change * slope;
    const double cosine = cosine2 <= 0 ? 0 : sqrt(cosine2);
    const double p = slope * from[3], q = slope * to[3];
    orl_text_add_head(text, curve->material, "cone", curve->name, part, 8);
    orl_text_add_point(text, orl_v3(a.x + p * way.x, a.y + p * way.y, a.z + p * way.z));
    orl_text_add_point(text, orl_v3(b.x + q * way.x, b.y + q * way.y, b.z + q * way.z));
    orl_text_add(text, "\n %.12g %.12g\n", cosine * from[3], cosine * to[3]);
}

int orl_genworm(const char *const *words, size_t count, const struct orl_generator_files *files,
                struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"genworm", words + 1, count - 1};
    struct orl_generator_curve curve = {0};
    double from[ORL_CURVE_EXPRESSIONS_MAX] = {0}, to[ORL_CURVE_EXPRESSIONS_MAX] = {0};
    char part[24];
    int code = orl_curve_read(&curve, &rest, 4, false, files, err);
    for (int i = 0; i <= curve.segments && code == 0; i++) {
        code = orl_curve_at(&curve, i, to, err);
        if (code < 0)
            break;
        if (i > 0)
            add_joint(&curve, i, from, to, text);
        snprintf(part, sizeof part, "s%d", i);
        orl_text_add_sphere(text, curve.material, curve.name, part, orl_v3(to[0], to[1], to[2]),
                            to[3]);
        for (int k = 0; k < 4; k++)
            from[k] = to[k];
    }
    orl_expressions_done(&curve.expressions);
    return code;
}
