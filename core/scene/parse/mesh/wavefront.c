#include "scene/parse/mesh/mesh_formats.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "base/memory/memory.h"

static const uint64_t no_normal = UINT64_MAX;
static const unsigned options = ORL_SCANNER_COMMENTS | ORL_SCANNER_CONTINUATIONS;

struct places {
    struct orl_vec3 *items;
    size_t count, room;
};

struct reading {
    struct orl_scanner scanner;
    struct places vertices, normals;       /* those of the whole file */
    struct places corners, corner_normals; /* those of the current face */
    struct orl_wavefront_face face;
    struct orl_wavefront_ignored *ignored;
};

static bool next_word(struct reading *r, struct orl_slice *ret_word)
{
    return orl_scanner_word_of_line(&r->scanner, ret_word);
}

static int fail(const struct reading *r, const char *what, struct orl_error *err)
{
    return orl_scanner_fail(&r->scanner, ORL_ERR_SYNTAX, err, "%s", what);
}

static void keep_name(char name[ORL_WAVEFRONT_NAME], const struct orl_slice *word)
{
    const size_t length = word->length < ORL_WAVEFRONT_NAME ? word->length : ORL_WAVEFRONT_NAME - 1;
    memcpy(name, word->text, length);
    name[length] = '\0';
}

/* ---- Vertices -------------------------------------------------------------------------------- */

static int add_place(struct places *places, struct orl_vec3 place, struct orl_error *err)
{
    if (!orl_array_reserve(&places->items, &places->room, places->count, sizeof *places->items))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    places->items[places->count++] = place;
    return 0;
}

/* Reads a vertex or normal. */
static int read_place_of(struct reading *r, struct places *into, struct orl_error *err)
{
    static const char what[] = "a vertex or normal needs three numbers";
    double place[3];
    struct orl_slice word;
    for (int k = 0; k < 3; k++) {
        if (!next_word(r, &word))
            return fail(r, what, err);
        const int code = orl_scanner_number(&r->scanner, word, what, &place[k], err);
        if (code < 0)
            return code;
    }
    return add_place(into, orl_v3(place[0], place[1], place[2]), err);
}

/* ---- Faces ----------------------------------------------------------------------------------- */

/* Reads an index: "7", from 1, or "-1" for the last of count; false if out of range. */
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

/* Reads "vertex", "vertex/place", "vertex//normal" or "vertex/place/normal"; a normal of 0 means
 * none. */
static bool read_corner(const struct reading *r, const struct orl_slice *word, uint64_t *ret_vertex,
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
    struct orl_slice word;
    uint64_t vertex, normal;
    bool with_normals = true;
    int code = 0;
    face->line = r->scanner.line;
    r->corners.count = r->corner_normals.count = 0;
    while (code == 0 && next_word(r, &word)) {
        if (!r->vertices.items || !read_corner(r, &word, &vertex, &normal))
            return fail(r, "a face uses a vertex or a normal that does not exist", err);
        code = add_place(&r->corners, r->vertices.items[vertex], err);
        with_normals = with_normals && normal != no_normal && r->normals.items;
        if (code == 0 && with_normals)
            code = add_place(&r->corner_normals, r->normals.items[normal], err);
    }
    if (code == 0 && r->corners.count < 3)
        return fail(r, "a face needs at least three corners", err);
    face->corners = r->corners.items;
    face->n_corners = r->corners.count;
    face->normals = with_normals ? r->corner_normals.items : NULL;
    face->number++;
    return code ? code : sink->add(sink->ctx, face, err);
}

static void read_groups(struct reading *r)
{
    struct orl_wavefront_face *face = &r->face;
    struct orl_slice word;
    face->n_groups = 0;
    while (face->n_groups < ORL_WAVEFRONT_GROUPS && next_word(r, &word))
        keep_name(face->groups[face->n_groups++], &word);
}

/* ---- Statements ------------------------------------------------------------------------------ */

static void read_name(struct reading *r, char name[ORL_WAVEFRONT_NAME])
{
    struct orl_slice word;
    if (next_word(r, &word))
        keep_name(name, &word);
}

static int read_statement(struct reading *r, const struct orl_wavefront_sink *sink,
                          struct orl_error *err)
{
    static const char *const curved[] = {"curv", "curv2", "surf", "p_surf"};
    struct orl_slice word;
    if (!next_word(r, &word))
        return 0;
    if (orl_slice_is(word, "v"))
        return read_place_of(r, &r->vertices, err);
    if (orl_slice_is(word, "f") || orl_slice_is(word, "fo"))
        return read_face(r, sink, err);
    if (orl_slice_is(word, "vn"))
        return read_place_of(r, &r->normals, err);
    if (orl_slice_is(word, "g"))
        read_groups(r);
    else if (orl_slice_is(word, "o"))
        read_name(r, r->face.object);
    else if (orl_slice_is(word, "usemtl"))
        read_name(r, r->face.material);
    else if (orl_slice_is(word, "usemap"))
        read_name(r, r->face.map);
    else if (orl_slice_is(word, "l") || orl_slice_is(word, "p"))
        r->ignored->lines++;
    for (size_t i = 0; i < sizeof curved / sizeof *curved; i++)
        r->ignored->curved += orl_slice_is(word, curved[i]);
    return 0;
}

bool orl_wavefront_detect(const char *text, size_t size)
{
    static const char *const firsts[] = {"v", "vt", "vn",     "vp",     "g",
                                         "o", "s",  "mtllib", "usemtl", "f"};
    struct orl_scanner scanner;
    struct orl_slice word = {NULL, 0};
    if (orl_scanner_init(&scanner, NULL, text, size, options, NULL) < 0)
        return false;
    orl_scanner_word(&scanner, &word);
    for (size_t i = 0; word.text && i < sizeof firsts / sizeof *firsts; i++)
        if (orl_slice_is(word, firsts[i]))
            return true;
    return false;
}

int orl_wavefront_read(const char *file, const char *text, size_t size,
                       const struct orl_wavefront_sink *sink,
                       struct orl_wavefront_ignored *ret_ignored, struct orl_error *err)
{
    struct reading r = {.ignored = ret_ignored};
    struct orl_slice left;
    int code = orl_scanner_init(&r.scanner, file, text, size, options, err);
    *ret_ignored = (struct orl_wavefront_ignored){0};
    while (code == 0 && orl_scanner_next_line(&r.scanner)) {
        code = read_statement(&r, sink, err);
        while (code == 0 && next_word(&r, &left))
            ; /* also words of continued lines */
    }
    free(r.vertices.items);
    free(r.normals.items);
    free(r.corners.items);
    free(r.corner_normals.items);
    return code;
}
