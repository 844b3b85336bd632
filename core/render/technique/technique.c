/* The table of techniques, and their names. */
#include "render/technique/technique.h"

/* Facts while the planner has not chosen a technique. */
static const struct orl_technique_facts undecided = {
    .name = "auto",
    .alternative = ORL_TECHNIQUE_BACKWARD,
    .photons = ORL_PHOTONS_FOR_MAPS,
    .reads_map = {[ORL_MAP_GLOBAL] = true, [ORL_MAP_CAUSTIC] = true},
    .final_gather = ORL_GATHER_NOWHERE};

static const struct orl_technique_definition *const techniques[ORL_TECHNIQUE_COUNT] = {
    [ORL_TECHNIQUE_BACKWARD] = &orl_backward_technique,
    [ORL_TECHNIQUE_GATHER] = &orl_gather_technique,
    [ORL_TECHNIQUE_DIRECT] = &orl_direct_technique,
    [ORL_TECHNIQUE_PRECOMPUTED] = &orl_precomputed_technique};

const struct orl_technique_facts *orl_technique_facts(enum orl_technique technique)
{
    return technique == ORL_TECHNIQUE_AUTO ? &undecided : &techniques[technique]->facts;
}

const char *orl_technique_name(enum orl_technique technique)
{
    return technique < ORL_TECHNIQUE_COUNT ? orl_technique_facts(technique)->name : "unknown";
}

int orl_renderer_create(enum orl_technique technique, const struct orl_lit_scene *lit_scene,
                        struct orl_thread_pool *pool, struct orl_renderer *ret_renderer,
                        struct orl_error *err)
{
    const struct orl_technique_definition *definition = techniques[technique];
    const int code =
        definition->methods->create(definition, lit_scene, pool, &ret_renderer->technique, err);
    ret_renderer->methods = code == 0 ? definition->methods : NULL;
    return code;
}

void orl_renderer_destroy(struct orl_renderer *renderer)
{
    if (renderer->methods)
        renderer->methods->destroy(renderer->technique);
    *renderer = (struct orl_renderer){.methods = NULL};
}
