/* Checks of a run's results at the end: results without light, and numerical trouble. */
#include <stdio.h>
#include <stdlib.h>

#include "light/enclosures.h"
#include "metrics/glare.h"
#include "render/film/film.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "scene/geometry/geometry.h"

/* Results without light: a warning if some are black, an error if all are. */

/* Numbers of black results. */
struct dark_counts {
    size_t sensors, views; /* number of black sensors and views */
    size_t first_sensor, first_view;
};

static struct dark_counts count_dark(const struct orl_result *result)
{
    struct dark_counts dark = {0};
    for (size_t i = 0; i < result->n_sensors; i++)
        if (result->illuminance_lx[i] == 0 && dark.sensors++ == 0)
            dark.first_sensor = i;
    for (size_t i = 0; i < result->n_views; i++)
        if (result->views[i].black && dark.views++ == 0)
            dark.first_view = i;
    return dark;
}

static int fail_dark(const struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    const struct orl_result *result = state->result;
    const bool lit = lit_scene->n_suns + lit_scene->n_domes + lit_scene->n_emitters > 0;
    char what[96];
    if (result->n_views == 0 && result->n_sensors == 1)
        snprintf(what, sizeof what, "the only sensor is at 0 lx");
    else if (result->n_views == 0)
        snprintf(what, sizeof what, "all %zu sensors are at 0 lx", result->n_sensors);
    else if (result->n_sensors == 0 && result->n_views == 1)
        snprintf(what, sizeof what, "the only view is black");
    else if (result->n_sensors == 0)
        snprintf(what, sizeof what, "all %zu views are black", result->n_views);
    else
        snprintf(what, sizeof what, "all sensors (%zu) and views (%zu) are black",
                 result->n_sensors, result->n_views);
    orl_error_set(err, ORL_ERR_UNLIT, "%s: %s", what,
                  lit ? "none of the scene's light reaches them"
                      : "the scene has no simulated light: no sky, sun or lamp");
    orl_error_hint(err, "%s; if darkness is correct, set \"dark\": \"expected\" in the job",
                   lit ? "They may lie inside a solid, face a surface, or be walled in: check that "
                         "windows are open to the outside and normals face the room"
                       : "Add a \"sky\" to the job (--sky for a project), or lights to the scene");
    return ORL_ERR_UNLIT;
}

int orl_run_diagnose_dark(struct orl_run_state *state, struct orl_error *err)
{
    const struct orl_result *result = state->result;
    const struct dark_counts dark = count_dark(result);
    if ((result->sky_given && result->sky_dark) || state->job->dark_expected)
        return 0;
    if (dark.sensors == result->n_sensors && dark.views == result->n_views)
        return fail_dark(state, err);
    if (dark.sensors > 0)
        orl_run_warn(state,
                     "%zu of %zu sensors %s at 0 lx, the first is sensors[%zu]: no light was found "
                     "there, for example inside a solid; the other sensors are not affected",
                     dark.sensors, result->n_sensors, dark.sensors == 1 ? "is" : "are",
                     dark.first_sensor);
    if (dark.views > 0)
        orl_run_warn(state, "%zu of %zu views %s black, the first is '%s'", dark.views,
                     result->n_views, dark.views == 1 ? "is" : "are",
                     result->views[dark.first_view].name);
    return 0;
}

/* Turns the counters of a run into warnings. */

enum { QUERY_PATHS = 16384, VIEW_PATHS = 2048 };

/* Distance from a surface at which an eye is clear of it, in units of the geometry's resolution. */
static const double clear_of_surfaces = 10;

/* Shares that cause a warning. */
static const double many_leaks = 1e-6, grave_leaks = 1e-3, much_flux = 1e-4, many_paths = 1e-3,
                    many_values = 1e-3, many_sparse = 0.1;

/* Counts the scene's faults. Warns once of each BSDF that would create energy; others are only
 * counted. */
