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

static struct orl_vec3 read_vector(struct orl_mgf_reader *r)
{
    const double x = orl_mgf_number(r, 1), y = orl_mgf_number(r, 2);
    return orl_v3(x, y, orl_mgf_number(r, 3));
}

static void read_point(struct orl_mgf_reader *r)
{
    r->current[ORL_MGF_VERTEX]->is.vertex.point = read_vector(r);
}

static void read_normal(struct orl_mgf_reader *r)
{
    r->current[ORL_MGF_VERTEX]->is.vertex.normal = read_vector(r);
}

static struct orl_mgf_material *changed_material(struct orl_mgf_reader *r)
{
    r->current[ORL_MGF_MATERIAL]->is.material.written = false;
    return &r->current[ORL_MGF_MATERIAL]->is.material;
}

static void read_part(struct orl_mgf_reader *r)
{
    struct orl_mgf_material *const m = changed_material(r);
    const bool specular = r->words[0][1] == 's', lamp = r->words[0][0] == 'e';
    struct orl_mgf_component part = {.value = orl_mgf_number(r, 1),
                                     .color = r->current[ORL_MGF_COLOR]->is.color};
    if (specular)
        part.roughness = orl_mgf_number(r, 2);
    if (!(part.value >= 0) || (!lamp && part.value > 1) || !(part.roughness >= 0))
        orl_mgf_fail(r, ORL_ERR_RANGE, "%s %s is out of range", r->words[0], r->words[1]);
    *(lamp                    ? &m->ed
      : r->words[0][0] == 'r' ? (specular ? &m->rs : &m->rd)
                              : (specular ? &m->ts : &m->td)) = part;
}

/* The imaginary part must be a number, but is not used. */
static void read_index(struct orl_mgf_reader *r)
{
    changed_material(r)->index = orl_mgf_number(r, 1);
    orl_mgf_number(r, 2);
}

static void read_sides(struct orl_mgf_reader *r)
{
    if (strcmp(r->words[1], "1") != 0 && strcmp(r->words[1], "2") != 0)
        orl_mgf_fail(r, ORL_ERR_RANGE, "the number of sides must be 1 or 2");
    changed_material(r)->one_sided = r->words[1][0] == '1';
}

static void read_color_name(struct orl_mgf_reader *r)
{
    orl_mgf_context(r, ORL_MGF_COLOR);
}

static void read_material_name(struct orl_mgf_reader *r)
{
    orl_mgf_context(r, ORL_MGF_MATERIAL);
}

static void read_vertex_name(struct orl_mgf_reader *r)
{
    orl_mgf_context(r, ORL_MGF_VERTEX);
}

/* ---- Objects and transforms ------------------------------------------------------------------ */

static void push_object(struct orl_mgf_reader *r, const char *name)
{
    char *const copy = strdup(name);
    if (!copy)
        orl_mgf_fail(r, ORL_ERR_NOMEM, "out of memory");
    else if (r->n_objects == ORL_MGF_DEPTH)
        orl_mgf_fail(r, ORL_ERR_LIMIT, "objects are nested deeper than %d", ORL_MGF_DEPTH);
    if (r->code)
        free(copy);
    else
        r->objects[r->n_objects++] = copy;
}

static void pop_objects(struct orl_mgf_reader *r, size_t left)
{
    while (r->n_objects > left)
        free(r->objects[--r->n_objects]);
}

static void read_object(struct orl_mgf_reader *r)
{
    if (r->n_words > 1)
        push_object(r, r->words[1]);
    else if (r->n_objects == 0)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "no object is open");
    else
        pop_objects(r, r->n_objects - 1);
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
static void use_copy(struct orl_mgf_reader *r, const struct orl_mgf_frame *frame)
{
    const struct orl_mgf_copy *copy = &frame->copies[frame->copy];
    pop_objects(r, frame->n_objects);
    r->xform = copy->xform;
    if (copy->name[0])
        push_object(r, copy->name);
}

/* Starts a transform given by the words from that one on; start: scanner behind its line, for
 * repeating its content. */
static void begin_xform(struct orl_mgf_reader *r, size_t word, const struct orl_scanner *start)
{
    struct orl_mgf_frame *frame = &r->frames[r->n_frames];
    struct orl_error why = {0};
    if (r->n_frames == ORL_MGF_DEPTH) {
        orl_mgf_fail(r, ORL_ERR_LIMIT, "transforms are nested deeper than %d", ORL_MGF_DEPTH);
        return;
    }
    *frame = (struct orl_mgf_frame){.most = ORL_LIMIT_XFORM_ARRAY,
                                    .outer = r->xform,
                                    .start = *start,
                                    .n_objects = r->n_objects};
    for (size_t i = 0; i < r->n_frames; i++)
        frame->most -= r->frames[i].n_copies < frame->most ? r->frames[i].n_copies : frame->most;
    r->n_frames++;
    const int code =
        orl_xform_expand(r->words + word, r->n_words - word, refuse_file, add_copy, frame, &why);
    if (code < 0)
        orl_mgf_fail(r, code, "%s", why.message);
    else if (frame->n_copies == 0)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "its count of copies is 0");
    else
        use_copy(r, frame);
}

