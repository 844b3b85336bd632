#include "annual/seats/seat_places.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 32, ROWS = 16, FIRST_SLOTS = 1024 };

int orl_seat_places_init(struct orl_seat_places *places, struct orl_vec3 eye)
{
    *places = (struct orl_seat_places){.eye = eye, .n_slots = FIRST_SLOTS};
    places->slots = calloc(FIRST_SLOTS, sizeof *places->slots);
    places->found = malloc(FIRST_SLOTS / 2 * sizeof *places->found);
    return places->slots && places->found ? 0 : ORL_ERR_NOMEM;
}

void orl_seat_places_done(struct orl_seat_places *places)
{
    orl_seat_places_trim(places);
    free(places->kept);
    free(places->sensors);
}

/* ---- Finding --------------------------------------------------------------------------------- */

/* Returns the axis nearest to a direction, with its sign: 0 to 5. */
static uint64_t side_of(struct orl_vec3 d)
{
    const double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    return x >= y && x >= z ? d.x < 0 : y >= z ? 2 + (d.y < 0) : 4 + (d.z < 0);
}

/* Returns the key of a hit's place: surface, side and cell. Shared places replace the surface by
 * the axis that it faces. */
static uint64_t name_of(const struct orl_seat_places *places, const struct orl_hit *hit,
                        bool shared)
{
    const struct orl_vec3 d = orl_normalize(orl_sub(hit->point, places->eye));
    const double turn = atan2(d.y, d.x) / (2 * ORL_PI) + 0.5, height = asin(fmax(-1, fmin(d.z, 1)));
    const uint64_t column = (uint64_t)(turn * COLUMNS) % COLUMNS;
    const uint64_t row = (uint64_t)fmin((height / ORL_PI + 0.5) * ROWS, ROWS - 1);
    const uint64_t surface = shared ? (1ULL << 40) + side_of(orl_hit_facing(hit))
                                    : (uint64_t)hit->facet * 2 + hit->front;
    return surface * ((uint64_t)COLUMNS * ROWS) + column * ROWS + row;
}

static size_t slot_of(const struct orl_seat_places *places, uint64_t name)
{
    size_t slot = (size_t)orl_mix64(name) & (places->n_slots - 1);
    while (places->slots[slot] > 0 && places->found[places->slots[slot] - 1].name != name)
        slot = (slot + 1) & (places->n_slots - 1);
    return slot;
}

static int grow_table(struct orl_seat_places *places)
{
    const size_t n = 2 * places->n_slots;
    uint32_t *slots = calloc(n, sizeof *slots);
    struct orl_seat_found *found = realloc(places->found, n / 2 * sizeof *found);
    if (found)
        places->found = found;
    if (!slots || !found) {
        free(slots);
        return ORL_ERR_NOMEM;
    }
    free(places->slots);
    places->slots = slots;
    places->n_slots = n;
    for (size_t i = 0; i < places->n_found; i++)
        slots[slot_of(places, found[i].name)] = (uint32_t)i + 1;
    return 0;
}

/* Each place keeps one of its hits, sampled in proportion to worth (a reservoir of one). */
int orl_seat_places_add(struct orl_seat_places *places, const struct orl_hit *hit, double worth,
                        struct orl_random *random, uint32_t *ret_found)
{
    uint64_t name = name_of(places, hit, false);
    size_t slot = slot_of(places, name);
    if (places->slots[slot] == 0 && places->n_found >= ORL_SEAT_MOST_FOUND) {
        name = name_of(places, hit, true);
        slot = slot_of(places, name);
    }
    if (places->slots[slot] == 0) {
        if (2 * (places->n_found + 1) > places->n_slots) {
            if (grow_table(places) < 0)
                return ORL_ERR_NOMEM;
            slot = slot_of(places, name);
        }
        places->found[places->n_found] = (struct orl_seat_found){.name = name};
        places->slots[slot] = (uint32_t)++places->n_found;
    }
    struct orl_seat_found *found = &places->found[places->slots[slot] - 1];
    found->worth += worth;
    if (orl_random_uniform(random) * found->worth < worth) {
        found->point = hit->point;
        found->facing = orl_hit_facing(hit);
    }
    *ret_found = places->slots[slot] - 1;
    return 0;
}

/* ---- Keeping --------------------------------------------------------------------------------- */

struct ranked {
    double worth;
    uint32_t found;
};

static int by_worth(const void *a, const void *b)
{
    const struct ranked *p = a, *q = b;
    if (p->worth != q->worth)
        return p->worth > q->worth ? -1 : 1;
    return p->found < q->found ? -1 : p->found > q->found;
}

/* Dissimilarity of two places: the angle between them as seen from the eye, plus a term for their
 * orientation. */
static double unlikeness(const struct orl_seat_places *places, const struct orl_seat_found *a,
                         const struct orl_seat_found *b)
{
    static const double facing_counts = 4;
    const double apart = orl_length(orl_sub(a->point, b->point));
    const double far = orl_length(orl_sub(a->point, places->eye));
    return apart / fmax(far, 1e-9) + facing_counts * (1 - orl_dot(a->facing, b->facing));
}

static uint32_t most_like(const struct orl_seat_places *places, const struct orl_seat_found *found)
{
    uint32_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < places->n_kept; i++) {
        const double here = unlikeness(places, found, &places->found[places->kept[i]]);
        if (here < least) {
            least = here;
            best = (uint32_t)i;
        }
    }
    return best;
}

static int list_sensors(struct orl_seat_places *places)
{
    places->sensors = malloc((places->n_kept + 1) * sizeof *places->sensors);
    if (!places->sensors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < places->n_kept; i++) {
        const struct orl_seat_found *found = &places->found[places->kept[i]];
        places->sensors[i] = (struct orl_seat_place){found->point, found->facing};
    }
    return 0;
}

int orl_seat_places_choose(struct orl_seat_places *places, const struct orl_crew *crew)
{
    const size_t n = places->n_found;
    struct ranked *ranked = malloc((n + 1) * sizeof *ranked);
    places->n_kept = n < ORL_SEAT_MOST_PLACES ? n : ORL_SEAT_MOST_PLACES;
    places->kept = malloc((places->n_kept + 1) * sizeof *places->kept);
    if (!ranked || !places->kept) {
        free(ranked);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < n; i++)
        ranked[i] = (struct ranked){places->found[i].worth, (uint32_t)i};
    qsort(ranked, n, sizeof *ranked, by_worth);
    for (size_t i = 0; i < places->n_kept; i++)
        places->kept[i] = ranked[i].found;
    int code = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        places->found[ranked[i].found].kept =
            i < places->n_kept ? (uint32_t)i : most_like(places, &places->found[ranked[i].found]);
        code = i % 1024 == 0 && orl_crew_cancelled(crew) ? ORL_ERR_CANCELLED : 0;
    }
    free(ranked);
    return code == 0 ? list_sensors(places) : code;
}

void orl_seat_places_trim(struct orl_seat_places *places)
{
    free(places->found);
    free(places->slots);
    places->found = NULL;
    places->slots = NULL;
    places->n_found = places->n_slots = 0;
}
