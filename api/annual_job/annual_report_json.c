/* Encodes a year's report as result.json. */
#include <string.h>

#include <oriel/base/version.h>

#include "annual_job/annual_json.h"
#include "annual_job/annual_members_json.h"
#include "json/encode.h"

/* json_pack's "o" fails on NULL, so that one check covers all parts (as in result_json.c). */

static json_t *interval_to_json(const struct orl_annual_value *value)
{
    return json_pack("[o, o]", orl_json_from_real(value->low), orl_json_from_real(value->high));
}

static const char *unit_of(const struct orl_annual_figure *figure)
{
    return figure->aggregate == ORL_AGGREGATE_SHARE ? "%" : orl_annual_unit(figure->metric.kind);
}

/* ---- Figures --------------------------------------------------------------------------------- */

static json_t *figure_to_json(const struct orl_annual_figure *figure,
                              const struct orl_annual_area *area)
{
    char metric[64], name[96];
    orl_annual_metric_name(&figure->metric, metric, sizeof metric);
    if (figure->aggregate == ORL_AGGREGATE_SHARE)
        snprintf(name, sizeof name, "%s%g%c%g",
                 figure->metric.kind == ORL_METRIC_DA ? "sDA" : "ASE", figure->metric.low_lx,
                 figure->metric.kind == ORL_METRIC_DA ? '/' : ',', figure->least);
    else
        snprintf(name, sizeof name, "average %s", metric);
    return json_pack("{s:s, s:s, s:s, s:o, s:o, s:I}", "name", name, "when",
                     orl_annual_when_name(figure->metric.when), "unit", unit_of(figure), "value",
                     orl_json_from_real(area->value.value), "interval_95",
                     interval_to_json(&area->value), "open", (json_int_t)area->open);
}

/* place: the index of a grid, or n_grids for all grids together. */
static json_t *figures_to_json(const struct orl_annual_report *report, size_t place)
{
    json_t *array = json_array();
    for (size_t f = 0; array && f < report->n_figures; f++)
        array = orl_json_append(
            array,
            figure_to_json(&report->figures[f], &report->areas[f * (report->n_grids + 1) + place]));
    return array;
}

static json_t *grids_to_json(const struct orl_annual_report *report)
{
    json_t *array = json_array();
    for (size_t g = 0; array && g < report->n_grids; g++)
        array = orl_json_append(array, json_pack("{s:o, s:I, s:o}", "name",
                                                 orl_json_from_text(report->grids[g].name),
                                                 "sensors", (json_int_t)report->grids[g].count,
                                                 "figures", figures_to_json(report, g)));
    return array;
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

static json_t *grid_name(const struct orl_annual_report *report, size_t grid)
{
    return orl_json_from_text(grid == ORL_ALL_GRIDS ? NULL : report->grids[grid].name);
}

/* Returns the number of hours behind the figure; json null for a daylight factor. */
static json_t *hours_of(const struct orl_annual_report *report, const struct orl_annual_verdict *v)
{
    const struct orl_annual_metric *metric = &v->target.figure.metric;
    return metric->kind == ORL_METRIC_DF ? json_null()
                                         : json_real(report->periods[metric->when].hours);
}

static json_t *verdicts_to_json(const struct orl_annual_report *report)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < report->n_verdicts; i++) {
        const struct orl_annual_verdict *v = &report->verdicts[i];
        array = orl_json_append(
            array, json_pack("{s:o, s:o, s:o, s:o, s:s, s:o, s:o, s:I, s:s, s:o, s:o}", "rule",
                             orl_json_from_text(v->rule ? v->rule->name : NULL), "clause",
                             orl_json_from_text(v->rule ? v->rule->clause : NULL), "target",
                             orl_json_from_text(v->target.text), "grid", grid_name(report, v->grid),
                             "unit", unit_of(&v->target.figure), "value",
                             orl_json_from_real(v->area.value.value), "interval_95",
                             interval_to_json(&v->area.value), "open", (json_int_t)v->area.open,
                             "verdict", orl_verdict_name(v->verdict), "note",
                             orl_json_from_text(v->note[0] ? v->note : NULL), "hours",
                             hours_of(report, v)));
    }
    return array;
}

/* Returns true if an earlier verdict has this rule and grid. */
static bool is_repeated(const struct orl_annual_verdict *verdicts, size_t i)
{
    for (size_t k = 0; k < i; k++)
        if (verdicts[k].rule == verdicts[i].rule && verdicts[k].grid == verdicts[i].grid)
            return true;
    return false;
}

