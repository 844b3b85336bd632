#include "project/project.h"

#include <ctype.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/scanner.h>

enum { LINE_SIZE = 8192, LEAST_LETTERS = 3, SIDE = 512, MOST_SIDE = 16384 };

struct rif_reader {
    struct orl_scanner scanner;
    int line;                    /* line where the current assignment begins */
    json_t *lists[4];            /* owned: materials, illum, scene, and views */
    json_t *left_out, *commands; /* owned */
    int width, height;
    double aspect;     /* pixel aspect of views; 0: from the picture size */
    bool backs_unseen; /* true if views have rpict's -bv- */
    struct orl_error *err;
};
enum { MATERIALS, ILLUM, SCENE, VIEWS };

static int fail(const struct rif_reader *r, int code, const char *what, struct orl_slice word,
                const char *mend)
{
    const int length = word.length < 200 ? (int)word.length : 200;
    orl_error_set(r->err, code, "%s: %.*s", what, length, word.length > 0 ? word.text : "");
    orl_error_hint(r->err, "%s", mend);
    orl_error_at(r->err, r->scanner.name, r->line, NULL);
    return code;
}

static int no_memory(const struct rif_reader *r)
{
    return orl_error_no_memory(r->err);
}

static json_t *text_of(struct orl_slice span)
{
    return json_stringn(span.text ? span.text : "", span.length);
}

static int leave_out(struct rif_reader *r, struct orl_slice what, const char *why)
{
    return json_array_append_new(r->left_out,
                                 json_pack("{s:o, s:s}", "file", text_of(what), "why", why))
               ? fail(r, ORL_ERR_SYNTAX, "a name is not UTF-8", what, "Rename it")
               : 0;
}

/* Adds a command as a scene file of one line. No file of the folder has its name. */
static int add_command(struct rif_reader *r, json_t *list, struct orl_slice command)
{
    char name[64];
    snprintf(name, sizeof name, "+command-%zu.rad", json_array_size(r->commands) + 1);
    json_t *text = json_sprintf("%.*s\n", (int)command.length, command.text);
    if (!text)
        return fail(r, ORL_ERR_SYNTAX, "a command is not UTF-8", command, "Write it in ASCII");
    return json_array_append_new(r->commands,
                                 json_pack("{s:s, s:o}", "name", name, "text", text)) ||
                   json_array_append_new(list, json_string(name))
               ? no_memory(r)
               : 0;
}

static int add_file(struct rif_reader *r, json_t *list, struct orl_slice file)
{
    if (file.length == 0)
        return fail(r, ORL_ERR_SYNTAX, "a file has no name", (struct orl_slice){"\"\"", 2},
                    "Name it, or leave it out");
    if (file.text[0] == '!')
        return add_command(r, list, file);
    if (file.length > 4 && memcmp(file.text + file.length - 4, ".oct", 4) == 0)
        return fail(r, ORL_ERR_UNSUPPORTED, "the scene is an octree", file,
                    "Name the scene files from which the octree was made");
    return json_array_append_new(list, text_of(file))
               ? fail(r, ORL_ERR_SYNTAX, "a name is not UTF-8", file, "Rename it")
               : 0;
}

/* Adds file names, some in quotes. */
static int add_files(struct rif_reader *r, json_t *list, struct orl_slice value)
{
    struct orl_slice word = {NULL, 0};
    int rc = 0, found = 1;
    while (rc == 0 && (found = orl_slice_take_quoted(&value, &word)) == 1)
        rc = add_file(r, list, word);
    return found < 0 ? fail(r, ORL_ERR_SYNTAX, "a quotation mark is not closed", word,
                            "Close it on the same line")
                     : rc;
}

static int list_objects_left_out(struct rif_reader *r, struct orl_slice value)
{
    struct orl_slice word;
    int rc = 0;
    while (rc == 0 && (word = orl_slice_take_word(&value)).length > 0)
        rc = leave_out(r, word, "an object: it is read only where a scene file refers to it");
    return rc;
}

/* Makes a valid view name from a word. */
static void clean_name(struct orl_slice word, size_t number, char ret_name[64])
{
    size_t i = 0;
    for (; i < word.length && i < 60; i++) {
        const unsigned char c = (unsigned char)word.text[i];
        ret_name[i] = c < 0x80 && (isalnum(c) || strchr("-_", c)) ? (char)c : '_';
    }
    ret_name[i] = '\0';
    if (i == 0)
        snprintf(ret_name, 64, "view%zu", number);
}