void orl_run_count_scene_faults(struct orl_run_state *state, const struct orl_scene *scene)
{
    const struct orl_parsed_scene *d = &scene->parsed_scene;
    const double tolerance = 1e-3; /* tolerance of the check of BSDFs */
    struct orl_health *h = &state->result->health;
    h->degenerate = d->n_degenerate;
    h->surfaces = scene->parsed_scene.n_read;
    h->instances = d->n_placements;
    for (size_t i = 0; i < d->n_materials; i++) {
        const struct orl_material *m = &d->materials[i];
        const struct orl_bsdf *const bsdf = orl_material_bsdf(m);
        struct orl_bsdf_info info;
        size_t first = 0;
        while (orl_material_bsdf(&d->materials[first]) != bsdf)
            first++;
        if (!bsdf || first < i)
            continue;
        orl_bsdf_describe(bsdf, &info);
        const double most = fmax(info.max_albedo[0], info.max_albedo[1]);
        h->bsdf_values += info.values;
        h->bsdf_clamped += info.clamped;
        h->bsdf_rescaled += most > 1;
        if (info.skipped_bytes > 0)
            orl_run_warn(
                state,
                "BSDF '%.100s': its file has %zu bytes of text before the XML, which are skipped",
                m->name, info.skipped_bytes);
        if (most > 1 + tolerance)
            orl_run_warn(state,
                         "BSDF '%.100s': reflectance and transmittance add up to %.3f for some "
                         "directions; values are rescaled to 1 there",
                         m->name, most);
    }
}

/* ---- Places without light -------------------------------------------------------------------- */

static struct orl_vec3 to_geometry_frame(const struct orl_run_state *state, struct orl_vec3 point)
{
    return orl_sub(point, state->lit_scene->geometry->center);
}

/* Lists every sensor and every eye of the job, owned by the caller; NULL if out of memory. */
static struct orl_query_point *list_query_points(const struct orl_run_state *state,
                                                 size_t *ret_count)
{
    const struct orl_job *job = state->job;
    struct orl_query_point *list = malloc((state->n_sensors + job->n_views + 1) * sizeof *list);
    size_t n = 0;
    for (size_t i = 0; list && i < state->n_sensors; i++) {
        const struct orl_vec3 normal = orl_normalize(state->sensors[i].direction);
        const struct orl_vec3 point = to_geometry_frame(state, state->sensors[i].position);
        list[n++] = (struct orl_query_point){
            orl_offset_from_surface(state->lit_scene->geometry, point, normal), normal};
    }
    for (size_t i = 0; list && i < job->n_views; i++) {
        struct orl_view view;
        if (orl_view_parse(job->views[i].view, &view, NULL) == 0)
            list[n++] = (struct orl_query_point){to_geometry_frame(state, view.point), {0, 0, 0}};
    }
    *ret_count = n;
    return list;
}

bool orl_run_is_dark(struct orl_run_state *state)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    size_t count = 0;
    /*
     * The test is skipped if light has a port to enter by, or if there is no light at all (a cheap
     * case). It is also skipped for views that see from everywhere (parallel) or through surfaces
     * (-bv-).
     */
    if (lit_scene->n_ports > 0 ||
        lit_scene->n_suns + lit_scene->n_domes + lit_scene->n_emitters == 0)
        return false;
    for (size_t i = 0; i < state->job->n_views; i++) {
        struct orl_view view;
        if (orl_view_parse(state->job->views[i].view, &view, NULL) < 0 || view.type == 'l' ||
            view.backs_unseen)
            return false;
    }
    struct orl_query_point *query_points = list_query_points(state, &count);
    const size_t paths = count > QUERY_PATHS ? count : QUERY_PATHS;
    const bool dark = query_points && count > 0 &&
                      !orl_light_reaches(lit_scene, query_points, count, paths, state->env->pool);
    free(query_points);
    if (dark)
        orl_run_warn(state,
                     "no light reaches the sensors and views: none of %zu paths from them "
                     "found any; they are black, and no photons were traced",
                     paths);
    return dark;
}

