#include "bsdf_json/bsdf_json.h"

#include <math.h>
#include <string.h>

#include "schemas.h"
#include "json/decode.h"
#include "json/encode.h"

/* ---- Request --------------------------------------------------------------------------------- */

struct draft {
    enum orl_job_origin origin;
    struct orl_bsdf_fit_request request;
    char *scene_id;
};

/* Decodes the files as a job's scene and moves them into the request. */
static int decode_files(const json_t *files, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    return orl_job_files_from_json(files, path, draft->origin, &draft->request.files,
                                   &draft->request.n_files, &draft->scene_id, err);
}

static int decode_members(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    struct orl_bsdf_fit_request *r = &draft->request;
    const struct orl_json_member members[] = {
        {.name = "kind"},
        {"measurements", .decode = decode_files, .into = draft},
        {"name", .text = &r->name},
        {"basis", .word = &r->basis},
        {"symmetry", .word = &r->symmetry},
        {"resolution", .whole_32 = &r->resolution},
        {"cull", .real = &r->cull},
        {"reversed", .flag = &r->reversed},
        {"keep_outliers", .flag = &r->keep_outliers},
        {"grazing", .real = &r->grazing_deg},
        {.name = "priority"},
        {.name = "tags"},
        {0}};
    return orl_json_members(doc, "", &orl_schema_bsdf_fit_request, members, err);
}

static int decode_document(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (json_is_object(doc) && (!kind || strcmp(kind, "bsdf_fit") != 0))
        return orl_json_fail(
            err, ORL_ERR_INVALID, "kind",
            "a document that fits a BSDF to measurements needs \"kind\": \"bsdf_fit\"");
    const int rc = decode_members(doc, draft, err);
    draft->request.has_basis = json_object_get(doc, "basis") != NULL;
    return rc == 0 && draft->request.has_basis
               ? orl_bsdf_check_tree_members(doc, draft->request.basis, err)
               : rc;
}

int orl_bsdf_fit_from_json(const json_t *doc, enum orl_job_origin origin,
                           struct orl_bsdf_fit_request *ret_request, char **ret_scene_id,
                           struct orl_error *err)
{
    struct draft draft = {.origin = origin};
    orl_bsdf_fit_request_init(&draft.request);
    const int rc = decode_document(doc, &draft, err);
    if (rc)
        orl_bsdf_fit_request_done(&draft.request);
    else
        *ret_request = draft.request;
    return orl_json_return_text(draft.scene_id, ret_scene_id, rc);
}

/* ---- Result ---------------------------------------------------------------------------------- */

/* json_pack's "o" fails on NULL, so that one check covers all parts. */

json_t *orl_bsdf_measurements_to_json(const struct orl_bsdf_measurements *m)
{
    return json_pack("{s:I, s:I, s:s?}", "rows", (json_int_t)m->rows, "incident_directions",
                     (json_int_t)m->directions, "sample", m->sample[0] ? m->sample : NULL);
}

static const char *const names[2][2] = {{"reflection_back", "transmission_back"},
                                        {"reflection_front", "transmission_front"}};

static json_t *number_or_null(double value, bool given)
{
    return given ? json_real(value) : json_null();
}

static json_t *component_to_json(const struct orl_bsdf_fit_result *f, int front, int t)
{
    const bool left_out = f->misplaced[front][t] >= 0;
    if (!f->has[front][t])
        return json_null();
    return json_pack("{s:{s:f, s:o}, s:o, s:f}", "diffuse", "value", f->diffuse[front][t].value,
                     "error", number_or_null(f->diffuse[front][t].error, left_out), "misplaced",
                     number_or_null(f->misplaced[front][t], left_out), "theta_most_deg",
                     f->theta_most_deg[front][t]);
}

static json_t *left_out_to_json(const struct orl_bsdf_fit_scan *s)
{
    return s->left_out
               ? json_pack("{s:f, s:f}", "predicted", s->predicted, "misplaced", s->misplaced)
               : json_null();
}

