#include "support/plan_query.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

bool plan_holds_number(const char *why)
{
    return strpbrk(why, "0123456789") != NULL;
}

/* A clock that advances with every call. */
static double tick(void *ctx)
{
    double *now = ctx;
    return *now += 0.001;
}

struct orl_plan plan_of(const struct plan_query *q, struct plan_left *ret_left)
{
    static char name[] = "v", view[] = "-vtv -vp 2 4 1.5 -vd 0 -1 0";
    struct orl_view_request views[1] = {{.name = name, .view = view, .width = 64, .height = 48}};
    static const struct orl_sensor inside = {{2, 2.5, .8}, {0, 0, 1}};
    struct orl_thread_pool *pool = orl_thread_pool_start(q->threads ? q->threads : 1);
    struct orl_lit_scene *all =
        build_lit_scene(q->text, q->bsdf ? "pane.xml" : NULL, q->bsdf, pool);
    struct orl_lit_scene *lit_scene = NULL;
    struct orl_plan plan;
    struct orl_job job;
    double now = 0;
    orl_job_init(&job);
    job.technique = q->technique;
    job.overrides[q->effect] = q->override;
    job.photons_caustic = q->caustic ? q->caustic : ORL_PHOTONS_BY_PLAN;
    job.views = q->view ? views : NULL;
    job.n_views = q->view;
    const struct orl_plan_request request = {.job = &job,
                                             .sensors = q->sensor ? q->sensor : &inside,
                                             .n_sensors = !q->view || q->sensor,
                                             .pool = pool,
                                             .now_s = tick,
                                             .ctx = &now};
    assert_int_equal(orl_plan_make(&request, all->lights, &plan, &lit_scene, NULL), 0);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        if (!plan_holds_number(plan.effects[i].why) || plan.effects[i].bound < 0)
            fail_msg("%s: '%s', bound %g", orl_effect_name((enum orl_effect)i), plan.effects[i].why,
                     plan.effects[i].bound);
    if (ret_left)
        *ret_left =
            (struct plan_left){.suns = lit_scene->n_suns,
                               .domes = lit_scene->n_domes,
                               .emitters = lit_scene->n_emitters,
                               .omit = lit_scene->omit,
                               .caustics_lit = lit_scene->caustics_lit,
                               .clear = lit_scene->n_ports > 0 && lit_scene->ports[0].clear,
                               .silent = lit_scene->n_ports > 0 && lit_scene->ports[0].silent};
    orl_lit_scene_free(lit_scene);
    orl_lit_scene_free(all);
    orl_thread_pool_stop(pool);
    return plan;
}

struct orl_plan plan_text(const char *text, struct plan_left *ret_left)
{
    return plan_of(&(struct plan_query){.text = text}, ret_left);
}

void plan_expect_skipped(const char *text, enum orl_effect effect, double bound)
{
    const struct orl_plan plan = plan_text(text, NULL);
    const struct orl_decision *d = &plan.effects[effect];
    if (d->simulated || d->bound > bound)
        fail_msg("%s is simulated, or may cost %g: %s", orl_effect_name(effect), d->bound, d->why);
}

void plan_expect_simulated(const char *text, enum orl_effect effect)
{
    const struct orl_plan plan = plan_text(text, NULL);
    const struct orl_decision *d = &plan.effects[effect];
    if (!d->simulated || !(d->bound > 0))
        fail_msg("%s is skipped, or costs nothing: %s", orl_effect_name(effect), d->why);
}
