#include "scene/generate/solid/solids.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text/words.h"

/*
 * gensurf: a grid of vertices by functions of s and t, which go from 0 to 1, row by row of s. With
 * -s normals are averaged over neighbours, including those one step beyond the edges. Scene text
 * then has a texture for each polygon (surf.cal), an OBJ file (-o) the normals themselves.
 */

/* Limits of cells along one side, and in total. */
enum { SIDE_MAX = 20000, FIELDS_MAX = 1000000 };

/* Numbers from a file in place of expressions, interpolated: z only, or all three coordinates; at
 * the grid's vertices, or at the centres of its cells. */
struct gensurf_data {
    double *values; /* owned; s changes fastest */
    int n_s, n_t;
    size_t each; /* 3, or 1; 0: no file */
    bool middles;
};

struct gensurf_vertex {
    bool valid;
    int number, normal_number; /* numbers in an OBJ file; 0: no normal */
    struct orl_vec3 place;
    struct orl_vec3 normal; /* average over its neighbourhood; unit or 0 */
    double s, t;
};

struct gensurf {
    const char *material, *name;
    int m, n; /* cells along s and t */
    bool smooth, object, inverted;
    bool checked; /* the last expression says which vertices exist */
    struct orl_generator_expressions expressions;
    struct gensurf_data data;
    int n_vertices, n_normals, n_faces; /* numbers written so far */
    struct orl_vec3 last_normal;        /* last one written */
};

static void gensurf_done(struct gensurf *surface)
{
    orl_expressions_done(&surface->expressions);
    free(surface->data.values);
}

/* ---- Data files ------------------------------------------------------------------------------ */

