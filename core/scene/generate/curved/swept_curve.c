#include "scene/generate/solid/solids.h"

#include <stdio.h>
#include <string.h>

/* genrev and genworm: surfaces along a curve by expressions of t, from 0 to 1 in even steps. */

enum { SEGMENTS_MAX = 50000, EXPRESSIONS_MAX = 4 };

struct generator_curve {
    const char *material, *name;
    int segments;
    bool smooth; /* -s */
    struct orl_generator_expressions expressions;
};

/* Reads all words of the command: material, name, n expressions, segments and options. The caller
 * passes curve->expressions to orl_expressions_done in every case. may_smooth: the option -s is
 * allowed. */
static int read_curve(struct generator_curve *curve, struct orl_words *words, size_t n,
                      bool may_smooth, const struct orl_generator_files *files,
                      struct orl_error *err)
{
    static const char *const inputs[] = {"t"};
    int code = orl_words_names(words, "the surface", &curve->material, &curve->name, err);
    if (code == 0 && words->left < n + 1)
        code =
            orl_error_set(err, ORL_ERR_SYNTAX, "%s needs %zu expressions and a number of segments",
                          words->program, n);
    if (code < 0)
        return code;
    const char *const *texts = words->at;
    words->at += n + 1;
    words->left -= n + 1;
    code = orl_expressions_begin(&curve->expressions, inputs, 1, err);
    while (code == 0 && words->left > 0) {
        const char *option = orl_words_take(words);
        if (may_smooth && strcmp(option, "-s") == 0)
            curve->smooth = true;
        else
            code = orl_expressions_define(&curve->expressions, option, words, files, err);
    }
    if (code == 0)
        code = orl_expressions_count(&curve->expressions, texts[n], "segments", words->program,
                                     SEGMENTS_MAX, &curve->segments, err);
    return code < 0 ? code
                    : orl_expressions_compile(&curve->expressions, texts, n,
                                              (size_t)curve->segments, err);
}

/* Returns the expressions' values at t = step / segments; ORL_ERR_RANGE unless all are finite. */
static int evaluate_curve(const struct generator_curve *curve, int step,
                          double ret_values[EXPRESSIONS_MAX], struct orl_error *err)
{
    const double t = (double)step / curve->segments;
    return orl_expressions_at(&curve->expressions, &t, ret_values, err);
}

/*
 * genrev: a surface of revolution about the z axis, made of cones, cylinders and rings along a
 * curve of heights and radii. Where the curve goes down, the front is inside. With -s each segment
 * has a texture (rev.cal) that interpolates normals between neighbours.
 */

/* A segment of the curve: heights and radii of its ends, and its normal (height, radius). */
struct segment {
    double from[2], to[2], normal[2];
};

/* Sign of the change from one step to the next: -1, 0 or 1. */
static int sign_of_change(double from, double to)
{
    const double tiny = 1e-9;
    return to < from - tiny ? -1 : to > from + tiny ? 1 : 0;
}

/* Adds the coefficients of a normal's coordinate along the segment: a line through the neighbours'
 * normals. If the segment does not change in that coordinate, the visible side. */
static int add_line(double change, double start, double before, double after, int side,
                    struct orl_text *text, struct orl_error *err)
{
    const double slope = change != 0 ? (after - before) / change : 0;
    if (!isfinite(slope))
        return orl_error_set(
            err, ORL_ERR_RANGE,
            "genrev: the curve does not move next to a segment, which -s does not allow");
    if (change != 0)
        orl_text_add(text, "\n %.12g %.12g", slope, before - slope * start);
    else
        orl_text_add(text, "\n 0 %d", side);
    return 0;
}

static int add_texture(const struct generator_curve *curve, const struct segment *segment,
                       const struct segment *before, const struct segment *after,
                       struct orl_text *text, struct orl_error *err)
{
    const int up = sign_of_change(segment->from[0], segment->to[0]);
    const int out = sign_of_change(segment->from[1], segment->to[1]);
    orl_text_add(text, "'%s' texfunc Phong\n4 rev_dx rev_dy rev_dz rev.cal\n0\n4", curve->material);
    int code = add_line(up ? segment->to[0] - segment->from[0] : 0, segment->from[0],
                        before->normal[0], after->normal[0], out < 0 ? 1 : -1, text, err);
    if (code == 0)
        code = add_line(out ? segment->to[1] - segment->from[1] : 0, segment->from[1],
                        before->normal[1], after->normal[1], up > 0 ? 1 : -1, text, err);
    orl_text_add(text, "\n");
    return code;
}

