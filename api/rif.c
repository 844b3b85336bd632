#include "rif.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { LINE_SIZE = 8192, LEAST_LETTERS = 3, SIDE = 512, MOST_SIDE = 16384 };

struct reading {
    const char *name;
    int line;
    json_t *lists[4];            /* owned: materials, illum, scene; the last is of views */
    json_t *left_out, *commands; /* owned */
    int width, height;
    double aspect;     /* of views' pixels; 0: what the size makes of it */
    bool backs_unseen; /* of views: rpict's -bv- */
    struct orl_error *err;
};
enum { MATERIALS, ILLUM, SCENE, VIEWS };

static int fail(const struct reading *r, int code, const char *what, const char *word,
                const char *mend)
{
    orl_error_set(r->err, code, "%s: %.200s", what, word);
    orl_error_hint(r->err, "%s", mend);
    orl_error_at(r->err, r->name, r->line, NULL);
    return code;
}

static int no_memory(const struct reading *r)
{
    return orl_error_set(r->err, ORL_ERR_NOMEM, "out of memory");
}

static int leave_out(struct reading *r, const char *what, const char *why)
{
    return json_array_append_new(r->left_out, json_pack("{s:s, s:s}", "file", what, "why", why))
               ? fail(r, ORL_ERR_SYNTAX, "a name is no UTF-8", what, "Rename it")
               : 0;
}

/* The next word of *text, cut off there, or NULL. */
static char *next_word(char **text)
{
    static const char space[] = " \t\r\n";
    char *word = *text + strspn(*text, space);
    char *end = word + strcspn(word, space);
    if (!*word)
        return NULL;
    *text = *end ? end + 1 : end;
    *end = '\0';
    return word;
}

/* A command becomes a scene file of one line, whose name no file of the folder has. */
static int add_command(struct reading *r, json_t *list, const char *command)
{
    char name[64];
    snprintf(name, sizeof name, "+command-%zu.rad", json_array_size(r->commands) + 1);
    json_t *text = json_sprintf("%s\n", command);
    if (!text)
        return fail(r, ORL_ERR_SYNTAX, "a command is no UTF-8", command, "Write it in ASCII");
    return json_array_append_new(r->commands,
                                 json_pack("{s:s, s:o}", "name", name, "text", text)) ||
                   json_array_append_new(list, json_string(name))
               ? no_memory(r)
               : 0;
}

static int add_file(struct reading *r, json_t *list, const char *file)
{
    const size_t length = strlen(file);
    if (length == 0)
        return fail(r, ORL_ERR_SYNTAX, "a file has no name", "\"\"", "Name it, or leave it out");
    if (file[0] == '!')
        return add_command(r, list, file);
    if (length > 4 && strcmp(file + length - 4, ".oct") == 0)
        return fail(r, ORL_ERR_UNSUPPORTED, "the scene is an octree", file,
                    "Name the scene files that it was made of");
    return json_array_append_new(list, json_string(file))
               ? fail(r, ORL_ERR_SYNTAX, "a name is no UTF-8", file, "Rename it")
               : 0;
}

/* Words, some in quotes. */
static int add_files(struct reading *r, json_t *list, char *value)
{
    int rc = 0;
    while (rc == 0) {
        value += strspn(value, " \t\r\n");
        const char quote = *value == '"' || *value == '\'' ? *value : '\0';
        char *word = quote ? value + 1 : next_word(&value);
        if (!word)
            return 0;
        if (quote) {
            value = strchr(word, quote);
            if (!value)
                return fail(r, ORL_ERR_SYNTAX, "a quote is open", word, "Close it on its line");
            *value++ = '\0';
        }
        rc = add_file(r, list, word);
    }
    return rc;
}

static int leave_objects(struct reading *r, char *value)
{
    char *word;
    int rc = 0;
    while (rc == 0 && (word = next_word(&value)) != NULL)
        rc = leave_out(r, word, "an object: the scene's files name it where it is wanted");
    return rc;
}

/* What jobs call views by. */
static void clean_name(const char *word, size_t number, char ret_name[64])
{
    size_t i = 0;
    for (; word && word[i] && i < 60; i++) {
        const unsigned char c = (unsigned char)word[i];
        ret_name[i] = c < 0x80 && (isalnum(c) || strchr("-_", c)) ? (char)c : '_';
    }
    ret_name[i] = '\0';
    if (i == 0)
        snprintf(ret_name, 64, "view%zu", number);
}

/* "[NAME] [OPTION ...]" */
static int add_view(struct reading *r, char *value)
{
    char name[64], *word = NULL;
    value += strspn(value, " \t");
    if (*value != '-')
        word = next_word(&value);
    value += strspn(value, " \t");
    for (char *end = value + strlen(value); end > value && strchr(" \t\r", end[-1]);)
        *--end = '\0';
    clean_name(word, json_array_size(r->lists[VIEWS]) + 1, name);
    if (*value != '-')
        return leave_out(r, name, "a view that rad works out from its ZONE");
    json_t *view = NULL;
    if (strncmp(value, "-vf ", 4) == 0) {
        char *rest = value + 4, *file = next_word(&rest);
        rest += strspn(rest, " \t");
        view =
            json_pack("{s:s, s:s*, s:s*}", "name", name, "file", file, "view", *rest ? rest : NULL);
    } else {
        view = json_pack("{s:s, s:s}", "name", name, "view", value);
    }
    return json_array_append_new(r->lists[VIEWS], view)
               ? fail(r, ORL_ERR_SYNTAX, "a view is no UTF-8", name, "Rename its file")
               : 0;
}

