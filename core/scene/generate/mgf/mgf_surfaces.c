/* Surfaces of MGF, written as polygons, spheres, cylinders, cones and rings; tori as rows of cones.
 * */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/generate/mgf/mgf_context.h"

typedef struct orl_mgf_vertex vertex_t;

static const vertex_t *find_vertex(struct orl_mgf_reader *r, size_t word)
{
    const struct orl_mgf_item *item = orl_mgf_find(r, ORL_MGF_VERTEX, r->words[word]);
    return item ? &item->is.vertex : NULL;
}

/* Kinds of surface by which mgf2rad numbers names. */
enum counted { FACE, SPHERE, CYLINDER, CONE, RING };

/* Writes "material type objects.number", and the argument counts. */
static int write_head(struct orl_mgf_reader *r, enum counted counted, const char *type,
                      size_t n_reals)
{
    static const char *const letters[] = {"f", "s", "cy", "c", "r"};
    const char *const material = orl_mgf_use_material(r);
    if (!material)
        return r->err->code;
    if (++r->n_surfaces > ORL_LIMIT_SURFACES)
        return orl_mgf_fail(r, ORL_ERR_LIMIT, "more than %lu surfaces", ORL_LIMIT_SURFACES);
    orl_text_add(r->text, "'%s' %s '", material, type);
    for (size_t i = 0; i < r->n_objects; i++)
        orl_text_add(r->text, "%s.", r->objects[i]);
    orl_text_add(r->text, "%s%zu'\n0\n0\n%zu\n", letters[counted], ++r->counts[counted], n_reals);
    return 0;
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

static int write_polygon(struct orl_mgf_reader *r, const struct orl_vec3 *corners, size_t n,
                         bool turned)
{
    const int code = write_head(r, FACE, "polygon", 3 * n);
    for (size_t i = 0; i < n && code == 0; i++)
        add_point(r, corners[turned != (r->xform.mirrored != r->xform.inverted) ? n - 1 - i : i]);
    return code;
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
static int write_face(struct orl_mgf_reader *r, const size_t *order, size_t n)
{
    static const size_t most = ORL_MGF_WORDS;
    struct orl_vec3 corners[ORL_MGF_WORDS];
    const vertex_t *vertices[ORL_MGF_WORDS];
    for (size_t i = 0; i < n && i < most; i++) {
        vertices[i] = find_vertex(r, order[i]);
        if (!vertices[i])
            return r->err->code;
        corners[i] = vertices[i]->point;
        r->smooth |= orl_length(vertices[i]->normal) > 0;
    }
    return write_polygon(r, corners, n, is_turned(vertices, n));
}

int orl_mgf_face(struct orl_mgf_reader *r)
{
    size_t order[ORL_MGF_WORDS], n = 0;
    const int code = orl_mgf_expect_words(r, 3, ORL_MGF_WORDS);
    while (n + 1 < r->n_words) {
        order[n] = n + 1;
        n++;
    }
    return code < 0 ? code : write_face(r, order, n);
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
int orl_mgf_face_with_holes(struct orl_mgf_reader *r)
{
    size_t order[2 * ORL_MGF_WORDS], n = 0, length, last = 0;
    int code = orl_mgf_expect_words(r, 3, ORL_MGF_WORDS / 2);
    for (size_t first = 1; first < r->n_words && code == 0; first += length + 1) {
        length = count_outline(r, first);
        if (length < 3)
            return orl_mgf_fail(r, ORL_ERR_SYNTAX, "an outline has fewer than three vertices");
        if (first > 1)
            order[n++] = first + length - 1;
        for (size_t i = 0; i < length; i++)
            order[n++] = first + i;
        if (first > 1)
            order[n++] = last;
        else
            last = length;
    }
    return code < 0 ? code : write_face(r, order, n);
}

int orl_mgf_prism(struct orl_mgf_reader *r)
{
    struct orl_vec3 near[ORL_MGF_WORDS], far[ORL_MGF_WORDS], normal = {0};
    double length = 0;
    const size_t n = r->n_words - 2;
    int code = orl_mgf_expect_words(r, 4, ORL_MGF_WORDS);
    if (code == 0)
        code = orl_mgf_number(r, r->n_words - 1, &length);
    for (size_t i = 0; i < n && code == 0; i++) {
        const vertex_t *vertex = find_vertex(r, 1 + i);
        if (!vertex)
            return r->err->code;
        near[i] = vertex->point;
        r->smooth |= orl_length(vertex->normal) > 0;
        if (i >= 2)
            normal = orl_add(normal,
                             orl_cross(orl_sub(near[i - 1], near[0]), orl_sub(near[i], near[0])));
    }
    if (code == 0 && !(fabs(length) > 1e-6 && orl_length(normal) > 0))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "the prism has no length or no area");
    for (size_t i = 0; i < n && code == 0; i++)
        far[i] = orl_sub(near[i], orl_scale(orl_normalize(normal), length));
    for (size_t i = 0; i < n && code == 0; i++) {
        const size_t before = (i + n - 1) % n;
        const struct orl_vec3 side[4] = {far[i], near[i], near[before], far[before]};
        code = write_polygon(r, side, 4, false);
    }
    if (code == 0)
        code = write_polygon(r, far, n, true);
    return code == 0 ? write_polygon(r, near, n, false) : code;
}

/* ---- Quadrics and rings
 * ----------------------------------------------------------------------- */

/* Reads the radius in a word, and scales it to the scene's units. */
static int read_radius(struct orl_mgf_reader *r, size_t word, double *ret_radius)
{
    const int code = orl_mgf_number(r, word, ret_radius);
    *ret_radius *= r->xform.scale;
    return code;
}

int orl_mgf_sphere(struct orl_mgf_reader *r)
{
    const vertex_t *center;
    double radius = 0;
    int code = orl_mgf_expect_words(r, 2, 2);
    if (code == 0)
        code = read_radius(r, 2, &radius);
    if (code < 0)
        return code;
    center = find_vertex(r, 1);
    if (!center)
        return r->err->code;
    code = write_head(r, SPHERE, radius < 0 ? "bubble" : "sphere", 4);
    if (code == 0) {
        add_point(r, center->point);
        orl_text_add(r->text, "%18.12g\n", fabs(radius));
    }
    return code;
}

/* Writes both ends, which are words 1 and last, and the head before them. */
static int write_ends(struct orl_mgf_reader *r, size_t last, enum counted counted, const char *type,
                      size_t n_reals)
{
    const vertex_t *const from = find_vertex(r, 1);
    const vertex_t *const to = from ? find_vertex(r, last) : NULL;
    const int code = to ? write_head(r, counted, type, n_reals) : r->err->code;
    if (code == 0) {
        add_point(r, from->point);
        add_point(r, to->point);
    }
    return code;
}

int orl_mgf_cylinder(struct orl_mgf_reader *r)
{
    double radius = 0;
    int code = orl_mgf_expect_words(r, 3, 3);
    if (code == 0)
        code = read_radius(r, 2, &radius);
    if (code == 0)
        code = write_ends(r, 3, CYLINDER, radius < 0 ? "tube" : "cylinder", 7);
    if (code == 0)
        orl_text_add(r->text, "%18.12g\n", fabs(radius));
    return code;
}

int orl_mgf_cone(struct orl_mgf_reader *r)
{
    double radii[2] = {0, 0};
    int code = orl_mgf_expect_words(r, 4, 4);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = read_radius(r, 2 + 2 * i, &radii[i]);
    if (code == 0 && (radii[0] * radii[1] < 0 || (radii[0] == 0 && radii[1] == 0)))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "radii %g and %g do not define a cone", radii[0],
                            radii[1]);
    if (code == 0)
        code = write_ends(r, 3, CONE, radii[0] + radii[1] < 0 ? "cup" : "cone", 8);
    if (code == 0)
        orl_text_add(r->text, "%18.12g %18.12g\n", fabs(radii[0]), fabs(radii[1]));
    return code;
}

int orl_mgf_ring(struct orl_mgf_reader *r)
{
    const vertex_t *center;
    double radii[2] = {0, 0};
    int code = orl_mgf_expect_words(r, 3, 3);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = read_radius(r, 2 + i, &radii[i]);
    if (code < 0)
        return code;
    center = find_vertex(r, 1);
    if (!center)
        return r->err->code;
    if (!(orl_length(center->normal) > 0) || radii[0] < 0 || !(radii[1] > radii[0]))
        return orl_mgf_fail(r, ORL_ERR_RANGE, "a ring needs a normal, and its larger radius last");
    code = write_head(r, RING, "ring", 8);
    if (code == 0) {
        add_point(r, center->point);
        add_vector(r, orl_normalize(orl_xform_vector(&r->xform, center->normal)));
        orl_text_add(r->text, "%18.12g %18.12g\n", radii[0], radii[1]);
    }
    return code;
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
static int name_vertex(struct orl_mgf_reader *r, const char *name, const char *from)
{
    const char *const words[4] = {"v", name, "=", from};
    memcpy(r->words, words, sizeof words);
    r->n_words = from ? 4 : 2;
    return orl_mgf_context(r, ORL_MGF_VERTEX);
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

static int add_cone(struct orl_mgf_reader *r, const struct word *first, const struct word *second)
{
    const char *const words[5] = {"cone", "_tv1", first->text, "_tv2", second->text};
    memcpy(r->words, words, sizeof words);
    r->n_words = 5;
    return orl_mgf_cone(r);
}

/* radii: of the hole and of the whole; both negative if the front is inside. */
static int write_torus(struct orl_mgf_reader *r, const char *name, const double radii[2])
{
    enum { QUARTER = 5 };
    const struct orl_mgf_item *const item = orl_mgf_find(r, ORL_MGF_VERTEX, name);
    if (!item)
        return r->err->code;
    const struct orl_mgf_vertex center = item->is.vertex;
    const double mean = .5 * (radii[0] + radii[1]), half = .5 * (radii[1] - radii[0]);
    if (!(orl_length(center.normal) > 0))
        return orl_mgf_fail(r, ORL_ERR_RANGE, "a torus needs a normal");
    int code = name_vertex(r, "_tv2", name);
    if (code == 0)
        place_vertex(r, &center, fabs(half));
    for (int i = 1; i <= 4 * QUARTER && code == 0; i++) {
        const double before = (i - 1) * M_PI_2 / QUARTER, angle = i * M_PI_2 / QUARTER;
        const double side = i <= 2 * QUARTER ? 1 : -1;
        const struct word radius[2] = {word_of(side * (mean + half * sin(before))),
                                       word_of(side * (mean + half * sin(angle)))};
        code = name_vertex(r, "_tv1", "_tv2");
        if (code == 0)
            code = name_vertex(r, "_tv2", NULL);
        if (code < 0)
            return code;
        place_vertex(r, &center, fabs(half) * cos(angle));
        code = add_cone(r, &radius[0], &radius[1]);
    }
    return code;
}

int orl_mgf_torus(struct orl_mgf_reader *r)
{
    static const double tiny = 1e-6;
    const char *const name = r->words[1];
    double radii[2] = {0, 0};
    int code = orl_mgf_expect_words(r, 3, 3);
    for (size_t i = 0; i < 2 && code == 0; i++)
        code = orl_mgf_number(r, 2 + i, &radii[i]);
    if (fabs(radii[0]) <= tiny)
        radii[0] = 0;
    const bool within = radii[0] < 0 || (radii[0] == 0 && radii[1] < 0);
    if (code == 0 && !(within ? radii[1] < radii[0] : radii[1] > radii[0]))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "radii %g and %g do not define a torus", radii[0],
                            radii[1]);
    return code == 0 ? write_torus(r, name, radii) : code;
}