static bool begins_option(struct orl_slice value)
{
    return value.length > 0 && *value.text == '-';
}

/* Adds a view from "[NAME] [OPTION ...]". */
static int add_view(struct rif_reader *r, struct orl_slice value)
{
    struct orl_slice word = {NULL, 0}, rest;
    char name[64];
    value = orl_slice_trim(value);
    if (!begins_option(value))
        word = orl_slice_take_word(&value);
    value = orl_slice_trim(value);
    clean_name(word, json_array_size(r->lists[VIEWS]) + 1, name);
    const struct orl_slice called = {name, strlen(name)};
    if (!begins_option(value))
        return leave_out(r, called, "rad computes this view from its ZONE");
    json_t *view = json_pack("{s:s}", "name", name);
    int rc = view ? 0 : -1;
    rest = value;
    if (orl_slice_is(orl_slice_take_word(&rest), "-vf")) {
        word = orl_slice_take_word(&rest);
        value = orl_slice_trim(rest);
        if (rc == 0 && word.length > 0)
            rc = json_object_set_new(view, "file", text_of(word));
    }
    if (rc == 0 && value.length > 0)
        rc = json_object_set_new(view, "view", text_of(value));
    if (rc == 0)
        return json_array_append_new(r->lists[VIEWS], view) ? no_memory(r) : 0;
    json_decref(view);
    return fail(r, ORL_ERR_SYNTAX, "a view is not UTF-8", called, "Rename its file");
}

static int fail_size(const struct rif_reader *r, struct orl_slice value)
{
    return fail(r, ORL_ERR_SYNTAX, "this is not a resolution", value,
                "Give one or two numbers from 1 to 16384, and optionally the pixel aspect");
}

/* Sets the size from "WIDTH [HEIGHT [ASPECT]]". */
static int set_size(struct rif_reader *r, struct orl_slice value)
{
    double sizes[3] = {0, 0, 1};
    struct orl_slice rest = value, word;
    int n = 0;
    for (; (word = orl_slice_take_word(&rest)).length > 0; n++) {
        if (orl_slice_is_decimal_comma(word))
            return fail(r, ORL_ERR_SYNTAX, "this is a decimal comma", word, "Write a point");
        if (n == 3 || orl_scanner_number(&r->scanner, word, NULL, &sizes[n], NULL) < 0)
            return fail_size(r, value);
    }
    if (n == 1)
        sizes[1] = sizes[0];
    for (int i = 0; i < 2; i++)
        if (!(sizes[i] >= 1 && sizes[i] <= MOST_SIDE && sizes[i] == floor(sizes[i])))
            return fail_size(r, value);
    if (!(sizes[2] == 0 || (sizes[2] >= 1e-3 && sizes[2] <= 1e3)))
        return fail_size(r, value);
    r->width = (int)sizes[0];
    r->height = (int)sizes[1];
    r->aspect = sizes[2];
    return 0;
}

/* Reads the rpict options that matter here: -bv- and -bv+. */
static int apply_options(struct rif_reader *r, struct orl_slice value)
{
    struct orl_slice word;
    while ((word = orl_slice_take_word(&value)).length > 0)
        if (orl_slice_is(word, "-bv-") || orl_slice_is(word, "-bv+"))
            r->backs_unseen = word.text[3] == '-';
    return 0;
}

static bool is_named(struct orl_slice word, const char *name)
{
    return word.length >= LEAST_LETTERS && word.length <= strlen(name) &&
           strncasecmp(word.text, name, word.length) == 0;
}

static int read_assignment(struct rif_reader *r, struct orl_slice line)
{
    line = orl_slice_trim(line);
    if (line.length == 0)
        return 0;
    struct orl_slice before = orl_slice_before(line, '=');
    if (before.length == line.length)
        return fail(r, ORL_ERR_SYNTAX, "the line assigns nothing", line,
                    "Lines are NAME= value, or begin with '#'");
    const struct orl_slice value = orl_slice_trim(
        (struct orl_slice){line.text + before.length + 1, line.length - before.length - 1});
    const struct orl_slice name = orl_slice_take_word(&before);
    if (name.length == 0)
        return fail(r, ORL_ERR_SYNTAX, "a name is missing before the value", value,
                    "Lines are NAME= value, or begin with '#'");
    return is_named(name, "materials")    ? add_files(r, r->lists[MATERIALS], value)
           : is_named(name, "illum")      ? add_files(r, r->lists[ILLUM], value)
           : is_named(name, "scene")      ? add_files(r, r->lists[SCENE], value)
           : is_named(name, "objects")    ? list_objects_left_out(r, value)
           : is_named(name, "view")       ? add_view(r, value)
           : is_named(name, "RESOLUTION") ? set_size(r, value)
           : is_named(name, "render") || is_named(name, "rpict") ? apply_options(r, value)
                                                                 : 0;
}

