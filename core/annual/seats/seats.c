/*
 * Glare over a year: builds the views of seats, runs their sensors as a year, and rates each seat.
 *
 * Views are large, and there may be many seats: at most ORL_GLARE_SEATS_AT_ONCE views are in
 * memory. If there are more seats, each view is built twice, for the sensors and for the rating.
 * Both are equal, because random numbers are keyed by seat.
 */
#include <oriel/annual_glare.h>

#include <stdlib.h>
#include <string.h>

#include "annual/seats/seat_glare.h"
#include "annual/shades/variant.h"
#include "annual/year/year_inputs.h"

/* ---- Seats as a year's sensors --------------------------------------------------------------- */

/* State of all seats while a year of their sensors runs. */
struct seating {
    const struct orl_seats_wish *wish;
    const struct orl_annual_result *result; /* result of the year to which the seats belong */
    unsigned char *wanted; /* by column: columns still to be rated, and columns of this run */
    unsigned char *now;
    struct orl_annual_request request; /* with the seats' sensors, which are owned */
    struct orl_seat_view *views;       /* by seat of the group */
    struct orl_error *errors;          /* by seat of the group */
    size_t group, n_group;             /* first seat of the group, and number of seats */
    size_t *n_places;                  /* by seat */
    struct orl_seat_hours *hours;      /* by seat */
    struct orl_year *year;
    /* Indices of the next row; place 0 is the seat's eye, then follow its places. */
    size_t seat, place;
    float *eye, *eye_direct, *eye_error, *places; /* rows of one seat */
};

static void view_seat(void *arg, size_t index, uint32_t member)
{
    struct seating *s = arg;
    const size_t seat = s->group + index;
    (void)member;
    orl_seat_view_init(&s->views[index], &s->year->scene, &s->wish->seats[seat],
                       s->request.seed + seat, s->year->env->run->crew, &s->errors[index]);
}

static void free_group(struct seating *s)
{
    for (size_t i = 0; i < s->n_group; i++) {
        orl_seat_view_done(&s->views[i]);
        s->views[i] = (struct orl_seat_view){.n_spots = 0};
    }
    s->n_group = 0;
}

/* Builds the views of a group that starts at the given seat. */
static int view_group(struct seating *s, size_t first, struct orl_error *err)
{
    const size_t left = s->wish->n_seats - first;
    struct orl_crew *crew = s->year->env->run->crew;
    free_group(s);
    memset(s->errors, 0, ORL_GLARE_SEATS_AT_ONCE * sizeof *s->errors);
    s->group = first;
    s->n_group = left < ORL_GLARE_SEATS_AT_ONCE ? left : ORL_GLARE_SEATS_AT_ONCE;
    const int code = orl_crew_try(crew, s->n_group, view_seat, s);
    if (code < 0)
        return orl_year_failed(s->year, code, err);
    for (size_t i = 0; i < s->n_group; i++)
        if (s->errors[i].code < 0) {
            *err = s->errors[i];
            return err->code;
        }
    return 0;
}

