#include "scene/parse/command/commands.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text/words.h"
#include "scene/generate/solid/solids.h"

/* Angles and lengths below this count as 0, as in replmarks. */
static const double tiny = 1e-6;

enum { CORNERS_MAX = 6 };

/* ---- The command ----------------------------------------------------------------------------- */

static int read_option(struct orl_markers *markers, struct orl_marker *marker,
                       struct orl_words *words, struct orl_error *err)
{
    const char *option = orl_words_take(words);
    const char **name = NULL;
    if (strcmp(option, "-e") == 0) {
        markers->expand = true;
        return 0;
    }
    if (strcmp(option, "-s") == 0)
        return orl_words_number(words, option, &marker->scale, err);
    if (strcmp(option, "-x") == 0 || strcmp(option, "-i") == 0 || strcmp(option, "-I") == 0) {
        name = &marker->object;
        marker->compiled = option[1] == 'x' ? NULL : option[1] == 'i' ? "instance" : "mesh";
    } else if (strcmp(option, "-m") == 0)
        name = &marker->replacement;
    else
        return orl_words_refuse(words, option, err);
    return orl_words_name(words, option, name, err);
}

int orl_markers_read(struct orl_markers *markers, const char *const *words, size_t count,
                     size_t *ret_used, struct orl_error *err)
{
    struct orl_words rest = {"replmarks", words, count};
    int code = 0;
    while (rest.left > 0 && rest.at[0][0] == '-') {
        struct orl_marker marker = {0};
        if (markers->n == ORL_MARKERS_MAX)
            return orl_error_set(err, ORL_ERR_LIMIT, "replmarks: more than %d markers",
                                 ORL_MARKERS_MAX);
        marker.scale = markers->n > 0 ? markers->items[markers->n - 1].scale : 0;
        while (code == 0 && rest.left > 0 && rest.at[0][0] == '-')
            code = read_option(markers, &marker, &rest, err);
        if (code == 0)
            code = orl_words_name(&rest, "the markers' modifier", &marker.modifier, err);
        if (code == 0 && !marker.object)
            code = orl_error_set(err, ORL_ERR_SYNTAX,
                                 "replmarks: -x, -i or -I and a file are missing for '%.80s'",
                                 marker.modifier);
        if (code < 0)
            return code;
        markers->items[markers->n++] = marker;
    }
    if (markers->n == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "replmarks needs -x, -i or -I, a file and a modifier");
    *ret_used = count - rest.left;
    return 0;
}

const struct orl_marker *orl_marker_find(const struct orl_parser *parser,
                                         const struct orl_scope *scope)
{
    const struct orl_markers *markers = scope->markers;
    const char *name =
        scope->modifier && !markers->scope->modifier ? scope->modifier : parser->primitive.modifier;
    if (strcmp(parser->primitive.type, "polygon") != 0)
        return NULL;
    for (size_t i = 0; i < markers->n; i++)
        if (strcmp(markers->items[i].modifier, name) == 0)
            return &markers->items[i];
    return NULL;
}

/* ---- Placement ------------------------------------------------------------------------------- */

struct edge {
    struct orl_vec3 from, to;
    float length2;
};

static struct edge reversed(struct edge edge)
{
    return (struct edge){edge.to, edge.from, edge.length2};
}

/* Sorts edges, longest first; of equal ones the earlier, the first being the closing edge. */
static void sort_edges(struct edge *edges, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        const struct edge edge = edges[i];
        size_t at = i;
        for (; at > 0 && edges[at - 1].length2 < edge.length2; at--)
            edges[at] = edges[at - 1];
        edges[at] = edge;
    }
}

/* Finds the axes from their common corner, not yet orthogonal; false if they do not meet. */
static bool find_axes(const struct orl_vec3 *corners, size_t n, struct orl_vec3 *ret_origin,
                      struct orl_vec3 *ret_x, struct orl_vec3 *ret_y)
{
    struct edge edges[CORNERS_MAX];
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 way = orl_sub(corners[i], corners[(i + n - 1) % n]);
        edges[i] = (struct edge){corners[(i + n - 1) % n], corners[i], (float)orl_dot(way, way)};
    }
    sort_edges(edges, n);
    struct edge x = edges[1], y = edges[2];
    if (orl_equal(x.to, y.from) || orl_equal(x.to, y.to))
        x = reversed(x);
    if (orl_equal(y.to, x.from))
        y = reversed(y);
    *ret_origin = x.from;
    *ret_x = orl_sub(x.to, x.from);
    *ret_y = orl_sub(y.to, y.from);
    return orl_equal(x.from, y.from);
}

