/* Views in files, and the sizes of their pictures. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

#include "render/film/film.h"
#include "run/request/job_inputs.h"
#include "run/stages/rendering.h"

enum { LINE_MAX_BYTES = 4096, NAME_MAX_BYTES = 64 };

/* A line of a view file: its options, and its name if it has one. */
struct view_line {
    char text[LINE_MAX_BYTES], name[NAME_MAX_BYTES];
    int number; /* line number in its file */
};

/* Returns the text after a leading word, or NULL if it does not begin with it. */
static const char *skip_word(const char *text, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(text, word, length) == 0 ? text + length : NULL;
}

/* Parses the name in rad's "view= name options". */
static const char *take_name(const char *text, struct view_line *line)
{
    text += strspn(text, " \t");
    const size_t length = strcspn(text, " \t");
    if (*text == '-' || length == 0 || length >= NAME_MAX_BYTES)
        return text;
    memcpy(line->name, text, length);
    line->name[length] = '\0';
    return text + length;
}

/* Returns true if a NUL-terminated line is a view. */
static bool read_line(const char *text, struct view_line *line)
{
    static const char *const programs[] = {"VIEW=", "rpict ", "rvu ", "rview "};
    const char *options = NULL;
    text += strspn(text, " \t");
    line->name[0] = '\0';
    for (size_t i = 0; i < sizeof programs / sizeof *programs && !options; i++)
        options = skip_word(text, programs[i]);
    if (!options && skip_word(text, "view="))
        options = take_name(skip_word(text, "view="), line);
    if (!options && (skip_word(text, "-v") || skip_word(text, "-x") || skip_word(text, "-y")))
        options = text;
    if (options)
        snprintf(line->text, sizeof line->text, "%s", options);
    return options;
}

/* Finds the next view of a file; returns false if there is none. A picture's header counts as such
 * a file. */
static bool next_view(struct orl_scanner *scanner, struct view_line *line)
{
    struct orl_slice text;
    char buffer[LINE_MAX_BYTES];
    while (orl_scanner_line(scanner, &text)) {
        while (text.length > 0 && text.text[text.length - 1] == 0x1a) /* trailing Ctrl-Z */
            text.length--;
        if (text.length >= sizeof buffer || memchr(text.text, '\0', text.length))
            continue;
        memcpy(buffer, text.text, text.length);
        buffer[text.length] = '\0';
        line->number = scanner->line;
        if (read_line(buffer, line))
            return true;
    }
    return false;
}

/* Returns true if a line is the requested view, by name or number. */
static bool is_entry(const struct view_line *line, int which, const char *entry)
{
    char number[16];
    snprintf(number, sizeof number, "%d", which);
    return !entry || strcmp(line->name, entry) == 0 || strcmp(number, entry) == 0;
}

