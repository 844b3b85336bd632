/* Surfaces of MGF, written as polygons, spheres, cylinders, cones, rings; tori as rows of cones. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/generate/mgf/mgf_context.h"

typedef struct orl_mgf_vertex vertex_t;

static const vertex_t *find_vertex(struct orl_mgf_reader *r, size_t word)
{
    return &orl_mgf_find(r, ORL_MGF_VERTEX, r->words[word])->is.vertex;
}

/* Kinds of surface by which mgf2rad numbers names. */
enum counted { FACE, SPHERE, CYLINDER, CONE, RING };

/* Writes "material type objects.number", and the argument counts. */
static void write_head(struct orl_mgf_reader *r, enum counted counted, const char *type,
                       size_t n_reals)
{
    static const char *const letters[] = {"f", "s", "cy", "c", "r"};
    const char *const material = orl_mgf_use_material(r);
    if (++r->n_surfaces > ORL_LIMIT_SURFACES)
        orl_mgf_fail(r, ORL_ERR_LIMIT, "more than %lu surfaces", ORL_LIMIT_SURFACES);
    orl_text_add(r->text, "'%s' %s '", material, type);
    for (size_t i = 0; i < r->n_objects; i++)
        orl_text_add(r->text, "%s.", r->objects[i]);
    orl_text_add(r->text, "%s%zu'\n0\n0\n%zu\n", letters[counted], ++r->counts[counted], n_reals);
}

static void add_vector(struct orl_mgf_reader *r, struct orl_vec3 v)
{
    orl_text_add(r->text, "%18.12g %18.12g %18.12g\n", v.x, v.y, v.z);
}

static void add_point(struct orl_mgf_reader *r, struct orl_vec3 point)
{
    add_vector(r, orl_xform_point(&r->xform, point));
}

/* ---- Faces ----------------------------------------------------------------------------------- */

static void write_polygon(struct orl_mgf_reader *r, const struct orl_vec3 *corners, size_t n,
                          bool turned)
{
    write_head(r, FACE, "polygon", 3 * n);
    for (size_t i = 0; i < n; i++)
        add_point(r, corners[turned != (r->xform.mirrored != r->xform.inverted) ? n - 1 - i : i]);
}

/* Returns true if all corner normals point away from the side that the corners' order gives. */
static bool is_turned(const vertex_t *const *vertices, size_t n)
{
    struct orl_vec3 normal = {0};
    for (size_t i = 1; i + 1 < n; i++)
        normal = orl_add(normal, orl_cross(orl_sub(vertices[i]->point, vertices[0]->point),
                                           orl_sub(vertices[i + 1]->point, vertices[0]->point)));
    for (size_t i = 0; i < n; i++)
        if (!(orl_dot(normal, vertices[i]->normal) < 0))
            return false;
    return n <= 4;
}

/* Writes a polygon of the vertices in these words. */
static void write_face(struct orl_mgf_reader *r, const size_t *order, size_t n)
{
    struct orl_vec3 corners[ORL_MGF_WORDS];
    const vertex_t *vertices[ORL_MGF_WORDS];
    for (size_t i = 0; i < n && i < ORL_MGF_WORDS; i++) {
        vertices[i] = find_vertex(r, order[i]);
        corners[i] = vertices[i]->point;
        r->smooth |= orl_length(vertices[i]->normal) > 0;
    }
    if (!r->code)
        write_polygon(r, corners, n, is_turned(vertices, n));
}

void orl_mgf_face(struct orl_mgf_reader *r)
{
    size_t order[ORL_MGF_WORDS], n = 0;
    while (n + 1 < r->n_words) {
        order[n] = n + 1;
        n++;
    }
    write_face(r, order, n);
}

/* Returns the number of words from first on before the next '-'. */
static size_t count_outline(const struct orl_mgf_reader *r, size_t first)
{
    size_t n = 0;
    while (first + n < r->n_words && strcmp(r->words[first + n], "-") != 0)
        n++;
    return n;
}