static json_t *rules_to_json(const struct orl_annual_report *report)
{
    const struct orl_annual_verdict *v = report->verdicts;
    json_t *array = json_array();
    for (size_t i = 0; array && i < report->n_verdicts; i++) {
        enum orl_verdict all = ORL_VERDICT_PASS;
        const char *note = NULL;
        if (!v[i].rule || is_repeated(v, i))
            continue;
        for (size_t k = i; k < report->n_verdicts; k++)
            if (v[k].rule == v[i].rule && v[k].grid == v[i].grid) {
                all = orl_verdict_combine(all, v[k].verdict);
                note = note || !v[k].note[0] ? note : v[k].note;
            }
        array = orl_json_append(
            array, json_pack("{s:s, s:o, s:s, s:o}", "rule", v[i].rule->name, "grid",
                             grid_name(report, v[i].grid), "verdict", orl_verdict_name(all), "note",
                             orl_json_from_text(all == ORL_VERDICT_UNDECIDED ? note : NULL)));
    }
    return array;
}

/* ---- Provenance ------------------------------------------------------------------------------ */

static json_t *inputs_to_json(const struct orl_annual_inputs *inputs)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < inputs->count; i++)
        array = orl_json_append(array, json_pack("{s:o, s:I, s:s}", "name",
                                                 orl_json_from_text(inputs->items[i].name), "bytes",
                                                 (json_int_t)inputs->items[i].bytes, "sha256",
                                                 inputs->items[i].digest));
    return array;
}

static json_t *scene_to_json(const struct orl_annual_request *request)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < request->n_scene_files; i++)
        array = orl_json_append(array, orl_json_from_text(request->scene_files[i]));
    return array;
}

static json_t *occupancy_to_json(const struct orl_report_request *report_request)
{
    const struct orl_occupancy *use = &report_request->occupancy;
    if (report_request->occupancy_file)
        return json_pack("{s:o}", "file", orl_json_from_text(report_request->occupancy_file));
    return json_pack("{s:f, s:f, s:i}", "from", use->from_h, "to", use->to_h, "days_of_week",
                     __builtin_popcount(use->days & 0x7f));
}

/* Returns the year's document with the scene given by file names and with the seed used. */
static json_t *document_to_json(const struct orl_annual_job *job)
{
    json_t *document = json_loads(job->document, 0, NULL);
    json_t *formats = json_array();
    if (job->formats.honeybee)
        formats = orl_json_append(formats, json_string("honeybee"));
    if (job->formats.matrices)
        formats = orl_json_append(formats, json_string("ill"));
    if (job->formats.coefficients)
        formats = orl_json_append(formats, json_string("coefficients"));
    if (job->formats.phases)
        formats = orl_json_append(formats, json_string("phases"));
    if (document && json_object_set_new(document, "formats", formats) == 0 &&
        json_object_set_new(document, "scene",
                            json_pack("{s:o}", "files", scene_to_json(&job->request))) == 0 &&
        json_object_set_new(document, "seed", json_integer((json_int_t)job->request.seed)) == 0)
        return document;
    json_decref(document);
    return NULL;
}

static json_t *provenance_to_json(const struct orl_annual_job *job,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_inputs *inputs)
{
    const struct orl_annual_request *request = &job->request;
    return json_pack(
        "{s:s, s:I, s:I, s:o, s:{s:o, s:o, s:o, s:f, s:f, s:s, s:o, s:o, s:I, s:s, s:I}, s:o}",
        "version", ORL_VERSION, "seed", (json_int_t)result->seed, "samples",
        (json_int_t)result->samples, "inputs", inputs_to_json(inputs), "settings", "scene",
        scene_to_json(request), "weather", orl_json_from_text(request->weather_file), "year",
        request->weather_year ? json_integer(request->weather_year) : json_null(), "north",
        request->north_deg, "ground_reflectance", request->ground_reflectance, "sun",
        orl_sun_method_name(request->sun_method), "occupancy",
        occupancy_to_json(&job->report_request), "shades", orl_annual_shades_settings(request),
        "sun_halvings", (json_int_t)request->sun_halvings, "technique",
        orl_annual_technique_name(request->technique), "photons", (json_int_t)request->photons,
        "document", document_to_json(job));
}

/* Encodes the reuse of earlier jobs' results: what was found and what had to be made; json null
 * if no reuse was asked for. */
