/* The files of a finished view. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/error_map.h"
#include "run/stages.h"

typedef int (*file_writer)(const struct orl_film *film, const struct orl_view *view,
                           const char *path, struct orl_error *err);

static int write_png(const struct orl_film *film, const struct orl_view *view, const char *path,
                     struct orl_error *err)
{
    (void)view;
    return orl_film_write_png(film, path, err);
}

static int write_error_png(const struct orl_film *film, const struct orl_view *view,
                           const char *path, struct orl_error *err)
{
    (void)view;
    return orl_film_write_error_png(film, path, err);
}

enum { FILES = 4, FILES_WITHOUT_ERRORS = 2 };

/* What is written, side by side, and how it went. */
struct writing {
    const struct orl_film *film;
    struct orl_view view;
    struct {
        file_writer write;
        char path[4096];
        struct orl_error err;
        int code;
    } files[FILES];
};

static void write_file(void *arg, size_t index, uint32_t member)
{
    struct writing *w = arg;
    (void)member;
    w->files[index].code =
        w->files[index].write(w->film, &w->view, w->files[index].path, &w->files[index].err);
}

static int path_of(const struct orl_run_state *state, const char *file, char ret_path[4096],
                   struct orl_error *err)
{
    const int length = snprintf(ret_path, 4096, "%s/%s", state->env->output_folder, file);
    if (length < 0 || length >= 4096)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
    return 0;
}

/* name.ending with the run's prefix, owned; NULL when out of memory. */
static char *file_name(const struct orl_run_state *state, const char *name, const char *ending)
{
    const char *prefix = state->env->file_prefix ? state->env->file_prefix : "";
    const size_t size = strlen(prefix) + strlen(name) + strlen(ending) + 2;
    char *file = malloc(size);
    if (file)
        snprintf(file, size, "%s%s.%s", prefix, name, ending);
    return file;
}

/* Of an earlier round. */
static void forget_files(struct orl_view_result *result)
{
    free(result->name);
    free(result->hdr);
    free(result->png);
    free(result->error_hdr);
    free(result->error_png);
    *result = (struct orl_view_result){.seconds = result->seconds};
}

/* Names of the files in the result, and their paths. */
static int name_files(const struct orl_run_state *state, struct orl_view_result *result,
                      struct writing *writing, size_t count, struct orl_error *err)
{
    static const struct {
        const char *ending;
        file_writer write;
    } kinds[FILES] = {{"hdr", orl_film_write_hdr},
                      {"png", write_png},
                      {"error.hdr", orl_film_write_error_hdr},
                      {"error.png", write_error_png}};
    char **const names[FILES] = {&result->hdr, &result->png, &result->error_hdr,
                                 &result->error_png};
    for (size_t i = 0; i < count; i++) {
        *names[i] = file_name(state, result->name, kinds[i].ending);
        if (!*names[i])
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        writing->files[i].write = kinds[i].write;
        const int code = path_of(state, *names[i], writing->files[i].path, err);
        if (code < 0)
            return code;
    }
    return 0;
}

static int write_files(const struct orl_run_state *state, struct writing *writing, size_t count,
                       struct orl_error *err)
{
    orl_crew_for(state->env->crew, count, write_file, writing);
    for (size_t i = 0; i < count; i++)
        if (writing->files[i].code < 0) {
            if (err)
                *err = writing->files[i].err;
            return writing->files[i].code;
        }
    return 0;
}

static bool is_black(const struct orl_film *film)
{
    const size_t count = (size_t)film->width * film->height;
    for (size_t i = 0; i < count; i++)
        if (film->pixels[i][0] != 0 || film->pixels[i][1] != 0 || film->pixels[i][2] != 0)
            return false;
    return true;
}

int orl_run_write_view(struct orl_run_state *state, size_t index, const struct orl_film *film,
                       struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view_result *result = &state->result->views[index];
    const size_t count = orl_film_knows_errors(film) ? FILES : FILES_WITHOUT_ERRORS;
    struct writing *writing = calloc(1, sizeof *writing);
    forget_files(result);
    result->name = strdup(request->name);
    if (!result->name || !writing) {
        free(writing);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    writing->film = film;
    result->black = is_black(film);
    int code = orl_view_parse(request->view, &writing->view, err);
    if (code == 0)
        code = name_files(state, result, writing, count, err);
    if (code == 0)
        code = write_files(state, writing, count, err);
    free(writing);
    return code;
}
