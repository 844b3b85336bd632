#include "recipe/model_grids.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

/* Units of Honeybee's models. */
static const struct {
    const char *name;
    double metres;
} units[] = {{"Meters", 1},
             {"Millimeters", 0.001},
             {"Feet", 0.3048},
             {"Inches", 0.0254},
             {"Centimeters", 0.01}};

static const char *text_of(const json_t *object, const char *name)
{
    return json_string_value(json_object_get(object, name));
}

static struct orl_vec3 corner(const json_t *vertices, const json_t *index)
{
    const json_t *at = json_array_get(vertices, (size_t)json_integer_value(index));
    return orl_v3(json_number_value(json_array_get(at, 0)),
                  json_number_value(json_array_get(at, 1)),
                  json_number_value(json_array_get(at, 2)));
}

/* Returns the area of a face of a mesh: a fan of triangles around its first corner. */
static double face_area(const json_t *vertices, const json_t *face)
{
    struct orl_vec3 sum = orl_v3(0, 0, 0);
    const struct orl_vec3 first = corner(vertices, json_array_get(face, 0));
    for (size_t i = 1; i + 1 < json_array_size(face); i++)
        sum =
            orl_add(sum, orl_cross(orl_sub(corner(vertices, json_array_get(face, i)), first),
                                   orl_sub(corner(vertices, json_array_get(face, i + 1)), first)));
    return 0.5 * orl_length(sum);
}

static int read_areas(const json_t *asset, struct orl_model_grid *grid)
{
    const json_t *mesh = json_object_get(asset, "mesh"), *faces = json_object_get(mesh, "faces"),
                 *vertices = json_object_get(mesh, "vertices");
    const size_t n = json_array_size(faces),
                 n_sensors = json_array_size(json_object_get(asset, "sensors"));
    if (n == 0 ||
        (n_sensors > 0 && n_sensors != n)) /* without sensors they are the faces' middles */
        return 0;
    grid->areas = malloc(n * sizeof *grid->areas);
    if (!grid->areas)
        return ORL_ERR_NOMEM;
    grid->n_areas = n;
    for (size_t i = 0; i < n; i++)
        grid->areas[i] = face_area(vertices, json_array_get(faces, i));
    return 0;
}

/* Returns the program type of the room of that identifier, or NULL. */
static const char *program_of(const json_t *model, const char *room_identifier)
{
    const json_t *room;
    size_t i;
    json_array_foreach(json_object_get(model, "rooms"), i, room)
    {
        const char *identifier = text_of(room, "identifier");
        if (identifier && room_identifier && strcmp(identifier, room_identifier) == 0)
            return text_of(json_object_get(json_object_get(room, "properties"), "energy"),
                           "program_type");
    }
    return NULL;
}

static int read_grid(const json_t *model, const json_t *asset, struct orl_model_grid *grid)
{
    const char *display = text_of(asset, "display_name"),
               *group = text_of(asset, "group_identifier");
    grid->identifier = text_of(asset, "identifier");
    grid->display_name = display ? display : grid->identifier;
    grid->group = group ? group : "";
    grid->program = program_of(model, text_of(asset, "room_identifier"));
    snprintf(grid->full_id, sizeof grid->full_id, "%s%s%s", grid->group, group ? "/" : "",
             grid->identifier);
    return read_areas(asset, grid);
}

int orl_model_grids_read(const json_t *model, struct orl_model_grids *ret_grids,
                         struct orl_error *err)
{
    const json_t *properties = json_object_get(json_object_get(model, "properties"), "radiance"),
                 *assets = json_object_get(properties, "sensor_grids"), *asset;
    struct orl_model_grids grids = {.metres = 1};
    const char *unit = text_of(model, "units");
    size_t i;
    int rc = 0;
    for (i = 0; unit && i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].name) == 0)
            grids.metres = units[i].metres;
    grids.items = calloc(json_array_size(assets) + 1, sizeof *grids.items);
    if (!grids.items)
        return orl_error_no_memory(err);
    json_array_foreach(assets, i, asset)
    {
        if (rc == 0 && text_of(asset, "identifier"))
            rc = read_grid(model, asset, &grids.items[grids.count++]);
    }
    if (rc) {
        orl_model_grids_done(&grids);
        return orl_error_no_memory(err);
    }
    *ret_grids = grids;
    return 0;
}

void orl_model_grids_done(struct orl_model_grids *grids)
{
    for (size_t i = 0; i < grids->count; i++)
        free(grids->items[i].areas);
    free(grids->items);
    *grids = (struct orl_model_grids){.items = NULL};
}
