/* Converts a BSDF to another basis: measures the file in place of a panel. */
#include <oriel/bsdf/bsdf_convert.h>

#include "bsdf/make/klems/klems_matrices.h"
#include "bsdf/make/panel/panel_mirrors.h"
#include "bsdf/make/trees/panel_trees.h"

static int check_request(const struct orl_bsdf_make_request *to, struct orl_error *err)
{
    if (to->accuracy > 0 || to->paths > 0)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "a BSDF that is converted takes no paths, and has no accuracy");
    return orl_bsdf_make_validate(to, err);
}

int orl_bsdf_convert(const struct orl_bsdf *bsdf, const char *source,
                     const struct orl_bsdf_make_request *to, const struct orl_bsdf_make_env *env,
                     struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct orl_bsdf_info info;
    struct orl_bsdf_make_request request = *to;
    struct orl_bsdf_make_result result = {0};
    int code = check_request(to, err);
    if (code < 0)
        return code;
    orl_bsdf_describe(bsdf, &info);
    if (!request.name)
        request.name = info.name;
    const struct orl_gonio_sample sample = {
        .file = bsdf, .source = source, .depth = {0, info.thickness_m}};
    result.depth[1] = info.thickness_m;
    request.symmetry = orl_gonio_mirrors_of(to, &sample);
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    code = orl_bsdf_basis_is_tree(to->basis)
               ? orl_gonio_make_trees(&request, env, &sample, NULL, &result, err)
               : orl_gonio_make_klems(&request, env, &sample, NULL, &result, err);
    orl_thread_pool_set_cancel(env->pool, NULL);
    result.paths = 0;
    if (code == 0)
        *ret_result = result;
    else
        orl_bsdf_make_result_done(&result);
    return code;
}
