/*
 * genprism: an outline in the plane z = 0, extruded. With -r its edges are rounded: the flat faces
 * are moved inwards by the radius, and cylinders and spheres fill the gaps.
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"
#include "base/text/words.h"
#include "scene/generate/solid/solids.h"

/* Lengths and shares below this count as 0. */
static const double tiny = 1e-6;

struct corner {
    double x, y;
    double back[2]; /* unit, towards the previous corner */
    double turn;    /* tangent of half the outline's turning angle, positive to the left */
};

struct prism {
    const char *material, *name;
    struct corner *corners;
    size_t n, room;
    struct orl_vec3 extrusion;
    double radius; /* radius of edges; negative if extruded downwards; 0: sharp */
    bool open, bare;
};

/* ---- Words ----------------------------------------------------------------------------------- */

static int add_corner(struct prism *prism, double x, double y, struct orl_error *err)
{
    if (prism->n >= ORL_LIMIT_POLYGON_VERTICES)
        return orl_error_set(err, ORL_ERR_LIMIT, "genprism: the outline has more than %u corners",
                             ORL_LIMIT_POLYGON_VERTICES);
    if (!orl_array_reserve(&prism->corners, &prism->room, prism->n, sizeof *prism->corners))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    prism->corners[prism->n++] = (struct corner){.x = x, .y = y};
    return 0;
}

/* Reads the next two numbers of a file: returns 1, 0 at its end, or a negative error. */
static int next_pair(const char **at, double pair[2], const char *name, struct orl_error *err)
{
    for (int k = 0; k < 2; k++) {
        const char *word = *at + strspn(*at, " \t\r\n\v\f");
        const size_t length = strcspn(word, " \t\r\n\v\f");
        if (length == 0)
            return 0;
        if (orl_number_read(word, length, &pair[k]) != ORL_NUMBER_OK)
            return orl_error_set(err, ORL_ERR_SYNTAX,
                                 "genprism: '%.*s' in '%.80s' is not a finite number",
                                 length < 40 ? (int)length : 40, word, name);
        *at = word + length;
    }
    return 1;
}

static int read_outline_file(struct prism *prism, const struct orl_generator_files *files,
                             const char *name, struct orl_error *err)
{
    double pair[2] = {0, 0};
    char *text = NULL;
    int code, more = 1;
    if (strcmp(name, "-") == 0)
        return orl_error_refuse(err, ORL_ERR_UNSUPPORTED,
                                "name the file of corners instead, or write them in the command",
                                "genprism: '-' (standard input) has no data");
    code = files->read(files->ctx, name, &text, err);
    for (const char *at = text; code == 0 && more;) {
        more = next_pair(&at, pair, name, err);
        code = more < 0 ? more : 0;
        if (more > 0)
            code = add_corner(prism, pair[0], pair[1], err);
    }
    free(text);
    return code;
}

static int read_outline(struct prism *prism, const struct orl_generator_files *files,
                        struct orl_words *words, struct orl_error *err)
{
    double x = 0, y = 0;
    int n = 0, code = 0;
    if (words->left == 0 || !isdigit((unsigned char)words->at[0][0])) {
        code = read_outline_file(prism, files, words->left > 0 ? orl_words_take(words) : "-", err);
    } else {
        code = orl_words_int(words, "the number of corners", 3, (int)ORL_LIMIT_POLYGON_VERTICES, &n,
                             err);
        for (int i = 0; i < n && code == 0; i++) {
            code = orl_words_number(words, "a corner", &x, err);
            code = code < 0 ? code : orl_words_number(words, "a corner", &y, err);
            code = code < 0 ? code : add_corner(prism, x, y, err);
        }
    }
    if (code == 0 && prism->n < 3)
        code =
            orl_error_set(err, ORL_ERR_SYNTAX,
                          "genprism: an outline needs at least three corners, not %zu", prism->n);
    return code;
}