static json_t *scan_to_json(const struct orl_bsdf_fit_scan *s)
{
    return json_pack(
        "{s:s, s:f, s:f, s:I, s:I, s:I, s:f, s:f, s:f, s:{s:f, s:f}, s:{s:f, s:f, s:f}, s:o}",
        "component", names[s->front][s->transmitted], "theta_deg", s->theta_deg, "phi_deg",
        s->phi_deg, "rows", (json_int_t)s->rows, "outliers", (json_int_t)s->outliers, "knots",
        (json_int_t)s->centers, "covered", s->covered, "hidden_deg", s->hidden_deg, "noise",
        s->noise, "total", "value", s->total, "standard_error", s->total_error, "peak", "value",
        s->peak, "theta_deg", s->peak_theta_deg, "phi_deg", s->peak_phi_deg, "left_out",
        left_out_to_json(s));
}

static json_t *scans_to_json(const struct orl_bsdf_fit_result *f)
{
    json_t *list = json_array();
    for (size_t i = 0; list && i < f->n_scans; i++)
        list = orl_json_append(list, scan_to_json(&f->scans[i]));
    return list;
}

static json_t *outliers_to_json(const struct orl_bsdf_fit_request *request,
                                const struct orl_bsdf_fit_result *f)
{
    json_t *list = json_array();
    for (size_t i = 0; list && i < f->n_outliers && i < ORL_BSDF_FIT_MAX_OUTLIERS; i++) {
        const struct orl_bsdf_outlier *o = &f->outliers[i];
        if (json_array_append_new(
                list, json_pack("{s:s, s:I, s:f, s:f}", "file", request->files[o->file], "line",
                                (json_int_t)o->line, "value", o->value, "around", o->around))) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

json_t *orl_bsdf_fitted_to_json(const struct orl_bsdf_fit_request *request,
                                const struct orl_bsdf_fit_result *f)
{
    return json_pack("{s:s, s:s, s:s, s:I, s:{s:o, s:o, s:o, s:o}, s:o, s:{s:I, s:o}, s:b}", "kind",
                     "bsdf_fit", "basis", orl_bsdf_basis_name(f->basis), "symmetry",
                     orl_bsdf_fit_symmetry_name(f->symmetry), "rows", (json_int_t)f->rows,
                     "components", names[1][1], component_to_json(f, 1, 1), names[0][1],
                     component_to_json(f, 0, 1), names[1][0], component_to_json(f, 1, 0),
                     names[0][0], component_to_json(f, 0, 0), "scans", scans_to_json(f), "outliers",
                     "count", (json_int_t)f->n_outliers, "told", outliers_to_json(request, f),
                     "color_left_out", (int)f->color_left_out);
}

/* ---- Warnings -------------------------------------------------------------------------------- */

/* Warns of unmeasured directions that may hide a peak, and of a total more than three standard
 * errors above 1. */
static int warn_of_scan(json_t *list, const struct orl_bsdf_fit_scan *s)
{
    const char *from = s->front ? "inside" : "outside";
    int rc = 0;
    if (s->hidden_deg > 0)
        rc |= json_array_append_new(
            list, json_sprintf("light from the %s, theta %.4g, phi %.4g: around the %s direction "
                               "nothing was measured within %.2g degrees; a peak there is lost",
                               from, s->theta_deg, s->phi_deg,
                               s->transmitted ? "straight" : "mirrored", s->hidden_deg));
    if (s->total > 1 + 3 * s->total_error)
        rc |= json_array_append_new(
            list,
            json_sprintf(
                "light from the %s, theta %.4g, phi %.4g: %.4g times the incident light is %s",
                from, s->theta_deg, s->phi_deg, s->total,
                s->transmitted ? "transmitted" : "reflected"));
    return rc;
}

json_t *orl_bsdf_fitted_warnings(const struct orl_bsdf_fit_result *f)
{
    json_t *list = json_array();
    int rc = list ? 0 : -1;
    for (size_t i = 0; i < f->n_scans && rc == 0; i++)
        rc = warn_of_scan(list, &f->scans[i]);
    for (int i = 0; i < 4 && rc == 0; i++)
        if (f->has[i / 2][i % 2] && f->misplaced[i / 2][i % 2] < 0)
            rc = json_array_append_new(
                list,
                json_sprintf("light from the %s, %s: too few incident directions to check the "
                             "interpolation between them",
                             i / 2 ? "inside" : "outside", i % 2 ? "transmitted" : "reflected"));
    if (f->color_left_out && rc == 0)
        rc = json_array_append_new(list, json_string("the fit keeps only Y of CIE-XYZ values"));
    if (rc == 0)
        return list;
    json_decref(list);
    return NULL;
}
