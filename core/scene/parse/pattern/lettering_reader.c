#include "scene/parse/pattern/pattern_readers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "scene/material/patterns/pattern.h"
#include "scene/parse/material/material_readers.h"

enum { CODES = 256, MOST_CORNERS = 32000, MOST_TEXT = 1 << 14, INDENT = 3 };

struct font {
    const struct orl_glyph *glyphs[CODES];
    int width; /* mean width of letters */
};

/* ---- Fonts ----------------------------------------------------------------------------------- */

/* Reads the next integer from 0 to most; returns -1 at the end, -2 if it is something else. */
static int next_number(struct orl_scanner *numbers, int most)
{
    struct orl_slice word;
    int value = 0;
    if (!orl_scanner_word(numbers, &word))
        return -1;
    for (size_t i = 0; i < word.length && value <= most; i++) {
        if (word.text[i] < '0' || word.text[i] > '9')
            return -2;
        value = 10 * value + (word.text[i] - '0');
    }
    return value > most ? -2 : value;
}

static bool read_corners(struct orl_scanner *numbers, struct orl_glyph *glyph,
                         unsigned char *corners)
{
    for (int i = 0; i < 2 * glyph->n; i++) {
        const int value = next_number(numbers, ORL_GLYPH_SIDE);
        int *const low = i & 1 ? &glyph->bottom : &glyph->left;
        int *const high = i & 1 ? &glyph->top : &glyph->right;
        if (value < 0)
            return false;
        corners[i] = (unsigned char)value;
        *low = value < *low ? value : *low;
        *high = value > *high ? value : *high;
    }
    return true;
}

/* Reads one letter; false if it is not valid. */
static bool read_glyph(struct orl_scanner *numbers, struct orl_arena *arena, int code,
                       struct font *font, bool *ret_memory)
{
    const int n = next_number(numbers, MOST_CORNERS), middle = (ORL_GLYPH_SIDE + 1) / 2;
    *ret_memory = true;
    if (code < 1 || n < 0 || font->glyphs[code])
        return false;
    struct orl_glyph *const glyph = orl_arena_alloc(arena, sizeof *glyph);
    unsigned char *const corners = orl_arena_alloc(arena, 2 * (size_t)n + 1);
    *ret_memory = glyph && corners;
    if (!*ret_memory)
        return false;
    *glyph = (struct orl_glyph){corners, n, middle, middle, middle, middle};
    font->glyphs[code] = glyph;
    return read_corners(numbers, glyph, corners);
}

static int read_font(struct orl_parser *parser, const struct orl_source *source, struct font *font,
                     struct orl_error *err)
{
    struct orl_scanner numbers;
    int code = orl_scanner_init(&numbers, source->name, source->file.data, source->file.size,
                                ORL_SCANNER_COMMENTS | ORL_SCANNER_COMMENTS_IN_WORDS, err);
    if (code < 0)
        return code;
    int letters = 0, width = 0;
    while ((code = next_number(&numbers, CODES - 1)) != -1) {
        bool memory;
        if (!read_glyph(&numbers, parser->out->arena, code, font, &memory)) {
            const int error = memory ? ORL_ERR_SYNTAX : ORL_ERR_NOMEM;
            orl_error_set(err, error,
                          memory ? "not a letter: a font file has, per letter, a unique code from "
                                   "1 to 255, a count of corners, and coordinates from 0 to 255"
                                 : "out of memory for a font");
            orl_error_at(err, source->name, numbers.line, NULL);
            return error;
        }
        const struct orl_glyph *const g = font->glyphs[code];
        if (g->right > g->left && g->top > g->bottom) {
            letters++;
            width += g->right - g->left;
        }
    }
    font->width = letters > 0 ? width / letters : 0;
    return 0;
}

/* ---- Lines ----------------------------------------------------------------------------------- */

/* A line being set: steps[i] is the distance from letter i - 1 to letter i. */
struct setting {
    const struct font *font;
    const char *text;
    size_t n;
    int *steps; /* n + 1 */
};

static const struct orl_glyph *glyph_of(const struct setting *s, size_t i)
{
    return s->font->glyphs[(unsigned char)s->text[i]];
}

static bool is_space(const struct setting *s, size_t i)
{
    const struct orl_glyph *const glyph = glyph_of(s, i);
    return glyph && glyph->n == 0;
}

static int set_evenly(const struct setting *s)
{
    int width = 0;
    s->steps[0] = 0;
    for (size_t i = 0; i < s->n; i++) {
        s->steps[i + 1] = glyph_of(s, i) ? ORL_GLYPH_SIDE : 0;
        width += s->steps[i + 1];
    }
    return width;
}