static int find_view(struct orl_scanner *scanner, const char *entry, struct view_line *ret_found,
                     struct orl_error *err)
{
    struct view_line line = {.number = 0};
    int count = 0, found = 0;
    while (next_view(scanner, &line)) {
        count++;
        if (is_entry(&line, count, entry) && found++ == 0)
            *ret_found = line;
    }
    if (count == 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the file has no views");
    if (found == 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the file has %d views, but none is '%s'",
                             count, entry);
    if (!entry && count > 1) {
        ret_found->number = 0;
        orl_error_set(err, ORL_ERR_INVALID, "the file has %d views", count);
        orl_error_hint(err, "Choose one with \"entry\": its number, from 1, or its name");
        return ORL_ERR_INVALID;
    }
    return 0;
}

int orl_view_file_read(const char *name, const char *text, size_t size, const char *entry,
                       char **ret_text, struct orl_error *err)
{
    struct view_line *found = calloc(1, sizeof *found);
    struct orl_view view;
    struct orl_scanner scanner;
    char *copy = NULL;
    int code = ORL_ERR_NOMEM;
    if (found)
        code = orl_scanner_init(&scanner, name, text, size, ORL_SCANNER_TEXT_HEADER, err);
    if (found && code == 0)
        code = find_view(&scanner, entry, found, err);
    if (code == 0)
        code = orl_view_parse(found->text, &view, err);
    if (code < 0)
        orl_error_at(err, name, found ? found->number : 0, entry);
    else
        copy = strdup(found->text);
    free(found);
    if (code < 0 && code != ORL_ERR_NOMEM)
        return code;
    if (!copy)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a view");
    *ret_text = copy;
    return 0;
}

char *orl_view_text_join(const char *options, const char *more)
{
    const size_t size = strlen(options) + (more ? strlen(more) : 0) + 2;
    char *joined = malloc(size);
    if (joined)
        snprintf(joined, size, "%s%s%s", options, more ? " " : "", more ? more : "");
    return joined;
}

int orl_view_text_size(const char *text, uint32_t *ret_width, uint32_t *ret_height,
                       struct orl_error *err)
{
    struct orl_view view;
    const int code = orl_view_parse(text, &view, err);
    if (code == 0) {
        *ret_width = view.x;
        *ret_height = view.y;
    }
    return code;
}

bool orl_view_text_is_fisheye(const char *text)
{
    const double whole_deg = 180 - 1e-6;
    struct orl_view view;
    return orl_view_parse(text, &view, NULL) == 0 && (view.type == 'a' || view.type == 'h') &&
           view.horizontal >= whole_deg && view.vertical >= whole_deg;
}

/* ---- Views of a job -------------------------------------------------------------------------- */

static int read_view(const struct orl_files *files, struct orl_view_request *view,
                     struct orl_error *err)
{
    struct orl_file file;
    char *options = NULL;
    int code = files->open(files->ctx, view->file, &file, err);
    if (code < 0)
        return code;
    code = orl_view_file_read(view->file, file.data, file.size, view->entry, &options, err);
    files->close(files->ctx, &file);
    if (code < 0)
        return code;
    char *whole = options ? orl_view_text_join(options, view->view) : NULL;
    free(options);
    if (!whole)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a view");
    view->view = whole;
    return 0;
}

/* Checks the named points again, because the pixel aspect may have reduced the requested size. */
static int check_points(const struct orl_view_request *view, struct orl_error *err)
{
    for (uint32_t i = 0; i < view->false_color.n_points; i++) {
        const struct orl_picture_point *point = &view->false_color.points[i];
        if (point->x <= view->width && point->y <= view->height)
            continue;
        orl_error_set(err, ORL_ERR_RANGE,
                      "view '%s': point '%s' at %g, %g lies outside the picture", view->name,
                      point->name, point->x, point->y);
        orl_error_hint(err, "With its pixel aspect the picture has %u x %u pixels", view->width,
                       view->height);
        return ORL_ERR_RANGE;
    }
    return 0;
}

static int resolve_view(const struct orl_files *files, struct orl_view_request *view,
                        struct orl_error *err)
{
    struct orl_view parsed = {.type = 'v'};
    int code = view->file ? read_view(files, view, err) : 0;
    if (code == 0)
        code = orl_view_parse(view->view ? view->view : "", &parsed, err);
    if (code < 0 && err && err->file[0] == '\0')
        orl_error_at(err, NULL, 0, view->name);
    if (code < 0)
        return code;
    view->file = NULL;
    orl_view_fit(&parsed, view->pixel_aspect > 0 ? view->pixel_aspect : parsed.pixel_aspect,
                 &view->width, &view->height);
    code = check_points(view, err);
    if (code < 0)
        return code;
    /* Report a bad mask before anything is rendered. */
    float *mask;
    code = orl_run_read_mask(files, view, &mask, err);
    free(mask);
    return code;
}

/* Invalid jobs are left as they are; later validation reports the error. */
int orl_run_resolve_views(const struct orl_job *job, const struct orl_files *files,
                          struct orl_view_request **ret_views, struct orl_error *err)
{
    const bool sound = orl_job_validate(job, NULL) == 0;
    struct orl_view_request *views;
    int code = 0;
    *ret_views = job->views;
    if (!sound || job->n_views == 0)
        return 0;
    views = calloc(job->n_views, sizeof *views);
    if (!views)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for views");
    memcpy(views, job->views, job->n_views * sizeof *views);
    for (size_t i = 0; i < job->n_views && code == 0; i++)
        code = resolve_view(files, &views[i], err);
    *ret_views = views;
    return code;
}

void orl_run_views_done(const struct orl_job *job, struct orl_view_request *views)
{
    for (size_t i = 0; i < job->n_views; i++)
        if (views[i].view != job->views[i].view)
            free(views[i].view);
    free(views);
}
