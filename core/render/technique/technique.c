/* The table of techniques, and their names. */
#include "render/technique/technique.h"

/* Facts while the planner has not chosen a technique. */
static const struct orl_technique_facts undecided = {
    .name = "auto",
    .alternative = ORL_TECHNIQUE_BACKWARD,
    .photons = ORL_PHOTONS_FOR_MAPS,
    .reads_map = {[ORL_MAP_GLOBAL] = true, [ORL_MAP_CAUSTIC] = true},
    .final_gather = ORL_GATHER_NOWHERE};

static const struct orl_technique_methods *const techniques[ORL_TECHNIQUE_COUNT] = {
    [ORL_TECHNIQUE_BACKWARD] = &orl_backward_technique,
    [ORL_TECHNIQUE_GATHER] = &orl_gather_technique,
    [ORL_TECHNIQUE_DIRECT] = &orl_direct_technique,
    [ORL_TECHNIQUE_PRECOMPUTED] = &orl_precomputed_technique};

const struct orl_technique_methods *orl_technique_methods(enum orl_technique technique)
{
    return techniques[technique];
}

const struct orl_technique_facts *orl_technique_facts(enum orl_technique technique)
{
    return technique == ORL_TECHNIQUE_AUTO ? &undecided : &techniques[technique]->facts;
}

const char *orl_technique_name(enum orl_technique technique)
{
    return technique < ORL_TECHNIQUE_COUNT ? orl_technique_facts(technique)->name : "unknown";
}
