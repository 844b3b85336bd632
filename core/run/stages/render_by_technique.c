#include "run/run_state.h"
#include "run/stages/run_stages.h"

int orl_run_technique(struct orl_run_state *state, struct orl_error *err)
{
    return state->result->plan.technique == ORL_TECHNIQUE_BACKWARD ? orl_run_backward(state, err)
                                                                   : orl_run_gather(state, err);
}
