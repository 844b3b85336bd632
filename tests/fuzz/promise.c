#include "fuzz/fuzz.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "light/daylight/daylight.h"
#include "scene/parsed_scene.h"
#include "json/problem.h"

void fuzz_promise(bool holds, const char *what, const char *file, int line)
{
    if (holds)
        return;
    fprintf(stderr, "%s:%d: broken promise: %s\n", file, line, what);
    abort();
}

static void check_text(const char *text, size_t size)
{
    FUZZ_PROMISE(memchr(text, '\0', size) != NULL);
}

void fuzz_check_error(int code, const struct orl_error *err)
{
    char line[4 * ORL_ERROR_TEXT_MAX];
    int status = 0;
    json_t *problem;
    FUZZ_PROMISE(code < 0 && code >= ORL_ERR_INTERNAL);
    FUZZ_PROMISE(code != ORL_ERR_INTERNAL);
    FUZZ_PROMISE(err->code == code);
    FUZZ_PROMISE(err->line >= 0);
    check_text(err->file, sizeof err->file);
    check_text(err->primitive, sizeof err->primitive);
    check_text(err->message, sizeof err->message);
    check_text(err->hint, sizeof err->hint);
    FUZZ_PROMISE(err->message[0] != '\0');
    orl_error_format(err, line, sizeof line);
    FUZZ_PROMISE(line[0] != '\0');
    problem = orl_problem_from_error(err, &status);
    FUZZ_PROMISE(problem != NULL);
    FUZZ_PROMISE(status >= 400 && status < 600);
    json_decref(problem);
}

void fuzz_check_finite(struct orl_vec3 v)
{
    FUZZ_PROMISE(isfinite(v.x) && isfinite(v.y) && isfinite(v.z));
}

void fuzz_check_unit(struct orl_vec3 v)
{
    fuzz_check_finite(v);
    FUZZ_PROMISE(fabs(orl_length(v) - 1) < 1e-6);
}

void fuzz_check_surfaces(const struct orl_parsed_scene *parsed_scene)
{
    for (size_t i = 0; i < parsed_scene->n_surfaces; i++) {
        const struct orl_surface *surface = &parsed_scene->surfaces[i];
        FUZZ_PROMISE(surface->material < parsed_scene->n_materials);
        fuzz_check_unit(surface->normal);
        for (uint32_t k = 0; k < surface->n_vertices; k++)
            fuzz_check_finite(surface->vertices[k]);
    }
}

void fuzz_check_daylight(const struct orl_daylight *daylight)
{
    static const struct orl_vec3 directions[] = {
        {0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -0.96, 0.28}, {-0.6, 0.64, 0.48}};
    check_text(daylight->warnings, sizeof daylight->warnings);
    if (daylight->black)
        return;
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++) {
        const double value = orl_sky_brightness(&daylight->pattern, directions[i]);
        FUZZ_PROMISE(isfinite(value) && value >= 0);
    }
    FUZZ_PROMISE(isfinite(daylight->sun_radiance) && daylight->sun_radiance >= 0);
    if (daylight->sun_radiance > 0) {
        fuzz_check_unit(daylight->sun);
        FUZZ_PROMISE(daylight->sun_angle_deg > 0 && daylight->sun_angle_deg < 10);
    }
}

/* ---- Projects ---------------------------------------------------------------------------------
 */

static bool has_file(const json_t *project, const char *name)
{
    const json_t *file;
    size_t i;
    json_array_foreach(json_object_get(project, "files"), i, file)
    {
        if (strcmp(json_string_value(file), name) == 0)
            return true;
    }
    return false;
}

void fuzz_check_project(const json_t *project)
{
    static const char *const lists[] = {"files", "grids", "views", "skies", "left_out", "commands"};
    const json_t *each;
    size_t i;
    for (i = 0; i < sizeof lists / sizeof *lists; i++)
        FUZZ_PROMISE(json_is_array(json_object_get(project, lists[i])));
    json_array_foreach(json_object_get(project, "files"), i, each)
        FUZZ_PROMISE(json_string_length(each) > 0);
    json_array_foreach(json_object_get(project, "views"), i, each)
    {
        FUZZ_PROMISE(json_string_length(json_object_get(each, "name")) > 0);
        FUZZ_PROMISE(json_object_get(each, "view") || json_object_get(each, "file"));
    }
    json_array_foreach(json_object_get(project, "commands"), i, each)
        FUZZ_PROMISE(has_file(project, json_string_value(json_object_get(each, "name"))));
}