static int add_segment(const struct generator_curve *curve, int number,
                       const struct segment near_segments[3], struct orl_text *text,
                       struct orl_error *err)
{
    const double *const from = near_segments[1].from, *const to = near_segments[1].to;
    const int up = sign_of_change(from[0], to[0]), out = sign_of_change(from[1], to[1]);
    const char *type = up == 0    ? "ring"
                       : out == 0 ? (up < 0 ? "tube" : "cylinder")
                                  : (up < 0 ? "cup" : "cone");
    char part[24];
    if (up == 0 && out == 0)
        return 0;
    const int code = curve->smooth ? add_texture(curve, &near_segments[1], &near_segments[0],
                                                 &near_segments[2], text, err)
                                   : 0;
    snprintf(part, sizeof part, "%d", number);
    orl_text_add_head(text, curve->smooth ? "Phong" : curve->material, type, curve->name, part,
                      up != 0 && out == 0 ? 7 : 8);
    orl_text_add_point(text, orl_v3(0, 0, up == 0 ? to[0] : from[0]));
    orl_text_add_point(text, orl_v3(0, 0, up == 0 ? -out : to[0]));
    if (up == 0 || out != 0)
        orl_text_add(text, "\n %.12g", from[1]);
    orl_text_add(text, " %.12g\n", to[1]);
    return code;
}

/* Returns the segment behind `before`, up to the step; beyond the curve's end it is empty, without
 * a normal. */
static int find_next_segment(const struct generator_curve *curve, const struct segment *before,
                             int step, struct segment *ret_segment, struct orl_error *err)
{
    double at[EXPRESSIONS_MAX];
    *ret_segment = (struct segment){{before->to[0], before->to[1]}, {0, 0}, {0, 0}};
    if (step > curve->segments)
        return 0;
    const int code = evaluate_curve(curve, step, at, err);
    if (code < 0)
        return code;
    const double dz = at[0] - before->to[0], dr = at[1] - before->to[1];
    const double length = sqrt(dz * dz + dr * dr);
    *ret_segment = (struct segment){
        {before->to[0], before->to[1]}, {at[0], at[1]}, {-dr / length, dz / length}};
    return 0;
}

int orl_genrev(const char *const *words, size_t count, const struct orl_generator_files *files,
               struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"genrev", words + 1, count - 1};
    struct generator_curve curve = {0};
    struct segment near_segments[3] = {
        {{0, 0}, {0, 0}, {0, 0}}}; /* previous, current and next segment */
    double start[EXPRESSIONS_MAX];
    int code = read_curve(&curve, &rest, 2, true, files, err);
    if (code == 0)
        code = evaluate_curve(&curve, 0, start, err);
    if (code == 0) {
        near_segments[0] = (struct segment){{0, 0}, {start[0], start[1]}, {0, 0}};
        code = find_next_segment(&curve, &near_segments[0], 1, &near_segments[1], err);
    }
    for (int i = 1; i <= curve.segments && code == 0; i++) {
        code = find_next_segment(&curve, &near_segments[1], i + 1, &near_segments[2], err);
        if (code == 0)
            code = add_segment(&curve, i, near_segments, text, err);
        near_segments[0] = near_segments[1];
        near_segments[1] = near_segments[2];
    }
    orl_expressions_done(&curve.expressions);
    return code;
}

/*
 * genworm: spheres along a curve in space, and between them cones or cylinders tangent to both.
 */

static void add_joint(const struct generator_curve *curve, int number, const double from[4],
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
    struct generator_curve curve = {0};
    double from[EXPRESSIONS_MAX] = {0}, to[EXPRESSIONS_MAX] = {0};
    char part[24];
    int code = read_curve(&curve, &rest, 4, false, files, err);
    for (int i = 0; i <= curve.segments && code == 0; i++) {
        code = evaluate_curve(&curve, i, to, err);
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
