#include "project/project.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

enum { VALUE_SIZE = 64 << 10, NAME_SIZE = 64, DEEPEST = 8, SIDE = 800, MOST_SIDE = 16384 };

struct frads_reader {
    const char *name;
    json_t *sections;                            /* owned: values by section, then key */
    json_t *files, *views, *left_out, *commands; /* owned */
    char *value, *spare;                         /* buffers of VALUE_SIZE bytes each */
    struct orl_error *err;
};

static int fail(const struct frads_reader *r, int code, int line, const char *what,
                const char *word, const char *mend)
{
    orl_error_set(r->err, code, "%s: %.200s", what, word);
    orl_error_hint(r->err, "%s", mend);
    orl_error_at(r->err, r->name, line, NULL);
    return code;
}

static int no_memory(const struct frads_reader *r)
{
    return orl_error_no_memory(r->err);
}

/* ---- Sections -------------------------------------------------------------------------------- */

/* Stores a value with its line number for errors: {"text", "line"}. */
static int store_value(struct frads_reader *r, const char *section, const char *key,
                       const char *text, int line)
{
    json_t *const values = json_object_get(r->sections, section);
    json_t *const value = json_pack("{s:s, s:i}", "text", text, "line", line);
    if (!value)
        return fail(r, ORL_ERR_SYNTAX, line, "a value is not UTF-8", key, "Write it in UTF-8");
    return json_object_set_new(values, key, value) ? no_memory(r) : 0;
}

static void trim_text(char *text)
{
    const size_t front = strspn(text, " \t\r");
    size_t length = strlen(text + front);
    memmove(text, text + front, length + 1);
    while (length > 0 && strchr(" \t\r", text[length - 1]))
        text[--length] = '\0';
}

static void lower_case(char *text)
{
    for (; *text; text++)
        *text = (char)tolower((unsigned char)*text);
}

/* Copies a line into ret_line, a buffer of VALUE_SIZE bytes. Returns false if it is too long. */
static bool copy_line(struct orl_slice line, char *ret_line)
{
    if (line.length >= VALUE_SIZE)
        return false;
    for (size_t i = 0; i < line.length; i++)
        ret_line[i] = line.text[i] ? line.text[i] : ' ';
    ret_line[line.length] = '\0';
    return true;
}

struct entry {
    char section[NAME_SIZE], key[NAME_SIZE];
    int line;
};

static int begin_section(struct frads_reader *r, struct entry *at, char *line, int number)
{
    char *const close = strchr(line, ']');
    if (!close || close - line - 1 >= NAME_SIZE || close == line + 1)
        return fail(r, ORL_ERR_SYNTAX, number, "this is not a section name", line,
                    "Sections are [Model], [RaySender] and the like");
    *close = '\0';
    snprintf(at->section, sizeof at->section, "%s", line + 1);
    at->key[0] = '\0';
    if (json_object_get(r->sections, at->section))
        return 0;
    json_t *const values = json_object();
    return json_object_set_new(r->sections, at->section, values)
               ? fail(r, ORL_ERR_SYNTAX, number, "a name is not UTF-8", line + 1, "Rename it")
               : 0;
}

/* Reads "key = value", or a continuation of the entry before. */
static int read_entry(struct frads_reader *r, struct entry *at, char *line, int number)
{
    const bool goes_on = at->key[0] && (line[0] == ' ' || line[0] == '\t');
    trim_text(line);
    if (line[0] == '\0' || line[0] == '#' || line[0] == ';')
        return 0;
    if (goes_on) {
        const size_t before = strlen(r->value), more = strlen(line);
        if (before + more + 2 > VALUE_SIZE)
            return fail(r, ORL_ERR_LIMIT, number, "a value is longer than 64 KiB", at->key,
                        "Name fewer files");
        r->value[before] = ' ';
        memcpy(r->value + before + 1, line, more + 1);
        return store_value(r, at->section, at->key, r->value, at->line);
    }
    if (line[0] == '[')
        return begin_section(r, at, line, number);
    char *const sign = line + strcspn(line, "=:");
    if (!at->section[0] || !*sign || sign == line || sign - line >= NAME_SIZE)
        return fail(r, ORL_ERR_SYNTAX, number, "the line assigns nothing", line,
                    "Lines are [Section], or key = value");
    *sign = '\0';
    snprintf(at->key, sizeof at->key, "%s", line);
    trim_text(at->key);
    lower_case(at->key);
    at->line = number;
    snprintf(r->value, VALUE_SIZE, "%s", sign + 1);
    trim_text(r->value);
    return store_value(r, at->section, at->key, r->value, number);
}