static int read_values(struct gensurf_data *data, size_t most, const char *text, const char *name,
                       size_t *ret_n, struct orl_error *err)
{
    static const char blanks[] = " \t\r\n\v\f";
    size_t n = 0;
    data->values = malloc(most * sizeof *data->values);
    if (!data->values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (const char *at = text + strspn(text, blanks); *at; at += strspn(at, blanks)) {
        const size_t length = strcspn(at, blanks);
        if (n == most)
            return orl_error_set(err, ORL_ERR_SYNTAX, "gensurf: '%.80s' has more than %zu numbers",
                                 name, most);
        if (orl_number_read(at, length, &data->values[n++]) != ORL_NUMBER_OK)
            return orl_error_set(err, ORL_ERR_SYNTAX,
                                 "gensurf: '%.*s' in '%.80s' is not a finite number",
                                 length < 40 ? (int)length : 40, at, name);
        at += length;
    }
    *ret_n = n;
    return 0;
}

static int read_data(struct gensurf *surface, size_t each, const char *text, const char *name,
                     struct orl_error *err)
{
    struct gensurf_data *data = &surface->data;
    const size_t m = (size_t)surface->m, n = (size_t)surface->n;
    const size_t at_vertices = (m + 1) * (n + 1) * each, in_middles = m * n * each;
    size_t found = 0;
    const int code = read_values(data, at_vertices, text, name, &found, err);
    if (code < 0)
        return code;
    data->middles = found == in_middles;
    data->n_s = surface->m + (data->middles ? 0 : 1);
    data->n_t = surface->n + (data->middles ? 0 : 1);
    data->each = each;
    if ((found != at_vertices && found != in_middles) || data->n_s < 2 || data->n_t < 2)
        return orl_error_set(
            err, ORL_ERR_SYNTAX,
            "gensurf: '%.80s' has %zu numbers; %d x %d fields need %zu, or %zu with the edges",
            name, found, surface->m, surface->n, in_middles, at_vertices);
    return 0;
}

static double interpolate_data(const struct gensurf_data *data, size_t coordinate, double s,
                               double t)
{
    const double u = data->middles ? s * data->n_s - .5 : s * (data->n_s - 1);
    const double v = data->middles ? t * data->n_t - .5 : t * (data->n_t - 1);
    const int i = u < 0 ? 0 : u >= data->n_s - 1 ? data->n_s - 2 : (int)u;
    const int j = v < 0 ? 0 : v >= data->n_t - 1 ? data->n_t - 2 : (int)v;
    const size_t each = data->each, row = each * (size_t)data->n_s;
    const double *at = data->values + (size_t)j * row + (size_t)i * each + coordinate;
    return (j + 1 - v) * ((i + 1 - u) * at[0] + (u - i) * at[each]) +
           (v - j) * ((i + 1 - u) * at[row] + (u - i) * at[row + each]);
}

/* ---- Words ----------------------------------------------------------------------------------- */

static int read_option(struct gensurf *surface, struct orl_words *words,
                       const struct orl_generator_files *files, struct orl_error *err)
{
    const char *option = orl_words_take(words);
    if (strcmp(option, "-s") == 0)
        surface->smooth = true;
    else if (strcmp(option, "-i") == 0)
        surface->inverted = true;
    else if (strcmp(option, "-o") == 0)
        surface->object = true;
    else
        return orl_expressions_define(&surface->expressions, option, words, files, err);
    return 0;
}

/* Reads z's word as a file if it exists; it gives all three coordinates if their words are
 * equal. */
static int read_file(struct gensurf *surface, const char *const texts[3],
                     const struct orl_generator_files *files, struct orl_error *err)
{
    struct orl_error missing = {0};
    char *text = NULL;
    if (strcmp(texts[2], "-") == 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "gensurf: '-' (standard input) has no data: name the file of numbers");
    if (files->read(files->ctx, texts[2], &text, &missing) < 0)
        return 0;
    const bool all = strcmp(texts[0], texts[2]) == 0 && strcmp(texts[1], texts[2]) == 0;
    const int code = read_data(surface, all ? 3 : 1, text, texts[2], err);
    free(text);
    return code;
}

static int compile_expressions(struct gensurf *surface, const char *const texts[3],
                               struct orl_error *err)
{
    static const char valid[] = "valid(s,t)";
    const size_t places = (size_t)(surface->m + 3) * (size_t)(surface->n + 3);
    const char *all[4];
    size_t n = 0;
    for (; n + surface->data.each < 3; n++)
        all[n] = texts[n];
    surface->checked =
        orl_functions_has(surface->expressions.functions, ORL_FUNCTION_GLOBAL, "valid") &&
        orl_functions_arity(surface->expressions.functions, ORL_FUNCTION_GLOBAL, "valid") == 2;
    if (surface->checked)
        all[n++] = valid;
    if (n == 0)
        return 0;
    return orl_expressions_compile(&surface->expressions, all, n, places, err);
}

static int read_counts(struct gensurf *surface, const char *const words[2], struct orl_error *err)
{
    int code = orl_expressions_count(&surface->expressions, words[0], "fields along s", "gensurf",
                                     SIDE_MAX, &surface->m, err);
    if (code == 0)
        code = orl_expressions_count(&surface->expressions, words[1], "fields along t", "gensurf",
                                     SIDE_MAX, &surface->n, err);
    if (code == 0 && (long)surface->m * surface->n > FIELDS_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "gensurf: %d x %d fields exceed the limit of %d",
                             surface->m, surface->n, FIELDS_MAX);
    return code;
}

/* Reads the words. The caller passes the surface to gensurf_done in every case. */
static int read_gensurf(struct gensurf *surface, struct orl_words *words,
                        const struct orl_generator_files *files, struct orl_error *err)
{
    static const char *const inputs[] = {"s", "t"};
    int code = orl_words_names(words, "the surface", &surface->material, &surface->name, err);
    if (code == 0 && words->left < 5)
        code = orl_error_set(err, ORL_ERR_SYNTAX,
                             "gensurf needs three expressions and two numbers of fields");
    if (code < 0)
        return code;
    const char *const *texts = words->at;
    words->at += 5;
    words->left -= 5;
    code = orl_expressions_begin(&surface->expressions, inputs, 2, err);
    while (code == 0 && words->left > 0)
        code = read_option(surface, words, files, err);
    if (code == 0)
        code = read_counts(surface, texts + 3, err);
    if (code == 0)
        code = read_file(surface, texts, files, err);
    return code < 0 ? code : compile_expressions(surface, texts, err);
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* Computes the vertex at (i / m, j / n), without a normal. */
static int evaluate_vertex(const struct gensurf *surface, int i, int j,
                           struct gensurf_vertex *ret_vertex, struct orl_error *err)
{
    const double at[2] = {(double)i / surface->m, (double)j / surface->n};
    const struct gensurf_data *data = &surface->data;
    double values[4] = {0}, place[3];
    const size_t given = 3 - data->each; /* number of coordinates by expressions */
    const int code = surface->expressions.function
                         ? orl_expressions_at(&surface->expressions, at, values, err)
                         : 0;
    ret_vertex->valid = !surface->checked || values[given] > 0;
    ret_vertex->place = orl_v3(0, 0, 0);
    ret_vertex->s = ret_vertex->t = 0;
    if (code < 0 || !ret_vertex->valid)
        return code;
    for (size_t k = 0; k < 3; k++)
        place[k] = k < given ? values[k] : interpolate_data(data, k - given, at[0], at[1]);
    ret_vertex->place = orl_v3(place[0], place[1], place[2]);
    ret_vertex->s = at[0];
    ret_vertex->t = at[1];
    return 0;
}

/* A normal over a cell: a linear function of u v, u, v and 1, where u and v are the coordinates
 * other than the axis. */
struct turning {
    bool given;
    int axis;
    struct orl_vec3 terms[4];
};

/* Inverts a by elimination with column pivots, which are swapped onto its diagonal; false if
 * singular. */
static bool invert(double a[4][4], double inverse[4][4])
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++)
            inverse[i][k] = i == k;
    for (int i = 0; i < 4; i++) {
        double most = 1e-6;
        int pivot = -1;
        for (int k = i; k < 4; k++)
            if (fabs(a[k][i]) > most) {
                most = fabs(a[k][i]);
                pivot = k;
            }
        if (pivot < 0)
            return false;
        for (int k = 0; k < 4; k++) {
            const double x = a[i][k], y = inverse[i][k];
            a[i][k] = a[pivot][k], inverse[i][k] = inverse[pivot][k];
            a[pivot][k] = x, inverse[pivot][k] = y;
        }
        const double by = a[i][i];
        for (int k = 0; k < 4; k++)
            a[i][k] /= by, inverse[i][k] /= by;
        for (int j = 0; j < 4; j++) {
            const double factor = a[j][i];
            for (int k = 0; k < 4 && j != i; k++)
                a[j][k] -= a[i][k] * factor, inverse[j][k] -= inverse[i][k] * factor;
        }
    }
    return true;
}