/*
 * Handles "fh a b c - d e f - ...": each hole becomes a path from the outline's last corner around
 * it and back, as holes of Radiance's polygons are written.
 */
void orl_mgf_face_with_holes(struct orl_mgf_reader *r)
{
    size_t order[2 * ORL_MGF_WORDS], n = 0, length, last = 0;
    for (size_t first = 1; first < r->n_words; first += length + 1) {
        length = count_outline(r, first);
        if (length < 3)
            orl_mgf_fail(r, ORL_ERR_SYNTAX, "an outline has fewer than three vertices");
        if (first > 1)
            order[n++] = first + length - 1;
        for (size_t i = 0; i < length; i++)
            order[n++] = first + i;
        if (first > 1)
            order[n++] = last;
        else
            last = length;
    }
    if (!r->code)
        write_face(r, order, n);
}

void orl_mgf_prism(struct orl_mgf_reader *r)
{
    struct orl_vec3 near[ORL_MGF_WORDS], far[ORL_MGF_WORDS], normal = {0};
    const size_t n = r->n_words - 2;
    const double length = orl_mgf_number(r, n + 1);
    for (size_t i = 0; i < n; i++) {
        const vertex_t *const vertex = find_vertex(r, 1 + i);
        near[i] = vertex->point;
        r->smooth |= orl_length(vertex->normal) > 0;
        if (i >= 2)
            normal = orl_add(normal,
                             orl_cross(orl_sub(near[i - 1], near[0]), orl_sub(near[i], near[0])));
    }
    if (!(fabs(length) > 1e-6 && orl_length(normal) > 0))
        orl_mgf_fail(r, ORL_ERR_RANGE, "the prism has no length or no area");
    for (size_t i = 0; i < n; i++)
        far[i] = orl_sub(near[i], orl_scale(orl_normalize(normal), length));
    for (size_t i = 0; i < n && !r->code; i++) {
        const size_t before = (i + n - 1) % n;
        const struct orl_vec3 side[4] = {far[i], near[i], near[before], far[before]};
        write_polygon(r, side, 4, false);
    }
    write_polygon(r, far, n, true);
    write_polygon(r, near, n, false);
}

/* ---- Quadrics and rings ---------------------------------------------------------------------- */

/* Reads the radius in a word, and scales it to the scene's units. */
static double read_radius(struct orl_mgf_reader *r, size_t word)
{
    return orl_mgf_number(r, word) * r->xform.scale;
}

void orl_mgf_sphere(struct orl_mgf_reader *r)
{
    const double radius = read_radius(r, 2);
    const vertex_t *const center = find_vertex(r, 1);
    write_head(r, SPHERE, radius < 0 ? "bubble" : "sphere", 4);
    add_point(r, center->point);
    orl_text_add(r->text, "%18.12g\n", fabs(radius));
}

/* Writes the head, and both ends, which are words 1 and 3. */
static void write_ends(struct orl_mgf_reader *r, enum counted counted, const char *type,
                       size_t n_reals)
{
    const vertex_t *const from = find_vertex(r, 1), *const to = find_vertex(r, 3);
    write_head(r, counted, type, n_reals);
    add_point(r, from->point);
    add_point(r, to->point);
}

void orl_mgf_cylinder(struct orl_mgf_reader *r)
{
    const double radius = read_radius(r, 2);
    write_ends(r, CYLINDER, radius < 0 ? "tube" : "cylinder", 7);
    orl_text_add(r->text, "%18.12g\n", fabs(radius));
}

void orl_mgf_cone(struct orl_mgf_reader *r)
{
    const double first = read_radius(r, 2), second = read_radius(r, 4);
    if (first * second < 0 || (first == 0 && second == 0))
        orl_mgf_fail(r, ORL_ERR_RANGE, "radii %g and %g do not define a cone", first, second);
    write_ends(r, CONE, first + second < 0 ? "cup" : "cone", 8);
    orl_text_add(r->text, "%18.12g %18.12g\n", fabs(first), fabs(second));
}

