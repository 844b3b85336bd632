#include "scene/generate/solid/solids.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* genbox: boxes with sharp, cut and round edges. */

/* A box from the origin to its size. */
struct genbox {
    const char *material, *name;
    double size[3];
    double bevel; /* depth of cut-off edges, or radius of round ones; 0: sharp edges */
    bool rounded, inverted;
    unsigned level; /* round edges have 2^level flat strips each; below 2: cylinders and spheres */
};

/* Sides, edges and corners of a box with cut edges; each is a list of corners by letter. */
static const char inset_sides[6][5] = {"dhgc", "oqmk", "OPNM", "feij", "plnr", "SQRT"};
static const char box_edges[12][3] = {"st", "sw", "su", "vt", "vu", "vz",
                                      "xt", "xw", "xz", "yu", "yw", "yz"};
static const char box_ends[8][2] = {"s", "t", "u", "v", "w", "x", "y", "z"};

/*
 * Returns the code of a letter: the letters 0-9 . _ A-Z a-z count from 0. Bits 0 to 2 say on which
 * far sides a corner is in x, y and z; bits 3 to 5, whether it is inside that side by the bevel.
 */
static unsigned corner_code(char letter)
{
    static const char letters[] =
        "0123456789._ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    return (unsigned)(strchr(letters, letter) - letters);
}

/* Returns a corner by its letter. For an inverted box near and far are swapped, which flips every
 * face and keeps its name. */
static struct orl_vec3 box_corner(const struct genbox *box, char letter)
{
    const unsigned code = corner_code(letter);
    double at[3];
    for (unsigned axis = 0; axis < 3; axis++) {
        const bool far = ((code >> axis & 1) != 0) != box->inverted;
        if (code >> axis & 8)
            at[axis] = far ? box->size[axis] - box->bevel : box->bevel;
        else
            at[axis] = far ? box->size[axis] : 0.0;
    }
    return orl_v3(at[0], at[1], at[2]);
}

/*
 * A box whose round edges are polygons: strips along the edges, and at the corners eighths of a
 * sphere, each recursively divided into four triangles. As in Radiance's program, faces are
 * collected and listed from the last to the first, numbered, without those of zero area.
 */

struct box_polygon {
    struct orl_vec3 corners[4];
    unsigned n;
};

struct box_polygons {
    struct box_polygon *items;
    size_t n;
};

static void add_polygon(struct box_polygons *polygons, unsigned n, struct orl_vec3 a,
                        struct orl_vec3 b, struct orl_vec3 c, struct orl_vec3 d)
{
    polygons->items[polygons->n++] = (struct box_polygon){{a, b, c, d}, n};
}

static struct orl_vec3 along(unsigned axis, double length)
{
    return orl_v3(axis == 0 ? length : 0, axis == 1 ? length : 0, axis == 2 ? length : 0);
}

/* Returns the vector out of the box perpendicular to an edge, of the radius' length. */
static struct orl_vec3 outward(const struct genbox *box, struct orl_vec3 point, unsigned axis)
{
    const double at = orl_component(point, (int)axis);
    return along(axis, at < 0.5 * box->size[axis] ? -box->bevel : box->bevel);
}

static void add_edge(struct box_polygons *polygons, const struct genbox *box, const char *edge)
{
    const struct orl_vec3 from = box_corner(box, edge[0]), to = box_corner(box, edge[1]);
    const unsigned differ = (corner_code(edge[0]) ^ corner_code(edge[1])) & 7;
    const unsigned axis = differ == 1 ? 0 : differ == 2 ? 1 : 2, n = 1U << box->level;
    const struct orl_vec3 first = outward(box, to, (axis + 2) % 3);
    const struct orl_vec3 last = outward(box, to, (axis + 1) % 3);
    const double step_rad = 0.5 * ORL_PI / n;
    struct orl_vec3 before = first;
    for (unsigned i = 1; i <= n; i++) {
        const struct orl_vec3 now =
            orl_add(orl_scale(first, cos(step_rad * i)), orl_scale(last, sin(step_rad * i)));
        add_polygon(polygons, 4, orl_add(from, before), orl_add(to, before), orl_add(to, now),
                    orl_add(from, now));
        before = now;
    }
}