static struct turning find_turning(const struct gensurf *surface,
                                   const struct gensurf_vertex *const corners[4])
{
    struct turning turning = {.given = false};
    struct orl_vec3 sum = corners[0]->normal;
    double equations[4][4], inverse[4][4];
    if (!surface->smooth)
        return turning;
    for (int k = 1; k < 4; k++)
        sum = orl_add(sum, corners[k]->normal);
    turning.axis = fabs(sum.x) > fabs(sum.y) ? 0 : 1;
    turning.axis = fabs(orl_component(sum, turning.axis)) > fabs(sum.z) ? turning.axis : 2;
    for (int k = 0; k < 4; k++) {
        const double u = orl_component(corners[k]->place, (turning.axis + 1) % 3);
        const double v = orl_component(corners[k]->place, (turning.axis + 2) % 3);
        const double row[4] = {u * v, u, v, 1};
        memcpy(equations[k], row, sizeof row);
    }
    turning.given = invert(equations, inverse);
    for (int k = 0; k < 4 && turning.given; k++)
        for (int i = 0; i < 4; i++)
            turning.terms[k] = orl_madd(turning.terms[k], corners[i]->normal, inverse[k][i]);
    return turning;
}

/* flat: the polygon's normal, to which the texture's value is added. */
static void add_texture(const struct gensurf *surface, const struct turning *turning,
                        struct orl_vec3 flat, struct orl_text *text)
{
    orl_text_add(text, "'%s' texfunc Phong\n4 surf_dx surf_dy surf_dz surf.cal\n0\n13 %d",
                 surface->material, turning->axis);
    for (int k = 0; k < 3; k++)
        orl_text_add_point(text, turning->terms[k]);
    orl_text_add_point(text, orl_sub(turning->terms[3], flat));
    orl_text_add(text, "\n");
}

static void add_polygon(struct gensurf *surface, const struct turning *turning,
                        struct orl_vec3 flat, const struct gensurf_vertex *const *corners, size_t n,
                        struct orl_text *text)
{
    char part[24];
    if (turning->given)
        add_texture(surface, turning, flat, text);
    snprintf(part, sizeof part, "%d", ++surface->n_faces);
    orl_text_add_head(text, turning->given ? "Phong" : surface->material, "polygon", surface->name,
                      part, 3 * n);
    for (size_t k = 0; k < n; k++)
        orl_text_add_point(text, corners[k]->place);
    orl_text_add(text, "\n");
}

