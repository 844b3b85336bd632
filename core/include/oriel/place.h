/* Named point that results are reported for. */
#ifndef ORIEL_PLACE_H
#define ORIEL_PLACE_H

#include <stddef.h>
#include <stdlib.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_named_place {
    char *name; /* owned */
    struct orl_vec3 at;
};

/* Checks each point with orl_check_point. Returns 0 or ORL_ERR_RANGE, with the point's name. */
int orl_places_check(const struct orl_named_place *places, size_t n, struct orl_error *err);

static inline void orl_named_places_free(struct orl_named_place *places, size_t n)
{
    for (size_t i = 0; places && i < n; i++)
        free(places[i].name);
    free(places);
}

#endif
