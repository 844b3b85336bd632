/* Requests for BSDFs of panels: defaults, checks, clean-up. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf/bsdf_make.h>

#include "base/memory/memory.h"
#include "bsdf/make/make_bsdf.h"

const char *orl_bsdf_basis_name(enum orl_bsdf_basis basis)
{
    static const char *const names[ORL_BSDF_BASES] = {"klems_full", "klems_half", "klems_quarter",
                                                      "tensor_tree_3", "tensor_tree_4"};
    return (size_t)basis < ORL_BSDF_BASES ? names[basis] : NULL;
}

const char *orl_gonio_klems_name(enum orl_bsdf_basis basis)
{
    return basis == ORL_BSDF_KLEMS_FULL   ? "LBNL/Klems Full"
           : basis == ORL_BSDF_KLEMS_HALF ? "LBNL/Klems Half"
                                          : "LBNL/Klems Quarter";
}

void orl_bsdf_make_request_init(struct orl_bsdf_make_request *request)
{
    memset(request, 0, sizeof *request);
    request->resolution = 64;
    request->cull = 0.05;
    request->cull_fraction = ORL_BSDF_CULL_FRACTION;
    request->symmetry = ORL_BSDF_SYMMETRY_AUTO;
    request->paths_most = 1 << 20;
    request->seed = 1;
}

void orl_bsdf_make_request_done(struct orl_bsdf_make_request *request)
{
    if (!request)
        return;
    orl_texts_free(request->files, request->n_files);
    free(request->name);
    memset(request, 0, sizeof *request);
}

int orl_gonio_refuse(struct orl_error *err, int code, const char *member, const char *message)
{
    orl_error_set(err, code, "%s", message);
    orl_error_at(err, NULL, 0, member);
    return code;
}

uint32_t orl_bsdf_make_paths(const struct orl_bsdf_make_request *request)
{
    if (request->paths)
        return request->paths;
    if (request->accuracy > 0 && orl_bsdf_basis_is_tree(request->basis))
        return 2048; /* half of them miss a share of 1 % of the light in less than one case of 10^4
                      */
    return request->basis == ORL_BSDF_TENSOR_TREE_4   ? 4096
           : request->basis == ORL_BSDF_TENSOR_TREE_3 ? 32768
                                                      : 16384;
}

/* Returns the incident cells on both sides; mirrored cells of a tree of rank 4 are not counted. */
static double incident_cells(const struct orl_bsdf_make_request *request)
{
    static const double of_basis[ORL_BSDF_BASES] = {145, 73, 41, 0, 0};
    const double side = request->resolution;
    const int mirrors = (request->symmetry & 1) + (request->symmetry >> 1 & 1);
    if (request->basis == ORL_BSDF_TENSOR_TREE_3)
        return side; /* half as many rings on each side */
    return request->basis == ORL_BSDF_TENSOR_TREE_4 ? 2 * ldexp(side * side, -mirrors)
                                                    : 2 * of_basis[request->basis];
}

double orl_bsdf_make_core_s(const struct orl_bsdf_make_request *request)
{
    return ORL_GONIO_PATH_S * incident_cells(request) * orl_bsdf_make_paths(request);
}

int orl_gonio_check_tree(uint32_t resolution, double cull, struct orl_error *err)
{
    if (resolution < 4 || resolution > 128 || (resolution & (resolution - 1)))
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "resolution",
                                "the resolution must be 4, 8, 16, 32, 64 or 128");
    if (!(cull >= 0 && cull <= 1))
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "cull", "the cull must be a share from 0 to 1");
    return 0;
}

/* Checks parameters of trees, and those allowed for matrices only. */
static int validate_tree(const struct orl_bsdf_make_request *r, struct orl_error *err)
{
    const int code = orl_gonio_check_tree(r->resolution, r->cull, err);
    if (code < 0)
        return code;
    if (r->basis == ORL_BSDF_TENSOR_TREE_3 && r->symmetry != ORL_BSDF_ASYMMETRIC &&
        r->symmetry != ORL_BSDF_SYMMETRY_AUTO)
        return orl_gonio_refuse(
            err, ORL_ERR_UNSUPPORTED, "symmetry",
            "a tensor tree of rank 3 is isotropic: a mirror symmetry does not apply to it");
    return 0;
}

int orl_bsdf_make_validate(const struct orl_bsdf_make_request *r, struct orl_error *err)
{
    if (!orl_bsdf_basis_name(r->basis))
        return orl_gonio_refuse(err, ORL_ERR_INVALID, "basis", "the basis is unknown");
    const uint32_t paths = orl_bsdf_make_paths(r);
    if (paths < ORL_BSDF_MAKE_PATHS_LEAST || paths > ORL_BSDF_MAKE_PATHS_MOST)
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "paths",
                                "paths must be from 16 to 16777216 per direction");
    if (!(r->accuracy >= 0 && r->accuracy < 1))
        return orl_gonio_refuse(err, ORL_ERR_RANGE, "accuracy",
                                "the accuracy must be above 0 and below 1");
    if (r->accuracy > 0 && (r->paths_most < paths || r->paths_most > ORL_BSDF_MAKE_PATHS_MOST))
        return orl_gonio_refuse(
            err, ORL_ERR_RANGE, "paths_most",
            "paths_most must be at least the initial number of paths, and at most 16777216");
    for (int i = 0; r->has_cell && i < 4; i++)
        if (!isfinite(r->cell[i]) || (i % 2 == 1 && !(r->cell[i] > r->cell[i - 1])))
            return orl_gonio_refuse(err, ORL_ERR_RANGE, "cell",
                                    "a cell must be x from, x to, y from, y to, in that order");
    return orl_bsdf_basis_is_tree(r->basis) ? validate_tree(r, err) : 0;
}