static void add_face(const struct gensurf *surface, const struct gensurf_vertex *const *corners,
                     size_t n, struct orl_text *text)
{
    orl_text_add(text, "f");
    for (size_t k = 0; k < n; k++) {
        const int place = corners[k]->number - surface->n_vertices - 1;
        const int normal = corners[k]->normal_number;
        orl_text_add(text, " %d/%d/%d", place, place,
                     normal > 0 ? normal - surface->n_normals - 1 : 0);
    }
    orl_text_add(text, "\n");
}

static void write_polygon(struct gensurf *surface, const struct turning *turning,
                          struct orl_vec3 flat, const struct gensurf_vertex *const *corners,
                          size_t n, struct orl_text *text)
{
    if (surface->object)
        add_face(surface, corners, n, text);
    else
        add_polygon(surface, turning, flat, corners, n, text);
}

/* Returns the unit normal; false unless all three vertices exist and are not collinear. */
static bool is_triangle(const struct gensurf_vertex *a, const struct gensurf_vertex *b,
                        const struct gensurf_vertex *c, struct orl_vec3 *ret_normal)
{
    const struct orl_vec3 normal =
        orl_cross(orl_sub(b->place, a->place), orl_sub(c->place, a->place));
    const double length = orl_length(normal);
    *ret_normal = length > 0 ? orl_scale(normal, 1 / length) : normal;
    return a->valid && b->valid && c->valid && length > 0;
}

/* Adds a cell of the grid by its corners: two triangles, or one polygon if they are coplanar.
 * corners[1] and [2] are the triangles' common edge. */
static void add_cell(struct gensurf *surface, const struct gensurf_vertex *const corners[4],
                     struct orl_text *text)
{
    const bool turned = surface->inverted;
    const struct gensurf_vertex *const c[4] = {corners[0], corners[turned ? 2 : 1],
                                               corners[turned ? 1 : 2], corners[3]};
    struct orl_vec3 first, second;
    const bool has_first = is_triangle(c[0], c[1], c[2], &first);
    const bool has_second = is_triangle(c[3], c[2], c[1], &second);
    const struct gensurf_vertex *const around[4] = {c[0], c[1], c[3], c[2]};
    const struct gensurf_vertex *const triangles[2][3] = {{c[0], c[1], c[2]}, {c[2], c[1], c[3]}};
    if (!has_first && !has_second)
        return;
    const struct turning turning = find_turning(surface, c);
    if (has_first && has_second && orl_dot(first, second) >= 1 - 1e-12) {
        write_polygon(surface, &turning, orl_scale(orl_add(first, second), .5), around, 4, text);
        return;
    }
    if (has_first)
        write_polygon(surface, &turning, first, triangles[0], 3, text);
    if (has_second)
        write_polygon(surface, &turning, second, triangles[1], 3, text);
}

/* ---- Rows ------------------------------------------------------------------------------------ */

/* Computes a row of vertices; at[0] is at t = 0. With -s it extends one step beyond both ends. */
static int fill_row(const struct gensurf *surface, int i, struct gensurf_vertex *at,
                    struct orl_error *err)
{
    const int beyond = surface->smooth ? 1 : 0;
    int code = 0;
    if (!surface->smooth && (i < 0 || i > surface->m))
        return 0;
    for (int j = -beyond; j <= surface->n + beyond && code == 0; j++)
        code = evaluate_vertex(surface, i, j, &at[j], err);
    return code;
}

/* ---- Normals --------------------------------------------------------------------------------- */

/* Difference between the two neighbours, or between the point and its only neighbour. */
static bool difference(const struct gensurf_vertex *before, const struct gensurf_vertex *at,
                       const struct gensurf_vertex *behind, struct orl_vec3 *ret_way)
{
    if (!before->valid && !behind->valid)
        return false;
    *ret_way = orl_sub(behind->valid ? behind->place : at->place,
                       before->valid ? before->place : at->place);
    return true;
}

