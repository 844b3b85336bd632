/* Glare over a year: seats looked from, their sensors run as a year, and each rated. */
#include <oriel/annual_glare.h>

#include <stdlib.h>
#include <string.h>

#include "annual/light.h"
#include "annual/seat_glare.h"
#include "annual/variant.h"

/* ---- Seats as a year's sensors --------------------------------------------------------------- */

/* All of it, while its year runs. */
struct seating {
    const struct orl_seats_wish *wish;
    const struct orl_annual_result *result; /* of the year that they are of */
    unsigned char *wanted; /* by column: what is left to be rated, and those of one run */
    unsigned char *now;
    struct orl_annual_request request; /* with the sensors of the seats; owned: those */
    struct orl_seat_view *views;
    struct orl_seat_hours *hours;
    struct orl_year *year;
    size_t seat, place; /* whose row comes next: of the seat its eye's, then its places' */
    float *eye, *eye_direct, *eye_error, *places; /* rows of a seat */
    atomic_bool failed;                           /* for want of memory */
};

static void look_from(void *arg, size_t index, uint32_t member)
{
    struct seating *s = arg;
    struct orl_error err = {0};
    (void)member;
    if (orl_seat_view_init(&s->views[index], &s->year->scene, &s->wish->seats[index],
                           s->request.seed + index, &err) < 0)
        atomic_store(&s->failed, true);
}

static int list_sensors(struct seating *s)
{
    const struct orl_vec3 center = s->year->world->geometry->center;
    size_t n = 0;
    for (size_t i = 0; i < s->wish->n_seats; i++)
        n += 1 + s->views[i].places.n_kept;
    struct orl_sensor *sensors = s->request.sensors = calloc(n + 1, sizeof *sensors);
    if (!sensors)
        return ORL_ERR_NOMEM;
    s->request.n_sensors = n;
    for (size_t i = 0; i < s->wish->n_seats; i++) {
        const struct orl_seat_places *p = &s->views[i].places;
        *sensors++ = (struct orl_sensor){s->wish->seats[i].at, s->wish->seats[i].towards};
        for (size_t k = 0; k < p->n_kept; k++) {
            const struct orl_seat_found *found = &p->found[p->kept[k]];
            *sensors++ = (struct orl_sensor){orl_add(found->point, center), found->facing};
        }
    }
    return 0;
}

static int make_rows(struct seating *s)
{
    const size_t n = s->result->n_columns + 1;
    s->eye = calloc(n, sizeof *s->eye);
    s->eye_direct = calloc(n, sizeof *s->eye_direct);
    s->eye_error = calloc(n, sizeof *s->eye_error);
    s->places = calloc(n * ORL_SEAT_MOST_PLACES * 2, sizeof *s->places);
    s->wanted = malloc(n);
    s->now = malloc(n);
    s->views = calloc(s->wish->n_seats + 1, sizeof *s->views);
    s->hours = calloc(s->wish->n_seats + 1, sizeof *s->hours);
    for (size_t i = 0; s->hours && i < s->wish->n_seats; i++) {
        struct orl_seat_hours *h = &s->hours[i];
        h->dgp = malloc(n * sizeof *h->dgp);
        h->low = malloc(n * sizeof *h->low);
        h->high = malloc(n * sizeof *h->high);
        h->eye_lx = malloc(n * sizeof *h->eye_lx);
        if (!h->dgp || !h->low || !h->high || !h->eye_lx)
            return ORL_ERR_NOMEM;
        for (size_t c = 0; c < n; c++)
            h->dgp[c] = h->low[c] = h->high[c] = h->eye_lx[c] = NAN;
    }
    return s->eye && s->eye_direct && s->eye_error && s->places && s->wanted && s->now &&
                   s->views && s->hours
               ? 0
               : ORL_ERR_NOMEM;
}