void orl_mgf_ring(struct orl_mgf_reader *r)
{
    const double inner = read_radius(r, 2), outer = read_radius(r, 3);
    const vertex_t *const center = find_vertex(r, 1);
    if (!(orl_length(center->normal) > 0) || inner < 0 || !(outer > inner))
        orl_mgf_fail(r, ORL_ERR_RANGE, "a ring needs a normal, and its larger radius last");
    write_head(r, RING, "ring", 8);
    add_point(r, center->point);
    add_vector(r, orl_normalize(orl_xform_vector(&r->xform, center->normal)));
    orl_text_add(r->text, "%18.12g %18.12g\n", inner, outer);
}

/* A torus of MGF, as mgf2rad approximates it: ten cones outside, ten cups inside. */

/* A number printed as a word. */
struct word {
    char text[24];
};

static struct word word_of(double value)
{
    struct word word;
    snprintf(word.text, sizeof word.text, "%.12g", value);
    return word;
}

/* Executes "v name [= template]". */
static void name_vertex(struct orl_mgf_reader *r, const char *name, const char *from)
{
    const char *const words[4] = {"v", name, "=", from};
    memcpy(r->words, words, sizeof words);
    r->n_words = from ? 4 : 2;
    orl_mgf_context(r, ORL_MGF_VERTEX);
}

/* Moves the current vertex along the centre's normal. */
static void place_vertex(struct orl_mgf_reader *r, const struct orl_mgf_vertex *center,
                         double along)
{
    const struct orl_vec3 n = orl_normalize(center->normal);
    const struct orl_vec3 at = orl_add(center->point, orl_scale(n, along));
    r->current[ORL_MGF_VERTEX]->is.vertex.point =
        orl_v3(strtod(word_of(at.x).text, NULL), strtod(word_of(at.y).text, NULL),
               strtod(word_of(at.z).text, NULL));
}

static void add_cone(struct orl_mgf_reader *r, const struct word *first, const struct word *second)
{
    const char *const words[5] = {"cone", "_tv1", first->text, "_tv2", second->text};
    memcpy(r->words, words, sizeof words);
    r->n_words = 5;
    orl_mgf_cone(r);
}

/* Writes a torus with the radii of the hole and of the whole; both negative if the front is
 * inside. */
static void write_torus(struct orl_mgf_reader *r, const char *name, double hole, double whole)
{
    enum { QUARTER = 5 };
    const vertex_t center = orl_mgf_find(r, ORL_MGF_VERTEX, name)->is.vertex;
    const double mean = .5 * (hole + whole), half = .5 * (whole - hole);
    if (!(orl_length(center.normal) > 0))
        orl_mgf_fail(r, ORL_ERR_RANGE, "a torus needs a normal");
    name_vertex(r, "_tv2", name);
    place_vertex(r, &center, fabs(half));
    for (int i = 1; i <= 4 * QUARTER && !r->code; i++) {
        const double before = (i - 1) * M_PI_2 / QUARTER, angle = i * M_PI_2 / QUARTER;
        const double side = i <= 2 * QUARTER ? 1 : -1;
        const struct word radius[2] = {word_of(side * (mean + half * sin(before))),
                                       word_of(side * (mean + half * sin(angle)))};
        name_vertex(r, "_tv1", "_tv2");
        name_vertex(r, "_tv2", NULL);
        place_vertex(r, &center, fabs(half) * cos(angle));
        add_cone(r, &radius[0], &radius[1]);
    }
}

void orl_mgf_torus(struct orl_mgf_reader *r)
{
    const double outer = orl_mgf_number(r, 3);
    double inner = orl_mgf_number(r, 2);
    if (fabs(inner) <= 1e-6)
        inner = 0;
    const bool within = inner < 0 || (inner == 0 && outer < 0);
    if (!(within ? outer < inner : outer > inner))
        orl_mgf_fail(r, ORL_ERR_RANGE, "radii %g and %g do not define a torus", inner, outer);
    write_torus(r, r->words[1], inner, outer);
}