static int read_option(struct prism *prism, struct orl_words *words, struct orl_error *err)
{
    const char *option = orl_words_take(words);
    struct orl_vec3 *v = &prism->extrusion;
    int code = 0;
    if (strcmp(option, "-c") == 0) {
        prism->open = !prism->open;
    } else if (strcmp(option, "-e") == 0) {
        prism->bare = !prism->bare;
    } else if (strcmp(option, "-r") == 0) {
        code = orl_words_number(words, option, &prism->radius, err);
    } else if (strcmp(option, "-l") == 0) {
        code = orl_words_point(words, option, v, err);
        if (code == 0 && fabs(v->z) <= tiny)
            code = orl_error_set(err, ORL_ERR_RANGE,
                                 "genprism: -l %g %g %g is parallel to the outline's plane", v->x,
                                 v->y, v->z);
    } else {
        code = orl_words_refuse(words, option, err);
    }
    return code;
}

/* ---- Sharp edges ----------------------------------------------------------------------------- */

static struct orl_vec3 sharp_corner(const struct prism *prism, size_t i, bool top)
{
    const struct orl_vec3 at = orl_v3(prism->corners[i].x, prism->corners[i].y, 0);
    return top ? orl_add(at, prism->extrusion) : at;
}

/* Returns a corner of the ends of a rounded prism, lifted above the lower end, or below the upper
 * one. */
static struct orl_vec3 rounded_corner(const struct prism *prism, size_t i, bool top, double lift)
{
    const struct corner *c = &prism->corners[i];
    const struct orl_vec3 foot = sharp_corner(prism, i, top);
    return orl_v3(foot.x + prism->radius * (c->turn * c->back[0] - c->back[1]),
                  foot.y + prism->radius * (c->turn * c->back[1] + c->back[0]),
                  top ? foot.z - lift : lift);
}

static void add_ends(const struct prism *prism, struct orl_text *text)
{
    for (int top = 0; top < 2; top++) {
        orl_text_add_head(text, prism->material, "polygon", prism->name, top ? "t" : "b",
                          3 * prism->n);
        for (size_t k = 0; k < prism->n; k++) {
            const size_t i = top ? prism->n - 1 - k : k;
            orl_text_add_point(text, prism->radius != 0 ? rounded_corner(prism, i, top, 0)
                                                        : sharp_corner(prism, i, top));
        }
        orl_text_add(text, "\n");
    }
}

static void add_quad(const struct prism *prism, size_t i, const struct orl_vec3 corners[4],
                     struct orl_text *text)
{
    char part[24];
    snprintf(part, sizeof part, "%zu", i + 1);
    orl_text_add_polygon(text, prism->material, prism->name, part, corners, 4);
}

static void add_side(const struct prism *prism, size_t i, size_t next, struct orl_text *text)
{
    const struct orl_vec3 corners[4] = {sharp_corner(prism, i, false), sharp_corner(prism, i, true),
                                        sharp_corner(prism, next, true),
                                        sharp_corner(prism, next, false)};
    add_quad(prism, i, corners, text);
}

/* ---- Round edges ----------------------------------------------------------------------------- */

static double side_of(const struct prism *prism)
{
    return prism->extrusion.z < 0 ? -1 : 1;
}

static int measure_corners(struct prism *prism, struct orl_error *err)
{
    const size_t n = prism->n;
    for (size_t i = 0; i < n; i++) {
        struct corner *c = &prism->corners[i];
        const struct corner *before = &prism->corners[(i + n - 1) % n];
        const double x = before->x - c->x, y = before->y - c->y, length = sqrt(x * x + y * y);
        if (!(length > tiny))
            return orl_error_set(
                err, ORL_ERR_RANGE,
                "genprism: corners %zu and %zu coincide, so edges between them cannot be rounded",
                (i + n - 1) % n + 1, i + 1);
        c->back[0] = x / length;
        c->back[1] = y / length;
    }
    for (size_t i = 0; i < n; i++) {
        struct corner *c = &prism->corners[i];
        const struct corner *after = &prism->corners[(i + 1) % n];
        const double cosine = c->back[0] * after->back[0] + c->back[1] * after->back[1];
        const double sine = after->back[0] * c->back[1] - after->back[1] * c->back[0];
        if (1 + cosine <= tiny)
            return orl_error_set(
                err, ORL_ERR_RANGE,
                "genprism: the outline reverses at corner %zu, where edges cannot be rounded",
                i + 1);
        c->turn = cosine < 1 ? sqrt((1 - cosine) / (1 + cosine)) : 0;
        c->turn = sine < 0 ? -c->turn : c->turn;
    }
    return 0;
}

