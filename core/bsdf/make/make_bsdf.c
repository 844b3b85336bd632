/* Entry point: makes a BSDF of a panel in the requested basis. */
#include <stdlib.h>
#include <string.h>

#include "base/sampling/sampling.h"
#include "bsdf/make/make_bsdf.h"
#include "bsdf/make/panel/panel.h"

int orl_gonio_measure(const struct orl_bsdf_make_request *request,
                      const struct orl_bsdf_make_env *env, const struct orl_gonio_sample *sample,
                      struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct orl_bsdf_make_result result = {0};
    struct orl_bsdf_make_request settled = *request;
    struct orl_sobol *sobol = malloc(sizeof *sobol);
    const struct orl_gonio_measurement measurement = {&settled, env, sample, sobol};
    if (!sobol)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sobol_init(sobol);
    memcpy(result.cell, sample->sides, sizeof result.cell);
    memcpy(result.depth, sample->depth, sizeof result.depth);
    orl_thread_pool_set_cancel(env->pool, env->cancel);
    settled.symmetry = orl_gonio_mirrors_of(request, sample);
    const int code = orl_bsdf_basis_is_tree(request->basis)
                         ? orl_gonio_make_trees(&measurement, &result, err)
                         : orl_gonio_make_klems(&measurement, &result, err);
    orl_thread_pool_set_cancel(env->pool, NULL);
    free(sobol);
    if (code == 0)
        *ret_result = result;
    else
        orl_bsdf_make_result_done(&result);
    return code;
}

int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_make_result *ret_result, struct orl_error *err)
{
    struct orl_gonio_sample sample;
    int code = orl_bsdf_make_validate(request, err);
    if (code == 0 && request->n_files == 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "no panel file is given");
    if (code == 0)
        code = orl_gonio_sample_load(request, env, &sample, err);
    if (code < 0)
        return code;
    code = orl_gonio_measure(request, env, &sample, ret_result, err);
    orl_gonio_sample_done(&sample);
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
