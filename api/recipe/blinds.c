/*
 * Blinds for windows without states of their own, as the recipes for LEED and WELL add them: a
 * sheet behind each aperture of a room, which transmits a given share of light diffusely. Apertures
 * of a room that face the same side are a group, which LM-83's rule opens and closes.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "recipe/recipe_run.h"

#define MATERIAL "recipe_blinds"
enum { NAME_SIZE = 192 };
static const double distance_m = 0.001; /* between glass and sheet */
static const double reflectance = 0.5;  /* of the sheet, diffuse */

/* A group of windows while it is collected: its shade, and the text of its sheets. */
struct blinds_writer {
    const struct orl_recipe_run *run;
    json_t *shades, *texts; /* array of shades; {"NAME": text} for each file */
    json_t *closed;         /* names of the files */
    int rc;
};

static const char *text_of(const json_t *object, const char *name)
{
    return json_string_value(json_object_get(object, name));
}

static struct orl_vec3 point_at(const json_t *points, size_t i)
{
    const json_t *at = json_array_get(points, i);
    return orl_v3(json_number_value(json_array_get(at, 0)),
                  json_number_value(json_array_get(at, 1)),
                  json_number_value(json_array_get(at, 2)));
}

/* Returns the unit normal of an outline, which points outdoors, by Newell's method. */
static struct orl_vec3 normal_of(const json_t *points)
{
    struct orl_vec3 sum = orl_v3(0, 0, 0);
    const size_t n = json_array_size(points);
    for (size_t i = 0; i < n; i++)
        sum = orl_add(sum, orl_cross(point_at(points, i), point_at(points, (i + 1) % n)));
    return orl_normalize(sum);
}

/* Returns the side that a window faces, in the scene's axes with +Y as north. */
static const char *side_of(struct orl_vec3 normal)
{
    static const char *const sides[] = {"North", "East", "South", "West"};
    static const double steep = 0.5; /* of the normal's height: 60 degrees from the zenith */
    if (fabs(normal.z) > steep)
        return normal.z > 0 ? "Skylight" : "Down";
    const double quarter = atan2(normal.x, normal.y) / (ORL_PI / 2);
    return sides[(int)(floor(quarter + 0.5) + 4) % 4];
}

/* Returns true if the window has states of its own in the model. */
static bool has_states(const json_t *aperture)
{
    const json_t *radiance = json_object_get(json_object_get(aperture, "properties"), "radiance");
    return text_of(radiance, "dynamic_group_identifier") &&
           json_array_size(json_object_get(radiance, "states")) > 1;
}

/* Finds the group's shade, or adds it. */
static json_t *find_group(struct blinds_writer *writer, const char *name, const char *file)
{
    json_t *shade;
    size_t i;
    json_array_foreach(writer->shades, i, shade)
    {
        if (strcmp(text_of(shade, "name"), name) == 0)
            return shade;
    }
    shade = json_pack("{s:s, s:[], s:[{s:s}, {s:s, s:[s]}], s:{s:s}}", "name", name, "windows",
                      "states", "name", "open", "name", "blinds", "files", file, "control", "by",
                      "LM-83");
    if (!shade || json_array_append_new(writer->shades, shade) ||
        json_array_append_new(writer->closed, json_string(file)))
        writer->rc = ORL_ERR_NOMEM;
    return shade;
}

/* Appends a sheet behind the window to the text of its group's file. */
static void add_sheet(struct blinds_writer *writer, const char *file, const char *identifier,
                      const json_t *points, struct orl_vec3 normal)
{
    const char *before = text_of(writer->texts, file);
    const double distance = distance_m / writer->run->grids.metres;
    const size_t n = json_array_size(points);
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    if (!stream) {
        writer->rc = ORL_ERR_NOMEM;
        return;
    }
    fprintf(stream, "%s\n" MATERIAL " polygon %s_blinds\n0\n0\n%zu\n", before ? before : "",
            identifier, 3 * n);
    for (size_t i = 0; i < n; i++) {
        const struct orl_vec3 p = orl_madd(point_at(points, i), normal, -distance);
        fprintf(stream, "%.10g %.10g %.10g\n", p.x, p.y, p.z);
    }
    fclose(stream);
    if (json_object_set_new(writer->texts, file, json_string(text)))
        writer->rc = ORL_ERR_NOMEM;
    free(text);
}