static struct orl_vec3 middle(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_normalize(orl_add(a, b));
}

/* Adds the surface of a sphere between three directions. */
static void add_sphere_part(struct box_polygons *polygons, struct orl_vec3 center, double radius,
                            const struct orl_vec3 d[3], unsigned level)
{
    if (level == 0) {
        add_polygon(polygons, 3, orl_madd(center, d[0], radius), orl_madd(center, d[1], radius),
                    orl_madd(center, d[2], radius), center);
        return;
    }
    const struct orl_vec3 m[3] = {middle(d[0], d[1]), middle(d[1], d[2]), middle(d[2], d[0])};
    for (unsigned i = 0; i < 3; i++)
        add_sphere_part(polygons, center, radius, (struct orl_vec3[3]){d[i], m[i], m[(i + 2) % 3]},
                        level - 1);
    add_sphere_part(polygons, center, radius, m, level - 1);
}

static void add_end(struct box_polygons *polygons, const struct genbox *box, char letter)
{
    const unsigned code = corner_code(letter);
    const bool odd = ((code ^ code >> 1 ^ code >> 2) & 1) != 0;
    struct orl_vec3 d[3];
    for (unsigned axis = 0; axis < 3; axis++)
        d[axis] = along(axis, ((code >> axis & 1) != 0) != box->inverted ? 1 : -1);
    if (!odd) {
        const struct orl_vec3 x = d[0];
        d[0] = d[1];
        d[1] = x;
    }
    add_sphere_part(polygons, box_corner(box, letter), box->bevel, d, box->level);
}

static double area(const struct box_polygon *polygon)
{
    struct orl_vec3 sum = {0, 0, 0};
    for (unsigned i = 2; i < polygon->n; i++)
        sum = orl_add(sum, orl_cross(orl_sub(polygon->corners[i - 1], polygon->corners[0]),
                                     orl_sub(polygon->corners[i], polygon->corners[0])));
    return 0.5 * orl_length(sum);
}

static void write_polygons(const struct box_polygons *polygons, const struct genbox *box,
                           struct orl_text *text)
{
    const double smallest = 1e-12;
    size_t number = 0;
    char part[24];
    for (size_t i = polygons->n; i-- > 0;) {
        const struct box_polygon *polygon = &polygons->items[i];
        if (area(polygon) <= smallest)
            continue;
        snprintf(part, sizeof part, "%zu", ++number);
        orl_text_add_polygon(text, box->material, box->name, part, polygon->corners, polygon->n);
    }
}

/* Writes the box with round edges as polygons. Returns 0 or ORL_ERR_NOMEM. */
static int write_rounded_box(const struct genbox *box, struct orl_text *text, struct orl_error *err)
{
    const size_t most = 6 + ((size_t)12 << box->level) + ((size_t)8 << 2 * box->level);
    struct box_polygons polygons = {.items = malloc(most * sizeof *polygons.items)};
    if (!polygons.items)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < 6; i++)
        add_polygon(&polygons, 4, box_corner(box, inset_sides[i][0]),
                    box_corner(box, inset_sides[i][1]), box_corner(box, inset_sides[i][2]),
                    box_corner(box, inset_sides[i][3]));
    for (size_t i = 0; i < 12; i++)
        add_edge(&polygons, box, box_edges[i]);
    for (size_t i = 0; i < 8; i++)
        add_end(&polygons, box, box_ends[i][0]);
    write_polygons(&polygons, box, text);
    free(polygons.items);
    return 0;
}

static const char sharp[6][5] = {"1540", "4620", "2310", "3267", "5137", "6457"};
static const char bevels[12][5] = {"NdcM", "kmOM", "cgok", "QSqo", "TjiS", "emqi",
                                   "efPO", "jrnf", "lNPn", "prTR", "hdlp", "QghR"};
