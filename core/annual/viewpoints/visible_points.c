#include "annual/viewpoints/viewpoints.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 32, ROWS = 16, FIRST_SLOTS = 1024 };

int orl_visible_points_init(struct orl_visible_points *visible_points, struct orl_vec3 eye)
{
    *visible_points = (struct orl_visible_points){.eye = eye, .n_slots = FIRST_SLOTS};
    visible_points->slots = calloc(FIRST_SLOTS, sizeof *visible_points->slots);
    visible_points->found = malloc(FIRST_SLOTS / 2 * sizeof *visible_points->found);
    return visible_points->slots && visible_points->found ? 0 : ORL_ERR_NOMEM;
}

void orl_visible_points_done(struct orl_visible_points *visible_points)
{
    orl_visible_points_trim(visible_points);
    free(visible_points->selected);
    free(visible_points->sensors);
}

/* ---- Finding --------------------------------------------------------------------------------- */

/* Returns the axis nearest to a direction, with its sign: 0 to 5. */
static uint64_t side_of(struct orl_vec3 d)
{
    const double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    return x >= y && x >= z ? d.x < 0 : y >= z ? 2 + (d.y < 0) : 4 + (d.z < 0);
}

/* Returns the key of a hit's visible point: surface, side and cell. Shared visible points replace
 * the surface by the axis that it faces. */
static uint64_t key_of(const struct orl_visible_points *visible_points, const struct orl_hit *hit,
                       bool shared)
{
    const struct orl_vec3 d = orl_normalize(orl_sub(hit->point, visible_points->eye));
    const double turn = atan2(d.y, d.x) / (2 * ORL_PI) + 0.5, height = asin(fmax(-1, fmin(d.z, 1)));
    const uint64_t column = (uint64_t)(turn * COLUMNS) % COLUMNS;
    const uint64_t row = (uint64_t)fmin((height / ORL_PI + 0.5) * ROWS, ROWS - 1);
    const uint64_t surface = shared ? (1ULL << 40) + side_of(orl_hit_facing(hit))
                                    : (uint64_t)hit->facet * 2 + hit->front;
    return surface * ((uint64_t)COLUMNS * ROWS) + column * ROWS + row;
}

static size_t slot_of(const struct orl_visible_points *visible_points, uint64_t key)
{
    size_t slot = (size_t)orl_mix64(key) & (visible_points->n_slots - 1);
    while (visible_points->slots[slot] > 0 &&
           visible_points->found[visible_points->slots[slot] - 1].key != key)
        slot = (slot + 1) & (visible_points->n_slots - 1);
    return slot;
}

static int grow_table(struct orl_visible_points *visible_points)
{
    const size_t n = 2 * visible_points->n_slots;
    uint32_t *slots = calloc(n, sizeof *slots);
    struct orl_hit_cluster *found = realloc(visible_points->found, n / 2 * sizeof *found);
    if (found)
        visible_points->found = found;
    if (!slots || !found) {
        free(slots);
        return ORL_ERR_NOMEM;
    }
    free(visible_points->slots);
    visible_points->slots = slots;
    visible_points->n_slots = n;
    for (size_t i = 0; i < visible_points->n_found; i++)
        slots[slot_of(visible_points, found[i].key)] = (uint32_t)i + 1;
    return 0;
}

/* Each visible point keeps one of its hits, sampled in proportion to importance (a reservoir of
 * one). */