static void add_window(struct blinds_writer *writer, const json_t *room, const json_t *aperture)
{
    const json_t *points = json_object_get(json_object_get(aperture, "geometry"), "boundary");
    const char *identifier = text_of(aperture, "identifier");
    char name[NAME_SIZE], file[NAME_SIZE + 16];
    if (!identifier || json_array_size(points) < 3 || has_states(aperture))
        return;
    const struct orl_vec3 normal = normal_of(points);
    snprintf(name, sizeof name, "%.150s_%s", text_of(room, "identifier"), side_of(normal));
    snprintf(file, sizeof file, "recipe_%s.rad", name);
    json_t *shade = find_group(writer, name, file);
    if (writer->rc == 0 &&
        json_array_append_new(json_object_get(shade, "windows"), json_string(identifier)))
        writer->rc = ORL_ERR_NOMEM;
    if (writer->rc == 0)
        add_sheet(writer, file, identifier, points, normal);
}

/* Starts each file with the sheet's material: Radiance's trans, of which a share goes straight. */
static int add_material(const struct orl_recipe_run *run, json_t *texts)
{
    const double diffuse = orl_recipe_number(run->inputs, "diffuse-transmission"),
                 specular = orl_recipe_number(run->inputs, "specular-transmission"),
                 through = diffuse + specular;
    const double most = through < 1 ? fmin(reflectance, 1 - through) : 0, color = most + through;
    const char *file;
    json_t *text;
    json_object_foreach(texts, file, text)
    {
        json_t *whole = json_sprintf("void trans " MATERIAL "\n0\n0\n7 %.10g %.10g %.10g 0 0 %.10g "
                                     "%.10g\n%s",
                                     color, color, color, through / color, specular / through,
                                     json_string_value(text));
        if (json_object_set_new(run->files, file, whole))
            return ORL_ERR_NOMEM;
    }
    return 0;
}

/* Collects the windows of all rooms. */
static void add_rooms(struct blinds_writer *writer)
{
    const json_t *room, *face, *aperture;
    size_t i, k, a;
    json_array_foreach(json_object_get(writer->run->model, "rooms"), i, room)
    {
        json_array_foreach(json_object_get(room, "faces"), k, face)
        {
            const char *condition = text_of(json_object_get(face, "boundary_condition"), "type");
            if (!condition || strcmp(condition, "Outdoors") != 0)
                continue;
            json_array_foreach(json_object_get(face, "apertures"), a, aperture)
            {
                add_window(writer, room, aperture);
            }
        }
    }
}

static bool model_has_states(const json_t *model)
{
    const json_t *room, *face, *aperture;
    size_t i, k, a;
    json_array_foreach(json_object_get(model, "rooms"), i, room)
    {
        json_array_foreach(json_object_get(room, "faces"), k, face)
        {
            json_array_foreach(json_object_get(face, "apertures"), a, aperture)
            {
                if (has_states(aperture))
                    return true;
            }
        }
    }
    return false;
}

/* Adds the year with all blinds of this folder's open, or closed. Those of the model stay in their
 * first state; closed ones cannot be chosen without the project's names, and stay, too. */
static int add_fixed(struct orl_recipe_run *run, const json_t *closed, struct orl_error *err)
{
    json_t *document = orl_recipe_year_document(run);
    if (document && closed)
        json_object_set(json_object_get(document, "scene"), "files", (json_t *)(uintptr_t)closed);
    return orl_recipe_add_job(run, document, err);
}

int orl_recipe_blinds_jobs(struct orl_recipe_run *run, struct orl_error *err)
{
    struct blinds_writer writer = {
        .run = run, .shades = json_array(), .texts = json_object(), .closed = json_array()};
    if (!run->model) {
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "this recipe needs a Honeybee model, not a folder");
        writer.rc = ORL_ERR_UNSUPPORTED;
    } else {
        add_rooms(&writer);
    }
    if (writer.rc == 0)
        writer.rc = add_material(run, writer.texts);
    if (writer.rc == ORL_ERR_NOMEM)
        orl_error_no_memory(err);
    const bool has_blinds = json_array_size(writer.shades) > 0;
    if (writer.rc == 0 && has_blinds && !model_has_states(run->model)) {
        writer.rc = add_fixed(run, NULL, err);
        writer.rc = writer.rc ? writer.rc : add_fixed(run, writer.closed, err);
    }
    if (writer.rc == 0) { /* the target makes the project's own groups close by LM-83's rule */
        json_t *document = orl_recipe_year_document(run);
        if (document)
            json_object_set_new(document, "targets", json_pack("[s]", "sDA300/50 >= 55 %"));
        if (document && has_blinds)
            json_object_set(document, "shades", writer.shades);
        writer.rc = orl_recipe_add_job(run, document, err);
    }
    json_decref(writer.shades);
    json_decref(writer.texts);
    json_decref(writer.closed);
    return writer.rc;
}
