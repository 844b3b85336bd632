#include "plan/decide.h"

#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "light/daylight/daylight.h"
#include "render/film/film.h"
#include "scene/geometry/geometry.h"
#include "scene/material/scatter.h"

enum { SKY_ROWS = 64, SKY_COLUMNS = 128, TIMED_RAYS = 2048, MOST_SENSORS_LOOKED_AT = 4096 };
static const double most_tolerance_lx = 0.01, tolerance_of_all = 1e-6;
static const double sky_margin = 1.1;  /* the peak of a sky lies between its samples */
static const double shading_share = 1; /* shading time, relative to a ray's time */
enum { RAYS_A_SAMPLE = 3 };

/* Returns the largest radiance of a dome, W/sr/m2 of luma. */
static double dome_peak(const struct orl_dome *dome)
{
    double most = 0;
    if (dome->views_only)
        return 0;
    if (!dome->sky && !dome->pattern)
        return orl_luma(dome->radiance);
    for (int row = 0; row < SKY_ROWS; row++) {
        for (int column = 0; column < SKY_COLUMNS; column++) {
            const double z = 2 * (row + 0.5) / SKY_ROWS - 1, s = sqrt(1 - z * z);
            const double phi = 2 * ORL_PI * (column + 0.5) / SKY_COLUMNS;
            const struct orl_vec3 d = orl_v3(s * cos(phi), s * sin(phi), z);
            if (orl_dot(d, dome->direction) < dome->cos_half_angle)
                continue;
            most = fmax(most, dome->pattern ? orl_luma(orl_dome_radiance(dome, d))
                                            : orl_sky_brightness(dome->sky, d));
        }
    }
    return sky_margin * most * (dome->pattern ? 1 : orl_luma(dome->radiance));
}

double orl_plan_survey_reflected_lx(const struct orl_plan_survey *survey, double direct_lx)
{
    const double rho = fmin(survey->rho, 1 - 1e-6);
    return direct_lx * rho / (1 - rho);
}

/* Returns diffuse and glossy reflectance at normal incidence: the light that walls and panels send
 * back into the room. */
static double reflectance(const struct orl_material *m)
{
    const enum orl_lobes back = (enum orl_lobes)(ORL_LOBE_DIFFUSE | ORL_LOBE_REFLECTED);
    if (!(orl_material_max_diffuse(m) > 0) && !orl_material_has_lobes(m))
        return 0;
    return fmin(
        fmax(orl_material_max_albedo(m, true, 1, back), orl_material_max_albedo(m, false, 1, back)),
        1);
}

void orl_plan_survey_measure(struct orl_plan_survey *survey)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    double sun = 0, sky = 0, lamp = 0;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        sun += orl_luma(lit_scene->suns[i].irradiance);
    for (size_t i = 0; i < lit_scene->n_domes && !survey->sky_measured; i++)
        sky += ORL_PI * dome_peak(&lit_scene->domes[i]);
    for (size_t i = 0; i < lit_scene->n_emitters; i++)
        lamp = fmax(lamp, ORL_PI * orl_luma(lit_scene->emitters[i].most));
    survey->sun_lx = ORL_EFFICACY_LM_PER_W * sun;
    if (lit_scene->n_domes == 0 || !survey->sky_measured)
        survey->sky_lx = ORL_EFFICACY_LM_PER_W * sky;
    survey->sky_measured = true;
    survey->lamp_lx = ORL_EFFICACY_LM_PER_W * lamp;
    survey->rho = survey->rho_diffuse = 0;
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        const struct orl_material *m = &lit_scene->materials[i];
        if (survey->surfaces[i] == 0)
            continue;
        survey->rho = fmax(survey->rho, reflectance(m));
        survey->rho_diffuse = fmax(survey->rho_diffuse, orl_material_max_diffuse(m));
    }
}

/* Counts the facets of the geometry for light and of that for views. */
static void count_surfaces(struct orl_plan_survey *survey)
{
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    const struct orl_lit_scene *seen = lit_scene->seen ? lit_scene->seen : lit_scene;
    for (size_t i = 0; i < lit_scene->geometry->n_facets; i++) {
        if (orl_facet_area(lit_scene->geometry, i) > 0 || orl_facet_area(seen->geometry, i) > 0)
            survey->surfaces[orl_facet_material(lit_scene->geometry, i)]++;
    }
    for (size_t i = 0; i < lit_scene->geometry->n_prototypes; i++) {
        const struct orl_geometry *const prototype = lit_scene->geometry->prototypes[i];
        for (size_t k = 0; k < prototype->n_facets; k++)
            survey->surfaces[orl_facet_material(prototype, k)] += (uint32_t)prototype->n_uses;
    }
    for (size_t i = 0; i < lit_scene->n_materials; i++) {
        const int32_t behind = orl_material_seen_as(&lit_scene->materials[i]);
        if (survey->surfaces[i] > 0 && behind >= 0 && survey->surfaces[behind] == 0)
            survey->surfaces[behind] = survey->surfaces[i];
    }
}