static int read_sections(struct frads_reader *r, const char *text, size_t size)
{
    struct entry at = {.line = 0};
    struct orl_scanner scanner;
    struct orl_slice line;
    int rc = orl_scanner_init(&scanner, r->name, text, size, 0, r->err);
    while (rc == 0 && orl_scanner_line(&scanner, &line))
        rc = copy_line(line, r->spare)
                 ? read_entry(r, &at, r->spare, scanner.line)
                 : fail(r, ORL_ERR_LIMIT, scanner.line, "a line is longer than 64 KiB", at.key,
                        "Name fewer files");
    return rc;
}

/* ---- Values ---------------------------------------------------------------------------------- */

static const json_t *value_of(const struct frads_reader *r, const char *section, const char *key)
{
    return json_object_get(json_object_get(r->sections, section), key);
}

static int line_of(const json_t *value)
{
    return (int)json_integer_value(json_object_get(value, "line"));
}

/* Appends the value to ret (VALUE_SIZE bytes), with references replaced by the values they name. */
static int expand_value(struct frads_reader *r, const char *section, const json_t *value, int depth,
                        char *ret)
{
    const char *text = json_string_value(json_object_get(value, "text"));
    const int line = line_of(value);
    if (depth > DEEPEST)
        return fail(r, ORL_ERR_LIMIT, line,
                    "references between values are nested more than eight deep", text,
                    "Replace one reference by its value");
    for (size_t used = strlen(ret); *text; used = strlen(ret)) {
        if (strncmp(text, "${", 2) != 0) {
            if (used + 2 > VALUE_SIZE)
                return fail(r, ORL_ERR_LIMIT, line, "a value is longer than 64 KiB", "",
                            "Name fewer files");
            ret[used] = *text++;
            ret[used + 1] = '\0';
            continue;
        }
        char names[2 * NAME_SIZE];
        const size_t length = strcspn(text + 2, "}");
        if (length >= sizeof names || !text[2 + length])
            return fail(r, ORL_ERR_SYNTAX, line, "a '${' has no closing '}'", text,
                        "Write ${key} or ${Section:key}");
        snprintf(names, sizeof names, "%.*s", (int)length, text + 2);
        char *const colon = strchr(names, ':'), *const key = colon ? colon + 1 : names;
        if (colon)
            *colon = '\0';
        lower_case(key);
        const char *const in = colon ? names : section;
        const json_t *const other = value_of(r, in, key);
        if (!other)
            return fail(r, ORL_ERR_SYNTAX, line, "a value refers to a key that does not exist", key,
                        "Write ${key} or ${Section:key}");
        const int rc = expand_value(r, in, other, depth + 1, ret);
        if (rc)
            return rc;
        text += length + 3;
    }
    return 0;
}

/* Sets *ret_words to an array of the value's words, empty if there is no such value. */
static int words_of(struct frads_reader *r, const char *section, const char *key,
                    json_t **ret_words)
{
    static const char space[] = " \t\r\n";
    const json_t *const value = value_of(r, section, key);
    char *at = r->value;
    int rc = 0;
    *ret_words = json_array();
    r->value[0] = '\0';
    if (value)
        rc = expand_value(r, section, value, 0, r->value);
    while (rc == 0 && *(at += strspn(at, space))) {
        char *const end = at + strcspn(at, space);
        if (json_array_append_new(*ret_words, json_stringn(at, (size_t)(end - at))))
            rc = no_memory(r);
        at = end;
    }
    return rc;
}

