/*
 * gensurf: a grid surface by functions of s and t, row by row. With -s normals are averaged over
 * neighbours, including those one step beyond the edges. Scene text then has a texture for each
 * polygon (surf.cal), an OBJ file (-o) the normals themselves.
 */
#include <stdlib.h>

#include "scene/generate/curved/gensurf.h"

/* Computes a row of vertices; at[0] is at t = 0. With -s it extends one step beyond both ends. */
static int fill_row(const struct orl_gensurf *surface, int i, struct orl_gensurf_vertex *at,
                    struct orl_error *err)
{
    const int beyond = surface->smooth ? 1 : 0;
    int code = 0;
    if (!surface->smooth && (i < 0 || i > surface->m))
        return 0;
    for (int j = -beyond; j <= surface->n + beyond && code == 0; j++)
        code = orl_gensurf_at(surface, i, j, &at[j], err);
    return code;
}

/* ---- Normals --------------------------------------------------------------------------------- */

/* Difference between the two neighbours, or between the point and its only neighbour. */
static bool difference(const struct orl_gensurf_vertex *before, const struct orl_gensurf_vertex *at,
                       const struct orl_gensurf_vertex *behind, struct orl_vec3 *ret_way)
{
    if (!before->valid && !behind->valid)
        return false;
    *ret_way = orl_sub(behind->valid ? behind->place : at->place,
                       before->valid ? before->place : at->place);
    return true;
}

static void find_normals(const struct orl_gensurf *surface,
                         struct orl_gensurf_vertex *const rows[3])
{
    for (int j = 0; j <= surface->n && surface->smooth; j++) {
        struct orl_gensurf_vertex *at = &rows[1][j];
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

static void write_row(struct orl_gensurf *surface, struct orl_gensurf_vertex *row,
                      struct orl_text *text)
{
    for (int j = 0; j <= surface->n; j++) {
        struct orl_gensurf_vertex *at = &row[j];
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
 * that keeps a triangle if a corner is missing. */
static void add_fields(struct orl_gensurf *surface, struct orl_gensurf_vertex *const rows[3],
                       struct orl_text *text)
{
    const struct orl_gensurf_vertex *a = rows[0], *b = rows[1];
    for (int j = 0; j < surface->n; j++) {
        bool odd = j % 2 == 1;
        if (!(a[j].valid && b[j + 1].valid))
            odd = true;
        else if (!(b[j].valid && a[j + 1].valid))
            odd = false;
        const struct orl_gensurf_vertex *const corners[2][4] = {
            {&b[j], &b[j + 1], &a[j], &a[j + 1]}, {&a[j], &b[j], &a[j + 1], &b[j + 1]}};
        orl_gensurf_add_field(surface, corners[odd], text);
    }
}

static void rotate_rows(struct orl_gensurf_vertex *rows[3])
{
    struct orl_gensurf_vertex *first = rows[0];
    rows[0] = rows[1];
    rows[1] = rows[2];
    rows[2] = first;
}

static int add_rows(struct orl_gensurf *surface, struct orl_gensurf_vertex *rows[3],
                    struct orl_text *text, struct orl_error *err)
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
        add_fields(surface, rows, text);
    }
    return code;
}

int orl_gensurf(const char *const *words, size_t count, const struct orl_generator_files *files,
                struct orl_text *text, struct orl_error *err)
{
    struct orl_words rest = {"gensurf", words + 1, count - 1};
    struct orl_gensurf surface = {0};
    struct orl_gensurf_vertex *all = NULL;
    int code = orl_gensurf_read(&surface, &rest, files, err);
    if (code == 0) {
        const size_t length = (size_t)surface.n + 3;
        all = calloc(3 * length, sizeof *all);
        struct orl_gensurf_vertex *rows[3] = {all + 1, all + length + 1, all + 2 * length + 1};
        code = all ? add_rows(&surface, rows, text, err)
                   : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    orl_gensurf_done(&surface);
    free(all);
    return code;
}
