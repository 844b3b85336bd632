/* Makes a BSDF of a panel in the requested basis. */
#include <stdlib.h>
#include <string.h>

#include "base/sobol.h"
#include "goniometer/klems_matrices.h"
#include "goniometer/panel_mirrors.h"
#include "goniometer/panel_trees.h"

static int make_from_sample(const struct orl_bsdf_make_request *request,
                            const struct orl_bsdf_make_env *env,
                            const struct orl_gonio_sample *sample, struct orl_bsdf_made *made,
                            struct orl_error *err)
{
    struct orl_sobol *sobol = malloc(sizeof *sobol);
    int code;
    if (!sobol)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sobol_init(sobol);
    memcpy(made->cell, sample->sides, sizeof made->cell);
    memcpy(made->depth, sample->depth, sizeof made->depth);
    orl_crew_heed(env->crew, env->cancel);
    struct orl_bsdf_make_request settled = *request;
    settled.symmetry = orl_gonio_mirrors_of(request, sample);
    code = orl_bsdf_basis_is_tree(request->basis)
               ? orl_gonio_make_trees(&settled, env, sample, sobol, made, err)
               : orl_gonio_make_klems(&settled, env, sample, sobol, made, err);
    orl_crew_heed(env->crew, NULL);
    free(sobol);
    return code;
}

int orl_bsdf_make(const struct orl_bsdf_make_request *request, const struct orl_bsdf_make_env *env,
                  struct orl_bsdf_made *ret_made, struct orl_error *err)
{
    struct orl_gonio_sample sample;
    struct orl_bsdf_made made = {0};
    int code = orl_bsdf_make_validate(request, err);
    if (code == 0 && request->n_files == 0)
        code = orl_error_set(err, ORL_ERR_INVALID, "no file of the panel is named");
    if (code == 0)
        code = orl_gonio_sample_load(request, env, &sample, err);
    if (code < 0)
        return code;
    code = make_from_sample(request, env, &sample, &made, err);
    orl_gonio_sample_done(&sample);
    if (code == 0)
        *ret_made = made;
    else
        orl_bsdf_made_done(&made);
    return code;
}

void orl_bsdf_made_done(struct orl_bsdf_made *made)
{
    if (!made)
        return;
    free(made->xml);
    free(made->errors_xml);
    free(made->directions);
    for (int part = 0; part < 4; part++)
        free(made->errors[part / 2][part % 2]);
    memset(made, 0, sizeof *made);
}
