/* Finds BSDF panes whose front faces outdoors. By Radiance's convention the front of a window faces
 * the room. */
#include <math.h>
#include <stdio.h>

#include <oriel/bsdf/bsdf.h>

#include "run/cache/scene_cache.h"
#include "run/diagnostics/diagnostics.h"
#include "run/diagnostics/run_warnings.h"
#include "run/run_state.h"
#include "scene/built/scene.h"
#include "scene/material/hemisphere.h"

enum { DIRECTIONS = 16 }; /* number of azimuths, and of steps in the square of the sine */
/* Tolerated differences: of the transmittance, relative to it, and of the reflectance. */
static const double small_transmitted = 0.05, small_reflected = 0.05;

/* Returns the direction, in the frame of the data, that replaces a direction when the pane is
 * turned about its up direction. */
static struct orl_vec3 turned(struct orl_vec3 in)
{
    return orl_v3(-in.x, in.y, -in.z);
}

/* Returns true if a BSDF transmits or reflects other light when its pane is turned round. */
static bool differs_when_turned(const struct orl_bsdf *bsdf)
{
    double transmitted = 0, transmitted_off = 0, reflected_off = 0;
    for (int i = 0; i < DIRECTIONS; i++)
        for (int k = 0; k < DIRECTIONS; k++) {
            const struct orl_vec3 in =
                orl_hemisphere_point((i + 0.5) / DIRECTIONS, (k + 0.5) / DIRECTIONS);
            const double t = orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_TRANSMIT));
            const double u = orl_luma(orl_bsdf_albedo(bsdf, turned(in), ORL_BSDF_TRANSMIT));
            const double r = orl_luma(orl_bsdf_albedo(bsdf, in, ORL_BSDF_REFLECT));
            const double s = orl_luma(orl_bsdf_albedo(bsdf, turned(in), ORL_BSDF_REFLECT));
            transmitted += (t + u) / 2;
            transmitted_off += fabs(t - u);
            reflected_off += fabs(r - s);
        }
    return transmitted_off > small_transmitted * transmitted ||
           reflected_off > small_reflected * DIRECTIONS * DIRECTIONS;
}

void orl_run_warn_of_turned_panes(struct orl_run_state *state)
{
    const struct orl_scene *scene = state->scene;
    const struct orl_bsdf *last = NULL;
    bool differs = false;
    size_t count = 0;
    uint32_t first = 0;
    char others[48] = "";
    for (size_t i = 0; i < scene->n_ports; i++) {
        const struct orl_material *m = orl_scene_material(scene, scene->ports[i].facet);
        if (!scene->ports[i].outside_is_front || m->kind != ORL_MATERIAL_BSDF)
            continue;
        if (m->bsdf != last)
            differs = differs_when_turned(m->bsdf);
        last = m->bsdf;
        if (differs && count++ == 0)
            first = scene->ports[i].facet;
    }
    if (count == 0)
        return;
    const struct orl_surface_label pane = orl_scene_label_of(scene, first);
    if (count > 1)
        snprintf(others, sizeof others, " (and %zu other panes so)", count - 1);
    orl_run_warn(state,
                 "the BSDF pane '%.100s' (%.200s:%d) has its front outdoors%s: Radiance and Oriel "
                 "take the front for the room's side of the data, whose exterior side is indoors "
                 "here; if that is not meant, reverse the order of the corners, or exchange front "
                 "and back in the BSDF file",
                 pane.name, pane.file, pane.line, others);
}
