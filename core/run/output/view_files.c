/* The files of a finished view. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/exr.h"
#include "render/picture/error_map.h"
#include "render/picture/false_color.h"
#include "run/diagnostics/run_warnings.h"
#include "run/output/output_files.h"
#include "run/run_state.h"
#include "run/stages/view_glare.h"

/* Context of files written in parallel, and their results. */
struct view_writer {
    const struct orl_film *film;
    struct orl_view view;
    struct orl_tonemapped tonemapped; /* set if one of the files is tone-mapped */
    const struct orl_false_color *colors;
    struct orl_scale scale; /* scale of the false colours */
    size_t count;
    struct {
        enum orl_picture picture;
        char path[4096];
        struct orl_error err;
        int code;
    } files[ORL_PICTURES];
};

static int write_picture(const struct view_writer *w, enum orl_picture picture, const char *path,
                         struct orl_error *err)
{
    switch (picture) {
    case ORL_PICTURE_HDR:
        return orl_film_write_hdr(w->film, &w->view, path, err);
    case ORL_PICTURE_PNG:
        return orl_tonemapped_write_png(&w->tonemapped, 8, path, err);
    case ORL_PICTURE_PNG16:
        return orl_tonemapped_write_png(&w->tonemapped, 16, path, err);
    case ORL_PICTURE_EXR:
    case ORL_PICTURE_EXR_FLOAT:
        return orl_exr_write(w->film, &w->view, picture == ORL_PICTURE_EXR, path, err);
    case ORL_PICTURE_FALSE:
    case ORL_PICTURE_LINES:
    case ORL_PICTURE_BANDS:
        return orl_false_color_write(w->film, &w->tonemapped, &w->scale, w->colors, picture, path,
                                     err);
    case ORL_PICTURE_ERROR_HDR:
        return orl_film_write_error_hdr(w->film, &w->view, path, err);
    case ORL_PICTURE_ERROR_PNG:
        return orl_film_write_error_png(w->film, path, err);
    default:
        return orl_error_set(err, ORL_ERR_INTERNAL, "no such picture");
    }
}

static void write_file(void *arg, size_t index, uint32_t member)
{
    struct view_writer *w = arg;
    (void)member;
    w->files[index].code =
        write_picture(w, w->files[index].picture, w->files[index].path, &w->files[index].err);
}

static int path_of(const struct orl_run_state *state, const char *file, char ret_path[4096],
                   struct orl_error *err)
{
    const int length = snprintf(ret_path, 4096, "%s/%s", state->env->output_folder, file);
    if (length < 0 || length >= 4096)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of the output folder is too long");
    return 0;
}

/* Returns name.ending with the run's prefix, owned by the caller; NULL if out of memory. */
static char *file_name(const struct orl_run_state *state, const char *name, const char *ending)
{
    const char *prefix = state->env->file_prefix ? state->env->file_prefix : "";
    const size_t size = strlen(prefix) + strlen(name) + strlen(ending) + 2;
    char *file = malloc(size);
    if (file)
        snprintf(file, size, "%s%s.%s", prefix, name, ending);
    return file;
}

/* Returns the pictures to write, as bits. */
static uint32_t pictures_of(const struct orl_view_request *request, const struct orl_film *film)
{
    uint32_t pictures = request->formats ? request->formats : ORL_PICTURES_DEFAULT;
    if (request->false_color.asked)
        pictures |= request->false_color.pictures ? request->false_color.pictures
                                                  : ORL_PICTURE_BIT(ORL_PICTURE_FALSE);
    if (orl_film_has_errors(film))
        pictures |= ORL_PICTURE_BIT(ORL_PICTURE_ERROR_HDR) | ORL_PICTURE_BIT(ORL_PICTURE_ERROR_PNG);
    return pictures;
}

/* Tone-mapped pictures. */
static const uint32_t tone_mapped =
    ORL_PICTURE_BIT(ORL_PICTURE_PNG) | ORL_PICTURE_BIT(ORL_PICTURE_PNG16) |
    ORL_PICTURE_BIT(ORL_PICTURE_LINES) | ORL_PICTURE_BIT(ORL_PICTURE_BANDS);

