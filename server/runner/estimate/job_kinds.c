#include "runner/estimate/job_estimate.h"

#include <oriel/annual/annual_phases.h>

#include "process/limits.h"

/* Refuses measurements. */
static int accept_any_scene(const struct orl_upload_contents *contents, struct orl_error *err)
{
    if (contents->measured_rows == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "this is the id of measurements, not of a scene");
    orl_error_at(err, NULL, 0, "scene");
    orl_error_hint(err, "To fit a BSDF to them, use \"kind\": \"bsdf_fit\"");
    return ORL_ERR_INVALID;
}

/* Refuses scenes with distant sources, for the reason that why gives. */
static int refuse_sources(const struct orl_upload_contents *contents, const char *why,
                          const char *hint, struct orl_error *err)
{
    const int rc = accept_any_scene(contents, err);
    if (rc || contents->sources == 0)
        return rc;
    orl_error_set(err, ORL_ERR_INVALID, "%s, but the scene has %llu distant sources", why,
                  (unsigned long long)contents->sources);
    orl_error_at(err, NULL, 0, "scene");
    orl_error_hint(err, "%s", hint);
    return ORL_ERR_INVALID;
}

/* ---- Render jobs ----------------------------------------------------------------------------- */

/* Bytes of result.json without sensors, of a study's results, and of one sensor. */
enum { DOCUMENT = 8192, STUDY = 1 << 18, SENSOR = 200 };
/* Bytes of the outlines and pixels of some heat maps, and of a sensor in maps and tables. */
enum { HEAT_MAPS = 1 << 20, GRID_MAP = 1 << 16, HEAT_MAP_SENSOR = 400 };

/* Bytes of a pixel in all the files of a view, errors included. */
static uint64_t pixel_bytes(const struct orl_view_request *view)
{
    enum { RGBE = 4, RGB = 3, WORDS = 6, HALVES = 6, FLOATS = 12 };
    const uint32_t formats = view->formats ? view->formats : ORL_PICTURES_DEFAULT;
    uint64_t bytes = RGBE + RGB;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_HDR) ? RGBE : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_PNG) ? RGB : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_PNG16) ? WORDS : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_EXR) ? HALVES : 0;
    bytes += formats & ORL_PICTURE_BIT(ORL_PICTURE_EXR_FLOAT) ? FLOATS : 0;
    return bytes + (view->false_color.asked ? 3 * RGB : 0);
}

/* Returns the bytes of a sky's part in sequences: a picture, the same picture in the animation, and
 * a smaller one on the sheet. */
static uint64_t sequence_bytes(const struct orl_job *job)
{
    enum { RGB = 3, PICTURES = 3, MARGINS = 1 << 16 };
    uint64_t bytes = 0;
    for (size_t i = 0; i < job->n_views; i++)
        bytes += (uint64_t)job->views[i].width * job->views[i].height * PICTURES * RGB + MARGINS;
    return bytes;
}

static uint64_t render_sensor_bytes(const struct orl_job_request *job_request)
{
    const size_t skies = job_request->of.render.n_skies;
    return skies > 0 ? (skies + 1) * SENSOR : SENSOR;
}

/* Returns the number of grids that may get a map; a file may have any number of sensors. */
static uint64_t count_maps(const struct orl_job *job)
{
    enum { LEAST_IN_PLANE = 4 };
    uint64_t maps = job->n_grids == 0 && (job->sensors_file || job->n_sensors >= LEAST_IN_PLANE);
    for (size_t i = 0; i < job->n_grids; i++)
        maps += job->grids[i].file || job->grids[i].count >= LEAST_IN_PLANE;
    return maps;
}

static uint64_t render_result_bytes(const struct orl_job_request *job_request)
{
    const struct orl_job *job = &job_request->of.render;
    uint64_t bytes = DOCUMENT + SENSOR * (uint64_t)job->n_sensors;
    for (size_t i = 0; i < job->n_views; i++)
        bytes += pixel_bytes(&job->views[i]) * (uint64_t)job->views[i].width * job->views[i].height;
    if (job->sequence.asked)
        bytes += sequence_bytes(job);
    if (job->heat_map.asked)
        bytes += HEAT_MAPS + HEAT_MAP_SENSOR * (uint64_t)job->n_sensors;
    if (job->sensor_files || job->heat_map.asked)
        bytes += GRID_MAP * count_maps(job) + HEAT_MAP_SENSOR * (uint64_t)job->n_sensors;
    /* Each sky needs as much; results of all skies together take less than one more. */
    return job->n_skies > 0 ? (job->n_skies + 1) * bytes : bytes;
}