/* Sets letters edge to edge, `gap` apart. Characters that the font lacks take no room. */
static int set_closely(const struct setting *s, int gap)
{
    int pen = gap / 2, before = 0;
    for (size_t i = 0; i < s->n; i++) {
        const struct orl_glyph *const glyph = glyph_of(s, i);
        const int at = !glyph ? before : glyph->n > 0 ? pen + gap / 2 - glyph->left : pen;
        s->steps[i] = at - before;
        before = at;
        if (glyph)
            pen = glyph->n > 0 ? at + glyph->right + gap / 2 : at + s->font->width;
    }
    s->steps[s->n] = pen - before + gap / 2;
    return pen + gap / 2;
}

/* Returns the end of the text that begins at letter i: behind more than INDENT spaces, or at the
 * line's end. */
static size_t end_of_part(const struct setting *s, size_t i, int *ret_letters)
{
    *ret_letters = 0;
    while (i < s->n) {
        size_t next = i + 1;
        while (glyph_of(s, i) && next < s->n && is_space(s, next))
            next++;
        if (glyph_of(s, i))
            *ret_letters += (int)(next - i);
        const bool indented = next - i > INDENT;
        i = next;
        if (indented)
            break;
    }
    return i;
}

/* Sets letters closely, then stretches each text between indentations to one mean width per letter.
 * */
static int set_in_steps(const struct setting *s, int gap)
{
    set_closely(s, gap);
    int width = s->steps[0];
    for (size_t first = 0; first < s->n;) {
        int letters, own = 0;
        const size_t end = end_of_part(s, first, &letters);
        const int wanted = letters * (s->font->width + gap);
        for (size_t i = first + 1; i <= end; i++)
            own += s->steps[i];
        int left = wanted - own;
        for (size_t i = first + 1; i <= end; i++) {
            const int share = left / (int)(end + 1 - i);
            s->steps[i] += share;
            left -= share;
        }
        width += wanted;
        first = end;
    }
    return width;
}

static int make_line(struct orl_parser *parser, struct setting *s, double spacing,
                     struct orl_lettering_line *line)
{
    const int gap = (int)(fabs(spacing) * ORL_GLYPH_SIDE);
    struct orl_placed_letter *const letters =
        orl_arena_alloc(parser->out->arena, (s->n + 1) * sizeof *letters);
    s->steps = calloc(s->n + 1, sizeof *s->steps);
    int at = 0;
    if (!letters || !s->steps) {
        free(s->steps);
        return ORL_ERR_NOMEM;
    }
    *line = (struct orl_lettering_line){.letters = letters};
    line->width = gap == 0      ? set_evenly(s)
                  : spacing < 0 ? set_closely(s, gap)
                                : set_in_steps(s, gap);
    for (size_t i = 0; i < s->n; i++) {
        at += s->steps[i];
        if (glyph_of(s, i) && glyph_of(s, i)->n > 0)
            letters[line->n++] = (struct orl_placed_letter){glyph_of(s, i), at};
    }
    free(s->steps);
    return 0;
}

/* ---- Texts ----------------------------------------------------------------------------------- */

static size_t count_lines(const char *text, size_t size)
{
    size_t n = size > 0 && text[size - 1] != '\n';
    for (size_t i = 0; i < size; i++)
        n += text[i] == '\n';
    return n;
}

static int set_lines(struct orl_parser *parser, const struct font *font, const char *text,
                     size_t size, double spacing, struct orl_lettering *ret)
{
    const size_t n = count_lines(text, size);
    struct orl_lettering_line *const lines =
        orl_arena_alloc(parser->out->arena, (n + 1) * sizeof *lines);
    int code = lines ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < n && code == 0; i++) {
        const char *const end = memchr(text, '\n', size);
        struct setting s = {font, text, end ? (size_t)(end - text) : size, NULL};
        code = make_line(parser, &s, spacing, &lines[i]);
        text += s.n + (end != NULL);
        size -= s.n + (end != NULL);
    }
    ret->lines = lines;
    ret->n_lines = n;
    return code;
}

/* Joins the primitive's words to one line; the caller frees it. */
static char *join_words(const struct orl_primitive *primitive, size_t first, size_t *ret_size)
{
    char *const line = malloc(MOST_TEXT);
    *ret_size = 0;
    for (size_t i = first; line && i < primitive->n_strings; i++) {
        const char *const word = orl_primitive_string(primitive, i);
        const size_t length = strlen(word);
        if (*ret_size + length + 1 >= MOST_TEXT)
            break;
        if (i > first)
            line[(*ret_size)++] = ' ';
        *ret_size = (size_t)(stpcpy(line + *ret_size, word) - line);
    }
    return line;
}

