/* Documents that request the BSDF of a panel, as the command line and the daemon read them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bsdf_json/bsdf_json.h"
#include "fuzz/fuzz.h"
#include "json/decode.h"

/* Checks that every accepted request is within bounds. */
static void check_request(const struct orl_bsdf_make_request *r, bool local)
{
    struct orl_error err = {0};
    FUZZ_PROMISE(local == (r->n_files > 0));
    FUZZ_PROMISE(orl_bsdf_basis_name(r->basis) != NULL);
    FUZZ_PROMISE((unsigned)r->symmetry <= ORL_BSDF_SYMMETRY_AUTO);
    FUZZ_PROMISE(r->resolution >= 4 && r->resolution <= 128);
    FUZZ_PROMISE(r->cull >= 0 && r->cull <= 1);
    FUZZ_PROMISE(r->accuracy >= 0 && r->accuracy < 1);
    FUZZ_PROMISE(!r->name || strlen(r->name) > 0);
    for (int i = 0; r->has_cell && i < 4; i++)
        FUZZ_PROMISE(isfinite(r->cell[i]) && (i % 2 == 0 || r->cell[i] > r->cell[i - 1]));
    const int code = orl_bsdf_make_validate(r, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return;
    }
    const uint32_t paths = orl_bsdf_make_paths(r);
    FUZZ_PROMISE(paths >= ORL_BSDF_MAKE_PATHS_LEAST && paths <= ORL_BSDF_MAKE_PATHS_MOST);
    FUZZ_PROMISE(!orl_bsdf_basis_is_tree(r->basis) || !(r->resolution & (r->resolution - 1)));
}

static bool check_document(const json_t *doc, enum orl_job_origin origin)
{
    struct orl_bsdf_make_request request;
    struct orl_error err = {0};
    char *id = NULL;
    const int code = orl_bsdf_make_from_json(doc, origin, &request, &id, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(id == NULL);
        return false;
    }
    FUZZ_PROMISE((origin == ORL_JOB_REMOTE) == (id != NULL));
    check_request(&request, origin == ORL_JOB_LOCAL);
    orl_bsdf_make_request_done(&request);
    free(id);
    return true;
}

bool fuzz_bsdf_make(const uint8_t *data, size_t size)
{
    struct orl_error err = {0};
    json_t *doc = NULL;
    const int code = orl_json_parse("make.json", (const char *)data, size, &doc, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        return false;
    }
    bool accepted = check_document(doc, ORL_JOB_LOCAL);
    accepted |= check_document(doc, ORL_JOB_REMOTE);
    json_decref(doc);
    return accepted;
}
