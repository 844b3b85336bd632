#include "checks/child/child_previews.h"

#include <math.h>

#include <oriel/base/limits.h>

#include "bsdf_json/bsdf_json.h"
#include "result/scene_json.h"

int orl_child_outline(const json_t *request, struct orl_mapped_inputs *mapped, json_t **ret_result,
                      struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    const json_t *height = json_object_get(request, "height");
    const struct orl_files files = orl_mapped_inputs_provider(mapped);
    const size_t count = orl_bundle_main_count(&mapped->bundle);
    struct orl_floor_plan plan;
    for (size_t i = 0; i < count; i++)
        names[i] = mapped->bundle.files[i].name;
    const int rc = orl_scene_floor_plan(
        names, count, &files, json_is_number(height) ? json_number_value(height) : NAN, &plan, err);
    if (rc == 0) {
        *ret_result = orl_floor_plan_to_json(&plan);
        orl_floor_plan_done(&plan);
    }
    return rc;
}

int orl_child_polar(const json_t *request, const struct orl_mapped_inputs *mapped,
                    json_t **ret_result, struct orl_error *err)
{
    static struct orl_bsdf_polar polar;
    struct orl_bsdf *bsdf = NULL;
    const bool front = json_is_true(json_object_get(request, "front"));
    const double theta = json_number_value(json_object_get(request, "theta_deg"));
    const double phi = json_number_value(json_object_get(request, "phi_deg"));
    const struct orl_bsdf_xml xml = {
        .name = "bsdf.xml", .data = mapped->single.data, .size = mapped->single.size};
    const int rc = orl_bsdf_load(&xml, &bsdf, err);
    if (rc)
        return rc;
    orl_bsdf_polar(bsdf, front, theta, phi, &polar);
    orl_bsdf_unref(bsdf);
    *ret_result = orl_bsdf_polar_to_json(&polar, front, theta, phi);
    return 0;
}
