/* Requests: defaults, checks, clean-up. */
#include <string.h>

#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/make/panel_request.h"

const char *orl_bsdf_fit_symmetry_name(enum orl_bsdf_fit_symmetry symmetry)
{
    static const char *const names[ORL_BSDF_FIT_SYMMETRIES] = {
        "auto", "isotropic", "quadrilateral", "left_right", "up_down", "half_turn", "none"};
    return (size_t)symmetry < ORL_BSDF_FIT_SYMMETRIES ? names[symmetry] : NULL;
}

void orl_bsdf_fit_request_init(struct orl_bsdf_fit_request *request)
{
    memset(request, 0, sizeof *request);
    request->resolution = 64;
    request->cull = 0.02;
}

void orl_bsdf_fit_request_done(struct orl_bsdf_fit_request *request)
{
    if (!request)
        return;
    orl_gonio_free_names(request->files, request->n_files, request->name);
    memset(request, 0, sizeof *request);
}

int orl_bsdf_fit_validate(const struct orl_bsdf_fit_request *r, struct orl_error *err)
{
    if (r->has_basis && !orl_bsdf_basis_name(r->basis))
        return orl_gonio_refuse(err, ORL_ERR_INVALID, "basis", "the basis is none that there is");
    if (!orl_bsdf_fit_symmetry_name(r->symmetry))
        return orl_gonio_refuse(err, ORL_ERR_INVALID, "symmetry",
                                "the symmetry is none that there is");
    const int code = orl_gonio_check_tree(r->resolution, r->cull, err);
    if (code < 0)
        return code;
    if (!(r->grazing_deg >= 0 && r->grazing_deg <= 45))
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "grazing",
                                "grazing rows are those within 0 to 45 degrees");
    if (r->has_basis && r->basis == ORL_BSDF_TENSOR_TREE_3 && r->symmetry != ORL_BSDF_FIT_AUTO &&
        r->symmetry != ORL_BSDF_FIT_ISOTROPIC)
        return orl_gonio_refuse(err, ORL_ERR_UNSUPPORTED, "basis",
                                "a tensor tree of rank 3 is of isotropic samples");
    return 0;
}