static void diagnose_view(struct orl_run_state *state, const char *name,
                          const struct orl_view *view)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    const struct orl_query_point query_point = {to_geometry_frame(state, view->point), {0, 0, 0}};
    struct orl_surface_contact touch;
    if (view->type == 'l' || view->backs_unseen)
        return;
    if (orl_find_surface_contact(lit_scene->geometry, query_point.point, &touch)) {
        const struct orl_surface_label label = orl_scene_label_of(lit_scene->scene, touch.facet);
        orl_run_warn_once(
            state,
            "view '%s': the viewpoint lies on a surface, '%.100s' (%.100s:%d), %.2g m from it: the "
            "side that it sees is random; move the viewpoint at least %.1g m away from the surface",
            name, label.name, label.file, label.line, touch.distance,
            clear_of_surfaces * orl_geometry_resolution(lit_scene->geometry));
    } else if (!orl_light_reaches(lit_scene, &query_point, 1, VIEW_PATHS, state->env->pool)) {
        orl_run_warn_once(
            state, "view '%s': no light reaches the viewpoint: it may be inside a solid or a wall",
            name);
    }
}

void orl_run_diagnose_views(struct orl_run_state *state)
{
    const struct orl_job *job = state->job;
    for (size_t i = 0; i < job->n_views && !orl_thread_pool_cancelled(state->env->pool); i++) {
        struct orl_view view;
        if (orl_view_parse(job->views[i].view, &view, NULL) == 0)
            diagnose_view(state, job->views[i].name, &view);
    }
}

/* ---- Warnings -------------------------------------------------------------------------------- */

static double share_of(uint64_t part, uint64_t whole)
{
    return whole > 0 ? (double)part / (double)whole : 0;
}

static void warn_of_leaks(struct orl_run_state *state, const struct orl_health *h)
{
    const struct orl_vec3 p = h->leak_from, d = h->leak_towards;
    const unsigned long long leaked = h->rays_leaked, rays = h->rays;
    const double lost = share_of(h->rays_leaked, h->rays);
    char place[160] = "", verdict[160];
    if (!(lost > many_leaks))
        return;
    if (orl_dot(d, d) > 0)
        snprintf(place, sizeof place, "; one left from (%.6g %.6g %.6g) towards (%.4f %.4f %.4f)",
                 p.x, p.y, p.z, d.x, d.y, d.z);
    if (lost < grave_leaks)
        snprintf(verdict, sizeof verdict,
                 "the results are good: about %.2g %% of the light is lost", 100 * lost);
    else
        snprintf(verdict, sizeof verdict,
                 "the results are not good near the gap: %.2g %% of the rays are lost, and light "
                 "that enters there is not simulated",
                 100 * lost);
    orl_run_warn(state,
                 "%llu of %llu rays left the building, but not through a window: the building is "
                 "not closed%s; %s",
                 leaked, rays, place, verdict);
}

/* Warns of estimates from few photons: fewer than 8 scatter by more than 1 / sqrt(8). The effect
 * depends on the technique. */
static void warn_of_sparse(struct orl_run_state *state, const struct orl_health *h)
{
    const bool shown = orl_technique_facts(state->result->plan.technique)->shows_density;
    const double sparse = share_of(h->sparse, h->estimates);
    if (!(sparse > many_sparse))
        return;
    orl_run_warn(
        state, "%.0f %% of the density estimates use fewer than 8 photons: %s", 100 * sparse,
        shown ? "results there are not good, with errors of a third or more; use more photons"
              : "each value is the mean of many estimates, so its stated error is valid; more "
                "photons would reduce it");
}

/* Lists the discs of suns and of their images in flat mirrors; returns their number. */
static size_t list_discs(const struct orl_lit_scene *lit_scene, struct orl_glare_disc *ret_discs)
{
    size_t n = 0;
    for (size_t i = 0; i < lit_scene->n_suns; i++)
        ret_discs[n++] =
            (struct orl_glare_disc){lit_scene->suns[i].frame.n, lit_scene->suns[i].solid_angle_sr};
    for (size_t i = 0; i < lit_scene->images.n_nodes; i++) {
        const struct orl_virtual_sun *image = &lit_scene->images.nodes[i];
        if (image->shown)
            ret_discs[n++] =
                (struct orl_glare_disc){image->frame.n, lit_scene->suns[image->sun].solid_angle_sr};
    }
    return n;
}

