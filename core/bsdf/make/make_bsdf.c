/* Entry point: makes a BSDF of a panel in the requested basis. */
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "bsdf/make/make_bsdf.h"
#include "bsdf/make/panel/panel.h"

static int make_from_sample(const struct orl_bsdf_make_request *request,
                            const struct orl_bsdf_make_env *env,
                            const struct orl_gonio_sample *sample,
                            struct orl_bsdf_make_result *result, struct orl_error *err)
{
    struct orl_sobol *sobol = malloc(sizeof *sobol);
    int code;
    if (!sobol)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sobol_init(sobol);
    memcpy(result->cell, sample->sides, sizeof result->cell);
    memcpy(result->depth, sample->depth, sizeof result->depth);
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    struct orl_bsdf_make_request settled = *request;
    settled.symmetry = orl_gonio_mirrors_of(request, sample);
    code = orl_bsdf_basis_is_tree(request->basis)
               ? orl_gonio_make_trees(&settled, env, sample, sobol, result, err)
               : orl_gonio_make_klems(&settled, env, sample, sobol, result, err);
    orl_thread_pool_set_cancel(env->pool, NULL);
    free(sobol);
    return code;
}

int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct orl_gonio_sample sample;
    struct orl_bsdf_make_result result = {0};
    int code = orl_bsdf_make_validate(request, err);
    if (code == 0 && request->n_files == 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "no panel file is given");
    if (code == 0)
        code = orl_gonio_sample_load(request, env, &sample, err);
    if (code < 0)
        return code;
    code = make_from_sample(request, env, &sample, &result, err);
    orl_gonio_sample_done(&sample);
    if (code == 0)
        *ret_result = result;
    else
        orl_bsdf_make_result_done(&result);
    return code;
}

void orl_bsdf_make_result_done(struct orl_bsdf_make_result *result)
{
    if (!result)
        return;
    free(result->xml);
    free(result->errors_xml);
    free(result->directions);
    for (int part = 0; part < 4; part++)
        free(result->errors[part / 2][part % 2]);
    memset(result, 0, sizeof *result);
}