/* Of a year that is prepared: what its sensors are. */
static int seat_all(void *ctx, struct orl_year *y, struct orl_error *err)
{
    struct seating *s = ctx;
    s->year = y;
    int code = orl_year_need_scene(y, err);
    if (code < 0)
        return code;
    if (y->hours.n_columns != s->result->n_columns)
        return orl_error_set(err, ORL_ERR_INVALID, "the weather file has changed under way");
    code = orl_crew_try(y->env->run->crew, s->wish->n_seats, look_from, s);
    if (code == 0 && atomic_load(&s->failed))
        code = ORL_ERR_NOMEM;
    if (code == 0)
        code = list_sensors(s);
    y->request = &s->request;
    y->result->n_sensors = s->request.n_sensors;
    return code < 0 ? orl_year_failed(y, code, err) : 0;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static int rate(struct seating *s, struct orl_error *err)
{
    const struct orl_seat_light light = {.year = s->year,
                                         .wanted = s->now,
                                         .eye = s->eye,
                                         .eye_direct = s->eye_direct,
                                         .eye_error = s->eye_error,
                                         .places = s->places};
    const int code = orl_seat_glare_find(&s->views[s->seat], &light, &s->hours[s->seat]);
    orl_seat_view_done(&s->views[s->seat]);
    s->views[s->seat] = (struct orl_seat_view){.n_spots = 0};
    s->seat++;
    s->place = 0;
    return code < 0 ? orl_year_failed(s->year, code, err) : 0;
}

/* The eye's, or a place's; behind a seat's last one it is rated. */
static int take_row(void *ctx, size_t sensor, const float *total, const float *direct,
                    const float *se, struct orl_error *err)
{
    struct seating *s = ctx;
    const size_t n = s->result->n_columns;
    (void)sensor;
    if (s->place == 0) {
        memcpy(s->eye, total, n * sizeof *total);
        memcpy(s->eye_direct, direct, n * sizeof *direct);
        memcpy(s->eye_error, se, n * sizeof *se);
    } else {
        float *without = s->places + (s->place - 1) * 2 * n, *all = without + n;
        for (size_t c = 0; c < n; c++) {
            without[c] = total[c] - direct[c];
            all[c] = total[c];
        }
    }
    return s->place++ == s->views[s->seat].places.n_kept ? rate(s, err) : 0;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

/* The states of groups at a column; of years without, all 0. */
static void states_at(const struct seating *s, size_t column,
                      unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
{
    const struct orl_annual_result *r = s->result;
    memset(ret_states, 0, ORL_SHADES_MOST_GROUPS);
    for (size_t g = 0; r->states && g < r->n_groups; g++)
        ret_states[g] = r->states[g * r->n_steps + r->step_of_column[column]];
}

/* Takes out of what is wanted the columns with the states of the first of them; how many. */
static size_t take_alike(struct seating *s, unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
{
    unsigned char states[ORL_SHADES_MOST_GROUPS];
    size_t n = 0;
    for (size_t c = 0; c < s->result->n_columns; c++) {
        s->now[c] = 0;
        if (!s->wanted[c])
            continue;
        states_at(s, c, n == 0 ? ret_states : states);
        s->now[c] = n == 0 || memcmp(states, ret_states, sizeof states) == 0;
        s->wanted[c] = !s->now[c];
        n += s->now[c];
    }
    return n;
}

/* A year of the seats in these states, of which the hours that have them are rated. */
static int run_states(struct seating *s, const struct orl_annual_request *request,
                      const struct orl_run_env *run, const unsigned char *states,
                      struct orl_error *err)
{
    struct orl_annual_variant variant;
    const struct orl_annual_env env = {.run = run, .row = take_row, .ctx = s};
    struct orl_annual_result result = {.n_steps = 0};
    int code = orl_annual_variant_init(&variant, request, states, false, err);
    const struct orl_year_variant how = {
        .swaps = request->n_groups > 0 ? &variant.swaps : NULL, .prepared = seat_all, .ctx = s};
    s->request = variant.request;
    s->request.sensors = NULL;
    s->request.n_sensors = 0;
    s->request.grids = NULL;
    s->request.n_grids = 0;
    s->request.coefficients = false;
    s->seat = 0;
    if (code == 0)
        code = orl_year_run(&s->request, &env, &how, &result, err);
    free(s->request.sensors);
    orl_annual_done(&result);
    orl_annual_variant_done(&variant);
    return code;
}

/* A run of each combination of states that hours in use have. */
static int run_all(struct seating *s, const struct orl_annual_request *request,
                   const struct orl_run_env *given, struct orl_error *err)
{
    struct orl_run_env run = *given;
    unsigned char states[ORL_SHADES_MOST_GROUPS];
    const double whole = given->part > 0 ? given->part : 1;
    size_t all = 0, n, runs = 0;
    int code = 0;
    for (size_t c = 0; c < s->result->n_columns; c++)
        all += s->wanted[c];
    run.warned = NULL; /* the year's own runs have told */
    while (code == 0 && (n = take_alike(s, states)) > 0) {
        if (runs++ == ORL_SHADES_MOST_COMBINATIONS)
            return orl_error_set(err, ORL_ERR_LIMIT,
                                 "shades are in more than %d combinations of states while seats "
                                 "are in use: glare needs a run of each",
                                 ORL_SHADES_MOST_COMBINATIONS);
        run.part = whole * (double)n / (double)all;
        code = run_states(s, request, &run, states, err);
        run.part_from += run.part;
    }
    return code;
}

/* ---- All of it ------------------------------------------------------------------------------- */

static void seating_done(struct seating *s)
{
    for (size_t i = 0; s->views && i < s->wish->n_seats; i++)
        orl_seat_view_done(&s->views[i]);
    free(s->views);
    free(s->wanted);
    free(s->now);
    free(s->eye);
    free(s->eye_direct);
    free(s->eye_error);
    free(s->places);
}

int orl_annual_glare_find(const struct orl_seats_wish *wish,
                          const struct orl_annual_request *request,
                          const struct orl_annual_result *result, const unsigned char *wanted,
                          const struct orl_run_env *run, struct orl_seat_hours **ret_hours,
                          struct orl_error *err)
{
    struct seating s = {.wish = wish, .result = result};
    int code = orl_seats_validate(wish, request, err);
    if (code < 0)
        return code;
    if (make_rows(&s) < 0) {
        code = orl_year_no_memory(err);
    } else {
        memcpy(s.wanted, wanted, result->n_columns);
        code = run_all(&s, request, run, err);
    }
    seating_done(&s);
    if (code < 0)
        orl_seat_hours_free(s.hours, wish->n_seats);
    else
        *ret_hours = s.hours;
    return code;
}