/* Adds the rim of an end: a cylinder per edge, and a sphere where the outline is convex. */
static void add_rim(const struct prism *prism, bool top, struct orl_text *text)
{
    const double radius = side_of(prism) * prism->radius;
    struct orl_vec3 before = rounded_corner(prism, prism->n - 1, top, prism->radius);
    char part[24];
    for (size_t i = 0; i < prism->n; i++) {
        const struct orl_vec3 now = rounded_corner(prism, i, top, prism->radius);
        if (side_of(prism) * prism->corners[i].turn > 0) {
            snprintf(part, sizeof part, "%sc%zu", top ? "t" : "b", i + 1);
            orl_text_add_sphere(text, prism->material, prism->name, part, now, radius);
        }
        snprintf(part, sizeof part, "%se%zu", top ? "t" : "b", i + 1);
        orl_text_add_cylinder(text, prism->material, prism->name, part, before, now, radius);
        before = now;
    }
}

/* Adds a side between its rounded edges, tangent to them, and the vertical edge behind it. */
static void add_round_side(const struct prism *prism, size_t i, size_t next, struct orl_text *text)
{
    const struct corner *a = &prism->corners[i], *b = &prism->corners[next];
    const double *u = b->back, r = prism->radius;
    const struct orl_vec3 e = prism->extrusion;
    const double s = side_of(prism) * (e.y * u[0] - e.x * u[1]) / orl_length(e);
    const bool slanted = fabs(s) > tiny;
    const double c = slanted ? 1 - sqrt(1 - s * s) : 0;
    const double t[3] = {-c * u[1], c * u[0], slanted ? s : 0};
    struct orl_vec3 corners[4];
    char part[24];
    for (int k = 0; k < 4; k++) {
        const bool top = k == 1 || k == 2;
        const double shift = k < 2 ? -a->turn : b->turn;
        const struct orl_vec3 foot = sharp_corner(prism, k < 2 ? i : next, top);
        corners[k] = orl_v3(foot.x + r * (t[0] + shift * u[0]), foot.y + r * (t[1] + shift * u[1]),
                            foot.z + r * (t[2] + (top ? -1 : 1)));
    }
    add_quad(prism, i, corners, text);
    if (side_of(prism) * b->turn < 0)
        return;
    snprintf(part, sizeof part, "e%zu", i + 1);
    orl_text_add_cylinder(text, prism->material, prism->name, part,
                          rounded_corner(prism, next, false, r),
                          rounded_corner(prism, next, true, r), side_of(prism) * r);
}

/* ---- Entry point ----------------------------------------------------------------------------- */

static int check_radius(struct prism *prism, struct orl_error *err)
{
    if (prism->radius > tiny && prism->radius > fabs(prism->extrusion.z))
        return orl_error_set(err, ORL_ERR_RANGE,
                             "genprism: the radius %g is larger than the prism's height",
                             prism->radius);
    prism->radius = prism->radius > tiny ? prism->radius * side_of(prism) : 0;
    return prism->radius != 0 ? measure_corners(prism, err) : 0;
}

static void add_prism(const struct prism *prism, struct orl_text *text)
{
    const bool rounded = prism->radius != 0;
    if (!prism->bare) {
        add_ends(prism, text);
        if (rounded) {
            add_rim(prism, false, text);
            add_rim(prism, true, text);
        }
    }
    for (size_t i = 0; i + (prism->open ? 1 : 0) < prism->n; i++)
        (rounded ? add_round_side : add_side)(prism, i, (i + 1) % prism->n, text);
}

int orl_genprism(const char *const *words, size_t count, const struct orl_generator_files *files,
                 struct orl_text *text, struct orl_error *err)
{
    struct prism prism = {.extrusion = {0, 0, 1}};
    struct orl_words rest = {"genprism", words + 1, count - 1};
    int code = orl_words_names(&rest, "the prism", &prism.material, &prism.name, err);
    if (code == 0)
        code = read_outline(&prism, files, &rest, err);
    while (code == 0 && rest.left > 0)
        code = read_option(&prism, &rest, err);
    if (code == 0)
        code = check_radius(&prism, err);
    if (code == 0)
        add_prism(&prism, text);
    free(prism.corners);
    return code;
}