/* Appends the sensors of the group: the eye and the places of each seat. */
static int add_sensors(struct seating *s)
{
    const struct orl_vec3 center = s->year->world->geometry->center;
    size_t n = s->request.n_sensors;
    for (size_t i = 0; i < s->n_group; i++)
        n += 1 + s->views[i].places.n_kept;
    struct orl_sensor *sensors = realloc(s->request.sensors, n * sizeof *sensors);
    if (!sensors)
        return ORL_ERR_NOMEM;
    s->request.sensors = sensors;
    sensors += s->request.n_sensors;
    s->request.n_sensors = n;
    for (size_t i = 0; i < s->n_group; i++) {
        const struct orl_seat_places *p = &s->views[i].places;
        const struct orl_seat *seat = &s->wish->seats[s->group + i];
        s->n_places[s->group + i] = p->n_kept;
        *sensors++ = (struct orl_sensor){seat->at, seat->towards};
        for (size_t k = 0; k < p->n_kept; k++)
            *sensors++ =
                (struct orl_sensor){orl_add(p->sensors[k].point, center), p->sensors[k].facing};
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
    s->views = calloc(ORL_GLARE_SEATS_AT_ONCE, sizeof *s->views);
    s->errors = calloc(ORL_GLARE_SEATS_AT_ONCE, sizeof *s->errors);
    s->n_places = calloc(s->wish->n_seats + 1, sizeof *s->n_places);
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
                   s->views && s->errors && s->n_places && s->hours
               ? 0
               : ORL_ERR_NOMEM;
}

/* Sets the sensors of a prepared year: those of all seats. */
static int place_seats(void *ctx, struct orl_year *y, struct orl_error *err)
{
    struct seating *s = ctx;
    s->year = y;
    int code = orl_year_need_scene(y, err);
    if (code < 0)
        return code;
    if (y->hours.n_columns != s->result->n_columns)
        return orl_error_set(err, ORL_ERR_INVALID, "the weather file has changed under way");
    for (size_t i = 0; i < s->wish->n_seats && code == 0; i += ORL_GLARE_SEATS_AT_ONCE) {
        code = view_group(s, i, err);
        if (code == 0 && add_sensors(s) < 0)
            code = orl_year_no_memory(err);
    }
    y->request = &s->request;
    y->result->n_sensors = s->request.n_sensors;
    return code;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static int rate_seat(struct seating *s, struct orl_error *err)
{
    const size_t in_group = s->seat % ORL_GLARE_SEATS_AT_ONCE;
    int code = s->group + in_group == s->seat ? 0 : view_group(s, s->seat, err);
    if (code < 0)
        return code;
    const struct orl_seat_light light = {.year = s->year,
                                         .wanted = s->now,
                                         .eye = s->eye,
                                         .eye_direct = s->eye_direct,
                                         .eye_error = s->eye_error,
                                         .places = s->places};
    code = orl_seat_glare_find(&s->views[in_group], &light, &s->hours[s->seat]);
    s->seat++;
    s->place = 0;
    return code < 0 ? orl_year_failed(s->year, code, err) : 0;
}

/* Stores the row of an eye or a place. After the last place of a seat, rates the seat. */
static int store_row(void *ctx, size_t sensor, const float *total, const float *direct,
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
    return s->place++ == s->n_places[s->seat] ? rate_seat(s, err) : 0;
}

/* ---- Runs ------------------------------------------------------------------------------------ */

/* Returns the states of the groups at a column; all are 0 in years without shades. */
static void states_at(const struct seating *s, size_t column,
                      unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
{
    const struct orl_annual_result *r = s->result;
    memset(ret_states, 0, ORL_SHADES_MOST_GROUPS);
    for (size_t g = 0; r->states && g < r->n_groups; g++)
        ret_states[g] = r->states[g * r->n_steps + r->step_of_column[column]];
}

/* Moves the first wanted column, and all with the same states, from wanted to now; returns their
 * number. */
static size_t select_alike(struct seating *s, unsigned char ret_states[ORL_SHADES_MOST_GROUPS])
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

/* Runs a year of the seats in these states, and rates the hours that have them. */
static int run_states(struct seating *s, const struct orl_annual_request *request,
                      const struct orl_run_env *run, const unsigned char *states,
                      struct orl_error *err)
{
    struct orl_annual_variant variant;
    const struct orl_annual_env env = {.run = run, .row = store_row, .ctx = s};
    struct orl_annual_result result = {.n_steps = 0};
    int code = orl_annual_variant_init(&variant, request, states, false, err);
    const struct orl_year_variant how = {
        .swaps = request->n_groups > 0 ? &variant.swaps : NULL, .prepared = place_seats, .ctx = s};
    s->request = variant.request;
    s->request.sensors = NULL;
    s->request.n_sensors = 0;
    s->request.grids = NULL;
    s->request.n_grids = 0;
    s->request.coefficients = false;
    s->seat = 0;
    if (code == 0)
        code = orl_year_run(&s->request, &env, &how, &result, err);
    free_group(s);
    free(s->request.sensors);
    orl_annual_done(&result);
    orl_annual_variant_done(&variant);
    return code;
}

/* Runs each combination of states that occurs in hours of use. */
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
    run.warned = NULL; /* the year's own runs have issued the warnings */
    while (code == 0 && (n = select_alike(s, states)) > 0) {
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
    free(s->views);
    free(s->errors);
    free(s->n_places);
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