/* Sets the files' names in the result, and their paths. */
static int name_files(const struct orl_run_state *state, uint32_t pictures,
                      struct orl_view_result *result, struct view_writer *view_writer,
                      struct orl_error *err)
{
    for (int i = 0; i < ORL_PICTURES; i++) {
        const enum orl_picture picture = (enum orl_picture)i;
        if (!(pictures & ORL_PICTURE_BIT(picture)))
            continue;
        result->files[i] = file_name(state, result->name, orl_picture_ending(picture));
        if (!result->files[i])
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        const size_t at = view_writer->count++;
        view_writer->files[at].picture = picture;
        const int code = path_of(state, result->files[i], view_writer->files[at].path, err);
        if (code < 0)
            return code;
    }
    return 0;
}

static int write_files(const struct orl_run_state *state, struct view_writer *view_writer,
                       struct orl_error *err)
{
    orl_parallel_for(state->env->pool, view_writer->count, write_file, view_writer);
    for (size_t i = 0; i < view_writer->count; i++)
        if (view_writer->files[i].code < 0) {
            if (err)
                *err = view_writer->files[i].err;
            return view_writer->files[i].code;
        }
    return 0;
}

/* Makes the scale of false colours, and evaluates the named points. */
static int make_color_scale(const struct orl_view_request *request, struct view_writer *view_writer,
                            struct orl_view_result *result, struct orl_error *err)
{
    const struct orl_false_color *colors = &request->false_color;
    view_writer->colors = colors;
    if (!colors->asked)
        return 0;
    result->points = calloc(colors->n_points + 1, sizeof *result->points);
    if (!result->points ||
        orl_scale_make(&view_writer->scale, view_writer->film, colors, request->irradiance) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for false colours");
    result->scale = view_writer->scale.top;
    for (; result->n_points < colors->n_points; result->n_points++) {
        const struct orl_picture_point *point = &colors->points[result->n_points];
        struct orl_point_value *value = &result->points[result->n_points];
        memcpy(value->name, point->name, sizeof value->name);
        value->value =
            orl_false_color_at(view_writer->film, &view_writer->scale, point->x, point->y);
    }
    return 0;
}

static int write_all(const struct orl_run_state *state, const struct orl_view_request *request,
                     struct orl_view_result *result, struct view_writer *view_writer,
                     struct orl_error *err)
{
    const uint32_t pictures = pictures_of(request, view_writer->film);
    int code = orl_view_parse(request->view, &view_writer->view, err);
    if (code == 0)
        code = name_files(state, pictures, result, view_writer, err);
    if (code == 0)
        code = make_color_scale(request, view_writer, result, err);
    if (code == 0 && (pictures & tone_mapped) &&
        orl_tonemapped_init(&view_writer->tonemapped, view_writer->film, &view_writer->view,
                            &request->display) < 0)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a picture");
    if (code == 0)
        code = write_files(state, view_writer, err);
    orl_tonemapped_done(&view_writer->tonemapped);
    return code;
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
    struct view_writer *view_writer = calloc(1, sizeof *view_writer);
    orl_view_result_done(result); /* from an earlier round */
    result->name = strdup(request->name);
    if (!result->name || !view_writer) {
        free(view_writer);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    view_writer->film = film;
    result->black = is_black(film);
    int code = orl_run_evaluate_glare(state, index, film, err);
    if (code == 0)
        code = write_all(state, request, result, view_writer, err);
    if (code == 0 && result->files[ORL_PICTURE_EXR] && orl_exr_exceeds_halves(film))
        orl_run_warn_once(state,
                          "%s: brighter than %d W/sr/m2, the most that halves hold, stands there "
                          "as that; \"exr_float\" has it as it is",
                          result->files[ORL_PICTURE_EXR], ORL_EXR_LARGEST_HALF);
    free(view_writer);
    return code;
}
