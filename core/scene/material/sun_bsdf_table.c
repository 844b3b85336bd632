#include "scene/material/sun_bsdf_table.h"

#include <stdlib.h>

#include "bsdf/cone_table.h"
#include "scene/material/kinds.h"

struct orl_sun_bsdf_table {
    const struct orl_material *material;
    struct orl_vec3 towards;
    struct orl_frame frame;
    struct orl_cone_table *cone_table;
};

int orl_sun_bsdf_table_new(const struct orl_material *material, struct orl_vec3 normal,
                           struct orl_vec3 towards, double half_angle_rad,
                           struct orl_sun_bsdf_table **ret_table)
{
    *ret_table = NULL;
    if (!orl_bsdf_surface_is_data_only(material))
        return 0;
    struct orl_sun_bsdf_table *sun_bsdf_table = calloc(1, sizeof *sun_bsdf_table);
    if (!sun_bsdf_table)
        return ORL_ERR_NOMEM;
    sun_bsdf_table->material = material;
    sun_bsdf_table->towards = towards;
    sun_bsdf_table->frame = orl_bsdf_frame(material, normal);
    const int code =
        orl_cone_table_new(material->bsdf, orl_to_local(&sun_bsdf_table->frame, towards),
                           half_angle_rad, &sun_bsdf_table->cone_table);
    if (code < 0 || !sun_bsdf_table->cone_table) {
        free(sun_bsdf_table);
        return code;
    }
    *ret_table = sun_bsdf_table;
    return 0;
}

static bool is_same(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool orl_sun_bsdf_table_matches(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                const struct orl_material *material, struct orl_vec3 normal,
                                struct orl_vec3 towards)
{
    return sun_bsdf_table->material == material && is_same(sun_bsdf_table->frame.n, normal) &&
           is_same(sun_bsdf_table->towards, towards);
}

void orl_sun_bsdf_table_free(struct orl_sun_bsdf_table *sun_bsdf_table)
{
    if (!sun_bsdf_table)
        return;
    orl_cone_table_free(sun_bsdf_table->cone_table);
    free(sun_bsdf_table);
}

struct orl_surface_sample orl_sun_bsdf_table_sample(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                                    struct orl_vec3 from, const double u[3])
{
    struct orl_surface_sample s = {.event = ORL_EVENT_ABSORBED, .transmitted = true};
    struct orl_vec3 out;
    if (!orl_cone_table_sample(sun_bsdf_table->cone_table,
                               orl_to_local(&sun_bsdf_table->frame, from), u, &out, &s.weight))
        return s;
    s.event = ORL_EVENT_GLOSSY;
    s.direction = orl_to_world(&sun_bsdf_table->frame, out);
    return s;
}