static json_t *reuse_to_json(const struct orl_annual_result *result)
{
    json_t *reuse = result->reuse.asked ? json_object() : json_null();
    uint64_t saved = 0;
    for (int i = 0; reuse && result->reuse.asked && i < ORL_ANNUAL_CACHE_KINDS; i++) {
        const struct orl_annual_cache_stats *r = &result->reuse.of[i];
        saved += r->rays_saved;
        json_object_set_new(reuse, orl_annual_cache_kind_name((enum orl_annual_cache_kind)i),
                            json_pack("{s:I, s:I, s:I}", "found", (json_int_t)r->found, "topped_up",
                                      (json_int_t)r->topped_up, "made", (json_int_t)r->made));
    }
    if (!result->reuse.asked ||
        json_object_set_new(reuse, "rays_saved", json_integer((json_int_t)saved)) == 0)
        return reuse;
    json_decref(reuse);
    return NULL;
}

/* ---- result.json ----------------------------------------------------------------------------- */

static json_t *timings_to_json(const struct orl_annual_result *result)
{
    json_t *timings = json_pack("{s:f}", "total", result->total_s);
    for (int stage = 0; timings && stage < ORL_ANNUAL_STAGES; stage++)
        timings = orl_json_checked(
            timings,
            json_object_set_new(timings, orl_annual_stage_name((enum orl_annual_stage)stage),
                                json_real(result->timings_s[stage])));
    return timings;
}

static json_t *warnings_to_json(const struct orl_annual_result *result)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < result->n_warnings; i++)
        array = orl_json_append(array, orl_json_from_text(result->warnings[i]));
    return array;
}

static json_t *hours_to_json(const struct orl_annual_report *report)
{
    const struct orl_annual_period *p = report->periods;
    const double per_hour = report->year.steps.per_hour;
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "occupied", p[ORL_WHEN_OCCUPIED].hours,
                     "daylight", p[ORL_WHEN_DAYLIGHT].hours, "year", p[ORL_WHEN_ALWAYS].hours,
                     "missing", (double)report->year.n_missing / per_hour, "doubtful",
                     (double)report->year.n_doubtful / per_hour, "sun_up",
                     (double)report->year.n_columns / per_hour);
}

json_t *orl_annual_refinement_to_json(const struct orl_annual_refinement *r)
{
    if (!r->asked)
        return json_null();
    return json_pack("{s:o, s:s, s:o, s:o, s:s, s:b, s:I, s:I, s:I, s:I}", "target",
                     orl_json_from_text(r->target.text), "unit", unit_of(&r->target.figure),
                     "value", orl_json_from_real(r->area.value.value), "interval_95",
                     interval_to_json(&r->area.value), "verdict", orl_verdict_name(r->verdict),
                     "settled", (int)r->decided, "rounds", (json_int_t)r->rounds, "refined_sensors",
                     (json_int_t)r->refined, "most_samples", (json_int_t)r->most_samples,
                     "sun_halvings", (json_int_t)r->sun_halvings);
}

json_t *orl_annual_report_to_json(const struct orl_annual_job *job,
                                  const struct orl_annual_result *result,
                                  const struct orl_annual_refinement *refinement,
                                  const struct orl_annual_report *report,
                                  const struct orl_annual_inputs *inputs, json_t *files)
{
    json_t *all = report->n_grids > 1 ? figures_to_json(report, report->n_grids) : json_null();
    return json_pack(
        "{s:s, s:s, s:o, s:{s:f, s:f, s:f}, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, "
        "s:O, "
        "s:o, s:o, s:o, s:o, s:I, s:o}",
        "kind", "annual", "state", "succeeded", "title", orl_json_from_text(job->title), "location",
        "latitude", result->site.latitude_deg, "longitude", result->site.longitude_deg, "time_zone",
        result->site.time_zone_h, "hours", hours_to_json(report), "median_diffuse",
        orl_json_from_real(report->median_diffuse_lx), "grids", grids_to_json(report), "all", all,
        "verdicts", verdicts_to_json(report), "rules", rules_to_json(report), "accuracy",
        orl_annual_refinement_to_json(refinement), "shades",
        orl_annual_shades_to_json(&job->request, result, report), "exposure",
        orl_annual_exposure_to_json(&job->report_request.exposure, report), "view_out",
        orl_annual_view_out_to_json(&job->report_request.view_out, report), "glare",
        orl_annual_glare_to_json(&job->report_request.glare, result, report), "files", files,
        "provenance", provenance_to_json(job, result, inputs), "reuse", reuse_to_json(result),
        "rays", json_integer((json_int_t)result->health.rays), "timings_s", timings_to_json(result),
        "threads", (json_int_t)result->threads, "warnings", warnings_to_json(result));
}
