#include "scene/parse/binary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/grow.h"
#include "scene/generate/generate.h"

/* Radiance's limits. */
enum { STRING_BYTES = 512, TYPES_MAX = 128 };

int orl_binary_fail(const struct orl_binary *binary, const char *what, struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_SYNTAX, "%s",
                         binary->ended ? "the compiled file ends too early" : what);
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

int orl_binary_open(const char *data, size_t size, const char *format, struct orl_binary *ret,
                    struct orl_error *err)
{
    enum { HEADER_MAX = 1 << 16 };
    const size_t most = size < HEADER_MAX ? size : HEADER_MAX;
    const char *end = most > 2 ? memmem(data, most, "\n\n", 2) : NULL;
    if (!end || memcmp(data, "#?", 2) != 0 || !says_format(data, (size_t)(end - data) + 1, format))
        return orl_error_set(err, ORL_ERR_SYNTAX, "it is not a file of format %s", format);
    *ret = (struct orl_binary){
        .data = (const unsigned char *)data, .size = size, .at = (size_t)(end - data) + 2};
    return 0;
}

/* ---- Numbers and strings --------------------------------------------------------------------- */

void orl_binary_skip(struct orl_binary *binary, uint64_t bytes)
{
    if (bytes > binary->size - binary->at) {
        binary->ended = true;
        binary->at = binary->size;
    } else {
        binary->at += (size_t)bytes;
    }
}

int64_t orl_binary_int(struct orl_binary *binary, unsigned bytes)
{
    const unsigned char *at = binary->data + binary->at;
    orl_binary_skip(binary, bytes);
    if (binary->ended)
        return 0;
    uint64_t value = at[0] & 0x80 ? UINT64_MAX : 0; /* sign extension */
    for (unsigned i = 0; i < bytes; i++)
        value = value << 8 | at[i];
    return (int64_t)value;
}

double orl_binary_number(struct orl_binary *binary)
{
    const int64_t mantissa = orl_binary_int(binary, 4);
    const int exponent = (int)orl_binary_int(binary, 1);
    if (mantissa == 0)
        return 0;
    return ldexp(((double)mantissa + (mantissa < 0 ? -0.5 : 0.5)) / 0x7fffffff, exponent);
}

const char *orl_binary_string(struct orl_binary *binary)
{
    const size_t left = binary->size - binary->at;
    const char *text = (const char *)binary->data + binary->at;
    const char *end = memchr(text, '\0', left < STRING_BYTES ? left : STRING_BYTES);
    if (!end) {
        orl_binary_skip(binary, left + (uint64_t)1);
        return "";
    }
    binary->at += (size_t)(end - text) + 1;
    return text;
}

/* ---- The octree ------------------------------------------------------------------------------ */

int orl_binary_skip_octree(struct orl_binary *binary, unsigned bytes, struct orl_error *err)
{
    enum { EMPTY, FULL, TREE, CHILDREN = 8 };
    uint64_t nodes = 1; /* not yet read */
    while (nodes > 0 && !binary->ended) {
        const int64_t kind = orl_binary_int(binary, 1);
        nodes--;
        if (kind == FULL) {
            const int64_t count = orl_binary_int(binary, bytes);
            if (count < 0)
                return orl_binary_fail(binary, "a leaf of its octree is damaged", err);
            orl_binary_skip(binary, (uint64_t)(count < INT32_MAX ? count : INT32_MAX) * bytes);
        } else if (kind == TREE) {
            nodes += CHILDREN;
        } else if (kind != EMPTY) {
            return orl_binary_fail(binary, "its octree is damaged", err);
        }
    }
    return binary->ended ? orl_binary_fail(binary, "", err) : 0;
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

static int read_types(struct orl_binary *binary, struct primitives *all, struct orl_error *err)
{
    const char *name;
    while (*(name = orl_binary_string(binary))) {
        if (all->n_types == TYPES_MAX)
            return orl_binary_fail(binary, "it has too many types of primitives", err);
        all->types[all->n_types++] = name;
    }
    return binary->ended ? orl_binary_fail(binary, "", err) : 0;
}

static int64_t read_count(struct orl_binary *binary)
{
    const int64_t count = orl_binary_int(binary, 2);
    return count > 0 ? count : 0;
}

static void add_strings(struct orl_binary *binary, struct orl_text *text, int64_t count)
{
    orl_text_add(text, "\n%d", (int)count);
    for (int64_t i = 0; i < count && !binary->ended; i++)
        add_word(text, orl_binary_string(binary));
}

static void add_numbers(struct orl_binary *binary, struct orl_text *text, int64_t count)
{
    orl_text_add(text, "\n0\n%d", (int)count);
    for (int64_t i = 0; i < count && !binary->ended; i++)
        orl_text_add(text, " %.11g", orl_binary_number(binary));
    orl_text_add(text, "\n");
}

/* An alias has one word; or none, if it stands for its modifier with all its properties. */
static void add_alias(struct orl_binary *binary, struct orl_text *text, const char *modifier,
                      const char *name)
{
    const int64_t count = read_count(binary);
    const char *target = count > 0 ? orl_binary_string(binary) : modifier;
    add_word(text, count > 0 ? modifier : "inherit");
    orl_text_add(text, " alias");
    add_word(text, name);
    add_word(text, target);
    orl_text_add(text, "\n");
    for (int64_t i = 1; i < count && !binary->ended; i++)
        orl_binary_string(binary);
    for (int64_t n = read_count(binary); n > 0 && !binary->ended; n--)
        orl_binary_number(binary);
}

static int add_primitive(struct orl_binary *binary, unsigned bytes, struct primitives *all,
                         int64_t type, struct orl_error *err)
{
    const int64_t modifier = orl_binary_int(binary, bytes);
    const char *name = orl_binary_string(binary);
    if (type < 0 || (size_t)type >= all->n_types || modifier < -1 ||
        modifier >= (int64_t)all->names->count)
        return orl_binary_fail(binary, "one of its primitives is damaged", err);
    if (!orl_grow(&all->names->at, &all->names->room, all->names->count, sizeof *all->names->at))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const char *modifier_name = modifier < 0 ? "void" : all->names->at[modifier];
    all->names->at[all->names->count++] = name;
    if (strcmp(all->types[type], "alias") == 0) {
        add_alias(binary, &all->text, modifier_name, name);
    } else {
        add_word(&all->text, modifier_name);
        add_word(&all->text, all->types[type]);
        add_word(&all->text, name);
        add_strings(binary, &all->text, read_count(binary));
        add_numbers(binary, &all->text, read_count(binary));
    }
    return binary->ended ? orl_binary_fail(binary, "", err) : 0;
}

int orl_binary_primitives(struct orl_binary *binary, unsigned bytes, struct orl_binary_names *names,
                          int (*take)(void *ctx, const char *text, size_t size,
                                      struct orl_error *err),
                          void *ctx, struct orl_error *err)
{
    enum { PIECE_BYTES = 1 << 20 };
    struct primitives all = {.names = names};
    int64_t type;
    int code = read_types(binary, &all, err);
    while (code == 0 && (type = orl_binary_int(binary, 1)) != -1) {
        code = add_primitive(binary, bytes, &all, type, err);
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