/* Rewinds to the transform's start for the next copy, or ends it. Returns true if it ended. */
static bool end_xform(struct orl_mgf_reader *r)
{
    struct orl_mgf_frame *frame = &r->frames[r->n_frames - 1];
    if (++frame->copy < frame->n_copies) {
        r->scanner = frame->start;
        use_copy(r, frame);
        return false;
    }
    pop_objects(r, frame->n_objects);
    r->xform = frame->outer;
    free(frame->copies);
    r->n_frames--;
    return true;
}

static void read_xform(struct orl_mgf_reader *r)
{
    if (r->n_words > 1)
        begin_xform(r, 1, &r->scanner);
    else if (r->n_frames == r->texts[r->n_texts - 1].n_frames)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "no transform is open");
    else
        end_xform(r);
}

/* ---- Files ----------------------------------------------------------------------------------- */

static void refuse_entity(struct orl_mgf_reader *r)
{
    orl_mgf_fail(r, ORL_ERR_UNSUPPORTED, "'%s' is not supported here", r->words[0]);
    orl_error_hint(r->err, "convert the geometry with mgf2rad beforehand, and include its output");
}

static void open_text(struct orl_mgf_reader *r, struct orl_mgf_text *ret_text)
{
    const struct orl_mgf *const mgf = r->mgf;
    const struct orl_mgf_text *const from = &r->texts[r->n_texts - 1].text;
    if (r->n_texts == ORL_LIMIT_INCLUDE_DEPTH) {
        orl_mgf_fail(r, ORL_ERR_LIMIT, "files include each other more than %u deep",
                     ORL_LIMIT_INCLUDE_DEPTH);
        return;
    }
    r->code = mgf->open(mgf->ctx, from->folder, r->words[1], ret_text, r->err);
    if (r->code)
        orl_error_at(r->err, from->file, r->line, "MGF's i");
    for (size_t i = 0; i < r->n_texts && !r->code; i++)
        if (strcmp(r->texts[i].text.file, ret_text->file) == 0)
            orl_mgf_fail(r, ORL_ERR_LIMIT, "'%.200s' includes itself", ret_text->file);
}

static void begin_text(struct orl_mgf_reader *r, const struct orl_mgf_text *text,
                       struct orl_scanner *ret_scanner)
{
    r->code = orl_scanner_init(ret_scanner, text->file, text->data, text->size,
                               ORL_SCANNER_CONTINUATIONS, r->err);
    ret_scanner->line = text->line;
}

/* Handles "i file [transform]". */
static void include_file(struct orl_mgf_reader *r)
{
    struct orl_mgf_open_text current = {.has_transform = r->n_words > 2, .resume = r->scanner};
    struct orl_scanner scanner;
    if (!r->mgf->open)
        refuse_entity(r);
    else if (r->n_words > 1)
        open_text(r, &current.text);
    else
        orl_mgf_expect_words(r, 1, 1);
    if (!r->code)
        begin_text(r, &current.text, &scanner);
    if (!r->code && current.has_transform)
        begin_xform(r, 2, &scanner);
    if (r->code)
        return;
    current.n_frames = r->n_frames;
    r->texts[r->n_texts++] = current;
    r->scanner = scanner;
}

/* At the end of a text: repeats it, or returns to the including one. Returns true if there is
 * none. */
static bool leave_text(struct orl_mgf_reader *r)
{
    const struct orl_mgf_open_text *const current = &r->texts[r->n_texts - 1];
    r->n_words = 0;
    r->n_read += LEAVE_COST;
    if (r->n_frames > current->n_frames) {
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "%zu transforms (xf) are not closed",
                     r->n_frames - current->n_frames);
    } else if (r->n_texts == 1) {
        return true;
    } else if (!current->has_transform || end_xform(r)) {
        r->scanner = current->resume;
        r->n_texts--;
    }
    return false;
}

/* ---- Entities -------------------------------------------------------------------------------- */

enum { ANY = ORL_MGF_WORDS };

