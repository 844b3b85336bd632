#include "scene/parse/instance/binary_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "scene/generate/generate.h"

/* Radiance's limits. */
enum { STRING_BYTES = 512, TYPES_MAX = 128 };

int orl_binary_fail(const struct orl_binary_reader *reader, const char *what, struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_SYNTAX, "%s",
                         reader->ended ? "the compiled file ends too early" : what);
}

/* ---- Header ---------------------------------------------------------------------------------- */

static bool says_format(const char *header, size_t size, const char *format)
{
    static const char key[] = "FORMAT=";
    const size_t n_key = sizeof key - 1, n_format = strlen(format);
    for (const char *line = header, *end = header + size; line && line < end;) {
        const size_t left = (size_t)(end - line);
        if (left > n_key + n_format && memcmp(line, key, n_key) == 0)
            return memcmp(line + n_key, format, n_format) == 0 && line[n_key + n_format] == '\n';
        line = memchr(line, '\n', left);
        line += line != NULL;
    }
    return false;
}

int orl_binary_open(const char *data, size_t size, const char *format,
                    struct orl_binary_reader *ret, struct orl_error *err)
{
    enum { HEADER_MAX = 1 << 16 };
    const size_t most = size < HEADER_MAX ? size : HEADER_MAX;
    const char *end = most > 2 ? memmem(data, most, "\n\n", 2) : NULL;
    if (!end || memcmp(data, "#?", 2) != 0 || !says_format(data, (size_t)(end - data) + 1, format))
        return orl_error_set(err, ORL_ERR_SYNTAX, "its format is not %s", format);
    *ret = (struct orl_binary_reader){
        .data = (const unsigned char *)data, .size = size, .at = (size_t)(end - data) + 2};
    return 0;
}

/* ---- Numbers and strings --------------------------------------------------------------------- */

static void skip_bytes(struct orl_binary_reader *reader, uint64_t bytes)
{
    if (bytes > reader->size - reader->at) {
        reader->ended = true;
        reader->at = reader->size;
    } else {
        reader->at += (size_t)bytes;
    }
}

int64_t orl_binary_int(struct orl_binary_reader *reader, unsigned bytes)
{
    const unsigned char *at = reader->data + reader->at;
    skip_bytes(reader, bytes);
    if (reader->ended)
        return 0;
    uint64_t value = at[0] & 0x80 ? UINT64_MAX : 0; /* sign extension */
    for (unsigned i = 0; i < bytes; i++)
        value = value << 8 | at[i];
    return (int64_t)value;
}

double orl_binary_number(struct orl_binary_reader *reader)
{
    const int64_t mantissa = orl_binary_int(reader, 4);
    const int exponent = (int)orl_binary_int(reader, 1);
    if (mantissa == 0)
        return 0;
    return ldexp(((double)mantissa + (mantissa < 0 ? -0.5 : 0.5)) / 0x7fffffff, exponent);
}

const char *orl_binary_string(struct orl_binary_reader *reader)
{
    const size_t left = reader->size - reader->at;
    const char *text = (const char *)reader->data + reader->at;
    const char *end = memchr(text, '\0', left < STRING_BYTES ? left : STRING_BYTES);
    if (!end) {
        skip_bytes(reader, left + (uint64_t)1);
        return "";
    }
    reader->at += (size_t)(end - text) + 1;
    return text;
}

/* ---- The octree ------------------------------------------------------------------------------ */

int orl_binary_skip_octree(struct orl_binary_reader *reader, unsigned bytes, struct orl_error *err)
{
    enum { EMPTY, FULL, TREE, CHILDREN = 8 };
    uint64_t nodes = 1; /* not yet read */
    while (nodes > 0 && !reader->ended) {
        const int64_t kind = orl_binary_int(reader, 1);
        nodes--;
        if (kind == FULL) {
            const int64_t count = orl_binary_int(reader, bytes);
            if (count < 0)
                return orl_binary_fail(reader, "a leaf of its octree is damaged", err);
            skip_bytes(reader, (uint64_t)(count < INT32_MAX ? count : INT32_MAX) * bytes);
        } else if (kind == TREE) {
            nodes += CHILDREN;
        } else if (kind != EMPTY) {
            return orl_binary_fail(reader, "its octree is damaged", err);
        }
    }
    return reader->ended ? orl_binary_fail(reader, "", err) : 0;
}

/* ---- Primitives ------------------------------------------------------------------------------ */

struct primitives {
    const char *types[TYPES_MAX];
    size_t n_types;
    struct orl_binary_names *names; /* names of the primitives read so far */
    struct orl_text text;
};

