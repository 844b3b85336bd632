/* A year with shades: which states there are in which hours, a run of each combination of them, and
 * of every hour the run that has its states. */
#include <stdlib.h>
#include <string.h>

#include "annual/schedule.h"
#include "annual/variant.h"
#include "annual/year.h"

enum { MOST = ORL_SHADES_MOST_RUNS };

struct shading {
    const struct orl_annual_request *request;
    const struct orl_annual_env *env;
    struct orl_annual_result *result; /* of all open, which becomes that of all */
    struct orl_year *reader;          /* of the hours alone */
    unsigned char *states;            /* [group * n_steps + step] */
    unsigned char (*combinations)[ORL_SHADES_MOST_GROUPS]; /* the first: all open */
    size_t n_combinations;
    unsigned char *which; /* of them, by column */
    double told;          /* of the whole, by runs that are over */
    struct orl_error *err;
};

static int no_memory(const struct shading *s)
{
    return orl_year_no_memory(s->err);
}

/* ---- Hours ----------------------------------------------------------------------------------- */

static int read_hours(struct shading *s)
{
    struct orl_crew *crew = s->env->run->crew;
    s->reader->request = s->request;
    s->reader->env = s->env;
    s->reader->result = s->result;
    s->reader->started_s = orl_year_now(s->reader);
    double since = s->reader->started_s;
    orl_year_tell(s->reader, ORL_STAGE_LOAD, 0);
    orl_bins_init(&s->reader->bins);
    orl_crew_heed(crew, s->env->run->cancel);
    const int code = orl_year_read_hours(s->reader, s->err);
    orl_crew_heed(crew, NULL);
    if (code < 0)
        return code;
    orl_year_tell_hours(s->reader);
    orl_year_book(s->reader, ORL_ANNUAL_SKIES, &since);
    s->states = calloc(s->request->n_groups * s->result->n_steps + 1, 1);
    s->which = calloc(s->result->n_columns + 1, 1);
    s->combinations = calloc(MOST, sizeof *s->combinations);
    s->n_combinations = 1;
    if (!s->states || !s->which || !s->combinations)
        return no_memory(s);
    return orl_shades_schedule(s->request, s->result, s->states, s->err);
}

/* ---- A run ----------------------------------------------------------------------------------- */

/* What it warns of that was not said before goes into the result. */
static int take_warnings(struct shading *s, struct orl_annual_result *run)
{
    struct orl_annual_result *all = s->result;
    for (size_t i = 0; i < run->n_warnings; i++) {
        size_t k = 0;
        while (k < all->n_warnings && strcmp(all->warnings[k], run->warnings[i]) != 0)
            k++;
        if (k < all->n_warnings)
            continue;
        char **grown = realloc(all->warnings, (all->n_warnings + 1) * sizeof *grown);
        if (!grown)
            return no_memory(s);
        all->warnings = grown;
        grown[all->n_warnings++] = run->warnings[i];
        if (s->env->run->warned)
            s->env->run->warned(s->env->run->ctx, run->warnings[i]);
        run->warnings[i] = NULL;
    }
    return 0;
}

static int take_account(struct shading *s, struct orl_annual_result *run)
{
    for (int i = 0; i < ORL_ANNUAL_STAGES; i++)
        s->result->timings_s[i] += run->timings_s[i];
    orl_health_add(&s->result->health, &run->health);
    for (size_t i = 0; i < run->n_scene_read; i++)
        if (orl_annual_note_read(s->result, run->scene_read[i]) < 0)
            return no_memory(s);
    s->result->reuse.asked = run->reuse.asked;
    for (int i = 0; i < ORL_YEARS_KINDS; i++)
        orl_annual_reused_add(&s->result->reuse.of[i], &run->reuse.of[i]);
    s->result->threads = run->threads;
    s->result->samples = run->samples;
    s->result->n_nodes = run->n_nodes;
    s->result->n_runs++;
    return take_warnings(s, run);
}

/* share: of what there is to do in all. */
static int run_combination(struct shading *s, size_t index, double share,
                           struct orl_annual_result *ret_run)
{
    struct orl_annual_variant variant;
    struct orl_run_env run = *s->env->run;
    struct orl_annual_env env = *s->env;
    const double whole = run.part > 0 ? run.part : 1;
    run.part_from += whole * s->told;
    run.part = whole * share;
    run.warned = NULL;
    env.run = &run;
    env.begins = NULL;
    env.row = NULL;
    env.round = s->env->round * MOST + (uint32_t)index;
    int code = orl_annual_variant_init(&variant, s->request, s->combinations[index], s->err);
    const struct orl_year_variant how = {.hours_of = s->reader, .swaps = &variant.swaps};
    if (code == 0)
        code = orl_year_run(&variant.request, &env, &how, ret_run, s->err);
    orl_annual_variant_done(&variant);
    s->told += share;
    return code == 0 ? take_account(s, ret_run) : code;
}

/* All open: its arrays are the result's. */
static int run_open(struct shading *s, double share)
{
    struct orl_annual_result run = {.n_sensors = 0};
    const int code = run_combination(s, 0, share, &run);
    if (code == 0) {
        s->result->total = run.total;
        s->result->direct = run.direct;
        s->result->se = run.se;
        run.total = run.direct = run.se = NULL;
    }
    orl_annual_done(&run);
    return code;
}