/* Reads the next line, joined with the lines that a backslash continues and without comments. A
 * comment extends over the joined lines. Returns 1, 0 at the end, or an error. */
static int read_logical_line(struct rif_reader *r, char *buffer, struct orl_slice *ret_line)
{
    struct orl_slice line;
    size_t length = 0;
    bool remark = false, joined = true;
    if (!orl_scanner_line(&r->scanner, &line))
        return 0;
    r->line = r->scanner.line;
    while (joined) {
        joined = line.length > 0 && line.text[line.length - 1] == '\\';
        line.length -= joined;
        const struct orl_slice plain =
            remark ? (struct orl_slice){"", 0} : orl_slice_before(line, '#');
        remark = remark || plain.length < line.length;
        if (length + plain.length + 1 >= LINE_SIZE)
            return fail(r, ORL_ERR_SYNTAX, "a line is longer than the limit in bytes",
                        (struct orl_slice){"8191", 4},
                        "Assign materials, illum, scene or view several times");
        for (size_t i = 0; i < plain.length; i++)
            buffer[length++] = plain.text[i] ? plain.text[i] : ' ';
        buffer[length++] = ' ';
        joined = joined && orl_scanner_line(&r->scanner, &line);
    }
    *ret_line = (struct orl_slice){buffer, length};
    return 1;
}

static json_t *make_project(struct rif_reader *r)
{
    json_t *view;
    size_t i;
    json_array_foreach(r->lists[VIEWS], i, view)
    {
        json_object_set_new(view, "width", json_integer(r->width));
        json_object_set_new(view, "height", json_integer(r->height));
        if (r->aspect != 1)
            json_object_set_new(view, "pixel_aspect", json_real(r->aspect));
        if (r->backs_unseen) {
            const char *const options = json_string_value(json_object_get(view, "view"));
            json_object_set_new(view, "view", json_sprintf("%s -bv-", options ? options : ""));
        }
    }
    json_array_extend(r->lists[MATERIALS], r->lists[ILLUM]);
    json_array_extend(r->lists[MATERIALS], r->lists[SCENE]);
    return json_pack("{s:O, s:[], s:O, s:{}, s:[], s:O, s:O}", "files", r->lists[MATERIALS],
                     "grids", "views", r->lists[VIEWS], "states", "skies", "left_out", r->left_out,
                     "commands", r->commands);
}

int orl_rif_read(const char *name, const char *text, size_t size, json_t **ret_project,
                 struct orl_error *err)
{
    struct rif_reader r = {.width = SIDE, .height = SIDE, .aspect = 1, .err = err};
    struct orl_slice line = {NULL, 0};
    char *buffer = malloc(LINE_SIZE);
    int rc = buffer ? orl_scanner_init(&r.scanner, name, text, size, 0, err) : no_memory(&r);
    for (size_t i = 0; i < 4; i++)
        r.lists[i] = json_array();
    r.left_out = json_array();
    r.commands = json_array();
    for (int more = 1; rc == 0 && more == 1;) {
        more = read_logical_line(&r, buffer, &line);
        rc = more == 1 ? read_assignment(&r, line) : more;
        r.line = more == 1 && rc == 0 ? r.scanner.line : r.line;
    }
    if (rc == 0 && json_array_size(r.lists[SCENE]) == 0)
        rc = fail(&r, ORL_ERR_SYNTAX, "no scene files are named",
                  (struct orl_slice){name, strlen(name)},
                  "Add scene= FILE ... to it; Oriel does not use the octree");
    if (rc == 0 && !(*ret_project = make_project(&r)))
        rc = no_memory(&r);
    for (size_t i = 0; i < 4; i++)
        json_decref(r.lists[i]);
    json_decref(r.left_out);
    json_decref(r.commands);
    free(buffer);
    return rc;
}