/* ---- Conversion to a project ----------------------------------------------------------------- */

static int leave_out(struct frads_reader *r, const char *section, const char *key, const char *why)
{
    json_t *words, *word;
    size_t i;
    int rc = words_of(r, section, key, &words);
    json_array_foreach(words, i, word)
    {
        if (rc == 0 &&
            json_array_append_new(r->left_out, json_pack("{s:O, s:s}", "file", word, "why", why)))
            rc = no_memory(r);
    }
    json_decref(words);
    return rc;
}

static int add_files(struct frads_reader *r, const char *key)
{
    json_t *words;
    const int rc = words_of(r, "Model", key, &words);
    if (rc == 0)
        json_array_extend(r->files, words);
    json_decref(words);
    return rc;
}

/* Writes the window's surfaces with that BSDF as a scene file of two lines. */
static int add_panel(struct frads_reader *r, const char *window, const char *xml, size_t number)
{
    char name[64];
    snprintf(name, sizeof name, "+window-%zu.rad", number);
    json_t *const text = json_sprintf("void BSDF frads.window.%zu 6 0 \"%s\" 0 0 1 . 0 0\n"
                                      "!xform -m frads.window.%zu \"%s\"\n",
                                      number, xml, number, window);
    if (!text)
        return no_memory(r);
    return json_array_append_new(r->commands,
                                 json_pack("{s:s, s:o}", "name", name, "text", text)) ||
                   json_array_append_new(r->files, json_string(name))
               ? no_memory(r)
               : 0;
}

static int add_windows(struct frads_reader *r)
{
    json_t *windows = NULL, *xmls = NULL;
    int rc = words_of(r, "Model", "windows", &windows);
    if (rc == 0)
        rc = words_of(r, "Model", "window_xmls", &xmls);
    const size_t n = json_array_size(windows), panels = json_array_size(xmls);
    if (rc == 0 && panels > 1 && panels != n)
        rc = fail(r, ORL_ERR_SYNTAX, line_of(value_of(r, "Model", "window_xmls")),
                  "the number of BSDFs is neither one nor the number of windows", "window_xmls",
                  "Give one file for each window, or one for all");
    for (size_t i = 0; i < n && rc == 0; i++) {
        const char *const window = json_string_value(json_array_get(windows, i));
        const char *const xml = json_string_value(json_array_get(xmls, panels > 1 ? i : 0));
        if (xml && (strpbrk(window, "\"!") || strpbrk(xml, "\"!")))
            rc = fail(r, ORL_ERR_SYNTAX, line_of(value_of(r, "Model", "windows")),
                      "a file's name has a '\"' or '!' in it", window, "Rename it");
        else if (xml)
            rc = add_panel(r, window, xml, i + 1);
        else
            rc = json_array_append(r->files, json_array_get(windows, i)) ? no_memory(r) : 0;
    }
    json_decref(windows);
    json_decref(xmls);
    return rc;
}

static int side_of(const json_t *word)
{
    const long side = word ? strtol(json_string_value(word), NULL, 10) : 0;
    return side >= 1 && side <= MOST_SIDE ? (int)side : SIDE;
}