/* Of the hours that have it, total and errors are the run's. */
static int run_other(struct shading *s, size_t index, double share)
{
    struct orl_annual_result run = {.n_sensors = 0}, *all = s->result;
    const size_t columns = all->n_columns;
    const int code = run_combination(s, index, share, &run);
    for (size_t i = 0; i < all->n_sensors && code == 0; i++)
        for (size_t c = 0; c < columns; c++) {
            if (s->which[c] != index)
                continue;
            all->total[i * columns + c] = run.total[i * columns + c];
            all->se[i * columns + c] = run.se[i * columns + c];
        }
    orl_annual_done(&run);
    return code;
}

/* ---- Which runs ------------------------------------------------------------------------------ */

static int control(struct shading *s)
{
    const struct orl_annual_result *r = s->result;
    bool *closed = malloc(r->n_columns + 1);
    if (!closed)
        return no_memory(s);
    for (size_t g = 0; g < s->request->n_groups; g++) {
        const struct orl_shade_control *control = &s->request->groups[g].control;
        if (control->kind == ORL_SHADES_NO_CONTROL)
            continue;
        orl_shades_control(s->request, control,
                           control->kind == ORL_SHADES_BY_SUN ? r->direct : r->total, r->n_columns,
                           closed);
        for (size_t c = 0; c < r->n_columns; c++)
            s->states[g * r->n_steps + r->step_of_column[c]] =
                closed[c] ? (unsigned char)control->state : 0;
    }
    free(closed);
    return 0;
}

static int find_combinations(struct shading *s)
{
    const size_t groups = s->request->n_groups, steps = s->result->n_steps;
    for (size_t c = 0; c < s->result->n_columns; c++) {
        unsigned char states[ORL_SHADES_MOST_GROUPS];
        size_t k = 0;
        for (size_t g = 0; g < groups; g++)
            states[g] = s->states[g * steps + s->result->step_of_column[c]];
        while (k < s->n_combinations && memcmp(s->combinations[k], states, groups) != 0)
            k++;
        if (k == MOST)
            return orl_error_set(s->err, ORL_ERR_LIMIT,
                                 "the window groups are in more than %d combinations of states",
                                 MOST);
        if (k == s->n_combinations)
            memcpy(s->combinations[s->n_combinations++], states, groups);
        s->which[c] = (unsigned char)k;
    }
    return 0;
}

/* How many runs there may be. */
static double foresee(const struct shading *s)
{
    double runs = 1;
    for (size_t g = 0; g < s->request->n_groups; g++)
        runs += (double)s->request->groups[g].n_states - 1;
    return runs;
}

static int run_all(struct shading *s)
{
    const double open = 1 / foresee(s);
    int code = run_open(s, open);
    if (code == 0)
        code = control(s);
    if (code == 0)
        code = find_combinations(s);
    for (size_t i = 1; i < s->n_combinations && code == 0; i++)
        code = run_other(s, i, (1 - open) / (double)(s->n_combinations - 1));
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static int hand_over(struct shading *s)
{
    struct orl_annual_result *r = s->result;
    int code = 0;
    for (size_t i = 0; s->env->row && i < r->n_sensors && code == 0; i++)
        code = s->env->row(s->env->ctx, i, orl_annual_row(r, r->total, i),
                           orl_annual_row(r, r->direct, i), orl_annual_row(r, r->se, i), s->err);
    if (!s->env->row)
        return code;
    free(r->total);
    free(r->direct);
    free(r->se);
    r->total = r->direct = r->se = NULL;
    return code;
}

static int shade(struct shading *s)
{
    int code = read_hours(s);
    if (code == 0 && s->env->begins)
        code = s->env->begins(s->env->ctx, s->result, s->err);
    if (code == 0)
        code = run_all(s);
    if (code < 0)
        return code;
    s->result->states = s->states;
    s->states = NULL;
    s->result->n_groups = s->request->n_groups;
    s->result->total_s = orl_year_now(s->reader) - s->reader->started_s;
    return hand_over(s);
}

static int run_shaded(const struct orl_annual_request *request, const struct orl_annual_env *env,
                      struct orl_annual_result *ret_result, struct orl_error *err)
{
    struct orl_annual_result result = {.seed = request->seed, .n_sensors = request->n_sensors};
    struct shading s = {.request = request, .env = env, .result = &result, .err = err};
    s.reader = calloc(1, sizeof *s.reader);
    const int code = s.reader ? shade(&s) : no_memory(&s);
    if (s.reader)
        orl_hours_done(&s.reader->hours);
    free(s.reader);
    free(s.states);
    free(s.which);
    free(s.combinations);
    if (code < 0)
        orl_annual_done(&result);
    else
        *ret_result = result;
    return code;
}

int orl_annual_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                   struct orl_annual_result *ret_result, struct orl_error *err)
{
    const int code = orl_annual_validate(request, err);
    if (code < 0)
        return code;
    return request->n_groups > 0 ? run_shaded(request, env, ret_result, err)
                                 : orl_year_run(request, env, NULL, ret_result, err);
}
