#include "bsdf_json/bsdf_json.h"

#include <math.h>
#include <string.h>

#include "schemas.h"
#include "json/decode.h"
#include "json/encode.h"

/* ---- Request --------------------------------------------------------------------------------- */

struct draft {
    enum orl_job_origin origin;
    struct orl_bsdf_make_request request;
    char *scene_id;
};

/* Decodes the scene as a job's and moves its files into the request. */
static int decode_scene(const json_t *scene, const char *path, void *into, struct orl_error *err)
{
    struct draft *draft = into;
    return orl_job_files_from_json(scene, path, draft->origin, &draft->request.files,
                                   &draft->request.n_files, &draft->scene_id, err);
}

static int decode_range(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    static const char wanted[] = "two numbers are expected, from and to";
    double *ends = into;
    if (!json_is_array(value) || json_array_size(value) != 2)
        return orl_json_fail(err, ORL_ERR_INVALID, path, wanted);
    for (size_t i = 0; i < 2; i++) {
        const struct orl_json_member end = {.real = &ends[i]};
        const int rc = orl_json_value(json_array_get(value, i), path,
                                      orl_schema_bsdf_make_range.items, &end, err);
        if (rc)
            return rc;
    }
    return ends[1] > ends[0] ? 0 : orl_json_fail(err, ORL_ERR_RANGE, path, wanted);
}

static int decode_cell(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_bsdf_make_request *r = into;
    const struct orl_json_member members[] = {{"x", .decode = decode_range, .into = r->cell},
                                              {"y", .decode = decode_range, .into = r->cell + 2},
                                              {0}};
    r->has_cell = true;
    return orl_json_members(value, path, &orl_schema_bsdf_cell, members, err);
}

static int decode_members(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    struct orl_bsdf_make_request *r = &draft->request;
    const struct orl_json_member members[] = {{.name = "kind"},
                                              {"scene", .decode = decode_scene, .into = draft},
                                              {"name", .text = &r->name},
                                              {"basis", .word = &r->basis},
                                              {"color", .flag = &r->color},
                                              {"cell", .decode = decode_cell, .into = r},
                                              {"symmetry", .word = &r->symmetry},
                                              {"resolution", .whole_32 = &r->resolution},
                                              {"cull", .real = &r->cull},
                                              {"paths", .whole_32 = &r->paths},
                                              {"accuracy", .real = &r->accuracy},
                                              {"paths_most", .whole_32 = &r->paths_most},
                                              {"seed", .whole = &r->seed},
                                              {.name = "priority"},
                                              {.name = "tags"},
                                              {0}};
    return orl_json_members(doc, "", &orl_schema_bsdf_make_request, members, err);
}

int orl_bsdf_check_tree_members(const json_t *doc, enum orl_bsdf_basis basis, struct orl_error *err)
{
    static const char *const members[] = {"resolution", "cull"};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (!orl_bsdf_basis_is_tree(basis) && json_object_get(doc, members[i]))
            return orl_json_fail(err, ORL_ERR_INVALID, members[i],
                                 "this member is for tensor trees, and the basis is not one");
    return 0;
}