static uint64_t photons_of(uint64_t target)
{
    return target == ORL_PHOTONS_BY_PLAN ? ORL_DEFAULT_PHOTONS : target;
}

static void render_needs(const struct orl_job_request *job_request,
                         struct orl_job_memory *ret_needs)
{
    const struct orl_job *job = orl_job_request_render_job(job_request);
    ret_needs->sensors = job->n_sensors;
    ret_needs->photons = photons_of(job->photons_global) + photons_of(job->photons_caustic);
    for (size_t i = 0; i < job->n_views; i++) {
        const uint64_t pixels = (uint64_t)job->views[i].width * job->views[i].height;
        ret_needs->pixels = pixels > ret_needs->pixels ? pixels : ret_needs->pixels;
        if (job->views[i].glare.mask[0] && pixels > ret_needs->mask_pixels)
            ret_needs->mask_pixels = pixels;
    }
}

static bool has_masks(const struct orl_job_request *job_request)
{
    const struct orl_job *job = orl_job_request_render_job(job_request);
    for (size_t i = 0; i < job->n_views; i++)
        if (job->views[i].glare.mask[0])
            return true;
    return false;
}

/* ---- Studies --------------------------------------------------------------------------------- */

static int check_study_limits(const struct orl_job_request *job_request, struct orl_error *err)
{
    return orl_study_check_runs(&job_request->of.study, ORL_SERVER_STUDY_RUNS, err);
}

static uint64_t study_result_bytes(const struct orl_job_request *job_request)
{
    (void)job_request;
    return STUDY;
}

static uint64_t study_sensor_bytes(const struct orl_job_request *job_request)
{
    (void)job_request;
    return 0;
}

static void study_needs(const struct orl_job_request *job_request, struct orl_job_memory *ret_needs)
{
    const struct orl_study_request *study = &job_request->of.study;
    render_needs(job_request, ret_needs);
    for (size_t i = 0; i < study->n_photons; i++)
        if (2 * study->photons[i] > ret_needs->photons)
            ret_needs->photons = 2 * study->photons[i];
}

/* ---- Annual jobs ---------------------------------------------------------------------------- */

/* Limits the pictures: one for every metric of every grid. */
static int check_annual_limits(const struct orl_job_request *job_request, struct orl_error *err)
{
    const struct orl_annual_job *job = &job_request->of.annual;
    const size_t maps = job->request.n_grids * job->report_request.n_metrics;
    if (maps <= ORL_LIMIT_PICTURES)
        return 0;
    orl_error_set(err, ORL_ERR_LIMIT,
                  "%zu grids with %zu metrics each are %zu pictures; the maximum is %u",
                  job->request.n_grids, job->report_request.n_metrics, maps, ORL_LIMIT_PICTURES);
    orl_error_at(err, NULL, 0, "grids");
    orl_error_hint(err, "Ask for fewer metrics, or move some of the grids to another job");
    return ORL_ERR_LIMIT;
}

/* Refuses scenes with distant sources, since an annual job has skies of its own. */
static int check_annual_contents(const struct orl_upload_contents *contents, struct orl_error *err)
{
    return refuse_sources(contents, "an annual job has its own skies and suns",
                          "Upload it without sky and sun", err);
}

/* Bytes of a map's or carpet's outlines and pixels, of a page, of a sensor in a map, of a sensor in
 * a table, and of a row of hours. */
enum { MAP = 100 << 10, PAGE = 1 << 20, MAP_SENSOR = 300, FIGURE = 40, HOURS_ROW = 64 };
/* Bytes that a grid adds to a row of hours.csv: the mean and its standard error. */
enum { HOURS_GRID = 26 };
/* Bytes of a sensor for an hour with light: stored until the job ends, and in each series of
 * results. */
enum { KEPT_HOUR = 12, SERIES_HOUR = 12 };

/* Returns the number of runs that store rows: one with all shades open. With shades, also
 * combinations of states, no more than the sum of all groups' states, and windows in no group. */
static uint64_t annual_runs(const struct orl_annual_request *request)
{
    uint64_t runs = request->n_groups > 0 ? 2 : 1;
    for (size_t g = 0; g < request->n_groups; g++)
        runs += request->groups[g].n_states;
    return runs;
}

static uint64_t annual_hour_bytes(const struct orl_job_request *job_request)
{
    const struct orl_annual_formats *formats = &job_request->of.annual.formats;
    const uint64_t series = (uint64_t)formats->honeybee + (uint64_t)formats->matrices;
    return KEPT_HOUR * annual_runs(&job_request->of.annual.request) + series * SERIES_HOUR;
}

