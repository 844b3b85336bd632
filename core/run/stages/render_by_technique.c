#include "run/stages.h"

int orl_run_technique(struct orl_run_state *state, struct orl_error *err)
{
    return state->result->plan.technique == ORL_TECHNIQUE_BACKWARD ? orl_run_backward(state, err)
                                                                   : orl_run_gather(state, err);
}
