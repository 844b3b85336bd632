/* Reads MGF entities in sequence; handles transforms, which may repeat their content, and included
 * files. */
#include "scene/generate/mgf/mgf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"
#include "scene/generate/mgf/mgf_context.h"

enum { WORDS_BYTES = 1 << 18, LEAVE_COST = 64 };

/* ---- Properties ------------------------------------------------------------------------------ */

static int read_vector(struct orl_mgf_reader *r, struct orl_vec3 *ret)
{
    double *const at[3] = {&ret->x, &ret->y, &ret->z};
    int code = orl_mgf_expect_words(r, 3, 3);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = orl_mgf_number(r, 1 + i, at[i]);
    return code;
}

static int read_point(struct orl_mgf_reader *r)
{
    return read_vector(r, &r->current[ORL_MGF_VERTEX]->is.vertex.point);
}

static int read_normal(struct orl_mgf_reader *r)
{
    return read_vector(r, &r->current[ORL_MGF_VERTEX]->is.vertex.normal);
}

static struct orl_mgf_material *changed_material(struct orl_mgf_reader *r)
{
    r->current[ORL_MGF_MATERIAL]->is.material.written = false;
    return &r->current[ORL_MGF_MATERIAL]->is.material;
}

static int read_part(struct orl_mgf_reader *r)
{
    struct orl_mgf_material *m = changed_material(r);
    struct orl_mgf_component part = {.color = r->current[ORL_MGF_COLOR]->is.color};
    const bool specular = r->words[0][1] == 's', lamp = r->words[0][0] == 'e';
    int code = orl_mgf_expect_words(r, specular ? 2 : 1, specular ? 2 : 1);
    if (code == 0)
        code = orl_mgf_number(r, 1, &part.value);
    if (code == 0 && specular)
        code = orl_mgf_number(r, 2, &part.roughness);
    if (code == 0 && (!(part.value >= 0) || (!lamp && part.value > 1) || !(part.roughness >= 0)))
        code = orl_mgf_fail(r, ORL_ERR_RANGE, "%s %s is out of range", r->words[0], r->words[1]);
    if (code < 0)
        return code;
    *(lamp                    ? &m->ed
      : r->words[0][0] == 'r' ? (specular ? &m->rs : &m->rd)
                              : (specular ? &m->ts : &m->td)) = part;
    return 0;
}

static int read_index(struct orl_mgf_reader *r)
{
    double imaginary = 0, *const index = &changed_material(r)->index;
    int code = orl_mgf_expect_words(r, 2, 2);
    if (code == 0)
        code = orl_mgf_number(r, 1, index);
    return code == 0 ? orl_mgf_number(r, 2, &imaginary) : code;
}

static int read_sides(struct orl_mgf_reader *r)
{
    const int code = orl_mgf_expect_words(r, 1, 1);
    if (code == 0 && strcmp(r->words[1], "1") != 0 && strcmp(r->words[1], "2") != 0)
        return orl_mgf_fail(r, ORL_ERR_RANGE, "the number of sides must be 1 or 2");
    if (code == 0)
        changed_material(r)->one_sided = r->words[1][0] == '1';
    return code;
}

static int read_color_name(struct orl_mgf_reader *r)
{
    return orl_mgf_context(r, ORL_MGF_COLOR);
}

static int read_material_name(struct orl_mgf_reader *r)
{
    return orl_mgf_context(r, ORL_MGF_MATERIAL);
}

static int read_vertex_name(struct orl_mgf_reader *r)
{
    return orl_mgf_context(r, ORL_MGF_VERTEX);
}

/* ---- Objects and transforms ------------------------------------------------------------------ */

static int push_object(struct orl_mgf_reader *r, const char *name)
{
    if (r->n_objects == ORL_MGF_DEPTH)
        return orl_mgf_fail(r, ORL_ERR_LIMIT, "objects are nested deeper than %d", ORL_MGF_DEPTH);
    r->objects[r->n_objects] = strdup(name);
    return r->objects[r->n_objects++] ? 0 : orl_mgf_fail(r, ORL_ERR_NOMEM, "out of memory");
}

static void pop_objects(struct orl_mgf_reader *r, size_t left)
{
    while (r->n_objects > left)
        free(r->objects[--r->n_objects]);
}