static int find_file(struct orl_parser *parser, const struct orl_scope *scope, size_t string,
                     const struct orl_source **ret_source, struct orl_error *err)
{
    const char *const name = orl_primitive_string(&parser->primitive, string);
    struct orl_error missing = {0};
    size_t index = 0;
    const int code = orl_sources_find(&parser->sources, scope->folder, name, &index, &missing);
    if (code == 0) {
        *ret_source = parser->sources.items + index;
        return orl_parser_count_text(parser, scope, (*ret_source)->file.size, err);
    }
    orl_parser_fail(parser, scope, err, code, "%.400s", missing.message);
    if (code == ORL_ERR_NOT_FOUND && !orl_files_hint_case(parser->sources.files, name, err))
        orl_error_hint(err,
                       "fonts and texts are files: put a copy beside the scene, or into a folder "
                       "of RAYPATH");
    return code;
}

static int set_text(struct orl_parser *parser, const struct orl_scope *scope,
                    const struct font *font, size_t first, double spacing,
                    struct orl_lettering *text, struct orl_error *err)
{
    const bool words = parser->primitive.n_strings > first + 2;
    const struct orl_source *source = NULL;
    char *joined = NULL;
    size_t size = 0;
    int code = words ? 0 : find_file(parser, scope, first + 1, &source, err);
    if (code < 0)
        return code;
    if (words)
        joined = join_words(&parser->primitive, first + 2, &size);
    else if (source)
        size = source->file.size;
    if (words ? !joined : !source)
        return ORL_ERR_NOMEM;
    if (!words && size >= MOST_TEXT)
        return orl_parser_fail(parser, scope, err, ORL_ERR_LIMIT,
                               "its text has %zu bytes, more "
                               "than %d",
                               size, MOST_TEXT);
    code = set_lines(parser, font, words ? joined : source->file.data, size, spacing, text);
    free(joined);
    return code;
}

/* Computes the vectors whose dot products with a place are its coordinates along right and down. */
static int place_text(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_lettering *text, struct orl_error *err)
{
    const double *const r = parser->primitive.reals;
    const struct orl_vec3 right = orl_xform_vector(&scope->xform, orl_v3(r[3], r[4], r[5]));
    const struct orl_vec3 down = orl_xform_vector(&scope->xform, orl_v3(r[6], r[7], r[8]));
    const double rr = orl_dot(right, right), dd = orl_dot(down, down), rd = orl_dot(right, down);
    const double area2 = rr * dd - rd * rd;
    text->origin = orl_xform_point(&scope->xform, orl_v3(r[0], r[1], r[2]));
    if (!(area2 > 1e-12 * rr * dd) || !isfinite(area2))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its right and down vectors do not span a plane");
    text->right = orl_scale(orl_madd(orl_scale(right, dd), down, -rd), 1 / area2);
    text->down = orl_scale(orl_madd(orl_scale(down, rr), right, -rd), 1 / area2);
    return 0;
}

int orl_lettering_read(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, size_t first, struct orl_error *err)
{
    const struct orl_primitive *const p = &parser->primitive;
    const size_t colors = first > 0 ? 0 : pattern->is_rgb ? 6 : 2, n = 9 + colors;
    const double spacing = p->n_reals > n ? p->reals[n] : 0;
    struct orl_lettering *const text = orl_arena_alloc(parser->out->arena, sizeof *text);
    const struct orl_source *source = NULL;
    struct font font = {.glyphs = {NULL}};
    if (!text)
        return ORL_ERR_NOMEM;
    *text = (struct orl_lettering){.unit = ORL_GLYPH_SIDE};
    if (p->n_strings < first + 2 || p->n_reals < n || !(fabs(spacing) <= 100))
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "%s takes a font file, a text file or '.' and words, and %zu "
                               "numbers, optionally followed by the spacing",
                               p->type, n);
    int code = find_file(parser, scope, first, &source, err);
    if (code == 0)
        code = read_font(parser, source, &font, err);
    if (code == 0)
        code = place_text(parser, scope, text, err);
    if (code == 0)
        code = set_text(parser, scope, &font, first, spacing, text, err);
    if (code < 0)
        return code;
    if (spacing != 0)
        text->unit = font.width + ORL_GLYPH_SIDE * fabs(spacing);
    struct orl_rgb inside = orl_gray(colors > 0 ? p->reals[9] : 1);
    struct orl_rgb around = orl_gray(colors > 0 ? p->reals[10] : 0);
    if (colors == 6) {
        inside = orl_material_rgb(parser, 9);
        around = orl_material_rgb(parser, 12);
    }
    pattern->source = ORL_PATTERN_TEXT;
    pattern->as_source.text = (struct orl_pattern_text){text, inside, around};
    return 0;
}