static const struct {
    const char *name;
    size_t least, most; /* words behind the name */
    void (*read)(struct orl_mgf_reader *reader);
} entities[] = {
    {"c", 0, 3, read_color_name},     {"cct", 1, 1, orl_mgf_cct},
    {"cmix", 4, ANY, orl_mgf_cmix},   {"cone", 4, 4, orl_mgf_cone},
    {"cspec", 4, ANY, orl_mgf_cspec}, {"cxy", 2, 2, orl_mgf_cxy},
    {"cyl", 3, 3, orl_mgf_cylinder},  {"ed", 1, 1, read_part},
    {"f", 3, ANY, orl_mgf_face},      {"fh", 3, ANY / 2, orl_mgf_face_with_holes},
    {"i", 0, ANY, include_file},      {"ies", 0, ANY, refuse_entity},
    {"ir", 2, 2, read_index},         {"m", 0, 3, read_material_name},
    {"n", 3, 3, read_normal},         {"o", 0, 1, read_object},
    {"p", 3, 3, read_point},          {"prism", 4, ANY, orl_mgf_prism},
    {"rd", 1, 1, read_part},          {"ring", 3, 3, orl_mgf_ring},
    {"rs", 2, 2, read_part},          {"sides", 1, 1, read_sides},
    {"sph", 2, 2, orl_mgf_sphere},    {"td", 1, 1, read_part},
    {"torus", 3, 3, orl_mgf_torus},   {"ts", 2, 2, read_part},
    {"v", 0, 3, read_vertex_name},    {"xf", 0, ANY, read_xform},
};

static void read_entity(struct orl_mgf_reader *r)
{
    size_t i = 0;
    while (i < sizeof entities / sizeof *entities && strcmp(entities[i].name, r->words[0]) != 0)
        i++;
    if (i == sizeof entities / sizeof *entities) {
        r->n_unknown++;
        return;
    }
    orl_mgf_expect_words(r, entities[i].least, entities[i].most);
    if (!r->code)
        entities[i].read(r);
}

/* Appends a word to the buffer, NUL-terminated. Names that are invalid in scene text are
 * refused. */
static void add_word(struct orl_mgf_reader *r, struct orl_slice word, size_t *used)
{
    char *const copy = r->buffer + *used;
    if (*used + word.length + 2 > WORDS_BYTES || r->n_words == ORL_MGF_WORDS) {
        orl_mgf_fail(r, ORL_ERR_LIMIT, "the line is too long");
        return;
    }
    for (size_t i = 0; i < word.length; i++) {
        if (word.text[i] == '\'' || word.text[i] == '\0')
            orl_mgf_fail(r, ORL_ERR_SYNTAX, "a name contains a character that is not allowed");
        copy[i] = word.text[i];
    }
    copy[word.length] = '\0';
    r->words[r->n_words++] = copy;
    *used += word.length + 1;
}

/* Splits the current entity, with lines continued by a backslash, into words; comments and blank
 * lines have none. */
static void read_words(struct orl_mgf_reader *r)
{
    const char *const start = r->scanner.at;
    struct orl_slice word;
    size_t used = 0;
    bool remark = false;
    r->n_words = 0;
    r->line = r->scanner.line;
    while (!r->code && orl_scanner_word_of_line(&r->scanner, &word)) {
        r->line = r->scanner.line;
        remark = remark || (r->n_words == 0 && word.text[0] == '#');
        if (!remark)
            add_word(r, word, &used);
    }
    r->n_read += (size_t)(r->scanner.at - start) + 1;
}

static void read_all(struct orl_mgf_reader *r)
{
    bool ended = false;
    while (!r->code && !ended) {
        if (orl_scanner_next_line(&r->scanner))
            read_words(r);
        else
            ended = leave_text(r);
        if (r->n_read > ORL_LIMIT_SCENE_TEXT || r->text->size > ORL_LIMIT_FILE_BYTES)
            orl_mgf_fail(r, ORL_ERR_LIMIT, "the geometry, with its repeats, is too large");
        if (!r->code && r->n_words > 0)
            read_entity(r);
    }
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
    int code = ORL_ERR_NOMEM;
    if (r && buffer) {
        *r = (struct orl_mgf_reader){.mgf = mgf,
                                     .text = text,
                                     .err = err,
                                     .texts[0].text = mgf->text,
                                     .n_texts = 1,
                                     .buffer = buffer,
                                     .xform = orl_xform_identity};
        for (int i = 0; i < 3; i++)
            r->xform.row[i] = orl_scale(r->xform.row[i], mgf->unit_m);
        r->xform.scale = mgf->unit_m;
        orl_mgf_context_init(r);
        begin_text(r, &mgf->text, &r->scanner);
        read_all(r);
        code = r->code;
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
