/* Seats of a request and their results: validation and freeing. */
#include <oriel/annual_glare.h>

#include <stdio.h>
#include <stdlib.h>

#include <oriel/coordinates.h>

void orl_seats_wish_done(struct orl_seats_wish *wish)
{
    for (size_t i = 0; wish->seats && i < wish->n_seats; i++)
        free(wish->seats[i].name);
    free(wish->seats);
    *wish = (struct orl_seats_wish){.seats = NULL};
}

void orl_seat_hours_free(struct orl_seat_hours *hours, size_t n)
{
    for (size_t i = 0; hours && i < n; i++) {
        free(hours[i].dgp);
        free(hours[i].low);
        free(hours[i].high);
        free(hours[i].eye_lx);
    }
    free(hours);
}

/* ---- Validation ------------------------------------------------------------------------------ */

int orl_seats_validate(const struct orl_seats_wish *wish, const struct orl_annual_request *request,
                       struct orl_error *err)
{
    static const double steepest = 0.999; /* sine of the altitude: 87.4 degrees */
    if (wish->n_seats == 0)
        return 0;
    if (request->n_terms > 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "glare needs a scene to look at: a year by matrices has none of it");
    for (size_t i = 0; i < wish->n_seats; i++) {
        const struct orl_seat *seat = &wish->seats[i];
        char what[96];
        snprintf(what, sizeof what, "the seat '%.64s'", seat->name);
        int code = orl_check_point(seat->at, what, err);
        if (code == 0)
            code = orl_check_direction(seat->towards, what, err);
        if (code < 0)
            return code;
        if (!(fabs(seat->towards.z) <= steepest * orl_length(seat->towards)))
            return orl_error_set(err, ORL_ERR_RANGE,
                                 "'%s' looks straight up or down: which way is up in its view is "
                                 "not known",
                                 seat->name);
    }
    return 0;
}
