#include "scene/parse/wavefront.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"

static const uint64_t no_normal = UINT64_MAX;

struct word {
    const char *text;
    size_t length;
};

struct places {
    struct orl_vec3 *items;
    size_t count, room;
};

struct reading {
    const char *at, *end;
    const char *file;
    int line;
    struct places vertices, normals;       /* of the file */
    struct places corners, corner_normals; /* of the face at hand */
    struct orl_wavefront_face face;
    struct orl_wavefront_rest *rest;
};

/* ---- Words ----------------------------------------------------------------------------------- */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/* A backslash at the end of a line joins the next to it. */
static bool skip_joint(struct reading *r)
{
    const char *at = r->at + 1;
    if (*r->at != '\\')
        return false;
    while (at < r->end && is_blank(*at))
        at++;
    if (at < r->end && *at != '\n')
        return false;
    r->at = at < r->end ? at + 1 : at;
    r->line++;
    return true;
}

/* The next of the line; false at its end. */
static bool next_word(struct reading *r, struct word *ret_word)
{
    while (r->at < r->end && (is_blank(*r->at) || skip_joint(r)))
        r->at += r->at < r->end && is_blank(*r->at);
    if (r->at == r->end || *r->at == '\n' || *r->at == '#')
        return false;
    ret_word->text = r->at;
    while (r->at < r->end && !is_blank(*r->at) && *r->at != '\n')
        r->at++;
    ret_word->length = (size_t)(r->at - ret_word->text);
    return true;
}

static void skip_line(struct reading *r)
{
    struct word word;
    while (next_word(r, &word))
        ;
    const char *end = memchr(r->at, '\n', (size_t)(r->end - r->at));
    r->at = end ? end + 1 : r->end;
    r->line++;
}

static bool is(const struct word *word, const char *text)
{
    return strlen(text) == word->length && memcmp(word->text, text, word->length) == 0;
}

static int fail(const struct reading *r, const char *what, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_SYNTAX, "%s", what);
    orl_error_at(err, r->file, r->line, NULL);
    return ORL_ERR_SYNTAX;
}

static void keep_name(char name[ORL_WAVEFRONT_NAME], const struct word *word)
{
    const size_t length = word->length < ORL_WAVEFRONT_NAME ? word->length : ORL_WAVEFRONT_NAME - 1;
    memcpy(name, word->text, length);
    name[length] = '\0';
}

/* ---- Vertices -------------------------------------------------------------------------------- */

static bool read_number(const struct word *word, double *ret_number)
{
    char text[64], *end;
    if (word->length >= sizeof text)
        return false;
    memcpy(text, word->text, word->length);
    text[word->length] = '\0';
    *ret_number = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*ret_number);
}

static int add_place(struct places *places, struct orl_vec3 place, struct orl_error *err)
{
    if (!orl_grow(&places->items, &places->room, places->count, sizeof *places->items))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    places->items[places->count++] = place;
    return 0;
}

/* Of a vertex or normal. */
static int read_place_of(struct reading *r, struct places *into, struct orl_error *err)
{
    double place[3];
    struct word word;
    for (int k = 0; k < 3; k++)
        if (!next_word(r, &word) || !read_number(&word, &place[k]))
            return fail(r, "a vertex, or normal, is three numbers", err);
    return add_place(into, orl_v3(place[0], place[1], place[2]), err);
}

/* ---- Faces ----------------------------------------------------------------------------------- */

/* "7", from 1, or "-1" for the last of so many; false where there is no such. */
static bool read_place(const char **at, const char *end, uint64_t count, uint64_t *ret_place)
{
    const bool back = *at < end && **at == '-';
    uint64_t number = 0;
    const char *digit = *at + back;
    if (digit == end || *digit < '0' || *digit > '9')
        return false;
    for (; digit < end && *digit >= '0' && *digit <= '9' && number < UINT32_MAX; digit++)
        number = 10 * number + (uint64_t)(*digit - '0');
    *at = digit;
    if (number < 1 || number > count)
        return false;
    *ret_place = back ? count - number : number - 1;
    return true;
}