/* Adds a view from "-vf FILE -x N -y N" or from view options. */
static int add_view(struct frads_reader *r, const char *key)
{
    json_t *words, *word;
    const char *file = NULL;
    int width = SIDE, height = SIDE, rc = words_of(r, "RaySender", key, &words);
    size_t i;
    r->spare[0] = '\0';
    json_array_foreach(words, i, word)
    {
        const char *const text = json_string_value(word);
        const json_t *const next = json_array_get(words, i + 1);
        if (strcmp(text, "-vf") == 0 && next)
            file = json_string_value(json_array_get(words, ++i));
        else if (strcmp(text, "-x") == 0)
            width = side_of(json_array_get(words, ++i));
        else if (strcmp(text, "-y") == 0)
            height = side_of(json_array_get(words, ++i));
        else
            snprintf(r->spare + strlen(r->spare), VALUE_SIZE - strlen(r->spare), "%s%s",
                     r->spare[0] ? " " : "", text);
    }
    if (rc == 0 && (file || r->spare[0])) {
        json_t *const view =
            json_pack("{s:s, s:s*, s:s*, s:i, s:i}", "name", key, "file", file, "view",
                      r->spare[0] ? r->spare : NULL, "width", width, "height", height);
        rc = json_array_append_new(r->views, view) ? no_memory(r) : 0;
    }
    json_decref(words);
    return rc;
}

static bool is_name(const char *key)
{
    for (const char *at = key; *at; at++)
        if (!isalnum((unsigned char)*at) && !strchr("-_", *at))
            return false;
    return true;
}

static int add_views(struct frads_reader *r)
{
    const char *key;
    json_t *value;
    int rc = 0;
    json_object_foreach(json_object_get(r->sections, "RaySender"), key, value)
    {
        if (rc == 0 && strncmp(key, "view", 4) == 0 && is_name(key))
            rc = add_view(r, key);
    }
    return rc;
}

static int leave_the_rest(struct frads_reader *r)
{
    static const char *const weather[] = {"epw_file", "epw_path", "wea_path"};
    int rc = leave_out(r, "RaySender", "grid_surface",
                       "frads generates this grid itself: write its points to a .pts file");
    if (rc == 0)
        rc = leave_out(r, "Model", "window_cfs", "geometry for matrices only");
    for (size_t i = 0; i < sizeof weather / sizeof *weather && rc == 0; i++)
        rc =
            leave_out(r, "Site", weather[i], "weather: give it to \"oriel annual\" with --weather");
    return rc;
}

static int read_project(struct frads_reader *r, const char *text, size_t size)
{
    static const char *const lists[] = {"scene", "ncps"};
    int rc = read_sections(r, text, size);
    if (rc == 0 && !value_of(r, "Model", "scene"))
        rc = fail(r, ORL_ERR_SYNTAX, 0, "no scene files are named", r->name,
                  "Add a section [Model] with scene = FILE ... to the configuration");
    if (rc == 0)
        rc = add_files(r, "material");
    if (rc == 0)
        rc = add_windows(r);
    for (size_t i = 0; i < sizeof lists / sizeof *lists && rc == 0; i++)
        rc = add_files(r, lists[i]);
    if (rc == 0)
        rc = add_views(r);
    return rc ? rc : leave_the_rest(r);
}

int orl_frads_read(const char *name, const char *text, size_t size, json_t **ret_project,
                   struct orl_error *err)
{
    struct frads_reader r = {.name = name,
                             .sections = json_object(),
                             .files = json_array(),
                             .views = json_array(),
                             .left_out = json_array(),
                             .commands = json_array(),
                             .value = calloc(1, VALUE_SIZE),
                             .spare = calloc(1, VALUE_SIZE),
                             .err = err};
    int rc = r.value && r.spare ? read_project(&r, text, size) : no_memory(&r);
    if (rc == 0 && !(*ret_project = json_pack("{s:O, s:[], s:O, s:{}, s:[], s:O, s:O}", "files",
                                              r.files, "grids", "views", r.views, "states", "skies",
                                              "left_out", r.left_out, "commands", r.commands)))
        rc = no_memory(&r);
    json_decref(r.sections);
    json_decref(r.files);
    json_decref(r.views);
    json_decref(r.left_out);
    json_decref(r.commands);
    free(r.value);
    free(r.spare);
    return rc;
}