/* Reports that the error of DGP is not met if the job asked for a narrower interval. */
static void withdraw_accuracy(struct orl_run_state *state, const char *view,
                              const struct orl_glare_value *dgp)
{
    struct orl_outcome *outcome = &state->result->outcome;
    const double half = (dgp->interval_95[1] - dgp->interval_95[0]) / 2;
    const double asked = state->job->goal.dgp_error;
    if (!outcome->asked || !outcome->met || !(asked > 0) || !(half > asked))
        return;
    outcome->met = false;
    snprintf(outcome->why, sizeof outcome->why,
             "the pixels of view '%.100s' are too wide for its DGP: see warnings", view);
}

/* Warns of views whose pixels blur a glare source, and widens the interval of their DGP. */
static void warn_of_blur(struct orl_run_state *state)
{
    const struct orl_lit_scene *lit_scene = state->lit_scene;
    struct orl_glare_disc *discs =
        calloc(lit_scene->n_suns + lit_scene->images.n_nodes + 1, sizeof *discs);
    const size_t n_discs = discs ? list_discs(lit_scene, discs) : 0;
    for (size_t i = 0; i < state->result->n_views; i++) {
        const struct orl_view_request *request = &state->job->views[i];
        struct orl_glare *glare = state->result->views[i].glare;
        uint32_t width;
        if (!glare || !(request->metrics & 1U << ORL_GLARE_DGP) ||
            orl_glare_sharpen(&request->glare, discs, n_discs, glare, NULL) < 0 ||
            !orl_glare_is_blurred(glare, request->width, &width))
            continue;
        struct orl_glare_value *dgp = &glare->values[ORL_GLARE_DGP];
        if (dgp->interval_95[1] < glare->sharper_dgp)
            dgp->interval_95[1] = glare->sharper_dgp;
        glare->class_of = orl_glare_class_of(dgp);
        withdraw_accuracy(state, request->name, dgp);
        orl_run_warn(state,
                     "view '%s': its pixels are too wide for a bright source of %zu pixels, such "
                     "as the sun, so DGP is too low: %.2f, and about %.2f with the source's own "
                     "size; make the view %u pixels wide",
                     request->name, glare->blurred_pixels, dgp->value, glare->sharper_dgp, width);
    }
    free(discs);
}

void orl_run_diagnose_health(struct orl_run_state *state)
{
    struct orl_health *h = &state->result->health;
    if (h->rays_leaked > 0)
        h->leak_from = orl_add(h->leak_from, state->lit_scene->geometry->center);
    warn_of_leaks(state, h);
    if (h->non_finite > 0)
        orl_run_warn(
            state, "%llu values were not finite and count as black: results near them are too low",
            (unsigned long long)h->non_finite);
    if (h->flux_capped_w > much_flux * h->flux_w)
        orl_run_warn(state,
                     "%.3g %% of the light was lost to the bounce limit, with %llu of %llu "
                     "photons: surfaces that absorb almost no light are too dark",
                     100 * h->flux_capped_w / h->flux_w, (unsigned long long)h->photons_capped,
                     (unsigned long long)h->photons);
    if (share_of(h->paths_capped, h->paths) > many_paths)
        orl_run_warn(state,
                     "%.3g %% of the paths from sensors and views were cut at the bounce limit: "
                     "results are too low, but by a smaller share",
                     100 * share_of(h->paths_capped, h->paths));
    if (share_of(h->bsdf_clamped, h->bsdf_values) > many_values)
        orl_run_warn(state, "%llu of %llu values of the BSDFs are negative and were read as zero",
                     (unsigned long long)h->bsdf_clamped, (unsigned long long)h->bsdf_values);
    warn_of_sparse(state, h);
    warn_of_blur(state);
}