static bool is_blank(const char *text)
{
    return text[strspn(text, " \t\r")] == '\0';
}

/* "WIDTH [HEIGHT [ASPECT]]" */
static int set_size(struct reading *r, char *value)
{
    char *end;
    const long width = strtol(value, &end, 10);
    const long height = is_blank(end) ? width : strtol(end, &end, 10);
    const double aspect = is_blank(end) ? 1 : strtod(end, &end);
    if (width < 1 || width > MOST_SIDE || height < 1 || height > MOST_SIDE || !is_blank(end) ||
        !(aspect == 0 || (aspect >= 1e-3 && aspect <= 1e3)))
        return fail(r, ORL_ERR_SYNTAX, "this is no resolution", value,
                    "One or two numbers from 1 to 16384 are wanted, or a third: pixels' aspect");
    r->width = (int)width;
    r->height = (int)height;
    r->aspect = aspect;
    return 0;
}

/* Options of rpict: what this program heeds of them. */
static int heed_options(struct reading *r, char *value)
{
    for (char *word; (word = next_word(&value)) != NULL;)
        if (strcmp(word, "-bv-") == 0 || strcmp(word, "-bv+") == 0)
            r->backs_unseen = word[3] == '-';
    return 0;
}

static bool is_named(const char *word, const char *name)
{
    const size_t length = strlen(word);
    return length >= LEAST_LETTERS && length <= strlen(name) &&
           strncasecmp(word, name, length) == 0;
}

static int read_assignment(struct reading *r, char *line)
{
    char *value = strchr(line, '='), *name;
    line += strspn(line, " \t\r");
    if (!*line)
        return 0;
    if (!value)
        return fail(r, ORL_ERR_SYNTAX, "the line assigns nothing", line,
                    "Lines are NAME= value, or begin with '#'");
    *value++ = '\0';
    name = next_word(&line);
    if (!name)
        return fail(r, ORL_ERR_SYNTAX, "a name is missing before the value", value,
                    "Lines are NAME= value, or begin with '#'");
    return is_named(name, "materials")    ? add_files(r, r->lists[MATERIALS], value)
           : is_named(name, "illum")      ? add_files(r, r->lists[ILLUM], value)
           : is_named(name, "scene")      ? add_files(r, r->lists[SCENE], value)
           : is_named(name, "objects")    ? leave_objects(r, value)
           : is_named(name, "view")       ? add_view(r, value)
           : is_named(name, "RESOLUTION") ? set_size(r, value)
           : is_named(name, "render") || is_named(name, "rpict") ? heed_options(r, value)
                                                                 : 0;
}

/* One line with those that go on, without comments. Returns what follows it. */
static const char *take_line(struct reading *r, const char *at, const char *end, char *ret_line,
                             int *rc)
{
    size_t length = 0;
    bool comment = false;
    for (; at < end; at++) {
        if (*at == '\\' && at + 1 < end && (at[1] == '\n' || at[1] == '\r')) {
            at += at[1] == '\r' && at + 2 < end;
            at++;
            r->line++;
            ret_line[length < LINE_SIZE - 1 ? length++ : length] = ' ';
            continue;
        }
        if (*at == '\n')
            break;
        comment = comment || *at == '#';
        if (!comment && length < LINE_SIZE - 1)
            ret_line[length++] = *at ? *at : ' ';
        else if (!comment)
            *rc = fail(r, ORL_ERR_SYNTAX, "a line is longer than bytes may be", "8191",
                       "Assign materials, illum, scene or view several times");
    }
    ret_line[length] = '\0';
    return at < end ? at + 1 : end;
}

static json_t *make_project(struct reading *r)
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
    struct reading r = {.name = name, .width = SIDE, .height = SIDE, .aspect = 1, .err = err};
    char *line = malloc(LINE_SIZE);
    int rc = line ? 0 : no_memory(&r);
    for (size_t i = 0; i < 4; i++)
        r.lists[i] = json_array();
    r.left_out = json_array();
    r.commands = json_array();
    for (const char *at = text; at < text + size && rc == 0;) {
        r.line++;
        const int first = r.line;
        at = take_line(&r, at, text + size, line, &rc);
        const int last = r.line;
        r.line = first;
        rc = rc ? rc : read_assignment(&r, line);
        r.line = last;
    }
    if (rc == 0 && json_array_size(r.lists[SCENE]) == 0)
        rc = fail(&r, ORL_ERR_SYNTAX, "no scene files are named", name,
                  "rad then takes an octree that is there: name the files that it was made of");
    if (rc == 0 && !(*ret_project = make_project(&r)))
        rc = no_memory(&r);
    for (size_t i = 0; i < 4; i++)
        json_decref(r.lists[i]);
    json_decref(r.left_out);
    json_decref(r.commands);
    free(line);
    return rc;
}