static int read_object(struct orl_mgf_reader *r)
{
    const int code = orl_mgf_expect_words(r, 0, 1);
    if (code < 0)
        return code;
    if (r->n_words > 1)
        return push_object(r, r->words[1]);
    if (r->n_objects == 0)
        return orl_mgf_fail(r, ORL_ERR_SYNTAX, "no object is open");
    pop_objects(r, r->n_objects - 1);
    return 0;
}

/* Adds one of the copies that a transform makes. */
static int add_copy(void *ctx, const struct orl_xform_use *use, struct orl_error *err)
{
    struct orl_mgf_frame *frame = ctx;
    if (frame->n_copies >= frame->most)
        return orl_error_set(err, ORL_ERR_LIMIT, "nested transforms make more than %u copies",
                             ORL_LIMIT_XFORM_ARRAY);
    if (use->n_files > 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%.60s' is not a transform", use->files[0]);
    if (!orl_array_reserve(&frame->copies, &frame->room, frame->n_copies, sizeof *frame->copies))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    struct orl_mgf_copy *const copy = &frame->copies[frame->n_copies++];
    copy->xform = orl_xform_compose(&frame->outer, &use->xform);
    snprintf(copy->name, sizeof copy->name, "%s", use->prefix ? use->prefix : "");
    return 0;
}

static int refuse_file(void *ctx, const char *name, char **ret_text, struct orl_error *err)
{
    (void)ctx;
    (void)ret_text;
    return orl_error_set(err, ORL_ERR_UNSUPPORTED, "'%.60s': files cannot be included here", name);
}

/* Makes the frame's current copy the active transform. */
static int use_copy(struct orl_mgf_reader *r, const struct orl_mgf_frame *frame)
{
    const struct orl_mgf_copy *copy = &frame->copies[frame->copy];
    pop_objects(r, frame->n_objects);
    r->xform = copy->xform;
    return copy->name[0] ? push_object(r, copy->name) : 0;
}

/* Starts a transform given by words; start: scanner behind its line, for repeating its content. */
static int begin_xform(struct orl_mgf_reader *r, const char *const *words, size_t n,
                       const struct orl_scanner *start)
{
    struct orl_mgf_frame *frame = &r->frames[r->n_frames];
    struct orl_error why = {0};
    int code;
    if (r->n_frames == ORL_MGF_DEPTH)
        return orl_mgf_fail(r, ORL_ERR_LIMIT, "transforms are nested deeper than %d",
                            ORL_MGF_DEPTH);
    *frame = (struct orl_mgf_frame){.most = ORL_LIMIT_XFORM_ARRAY,
                                    .outer = r->xform,
                                    .start = *start,
                                    .n_objects = r->n_objects};
    for (size_t i = 0; i < r->n_frames; i++)
        frame->most -= r->frames[i].n_copies < frame->most ? r->frames[i].n_copies : frame->most;
    r->n_frames++;
    code = orl_xform_expand(words, n, refuse_file, add_copy, frame, &why);
    if (code < 0)
        return orl_mgf_fail(r, code, "%s", why.message);
    if (frame->n_copies == 0)
        return orl_mgf_fail(r, ORL_ERR_SYNTAX, "its count of copies is 0");
    return use_copy(r, frame);
}

/* Rewinds to the transform's start for the next copy, or ends it. */
static int end_xform(struct orl_mgf_reader *r, bool *ret_ended)
{
    struct orl_mgf_frame *frame = &r->frames[r->n_frames - 1];
    *ret_ended = ++frame->copy == frame->n_copies;
    if (!*ret_ended) {
        r->scanner = frame->start;
        return use_copy(r, frame);
    }
    pop_objects(r, frame->n_objects);
    r->xform = frame->outer;
    free(frame->copies);
    r->n_frames--;
    return 0;
}

static int read_xform(struct orl_mgf_reader *r)
{
    bool ended;
    if (r->n_words > 1)
        return begin_xform(r, r->words + 1, r->n_words - 1, &r->scanner);
    if (r->n_frames == r->texts[r->n_texts - 1].n_frames)
        return orl_mgf_fail(r, ORL_ERR_SYNTAX, "no transform is open");
    return end_xform(r, &ended);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static int refuse_entity(struct orl_mgf_reader *r)
{
    const int code =
        orl_mgf_fail(r, ORL_ERR_UNSUPPORTED, "'%s' is not supported here", r->words[0]);
    orl_error_hint(r->err, "convert the geometry with mgf2rad beforehand, and include its output");
    return code;
}

static int open_text(struct orl_mgf_reader *r, struct orl_mgf_text *ret_text)
{
    const struct orl_mgf *const mgf = r->mgf;
    if (r->n_texts == ORL_LIMIT_INCLUDE_DEPTH)
        return orl_mgf_fail(r, ORL_ERR_LIMIT, "files include each other more than %u deep",
                            ORL_LIMIT_INCLUDE_DEPTH);
    const int code =
        mgf->open(mgf->ctx, r->texts[r->n_texts - 1].text.folder, r->words[1], ret_text, r->err);
    if (code < 0) {
        orl_error_at(r->err, r->texts[r->n_texts - 1].text.file, r->line, "MGF's i");
        return code;
    }
    for (size_t i = 0; i < r->n_texts; i++)
        if (strcmp(r->texts[i].text.file, ret_text->file) == 0)
            return orl_mgf_fail(r, ORL_ERR_LIMIT, "'%.200s' includes itself", ret_text->file);
    return 0;
}

static int begin_text(const struct orl_mgf_reader *r, const struct orl_mgf_text *text,
                      struct orl_scanner *ret_scanner)
{
    const int code = orl_scanner_init(ret_scanner, text->file, text->data, text->size,
                                      ORL_SCANNER_CONTINUATIONS, r->err);
    ret_scanner->line = text->line;
    return code;
}

/* Handles "i file [transform]". */
static int include_file(struct orl_mgf_reader *r)
{
    struct orl_mgf_open_text current = {.has_transform = r->n_words > 2, .resume = r->scanner};
    struct orl_scanner scanner;
    if (!r->mgf->open)
        return refuse_entity(r);
    int code = r->n_words > 1 ? open_text(r, &current.text) : orl_mgf_expect_words(r, 1, 1);
    if (code == 0)
        code = begin_text(r, &current.text, &scanner);
    if (code == 0 && current.has_transform)
        code = begin_xform(r, r->words + 2, r->n_words - 2, &scanner);
    if (code < 0)
        return code;
    current.n_frames = r->n_frames;
    r->texts[r->n_texts++] = current;
    r->scanner = scanner;
    return 0;
}

/* At the end of a text: repeats it, or returns to the including one, if any. */
static int leave_text(struct orl_mgf_reader *r, bool *ret_ended)
{
    const struct orl_mgf_open_text *const current = &r->texts[r->n_texts - 1];
    bool ended = true;
    r->n_words = 0;
    r->n_read += LEAVE_COST;
    if (r->n_frames > current->n_frames)
        return orl_mgf_fail(r, ORL_ERR_SYNTAX, "%zu transforms (xf) are not closed",
                            r->n_frames - current->n_frames);
    const int code = current->has_transform ? end_xform(r, &ended) : 0;
    *ret_ended = r->n_texts == 1;
    if (code < 0 || *ret_ended || !ended)
        return code;
    r->scanner = current->resume;
    r->n_texts--;
    return 0;
}

/* ---- Entities -------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    int (*read)(struct orl_mgf_reader *reader);
} entities[] = {
    {"c", read_color_name},    {"cct", orl_mgf_cct},
    {"cmix", orl_mgf_cmix},    {"cone", orl_mgf_cone},
    {"cspec", orl_mgf_cspec},  {"cxy", orl_mgf_cxy},
    {"cyl", orl_mgf_cylinder}, {"ed", read_part},
    {"f", orl_mgf_face},       {"fh", orl_mgf_face_with_holes},
    {"i", include_file},       {"ies", refuse_entity},
    {"ir", read_index},        {"m", read_material_name},
    {"n", read_normal},        {"o", read_object},
    {"p", read_point},         {"prism", orl_mgf_prism},
    {"rd", read_part},         {"ring", orl_mgf_ring},
    {"rs", read_part},         {"sides", read_sides},
    {"sph", orl_mgf_sphere},   {"td", read_part},
    {"torus", orl_mgf_torus},  {"ts", read_part},
    {"v", read_vertex_name},   {"xf", read_xform},
};

static int read_entity(struct orl_mgf_reader *r)
{
    for (size_t i = 0; i < sizeof entities / sizeof *entities; i++)
        if (strcmp(entities[i].name, r->words[0]) == 0)
            return entities[i].read(r);
    r->n_unknown++;
    return 0;
}

/* Appends a word to the buffer, NUL-terminated. Names that are invalid in scene text are
 * refused. */
static int add_word(struct orl_mgf_reader *r, struct orl_slice word, size_t *used)
{
    char *const copy = r->buffer + *used;
    if (*used + word.length + 2 > WORDS_BYTES || r->n_words == ORL_MGF_WORDS)
        return orl_mgf_fail(r, ORL_ERR_LIMIT, "the line is too long");
    for (size_t i = 0; i < word.length; i++) {
        if (word.text[i] == '\'' || word.text[i] == '\0')
            return orl_mgf_fail(r, ORL_ERR_SYNTAX,
                                "a name contains a character that is not allowed");
        copy[i] = word.text[i];
    }
    copy[word.length] = '\0';
    r->words[r->n_words++] = copy;
    *used += word.length + 1;
    return 0;
}

/* Splits the current entity, with lines continued by a backslash, into words; comments and blank
 * lines have none. */
static int read_words(struct orl_mgf_reader *r)
{
    const char *const start = r->scanner.at;
    struct orl_slice word;
    size_t used = 0;
    bool remark = false;
    int code = 0;
    r->n_words = 0;
    r->line = r->scanner.line;
    while (code == 0 && orl_scanner_word_of_line(&r->scanner, &word)) {
        r->line = r->scanner.line;
        remark = remark || (r->n_words == 0 && word.text[0] == '#');
        code = remark ? 0 : add_word(r, word, &used);
    }
    r->n_read += (size_t)(r->scanner.at - start) + 1;
    return code;
}

static int read_all(struct orl_mgf_reader *r)
{
    bool ended = false;
    int code = 0;
    while (code == 0 && !ended) {
        code = orl_scanner_next_line(&r->scanner) ? read_words(r) : leave_text(r, &ended);
        if (code == 0 && (r->n_read > ORL_LIMIT_SCENE_TEXT || r->text->size > ORL_LIMIT_FILE_BYTES))
            code = orl_mgf_fail(r, ORL_ERR_LIMIT, "the geometry, with its repeats, is too large");
        if (code == 0 && r->n_words > 0)
            code = read_entity(r);
    }
    return code;
}

static void warn_of_content(const struct orl_mgf_reader *r)
{
    if (r->smooth)
        orl_text_warn(r->text,
                      "the geometry's vertex normals are ignored: its faces are shaded flat");
    if (r->n_cut > 0)
        orl_text_warn(r->text,
                      "%zu colours of the geometry's materials are brighter than a surface of that "
                      "colour can be: channels above 1 are clamped to 1",
                      r->n_cut);
    if (r->n_unknown > 0)
        orl_text_warn(r->text, "%zu of the geometry's entities are unknown in MGF and ignored",
                      r->n_unknown);
}

int orl_mgf_write(const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err)
{
    struct orl_mgf_reader *r = calloc(1, sizeof *r);
    char *buffer = malloc(WORDS_BYTES);
    struct orl_error own = {0};
    int code = ORL_ERR_NOMEM;
    if (r && buffer) {
        *r = (struct orl_mgf_reader){.mgf = mgf,
                                     .text = text,
                                     .err = err ? err : &own,
                                     .texts[0].text = mgf->text,
                                     .n_texts = 1,
                                     .buffer = buffer,
                                     .xform = orl_xform_identity};
        for (int i = 0; i < 3; i++)
            r->xform.row[i] = orl_scale(r->xform.row[i], mgf->unit_m);
        r->xform.scale = mgf->unit_m;
        orl_mgf_context_init(r);
        code = begin_text(r, &mgf->text, &r->scanner);
        if (code == 0)
            code = read_all(r);
        if (code == 0)
            warn_of_content(r);
        for (size_t i = 0; i < r->n_frames; i++)
            free(r->frames[i].copies);
        pop_objects(r, 0);
        orl_mgf_context_done(r);
    } else {
        orl_error_set(err, code, "out of memory");
    }
    free(buffer);
    free(r);
    return code;
}