static void find_normals(const struct gensurf *surface, struct gensurf_vertex *const rows[3])
{
    for (int j = 0; j <= surface->n && surface->smooth; j++) {
        struct gensurf_vertex *at = &rows[1][j];
        struct orl_vec3 along_s, along_t;
        if (!at->valid)
            continue;
        at->normal = orl_v3(0, 0, 0);
        if (!difference(&rows[0][j], at, &rows[2][j], &along_s) ||
            !difference(at - 1, at, at + 1, &along_t))
            continue;
        const struct orl_vec3 normal =
            surface->inverted ? orl_cross(along_t, along_s) : orl_cross(along_s, along_t);
        const double length = orl_length(normal);
        at->normal = length > 0 ? orl_scale(normal, 1 / length) : normal;
    }
}

/* ---- OBJ ------------------------------------------------------------------------------------- */

static bool is_same(struct orl_vec3 a, struct orl_vec3 b)
{
    const double tiny = 1e-6;
    return fabs(a.x - b.x) <= tiny && fabs(a.y - b.y) <= tiny && fabs(a.z - b.z) <= tiny;
}

static void write_row(struct gensurf *surface, struct gensurf_vertex *row, struct orl_text *text)
{
    for (int j = 0; j <= surface->n; j++) {
        struct gensurf_vertex *at = &row[j];
        const struct orl_vec3 n = at->normal;
        if (!at->valid)
            continue;
        orl_text_add(text, "v %.12g %.12g %.12g\nvt %.9g %.9g\n", at->place.x, at->place.y,
                     at->place.z, at->s, at->t);
        at->number = ++surface->n_vertices;
        at->normal_number = 0;
        if (!surface->smooth || orl_dot(n, n) <= 1e-12)
            continue;
        if (!is_same(n, surface->last_normal)) {
            orl_text_add(text, "vn %.9g %.9g %.9g\n", n.x, n.y, n.z);
            surface->last_normal = n;
            surface->n_normals++;
        }
        at->normal_number = surface->n_normals;
    }
}

/* ---- Output ---------------------------------------------------------------------------------- */

/* Adds the quadrilaterals between two rows, split along alternating diagonals, or along the one
 * that leaves a triangle if a corner is missing. */
static void add_cells(struct gensurf *surface, struct gensurf_vertex *const rows[3],
                      struct orl_text *text)
{
    const struct gensurf_vertex *a = rows[0], *b = rows[1];
    for (int j = 0; j < surface->n; j++) {
        bool odd = j % 2 == 1;
        if (!(a[j].valid && b[j + 1].valid))
            odd = true;
        else if (!(b[j].valid && a[j + 1].valid))
            odd = false;
        const struct gensurf_vertex *const corners[2][4] = {{&b[j], &b[j + 1], &a[j], &a[j + 1]},
                                                            {&a[j], &b[j], &a[j + 1], &b[j + 1]}};
        add_cell(surface, corners[odd], text);
    }
}

static void rotate_rows(struct gensurf_vertex *rows[3])
{
    struct gensurf_vertex *first = rows[0];
    rows[0] = rows[1];
    rows[1] = rows[2];
    rows[2] = first;
}

static int add_rows(struct gensurf *surface, struct gensurf_vertex *rows[3], struct orl_text *text,
                    struct orl_error *err)
{
    int code = 0;
    for (int i = -1; i <= 1 && code == 0; i++)
        code = fill_row(surface, i, rows[i + 1], err);
    if (code < 0)
        return code;
    find_normals(surface, rows);
    if (surface->object) {
        text->object = true;
        orl_text_add(text, "usemtl %s\no %s\n", surface->material, surface->name);
        write_row(surface, rows[1], text);
    }
    for (int i = 0; i < surface->m && code == 0 && !text->failed; i++) {
        rotate_rows(rows);
        code = fill_row(surface, i + 2, rows[2], err);
        if (code < 0)
            break;
        find_normals(surface, rows);
        if (surface->object)
            write_row(surface, rows[1], text);
        add_cells(surface, rows, text);
    }
    return code;
}

int orl_gensurf(const char *const *words, size_t count, const struct orl_generator_files *files,
                struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"gensurf", words + 1, count - 1};
    struct gensurf surface = {0};
    struct gensurf_vertex *all = NULL;
    int code = read_gensurf(&surface, &rest, files, err);
    if (code == 0) {
        const size_t length = (size_t)surface.n + 3;
        all = calloc(3 * length, sizeof *all);
        struct gensurf_vertex *rows[3] = {all + 1, all + length + 1, all + 2 * length + 1};
        code = all ? add_rows(&surface, rows, text, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    gensurf_done(&surface);
    free(all);
    return code;
}
