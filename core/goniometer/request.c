/* Requests: defaults, checks, clean-up. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/bsdf_make.h>

const char *orl_bsdf_basis_name(enum orl_bsdf_basis basis)
{
    static const char *const names[ORL_BSDF_BASES] = {"klems_full", "klems_half", "klems_quarter"};
    return (size_t)basis < ORL_BSDF_BASES ? names[basis] : NULL;
}

void orl_bsdf_make_request_init(struct orl_bsdf_make_request *request)
{
    memset(request, 0, sizeof *request);
    request->paths = 16384;
    request->paths_most = 1 << 20;
    request->seed = 1;
}

void orl_bsdf_make_request_done(struct orl_bsdf_make_request *request)
{
    if (!request)
        return;
    for (size_t i = 0; i < request->n_files; i++)
        free(request->files[i]);
    free(request->files);
    free(request->name);
    memset(request, 0, sizeof *request);
}

static int fail(struct orl_error *err, int code, const char *member, const char *message)
{
    orl_error_set(err, code, "%s", message);
    orl_error_at(err, NULL, 0, member);
    return code;
}

int orl_bsdf_make_validate(const struct orl_bsdf_make_request *r, struct orl_error *err)
{
    if (r->n_files == 0)
        return fail(err, ORL_ERR_INVALID, "scene", "no file of the panel is named");
    if (!orl_bsdf_basis_name(r->basis))
        return fail(err, ORL_ERR_INVALID, "basis", "the basis is none that there is");
    if (r->paths < ORL_BSDF_MAKE_PATHS_LEAST || r->paths > ORL_BSDF_MAKE_PATHS_MOST)
        return fail(err, ORL_ERR_RANGE, "paths", "from 16 to 16777216 paths a direction");
    if (!(r->accuracy >= 0 && r->accuracy < 1))
        return fail(err, ORL_ERR_RANGE, "accuracy", "an accuracy is above 0 and below 1");
    if (r->accuracy > 0 && (r->paths_most < r->paths || r->paths_most > ORL_BSDF_MAKE_PATHS_MOST))
        return fail(err, ORL_ERR_RANGE, "paths_most",
                    "the most paths are no fewer than those to begin with, and at most 16777216");
    for (int i = 0; r->has_cell && i < 4; i++)
        if (!isfinite(r->cell[i]) || (i % 2 == 1 && !(r->cell[i] > r->cell[i - 1])))
            return fail(err, ORL_ERR_RANGE, "cell",
                        "a cell is x from, x to, y from, y to, in that order");
    return 0;
}
