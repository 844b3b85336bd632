/* Glare of a view, in the result. */
#ifndef ORL_RUN_STAGES_VIEW_GLARE_H
#define ORL_RUN_STAGES_VIEW_GLARE_H

#include "run/run_state.h"

/* Reads the luminances of the mask that a view with metrics names; the caller owns *ret_mask, which
 * is NULL if there is no mask. Fails if the picture cannot be read or has another size. */
int orl_run_read_mask(const struct orl_files *files, const struct orl_view_request *view,
                      float **ret_mask, struct orl_error *err);

/* Stores the glare of a view with metrics in the result. */
int orl_run_evaluate_glare(struct orl_run_state *state, size_t index, const struct orl_film *film,
                           struct orl_error *err);
/* Stores the errors of that glare, from the view's batches; call it after orl_run_evaluate_glare.
 */
struct orl_view_batches;
int orl_run_evaluate_glare_errors(struct orl_run_state *state, size_t index,
                                  const struct orl_film *film,
                                  const struct orl_view_batches *batches, struct orl_error *err);

#endif
