#include "annual_glare.h"

#include <stdio.h>

#include "encode.h"
#include "members.h"
#include "places_json.h"

enum { NAME_MAX_BYTES = 63 };

/* ---- Request --------------------------------------------------------------------------------- */

static int decode_seat(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_seat *seat = into;
    const struct orl_json_member members[] = {
        {"name", .text = &seat->name, .longest = NAME_MAX_BYTES},
        {"at", .decode = orl_point_from_json, .into = &seat->at, .required = true},
        {"towards", .decode = orl_direction_from_json, .into = &seat->towards, .required = true},
        {0}};
    return orl_json_members(value, path, members, err);
}

static int name_seats(struct orl_seats_wish *wish, struct orl_error *err)
{
    for (size_t i = 0; i < wish->n_seats; i++)
        if (!wish->seats[i].name && asprintf(&wish->seats[i].name, "seat%zu", i + 1) < 0) {
            wish->seats[i].name = NULL;
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        }
    return 0;
}

int orl_seats_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_seats_wish *wish = into;
    const struct orl_json_list seats = {.items = &wish->seats,
                                        .count = &wish->n_seats,
                                        .size = sizeof *wish->seats,
                                        .most = ORL_GLARE_MOST_SEATS,
                                        .each = decode_seat,
                                        .empty = "no seat is given"};
    const int rc = orl_json_list(value, path, &seats, err);
    return rc ? rc : name_seats(wish, err);
}

int orl_annual_glare_from_json(const json_t *value, const char *path, void *into,
                               struct orl_error *err)
{
    const struct orl_json_member members[] = {
        {"seats", .decode = orl_seats_from_json, .into = into, .required = true}, {0}};
    return orl_json_members(value, path, members, err);
}

/* ---- Result ---------------------------------------------------------------------------------- */

static json_t *interval_of(const struct orl_annual_value *v)
{
    return json_pack("[o, o]", orl_json_from_real(v->low), orl_json_from_real(v->high));
}

static json_t *above_to_json(const struct orl_seat_glare *seat)
{
    json_t *array = json_array();
    for (int i = 0; array && i < ORL_GLARE_BOUNDS; i++)
        array = orl_json_append(array, json_pack("{s:f, s:f, s:o}", "dgp", orl_glare_bounds[i],
                                                 "percent", seat->above[i].value, "interval_95",
                                                 interval_of(&seat->above[i])));
    return array;
}

static json_t *worst_to_json(const struct orl_seat_glare *seat,
                             const struct orl_annual_result *result)
{
    json_t *array = json_array();
    for (size_t i = 0; array && i < seat->n_worst; i++) {
        const struct orl_seat_hour *hour = &seat->worst[i];
        const struct orl_annual_step *step = &result->steps[hour->step];
        array = orl_json_append(array, json_pack("{s:i, s:i, s:f, s:f, s:o, s:f}", "month",
                                                 step->month, "day", step->day, "hour", step->hour,
                                                 "dgp", hour->dgp.value, "interval_95",
                                                 interval_of(&hour->dgp), "eye_lx", hour->eye_lx));
    }
    return array;
}

static json_t *seat_to_json(const char *name, const struct orl_seat_glare *seat,
                            const struct orl_annual_result *result)
{
    const bool sure = seat->lowest == seat->highest;
    return json_pack("{s:o, s:o, s:{s:f, s:o}, s:s, s:o}", "name", orl_json_from_text(name),
                     "above", above_to_json(seat), "exceeded_5", "dgp", seat->exceeded.value,
                     "interval_95", interval_of(&seat->exceeded), "protection",
                     sure ? orl_glare_protection_name(seat->level) : "undecided", "worst",
                     worst_to_json(seat, result));
}

json_t *orl_annual_glare_to_json(const struct orl_seats_wish *wish,
                                 const struct orl_annual_result *result,
                                 const struct orl_annual_report *report)
{
    if (report->n_seats == 0)
        return json_null();
    json_t *array = json_array();
    for (size_t i = 0; array && i < report->n_seats; i++)
        array =
            orl_json_append(array, seat_to_json(wish->seats[i].name, &report->seats[i], result));
    return json_pack("{s:o, s:{s:f, s:o}}", "seats", array, "autonomy", "percent",
                     report->glare_autonomy.value, "interval_95",
                     interval_of(&report->glare_autonomy));
}
