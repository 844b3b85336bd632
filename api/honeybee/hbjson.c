#include "honeybee/hbjson.h"

#include <string.h>

#include "honeybee/model_objects.h"
#include "honeybee/modifiers.h"

bool orl_hbjson_is_model(const json_t *document)
{
    const char *type = json_string_value(json_object_get(document, "type"));
    return type && strcmp(type, "Model") == 0;
}

/* Reads the tolerance; the default is Honeybee's for the model's unit. */
static int read_tolerance(struct orl_hb *hb)
{
    static const struct {
        const char *unit;
        double tolerance;
    } units[] = {
        {"Meters", 0.01}, {"Millimeters", 1}, {"Centimeters", 1}, {"Feet", 0.01}, {"Inches", 0.1}};
    const struct orl_hb_at in_units = {NULL, "units", 0}, in_tolerance = {NULL, "tolerance", 0};
    const json_t *named = orl_hb_get(hb->model, "units"),
                 *tolerance = orl_hb_get(hb->model, "tolerance");
    const char *unit = named ? json_string_value(named) : "Meters";
    size_t i = 0;
    while (i < sizeof units / sizeof *units && (!unit || strcmp(units[i].unit, unit) != 0))
        i++;
    if (i == sizeof units / sizeof *units)
        return orl_hb_fail(
            &in_units, hb->err, ORL_ERR_INVALID,
            "one of Meters, Millimeters, Centimeters, Feet and Inches is expected here");
    hb->tolerance = units[i].tolerance;
    const int rc = tolerance ? orl_hb_number(hb, tolerance, &in_tolerance, &hb->tolerance) : 0;
    if (rc == 0 && hb->tolerance < 0)
        return orl_hb_fail(&in_tolerance, hb->err, ORL_ERR_RANGE, "it must be 0 or above");
    return rc;
}

/* Refuses Dragonfly models, which have the same type but storeys instead of rooms. */
static int refuse_dragonfly(struct orl_hb *hb)
{
    if (!json_object_get(hb->model, "buildings"))
        return 0;
    orl_hb_fail(&(struct orl_hb_at){NULL, "buildings", 0}, hb->err, ORL_ERR_UNSUPPORTED,
                "this is a Dragonfly model");
    orl_error_hint(hb->err,
                   "Convert it to Honeybee models first: dragonfly translate model-to-honeybee");
    return ORL_ERR_UNSUPPORTED;
}

/* Refuses a model without surfaces: grids and views alone are no scene. */
static int refuse_empty(struct orl_hb *hb)
{
    static const char *const members[] = {"rooms",          "orphaned_faces",  "orphaned_apertures",
                                          "orphaned_doors", "orphaned_shades", "shade_meshes"};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (json_array_size(json_object_get(hb->model, members[i])) > 0)
            return 0;
    return orl_hb_fail(&(struct orl_hb_at){NULL, "rooms", 0}, hb->err, ORL_ERR_INVALID,
                       "the model is empty: it has no rooms, faces, openings or shades");
}

static int write_files(struct orl_hb *hb)
{
    struct orl_hb_groups groups = {0};
    int rc = refuse_dragonfly(hb);
    if (rc == 0)
        rc = refuse_empty(hb);
    if (rc == 0)
        rc = read_tolerance(hb);
    if (rc == 0)
        rc = orl_hb_modifiers_read(hb);
    if (rc == 0)
        rc = orl_hb_sets_read(hb);
    if (rc == 0)
        rc = orl_hb_surfaces_write(hb, &groups);
    if (rc == 0)
        rc = orl_hb_groups_write(hb, &groups);
    if (rc == 0)
        rc = orl_hb_luminaires_write(hb);
    if (rc == 0)
        rc = orl_hb_grids_write(hb);
    if (rc == 0)
        rc = orl_hb_views_write(hb);
    if (rc == 0)
        rc = orl_hb_warnings_end(hb);
    orl_hb_discard(&hb->warnings);
    orl_hb_groups_done(&groups);
    return rc;
}

int orl_hbjson_translate(const json_t *model, struct orl_text_files *ret_files,
                         struct orl_error *err)
{
    struct orl_hb hb = {.model = model, .err = err};
    int rc = orl_hbjson_is_model(model)
                 ? write_files(&hb)
                 : orl_hb_fail(&(struct orl_hb_at){NULL, "type", 0}, err, ORL_ERR_INVALID,
                               "the document is not a Honeybee model");
    orl_hb_modifiers_done(&hb);
    if (rc) {
        orl_text_files_done(&hb.files);
        return rc;
    }
    *ret_files = hb.files;
    return 0;
}