/* Returns the bytes of one sensor's float matrices that are stored until the job ends, without the
 * windows' own matrices. */
static uint64_t annual_array_bytes(const struct orl_annual_formats *formats)
{
    const uint64_t values = (formats->coefficients ? (uint64_t)ORL_ANNUAL_PATCHES : 0) +
                            (formats->phases ? (uint64_t)ORL_PHASES_SUNS : 0);
    return values * sizeof(float);
}

static uint64_t annual_sensor_bytes(const struct orl_job_request *job_request)
{
    return SENSOR +
           (MAP_SENSOR + FIGURE) * (uint64_t)job_request->of.annual.report_request.n_metrics +
           ORL_MATRIX_CHANNELS * annual_array_bytes(&job_request->of.annual.formats);
}

/* Bytes in results: a viewpoint's numbers in a row of glare.csv, and its headings; a point's row in
 * exposure.csv or view-out.csv together with its entry in the document. */
enum { VIEWPOINT_HOUR = 40, VIEWPOINT_HEADINGS = 512, POINT_ROW = 400 };

static uint64_t annual_result_bytes(const struct orl_job_request *job_request)
{
    const struct orl_annual_job *job = &job_request->of.annual;
    const struct orl_report_request *report_request = &job->report_request;
    const uint64_t maps = report_request->n_metrics + 2;
    const uint64_t points = report_request->exposure.n_points + report_request->view_out.n_points;
    return DOCUMENT + UINT64_C(8784) * HOURS_ROW +
           job->request.n_grids * (PAGE + MAP * maps + UINT64_C(8784) * HOURS_GRID) +
           job->request.n_sensors * annual_sensor_bytes(job_request) +
           report_request->glare.n_viewpoints *
               (VIEWPOINT_HEADINGS + UINT64_C(8784) * VIEWPOINT_HOUR) +
           points * POINT_ROW;
}

/* Returns the glare viewpoints of the largest list: reported ones, or those of a control. Each list
 * is one run. */
static uint64_t annual_viewpoints(const struct orl_annual_job *job)
{
    uint64_t most = job->report_request.glare.n_viewpoints;
    for (size_t g = 0; g < job->request.n_groups; g++) {
        const size_t n = job->request.groups[g].control.viewpoints.n_viewpoints;
        most = n > most ? n : most;
    }
    return most;
}

static void annual_needs(const struct orl_job_request *job_request,
                         struct orl_job_memory *ret_needs)
{
    const struct orl_annual_job *job = &job_request->of.annual;
    ret_needs->sensors = job->request.n_sensors;
    /* If verdicts must be certain, a second set of as many sensors' hours exists in memory. With
     * shades, another state exists beside the open one in each round. */
    const uint64_t rounds = job->report_request.until ? 2 : 1,
                   states = job->request.n_groups > 0 ? 2 : 1;
    ret_needs->hour_bytes = KEPT_HOUR * (rounds + states - 1);
    ret_needs->hour_bytes += job->request.n_terms > 0 ? sizeof(double) : 0; /* sums of products */
    ret_needs->array_bytes = annual_array_bytes(&job->formats);
    ret_needs->photons = job->request.photons < ORL_ANNUAL_MOST_MAP_VALUES
                             ? job->request.photons
                             : ORL_ANNUAL_MOST_MAP_VALUES;
    ret_needs->viewpoints = annual_viewpoints(job);
    ret_needs->sun_nodes = (1U << 2 * job->request.sun_halvings) - 1;
    /* With one group, its light is not separated from the rest. */
    ret_needs->window_groups = job->request.n_groups > 1 ? job->request.n_groups : 0;
    ret_needs->windows = job->formats.phases ? ORL_PHASES_MOST_WINDOWS : 0;
}

static bool annual_whole_scene(const struct orl_job_request *job_request)
{
    const struct orl_annual_request *request = &job_request->of.annual.request;
    return request->n_groups > 0 || request->n_terms > 0;
}

/* ---- BSDFs of panels ------------------------------------------------------------------------- */

/* Bytes of a value in its file and of its standard error; for trees the bytes of the maximum number
 * of values. */
enum { VALUE = 12, ERROR = 24, TREES = 160 << 20 };
enum { PARTS = 4, SUMS = 16 * 2 * 8, TREE_MEMORY = 640 << 20 };

/* Returns the pairs of directions in a component (front or back, reflection or transmission). */
static uint64_t bsdf_pairs(enum orl_bsdf_basis basis)
{
    const uint64_t n = basis == ORL_BSDF_KLEMS_FULL ? 145 : basis == ORL_BSDF_KLEMS_HALF ? 77 : 41;
    return n * n;
}