/* Times rays in the whole box of the scene; used for estimates only. */
static double time_rays(const struct orl_plan_survey *survey)
{
    const struct orl_plan_request *request = survey->request;
    const struct orl_geometry *g = survey->lit_scene->geometry;
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_PILOT, 0);
    const double started = request->now_s ? request->now_s(request->ctx) : 0;
    for (int i = 0; i < TIMED_RAYS; i++) {
        struct orl_hit hit;
        const double x = orl_random_uniform(&random), y = orl_random_uniform(&random);
        const struct orl_vec3 from =
            orl_v3(g->low.x + x * (g->high.x - g->low.x), g->low.y + y * (g->high.y - g->low.y),
                   g->low.z + orl_random_uniform(&random) * (g->high.z - g->low.z));
        const double z = 2 * orl_random_uniform(&random) - 1, s = sqrt(fmax(0, 1 - z * z));
        const double phi = 2 * ORL_PI * orl_random_uniform(&random);
        orl_geometry_intersect(g, from, orl_v3(s * cos(phi), s * sin(phi), z), INFINITY, &hit);
    }
    const double ended = request->now_s ? request->now_s(request->ctx) : 0;
    return (1 + shading_share) * fmax(ended - started, 0) / TIMED_RAYS;
}

int orl_plan_survey_init(struct orl_plan_survey *survey, const struct orl_plan_request *request,
                         struct orl_lit_scene *lit_scene)
{
    const struct orl_job *job = request->job;
    const size_t n = lit_scene->n_materials + 1;
    const uint32_t samples =
        job->gather_samples ? job->gather_samples : (uint32_t)ORL_DEFAULT_GATHER_SAMPLES;
    *survey = (struct orl_plan_survey){.request = request, .lit_scene = lit_scene};
    survey->surfaces = calloc(n, sizeof *survey->surfaces);
    if (!survey->surfaces)
        return ORL_ERR_NOMEM;
    count_surfaces(survey);
    orl_plan_survey_measure(survey);
    const double all = survey->sun_lx + survey->sky_lx + survey->lamp_lx;
    survey->tolerance_lx = fmin(most_tolerance_lx, tolerance_of_all * all);
    survey->ray_s = time_rays(survey);
    survey->sensor_rays = RAYS_A_SAMPLE * (double)request->n_sensors * samples;
    for (size_t i = 0; i < job->n_views; i++)
        survey->pixels += (double)job->views[i].width * job->views[i].height;
    return 0;
}

void orl_plan_survey_done(struct orl_plan_survey *survey)
{
    free(survey->surfaces);
}

size_t orl_plan_survey_count(const struct orl_plan_survey *survey,
                             bool (*is)(const struct orl_material *material))
{
    size_t n = 0;
    for (size_t i = 0; i < survey->lit_scene->n_materials; i++)
        if (survey->surfaces[i] > 0 && is(&survey->lit_scene->materials[i]))
            n += survey->surfaces[i];
    return n;
}

bool orl_plan_survey_is_outdoor(const struct orl_plan_survey *survey)
{
    const struct orl_plan_request *request = survey->request;
    const struct orl_lit_scene *lit_scene = survey->lit_scene;
    const struct orl_job *job = request->job;
    if (lit_scene->open || request->n_sensors > MOST_SENSORS_LOOKED_AT)
        return true;
    for (size_t i = 0; i < request->n_sensors; i++) {
        const struct orl_sensor *s = &request->sensors[i];
        const struct orl_vec3 at = orl_sub(s->position, lit_scene->geometry->center);
        const struct orl_vec3 normal = orl_normalize(s->direction);
        if (orl_lit_scene_is_outside(lit_scene,
                                     orl_offset_from_surface(lit_scene->geometry, at, normal)))
            return true;
    }
    for (size_t i = 0; i < job->n_views; i++) {
        struct orl_view view;
        if (orl_view_parse(job->views[i].view, &view, NULL) < 0 || view.type == 'l' ||
            orl_lit_scene_is_outside(lit_scene, orl_sub(view.point, lit_scene->geometry->center)))
            return true;
    }
    return false;
}
