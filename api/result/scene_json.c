#include "result/scene_json.h"

#include "json/encode.h"

/* Bounds of an empty or infinite scene are not finite, which JSON cannot express; they become
 * null. */
static json_t *point_to_json(const double point[3])
{
    json_t *array = json_array();
    int rc = array ? 0 : -1;
    for (int axis = 0; axis < 3 && rc == 0; axis++) {
        json_t *number = json_real(point[axis]);
        rc = json_array_append_new(array, number ? number : json_null());
    }
    if (rc) {
        json_decref(array);
        return NULL;
    }
    return array;
}

json_t *orl_scene_summary_to_json(const struct orl_scene_summary *summary)
{
    json_t *referenced = json_array();
    for (size_t i = 0; i < summary->n_referenced; i++)
        if (json_array_append_new(referenced, json_string(summary->referenced[i]))) {
            json_decref(referenced);
            return NULL;
        }
    return json_pack(
        "{s:I, s:I, s:I, s:I, s:I, s:I, s:{s:o, s:o}, s:s, s:o}", "surfaces",
        (json_int_t)summary->surfaces, "placed_surfaces", (json_int_t)summary->placed_surfaces,
        "materials", (json_int_t)summary->materials, "sources", (json_int_t)summary->sources,
        "triangles", (json_int_t)summary->triangles, "bsdfs", (json_int_t)summary->bsdfs, "bounds",
        "min", point_to_json(summary->bounds_min), "max", point_to_json(summary->bounds_max),
        "digest", summary->digest, "referenced", referenced);
}

json_t *orl_floor_plan_to_json(const struct orl_floor_plan *plan)
{
    json_t *lines = json_array();
    for (size_t i = 0; lines && i < plan->count; i++) {
        const double *line = plan->lines[i];
        if (json_array_append_new(lines,
                                  json_pack("[f, f, f, f]", line[0], line[1], line[2], line[3]))) {
            json_decref(lines);
            return NULL;
        }
    }
    return json_pack("{s:o, s:{s:o, s:o}, s:o, s:b}", "height", orl_json_from_real(plan->height),
                     "bounds", "min", point_to_json(plan->low), "max", point_to_json(plan->high),
                     "lines", lines, "more", (int)plan->more);
}
