/* The glare of a finished view. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metrics/glare.h"
#include "run/diagnostics/diagnostics.h"
#include "run/run_state.h"
#include "run/stages/rendering.h"

/* A view that covers less than this share of the hemisphere lacks light at the eye. */
static const double almost_all = 0.98;

/* Warns once for a view, for any number of rounds. */
static void warn_of_field(struct orl_run_state *state, const struct orl_view_request *request,
                          const struct orl_glare *glare)
{
    const double share = glare->field_sr / (2 * ORL_PI);
    if (request->glare.eye_lx > 0 || share >= almost_all)
        return;
    orl_run_warn_once(state,
                      "view '%s' covers %.0f %% of the hemisphere: its glare metrics lack light "
                      "from outside the view",
                      request->name, 100 * share);
}

int orl_run_read_mask(const struct orl_files *files, const struct orl_view_request *view,
                      float **ret_mask, struct orl_error *err)
{
    const char *name = view->glare.mask;
    struct orl_file file;
    *ret_mask = NULL;
    if (view->metrics == 0 || !name[0])
        return 0;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    const struct orl_picture_bytes bytes = {name, file.data, file.size};
    code = orl_glare_read_mask(&bytes, view->width, view->height, ret_mask, err);
    files->close(files->ctx, &file);
    return code;
}

static int compute_glare(const struct orl_run_env *env, const struct orl_view_request *request,
                         const struct orl_film *film, struct orl_glare *ret_glare,
                         struct orl_error *err)
{
    struct orl_view view;
    float *cd_m2 = orl_film_luminances(film), *mask = NULL;
    int code = cd_m2 ? orl_view_parse(request->view, &view, err)
                     : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for glare");
    if (code == 0)
        code = orl_run_read_mask(env->files, request, &mask, err);
    const struct orl_glare_picture glare_picture = {&view, film->width, film->height,
                                                    cd_m2, mask,        env->cancel};
    if (code == 0)
        code = orl_glare_worst_direction(&glare_picture, &request->glare, ret_glare, err);
    free(cd_m2);
    free(mask);
    return code;
}

int orl_run_evaluate_glare(struct orl_run_state *state, size_t index, const struct orl_film *film,
                           struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view_result *result = &state->result->views[index];
    if (request->metrics == 0)
        return 0;
    struct orl_glare *glare = calloc(1, sizeof *glare);
    if (!glare)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for glare");
    const int code = compute_glare(state->env, request, film, glare, err);
    if (code < 0) {
        free(glare);
        return code;
    }
    result->glare = glare;
    result->metrics = request->metrics;
    warn_of_field(state, request, glare);
    return 0;
}

int orl_run_evaluate_glare_errors(struct orl_run_state *state, size_t index,
                                  const struct orl_film *film,
                                  const struct orl_view_batches *batches, struct orl_error *err)
{
    const struct orl_view_request *request = &state->job->views[index];
    struct orl_view view;
    const struct orl_glare_picture glare_picture = {
        .view = &view, .width = film->width, .height = film->height, .cancel = state->env->cancel};
    const int code = orl_view_parse(request->view, &view, err);
    return code < 0 ? code
                    : orl_glare_errors(batches, &glare_picture, &request->glare,
                                       state->result->views[index].glare, err);
}