static uint64_t bsdf_result_bytes(const struct orl_job_request *job_request)
{
    const struct orl_bsdf_make_request *request = &job_request->of.bsdf_make;
    const uint64_t channels = request->color ? 3 : 1;
    return orl_bsdf_basis_is_tree(request->basis)
               ? TREES
               : DOCUMENT + PARTS * bsdf_pairs(request->basis) * (channels * VALUE + ERROR);
}

static uint64_t bsdf_sensor_bytes(const struct orl_job_request *job_request)
{
    (void)job_request;
    return 0;
}

static void bsdf_needs(const struct orl_job_request *job_request, struct orl_job_memory *ret_needs)
{
    const struct orl_bsdf_make_request *request = &job_request->of.bsdf_make;
    const uint64_t channels = request->color ? 3 : 1;
    ret_needs->bsdf_made_bytes =
        orl_bsdf_basis_is_tree(request->basis)
            ? TREE_MEMORY
            : 2 * bsdf_pairs(request->basis) * channels * SUMS + 2 * bsdf_result_bytes(job_request);
}

/* Refuses scenes with distant sources: a panel has no light of its own. */
static int check_bsdf_contents(const struct orl_upload_contents *contents, struct orl_error *err)
{
    return refuse_sources(contents, "a panel cannot contain a sun or sky", "Upload the panel alone",
                          err);
}

/* ---- BSDFs of measurements ------------------------------------------------------------------- */

static enum orl_bsdf_basis fit_basis(const struct orl_bsdf_fit_request *request)
{
    return request->has_basis ? request->basis : ORL_BSDF_TENSOR_TREE_4;
}

/* Returns the bytes of the BSDF and of the report of each scan. */
static uint64_t fit_result_bytes(const struct orl_job_request *job_request)
{
    const enum orl_bsdf_basis basis = fit_basis(&job_request->of.bsdf_fit);
    return orl_bsdf_basis_is_tree(basis)
               ? TREES
               : 2 * (uint64_t)DOCUMENT + PARTS * bsdf_pairs(basis) * VALUE;
}

/* Estimates memory without the rows of measurements, which are counted later. */
static void fit_needs(const struct orl_job_request *job_request, struct orl_job_memory *ret_needs)
{
    ret_needs->bsdf_made_bytes = orl_bsdf_basis_is_tree(fit_basis(&job_request->of.bsdf_fit))
                                     ? TREE_MEMORY
                                     : 2 * fit_result_bytes(job_request);
}

static int check_fit_contents(const struct orl_upload_contents *contents, struct orl_error *err)
{
    if (contents->measured_rows > 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "this is the id of a scene, not of measurements");
    orl_error_at(err, NULL, 0, "measurements");
    orl_error_hint(err, "Upload the file of the goniophotometer, or compute a panel's BSDF from "
                        "its geometry: \"kind\": \"bsdf_make\"");
    return ORL_ERR_INVALID;
}

const struct orl_job_kind orl_job_kinds[ORL_JOB_KIND_COUNT] = {
    [ORL_JOB_KIND_RENDER] = {.result_bytes = render_result_bytes,
                             .sensor_bytes = render_sensor_bytes,
                             .needs = render_needs,
                             .whole_scene = has_masks,
                             .check_contents = accept_any_scene},
    [ORL_JOB_KIND_STUDY] = {.check_limits = check_study_limits,
                            .result_bytes = study_result_bytes,
                            .sensor_bytes = study_sensor_bytes,
                            .needs = study_needs,
                            .whole_scene = has_masks,
                            .check_contents = accept_any_scene},
    [ORL_JOB_KIND_ANNUAL] = {.check_limits = check_annual_limits,
                             .result_bytes = annual_result_bytes,
                             .sensor_bytes = annual_sensor_bytes,
                             .hour_bytes = annual_hour_bytes,
                             .needs = annual_needs,
                             .whole_scene = annual_whole_scene,
                             .check_contents = check_annual_contents},
    [ORL_JOB_KIND_BSDF_MAKE] = {.result_bytes = bsdf_result_bytes,
                                .sensor_bytes = bsdf_sensor_bytes,
                                .needs = bsdf_needs,
                                .check_contents = check_bsdf_contents},
    [ORL_JOB_KIND_BSDF_FIT] = {.result_bytes = fit_result_bytes,
                               .sensor_bytes = bsdf_sensor_bytes,
                               .needs = fit_needs,
                               .check_contents = check_fit_contents},
};