static int decode_document(const json_t *doc, struct draft *draft, struct orl_error *err)
{
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (json_is_object(doc) && (!kind || strcmp(kind, "bsdf_make") != 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "kind",
                             "a document that makes a BSDF needs \"kind\": \"bsdf_make\"");
    int rc = decode_members(doc, draft, err);
    if (rc == 0)
        rc = orl_bsdf_check_tree_members(doc, draft->request.basis, err);
    if (rc == 0 && json_object_get(doc, "paths_most") && !(draft->request.accuracy > 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "paths_most",
                             "it limits the paths for \"accuracy\", which is not given");
    return rc;
}

int orl_bsdf_make_from_json(const json_t *doc, enum orl_job_origin origin,
                            struct orl_bsdf_make_request *ret_request, char **ret_scene_id,
                            struct orl_error *err)
{
    struct draft draft = {.origin = origin};
    orl_bsdf_make_request_init(&draft.request);
    const int rc = decode_document(doc, &draft, err);
    if (rc)
        orl_bsdf_make_request_done(&draft.request);
    else
        *ret_request = draft.request;
    return orl_json_return_text(draft.scene_id, ret_scene_id, rc);
}

/* ---- Result ---------------------------------------------------------------------------------- */

/* json_pack's "o" fails on NULL, so that one check covers all parts. */

static json_t *share_to_json(struct orl_bsdf_share share)
{
    return json_pack("{s:f, s:f}", "value", share.value, "standard_error", share.error);
}

static json_t *side_to_json(const struct orl_bsdf_share shares[2])
{
    return json_pack("{s:o, s:o}", "reflected", share_to_json(shares[0]), "transmitted",
                     share_to_json(shares[1]));
}

static json_t *directions_to_json(const struct orl_bsdf_make_result *made)
{
    json_t *list = json_array();
    for (size_t i = 0; list && i < made->n_directions; i++) {
        const struct orl_bsdf_make_direction *d = &made->directions[i];
        if (json_array_append_new(list, json_pack("{s:f, s:f, s:o, s:o}", "theta_deg", d->theta_deg,
                                                  "phi_deg", d->phi_deg, "front",
                                                  side_to_json(d->shares[1]), "back",
                                                  side_to_json(d->shares[0])))) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *row_to_json(const float *values, size_t count)
{
    json_t *row = json_array();
    for (size_t i = 0; row && i < count; i++)
        row = orl_json_append(row, json_real((double)values[i]));
    return row;
}

static json_t *errors_to_json(const float *errors, size_t cells)
{
    json_t *rows = errors ? json_array() : json_null();
    for (size_t i = 0; errors && rows && i < cells; i++)
        rows = orl_json_append(rows, row_to_json(errors + i * cells, cells));
    return rows;
}

json_t *orl_bsdf_made_to_json(const struct orl_bsdf_make_result *m)
{
    const size_t n = m->n_directions;
    return json_pack("{s:s, s:{s:o, s:o}, s:o, s:{s:o, s:o, s:o, s:o}, s:f, s:f, s:b, s:I, s:f, "
                     "s:{s:[f, f], s:[f, "
                     "f], s:[f, f]}}",
                     "kind", "bsdf_make", "diffuse", "front", side_to_json(m->diffuse[1]), "back",
                     side_to_json(m->diffuse[0]), "directions", directions_to_json(m),
                     "standard_errors", "transmission_front", errors_to_json(m->errors[1][1], n),
                     "transmission_back", errors_to_json(m->errors[0][1], n), "reflection_front",
                     errors_to_json(m->errors[1][0], n), "reflection_back",
                     errors_to_json(m->errors[0][0], n), "worst_relative_error", m->worst,
                     "joined_relative_error", m->merge_error, "reached", (int)m->reached, "paths",
                     (json_int_t)m->paths, "lost", m->lost, "cell", "x", m->cell[0], m->cell[1],
                     "y", m->cell[2], m->cell[3], "z", m->depth[0], m->depth[1]);
}

/* Returns true if all light is transmitted and none reflected, up to rounding. */
static bool is_air(const struct orl_bsdf_make_result *made)
{
    const double rounding = 1e-9;
    for (int side = 0; side < 2; side++) {
        const struct orl_bsdf_share *s = made->diffuse[side];
        if (!(fabs(s[1].value - 1) < rounding) || s[0].value != 0)
            return false;
    }
    return true;
}

json_t *orl_bsdf_made_warnings(const struct orl_bsdf_make_result *made,
                               const struct orl_bsdf_make_request *request)
{
    const double lost_unsaid = 1e-4;
    json_t *list = json_array();
    int rc = list ? 0 : -1;
    if (!made->reached)
        rc |= json_array_append_new(
            list, json_sprintf("the accuracy was not reached within %u paths per direction: the "
                               "largest standard error is %.2g %% of its value",
                               request->paths_most, 100 * made->worst));
    if (is_air(made))
        rc |= json_array_append_new(
            list, json_sprintf("no ray hit a surface in the cell, x %g to %g, y %g to %g: all "
                               "light passes through it unchanged",
                               made->cell[0], made->cell[1], made->cell[2], made->cell[3]));
    if (made->lost > lost_unsaid)
        rc |= json_array_append_new(list,
                                    json_sprintf("%.2g %% of the light is missing: its paths "
                                                 "inside the panel were too long and were cut off",
                                                 100 * made->lost));
    return orl_json_checked(list, rc);
}