static const char corners[8][4] = {"Mck", "dNl", "Ome", "ogQ", "Siq", "pRh", "fnP", "Trj"};

static void add_face(struct orl_text *text, const struct genbox *box, const char *face)
{
    struct orl_vec3 face_corners[4];
    size_t n = 0;
    for (; face[n]; n++)
        face_corners[n] = box_corner(box, face[n]);
    orl_text_add_polygon(text, box->material, box->name, face, face_corners, n);
}

static void add_box(struct orl_text *text, const struct genbox *box)
{
    for (size_t i = 0; i < 6; i++)
        add_face(text, box, box->bevel > 0 ? inset_sides[i] : sharp[i]);
    for (size_t i = 0; i < 12 && box->bevel > 0; i++)
        if (box->rounded)
            orl_text_add_cylinder(text, box->material, box->name, box_edges[i],
                                  box_corner(box, box_edges[i][0]),
                                  box_corner(box, box_edges[i][1]), box->bevel);
        else
            add_face(text, box, bevels[i]);
    for (size_t i = 0; i < 8 && box->bevel > 0; i++)
        if (box->rounded)
            orl_text_add_sphere(text, box->material, box->name, box_ends[i],
                                box_corner(box, box_ends[i][0]), box->bevel);
        else
            add_face(text, box, corners[i]);
}

static int refuse_option(const char *option, const char *hint, struct orl_error *err)
{
    return orl_error_refuse(err, ORL_ERR_UNSUPPORTED, hint, "genbox: option '%s' is not supported",
                            option);
}

static int read_option(struct orl_words *words, struct genbox *box, int *segments,
                       struct orl_error *err)
{
    const char *option = orl_words_take(words);
    int code = 0;
    if (strcmp(option, "-i") == 0) {
        box->inverted = true;
    } else if (strcmp(option, "-b") == 0 || strcmp(option, "-r") == 0) {
        box->rounded = box->rounded || option[1] == 'r';
        code = orl_words_number(words, option, &box->bevel, err);
        if (code == 0 && box->bevel <= 0)
            code = orl_error_set(err, ORL_ERR_RANGE, "genbox: %s %g is not positive", option,
                                 box->bevel);
    } else if (strcmp(option, "-n") == 0) {
        enum { SEGMENTS_MAX = 256 };
        code = orl_words_int(words, option, 1, SEGMENTS_MAX, segments, err);
    } else if (strcmp(option, "-o") == 0) {
        code = refuse_option(option, "remove it: it writes an OBJ file instead of a scene", err);
    } else if (strcmp(option, "-s") == 0) {
        code = refuse_option(option,
                             "remove it: normals do not vary over a polygon; use more segments "
                             "(-n) for a smoother result",
                             err);
    } else {
        code = orl_words_refuse(words, option, err);
    }
    return code;
}

static int read_size(struct orl_words *words, double size[3], struct orl_error *err)
{
    int code = 0;
    for (int axis = 0; axis < 3 && code == 0; axis++) {
        code = orl_words_number(words, "a size", size + axis, err);
        if (code == 0 && size[axis] <= 0)
            code = orl_error_set(err, ORL_ERR_RANGE, "genbox: size %g is not positive", size[axis]);
    }
    return code;
}

int orl_genbox(const char *const *words, size_t count, struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"genbox", words + 1, count - 1};
    struct genbox box = {0};
    int segments = 1, code;
    if (count < 6)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "genbox needs a material, a name and three sizes");
    code = orl_words_names(&rest, "the box", &box.material, &box.name, err);
    if (code == 0)
        code = read_size(&rest, box.size, err);
    while (code == 0 && rest.left > 0)
        code = read_option(&rest, &box, &segments, err);
    if (code < 0)
        return code;
    /* Cylinders and spheres are right from outside only; from inside they would be in the way. */
    if (box.inverted && segments == 1)
        segments = 32;
    while (box.rounded && (1 << box.level) < segments)
        box.level++;
    if (box.level > 1)
        return write_rounded_box(&box, text, err);
    add_box(text, &box);
    return 0;
}