/* Adds a word, in quotes if it has blanks; the quote character that it does not contain is used. */
static void add_word(struct orl_text *text, const char *word)
{
    const char *quote = strchr(word, '"') ? "'" : "\"";
    const bool plain = *word && !word[strcspn(word, " \t\n\r\f\v\"'")];
    orl_text_add(text, " %s%s%s", plain ? "" : quote, word, plain ? "" : quote);
}

static int read_types(struct orl_binary_reader *reader, struct primitives *all,
                      struct orl_error *err)
{
    const char *name;
    while (*(name = orl_binary_string(reader))) {
        if (all->n_types == TYPES_MAX)
            return orl_binary_fail(reader, "it has too many types of primitives", err);
        all->types[all->n_types++] = name;
    }
    return reader->ended ? orl_binary_fail(reader, "", err) : 0;
}

static int64_t read_count(struct orl_binary_reader *reader)
{
    const int64_t count = orl_binary_int(reader, 2);
    return count > 0 ? count : 0;
}

static void add_strings(struct orl_binary_reader *reader, struct orl_text *text, int64_t count)
{
    orl_text_add(text, "\n%d", (int)count);
    for (int64_t i = 0; i < count && !reader->ended; i++)
        add_word(text, orl_binary_string(reader));
}

static void add_numbers(struct orl_binary_reader *reader, struct orl_text *text, int64_t count)
{
    orl_text_add(text, "\n0\n%d", (int)count);
    for (int64_t i = 0; i < count && !reader->ended; i++)
        orl_text_add(text, " %.11g", orl_binary_number(reader));
    orl_text_add(text, "\n");
}

/* An alias has one word; or none, if it represents its modifier with all its properties. */
static void add_alias(struct orl_binary_reader *reader, struct orl_text *text, const char *modifier,
                      const char *name)
{
    const int64_t count = read_count(reader);
    const char *target = count > 0 ? orl_binary_string(reader) : modifier;
    add_word(text, count > 0 ? modifier : "inherit");
    orl_text_add(text, " alias");
    add_word(text, name);
    add_word(text, target);
    orl_text_add(text, "\n");
    for (int64_t i = 1; i < count && !reader->ended; i++)
        orl_binary_string(reader);
    for (int64_t n = read_count(reader); n > 0 && !reader->ended; n--)
        orl_binary_number(reader);
}

static int add_primitive(struct orl_binary_reader *reader, unsigned bytes, struct primitives *all,
                         int64_t type, struct orl_error *err)
{
    const int64_t modifier = orl_binary_int(reader, bytes);
    const char *name = orl_binary_string(reader);
    if (type < 0 || (size_t)type >= all->n_types || modifier < -1 ||
        modifier >= (int64_t)all->names->count)
        return orl_binary_fail(reader, "one of its primitives is damaged", err);
    if (!orl_array_reserve(&all->names->at, &all->names->room, all->names->count,
                           sizeof *all->names->at))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const char *modifier_name = modifier < 0 ? "void" : all->names->at[modifier];
    all->names->at[all->names->count++] = name;
    if (strcmp(all->types[type], "alias") == 0) {
        add_alias(reader, &all->text, modifier_name, name);
    } else {
        add_word(&all->text, modifier_name);
        add_word(&all->text, all->types[type]);
        add_word(&all->text, name);
        add_strings(reader, &all->text, read_count(reader));
        add_numbers(reader, &all->text, read_count(reader));
    }
    return reader->ended ? orl_binary_fail(reader, "", err) : 0;
}

int orl_binary_primitives(struct orl_binary_reader *reader, unsigned bytes,
                          struct orl_binary_names *names,
                          int (*take)(void *ctx, const char *text, size_t size,
                                      struct orl_error *err),
                          void *ctx, struct orl_error *err)
{
    enum { PIECE_BYTES = 1 << 20 };
    struct primitives all = {.names = names};
    int64_t type;
    int code = read_types(reader, &all, err);
    while (code == 0 && (type = orl_binary_int(reader, 1)) != -1) {
        code = add_primitive(reader, bytes, &all, type, err);
        if (code == 0 && all.text.failed)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        if (code == 0 && all.text.size >= PIECE_BYTES) {
            code = take(ctx, all.text.data, all.text.size, err);
            all.text.size = 0;
        }
    }
    if (code == 0 && all.text.size > 0)
        code = take(ctx, all.text.data, all.text.size, err);
    orl_text_done(&all.text);
    return code;
}