/* ---- The words of an xform command, numbers in six decimals ---- */

static void say_turn(struct orl_shell_words *shell_words, const char *axis, double angle_rad)
{
    if (fabs(angle_rad) <= tiny)
        return;
    orl_shell_words_add(shell_words, "%s", axis);
    orl_shell_words_add(shell_words, "%f", angle_rad * (180.0 / ORL_PI));
}

/* Adds the rotations that take the scene's axes to these. */
static void say_axes(struct orl_shell_words *shell_words, struct orl_vec3 x, struct orl_vec3 y,
                     struct orl_vec3 z)
{
    if (y.z * y.z + z.z * z.z < 2 * tiny * tiny) {
        orl_shell_words_add(shell_words, "-ry");
        orl_shell_words_add(shell_words, "%f", x.z < 0 ? 90.0 : -90.0);
        orl_shell_words_add(shell_words, "-rz");
        orl_shell_words_add(shell_words, "%f", -atan2(y.x, y.y) * (180.0 / ORL_PI));
        return;
    }
    say_turn(shell_words, "-rx", atan2(y.z, z.z));
    say_turn(shell_words, "-ry", asin(fmin(1, fmax(-1, -x.z))));
    say_turn(shell_words, "-rz", atan2(x.y, x.x));
}

static int fail(struct orl_parser *parser, const struct orl_scope *scope, struct orl_error *err)
{
    return orl_parser_refuse(
        parser, scope, err, ORL_ERR_SYNTAX,
        "a marker is a right triangle: its second longest side is the x axis, its "
        "shortest the y axis of the inserted object",
        "it is not a marker for replmarks");
}

/* Reads the corners in the coordinates of the command's scope. */
static int read_corners(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_vec3 corners[CORNERS_MAX], size_t *ret_n, struct orl_error *err)
{
    const double *r = parser->primitive.reals;
    const size_t n = parser->primitive.n_reals / 3;
    if (parser->primitive.n_reals % 3 != 0 || n < 3 || n > CORNERS_MAX)
        return fail(parser, scope, err);
    for (size_t i = 0; i < n; i++) {
        corners[i] = orl_xform_point(&scope->since, orl_v3(r[3 * i], r[3 * i + 1], r[3 * i + 2]));
        if (!(fabs(corners[i].x) < 1e12 && fabs(corners[i].y) < 1e12 && fabs(corners[i].z) < 1e12))
            return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                                   "its coordinates are too large");
    }
    *ret_n = n;
    return 0;
}

int orl_marker_place(struct orl_parser *parser, const struct orl_scope *scope, double scale,
                     struct orl_xform *ret_xform, struct orl_error *err)
{
    struct orl_vec3 corners[CORNERS_MAX], origin, x, y;
    struct orl_shell_words shell_words = {.count = 0};
    size_t n = 0, used = 0;
    int code = read_corners(parser, scope, corners, &n, err);
    if (code < 0)
        return code;
    if (!find_axes(corners, n, &origin, &x, &y))
        return fail(parser, scope, err);
    const double length = orl_length(x);
    const struct orl_vec3 up = orl_cross(x, y);
    if (!(length > 0) || !(orl_length(up) > 0))
        return fail(parser, scope, err);
    x = orl_scale(x, 1 / length);
    const struct orl_vec3 z = orl_normalize(up);
    if (scale > 0) {
        orl_shell_words_add(&shell_words, "-s");
        orl_shell_words_add(&shell_words, "%f", length * scale);
    }
    say_axes(&shell_words, x, orl_cross(z, x), z);
    orl_shell_words_add(&shell_words, "-t");
    orl_shell_words_add(&shell_words, "%f", origin.x);
    orl_shell_words_add(&shell_words, "%f", origin.y);
    orl_shell_words_add(&shell_words, "%f", origin.z);
    code = orl_xform_read(shell_words.words, shell_words.count, ret_xform, &used, err);
    return code < 0 ? orl_parser_fail(parser, scope, err, code, "its size is out of range") : 0;
}