int orl_visible_points_add(struct orl_visible_points *visible_points, const struct orl_hit *hit,
                           double importance, struct orl_random *random, uint32_t *ret_found)
{
    uint64_t key = key_of(visible_points, hit, false);
    size_t slot = slot_of(visible_points, key);
    if (visible_points->slots[slot] == 0 &&
        visible_points->n_found >= ORL_VISIBLE_POINTS_MOST_CLUSTERS) {
        key = key_of(visible_points, hit, true);
        slot = slot_of(visible_points, key);
    }
    if (visible_points->slots[slot] == 0) {
        if (2 * (visible_points->n_found + 1) > visible_points->n_slots) {
            if (grow_table(visible_points) < 0)
                return ORL_ERR_NOMEM;
            slot = slot_of(visible_points, key);
        }
        visible_points->found[visible_points->n_found] = (struct orl_hit_cluster){.key = key};
        visible_points->slots[slot] = (uint32_t)++visible_points->n_found;
    }
    struct orl_hit_cluster *found = &visible_points->found[visible_points->slots[slot] - 1];
    found->importance += importance;
    if (orl_random_uniform(random) * found->importance < importance) {
        found->point = hit->point;
        found->facing = orl_hit_facing(hit);
    }
    *ret_found = visible_points->slots[slot] - 1;
    return 0;
}

/* ---- Keeping --------------------------------------------------------------------------------- */

struct ranked {
    double importance;
    uint32_t found;
};

static int by_importance(const void *a, const void *b)
{
    const struct ranked *p = a, *q = b;
    if (p->importance != q->importance)
        return p->importance > q->importance ? -1 : 1;
    return p->found < q->found ? -1 : p->found > q->found;
}

/* Dissimilarity of two visible points: the angle between them as seen from the eye, plus a term for
 * their orientation. */
static double unlikeness(const struct orl_visible_points *visible_points,
                         const struct orl_hit_cluster *a, const struct orl_hit_cluster *b)
{
    static const double facing_counts = 4;
    const double apart = orl_length(orl_sub(a->point, b->point));
    const double far = orl_length(orl_sub(a->point, visible_points->eye));
    return apart / fmax(far, 1e-9) + facing_counts * (1 - orl_dot(a->facing, b->facing));
}

static uint32_t most_like(const struct orl_visible_points *visible_points,
                          const struct orl_hit_cluster *found)
{
    uint32_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < visible_points->n_selected; i++) {
        const double here =
            unlikeness(visible_points, found, &visible_points->found[visible_points->selected[i]]);
        if (here < least) {
            least = here;
            best = (uint32_t)i;
        }
    }
    return best;
}

static int list_sensors(struct orl_visible_points *visible_points)
{
    visible_points->sensors =
        malloc((visible_points->n_selected + 1) * sizeof *visible_points->sensors);
    if (!visible_points->sensors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < visible_points->n_selected; i++) {
        const struct orl_hit_cluster *found = &visible_points->found[visible_points->selected[i]];
        visible_points->sensors[i] = (struct orl_visible_point){found->point, found->facing};
    }
    return 0;
}

int orl_visible_points_choose(struct orl_visible_points *visible_points,
                              const struct orl_thread_pool *pool)
{
    const size_t n = visible_points->n_found;
    struct ranked *ranked = malloc((n + 1) * sizeof *ranked);
    visible_points->n_selected = n < ORL_VISIBLE_POINTS_MOST ? n : ORL_VISIBLE_POINTS_MOST;
    visible_points->selected =
        malloc((visible_points->n_selected + 1) * sizeof *visible_points->selected);
    if (!ranked || !visible_points->selected) {
        free(ranked);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < n; i++)
        ranked[i] = (struct ranked){visible_points->found[i].importance, (uint32_t)i};
    qsort(ranked, n, sizeof *ranked, by_importance);
    for (size_t i = 0; i < visible_points->n_selected; i++)
        visible_points->selected[i] = ranked[i].found;
    int code = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        visible_points->found[ranked[i].found].selected =
            i < visible_points->n_selected
                ? (uint32_t)i
                : most_like(visible_points, &visible_points->found[ranked[i].found]);
        code = i % 1024 == 0 && orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : 0;
    }
    free(ranked);
    return code == 0 ? list_sensors(visible_points) : code;
}

void orl_visible_points_trim(struct orl_visible_points *visible_points)
{
    free(visible_points->found);
    free(visible_points->slots);
    visible_points->found = NULL;
    visible_points->slots = NULL;
    visible_points->n_found = visible_points->n_slots = 0;
}