/* "vertex", "vertex/place", "vertex//normal" or "vertex/place/normal", of which 0 is none. */
static bool read_corner(const struct reading *r, const struct word *word, uint64_t *ret_vertex,
                        uint64_t *ret_normal)
{
    const char *at = word->text, *end = word->text + word->length;
    *ret_normal = no_normal;
    if (!read_place(&at, end, r->vertices.count, ret_vertex))
        return false;
    if (at == end)
        return true;
    if (*at++ != '/')
        return false;
    while (at < end && *at != '/')
        at++;
    if (at == end || at + 1 == end || (at + 2 == end && at[1] == '0'))
        return true;
    at++;
    return read_place(&at, end, r->normals.count, ret_normal) && at == end;
}

static int read_face(struct reading *r, const struct orl_wavefront_sink *sink,
                     struct orl_error *err)
{
    struct orl_wavefront_face *face = &r->face;
    struct word word;
    uint64_t vertex, normal;
    bool with_normals = true;
    int code = 0;
    face->line = r->line;
    r->corners.count = r->corner_normals.count = 0;
    while (code == 0 && next_word(r, &word)) {
        if (!r->vertices.items || !read_corner(r, &word, &vertex, &normal))
            return fail(r, "a face names a vertex or a normal that is not there", err);
        code = add_place(&r->corners, r->vertices.items[vertex], err);
        with_normals = with_normals && normal != no_normal && r->normals.items;
        if (code == 0 && with_normals)
            code = add_place(&r->corner_normals, r->normals.items[normal], err);
    }
    if (code == 0 && r->corners.count < 3)
        return fail(r, "a face has three corners at least", err);
    face->corners = r->corners.items;
    face->n_corners = r->corners.count;
    face->normals = with_normals ? r->corner_normals.items : NULL;
    face->number++;
    return code ? code : sink->add(sink->ctx, face, err);
}

static void read_groups(struct reading *r)
{
    struct orl_wavefront_face *face = &r->face;
    struct word word;
    face->n_groups = 0;
    while (face->n_groups < ORL_WAVEFRONT_GROUPS && next_word(r, &word))
        keep_name(face->groups[face->n_groups++], &word);
}

/* ---- Statements ------------------------------------------------------------------------------ */

static void read_name(struct reading *r, char name[ORL_WAVEFRONT_NAME])
{
    struct word word;
    if (next_word(r, &word))
        keep_name(name, &word);
}

static int read_statement(struct reading *r, const struct orl_wavefront_sink *sink,
                          struct orl_error *err)
{
    static const char *const curved[] = {"curv", "curv2", "surf", "p_surf"};
    struct word word;
    if (!next_word(r, &word))
        return 0;
    if (is(&word, "v"))
        return read_place_of(r, &r->vertices, err);
    if (is(&word, "f") || is(&word, "fo"))
        return read_face(r, sink, err);
    if (is(&word, "vn"))
        return read_place_of(r, &r->normals, err);
    if (is(&word, "g"))
        read_groups(r);
    else if (is(&word, "o"))
        read_name(r, r->face.object);
    else if (is(&word, "usemtl"))
        read_name(r, r->face.material);
    else if (is(&word, "usemap"))
        read_name(r, r->face.map);
    else if (is(&word, "l") || is(&word, "p"))
        r->rest->lines++;
    for (size_t i = 0; i < sizeof curved / sizeof *curved; i++)
        r->rest->curved += is(&word, curved[i]);
    return 0;
}

bool orl_wavefront_is(const char *text, size_t size)
{
    static const char *const firsts[] = {"v", "vt", "vn",     "vp",     "g",
                                         "o", "s",  "mtllib", "usemtl", "f"};
    struct reading r = {.at = text, .end = text + size};
    struct word word = {NULL, 0};
    while (r.at < r.end && !next_word(&r, &word))
        skip_line(&r);
    for (size_t i = 0; word.text && i < sizeof firsts / sizeof *firsts; i++)
        if (is(&word, firsts[i]))
            return true;
    return false;
}

int orl_wavefront_read(const char *file, const char *text, size_t size,
                       const struct orl_wavefront_sink *sink, struct orl_wavefront_rest *ret_rest,
                       struct orl_error *err)
{
    struct reading r = {.at = text, .end = text + size, .file = file, .line = 1, .rest = ret_rest};
    int code = 0;
    *ret_rest = (struct orl_wavefront_rest){0};
    while (code == 0 && r.at < r.end) {
        code = read_statement(&r, sink, err);
        skip_line(&r);
    }
    free(r.vertices.items);
    free(r.normals.items);
    free(r.corners.items);
    free(r.corner_normals.items);
    return code;
}
