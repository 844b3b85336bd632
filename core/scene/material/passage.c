#include "scene/material/passage.h"

#include <stdlib.h>

#include "bsdf/incident.h"
#include "scene/material/kinds.h"

struct orl_passage {
    const struct orl_material *material;
    struct orl_vec3 towards;
    struct orl_frame frame;
    struct orl_incident *incident;
};

int orl_passage_new(const struct orl_material *material, struct orl_vec3 normal,
                    struct orl_vec3 towards, double half_angle_rad,
                    struct orl_passage **ret_passage)
{
    *ret_passage = NULL;
    if (!orl_panel_is_data_alone(material))
        return 0;
    struct orl_passage *passage = calloc(1, sizeof *passage);
    if (!passage)
        return ORL_ERR_NOMEM;
    passage->material = material;
    passage->towards = towards;
    passage->frame = orl_bsdf_frame(material, normal);
    const int code = orl_incident_new(material->bsdf, orl_to_local(&passage->frame, towards),
                                      half_angle_rad, &passage->incident);
    if (code < 0 || !passage->incident) {
        free(passage);
        return code;
    }
    *ret_passage = passage;
    return 0;
}

static bool is_same(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool orl_passage_serves(const struct orl_passage *passage, const struct orl_material *material,
                        struct orl_vec3 normal, struct orl_vec3 towards)
{
    return passage->material == material && is_same(passage->frame.n, normal) &&
           is_same(passage->towards, towards);
}

void orl_passage_free(struct orl_passage *passage)
{
    if (!passage)
        return;
    orl_incident_free(passage->incident);
    free(passage);
}

struct orl_scatter orl_passage_sample(const struct orl_passage *passage, struct orl_vec3 from,
                                      const double u[3])
{
    struct orl_scatter s = {.event = ORL_EVENT_ABSORBED, .transmitted = true};
    struct orl_vec3 out;
    if (!orl_incident_sample(passage->incident, orl_to_local(&passage->frame, from), u, &out,
                             &s.weight))
        return s;
    s.event = ORL_EVENT_GLOSSY;
    s.direction = orl_to_world(&passage->frame, out);
    return s;
}
