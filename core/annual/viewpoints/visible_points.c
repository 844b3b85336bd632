#include "annual/viewpoints/viewpoints.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 32, ROWS = 16, FIRST_SLOTS = 1024 };

int orl_visible_points_init(struct orl_visible_points *v, struct orl_vec3 eye)
{
    *v = (struct orl_visible_points){.eye = eye, .n_slots = FIRST_SLOTS};
    v->slots = calloc(FIRST_SLOTS, sizeof *v->slots);
    v->found = malloc(FIRST_SLOTS / 2 * sizeof *v->found);
    return v->slots && v->found ? 0 : ORL_ERR_NOMEM;
}

void orl_visible_points_done(struct orl_visible_points *v)
{
    orl_visible_points_trim(v);
    free(v->selected);
    free(v->sensors);
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
static uint64_t key_of(const struct orl_visible_points *v, const struct orl_hit *hit, bool shared)
{
    const struct orl_vec3 d = orl_normalize(orl_sub(hit->point, v->eye));
    const double turn = atan2(d.y, d.x) / (2 * ORL_PI) + 0.5, height = asin(fmax(-1, fmin(d.z, 1)));
    const uint64_t column = (uint64_t)(turn * COLUMNS) % COLUMNS;
    const uint64_t row = (uint64_t)fmin((height / ORL_PI + 0.5) * ROWS, ROWS - 1);
    const uint64_t surface = shared ? (1ULL << 40) + side_of(orl_hit_facing(hit))
                                    : (uint64_t)hit->facet * 2 + hit->front;
    return surface * ((uint64_t)COLUMNS * ROWS) + column * ROWS + row;
}

static size_t slot_of(const struct orl_visible_points *v, uint64_t key)
{
    size_t slot = (size_t)orl_mix64(key) & (v->n_slots - 1);
    while (v->slots[slot] > 0 && v->found[v->slots[slot] - 1].key != key)
        slot = (slot + 1) & (v->n_slots - 1);
    return slot;
}

static int grow_table(struct orl_visible_points *v)
{
    const size_t n = 2 * v->n_slots;
    uint32_t *slots = calloc(n, sizeof *slots);
    struct orl_hit_cluster *found = realloc(v->found, n / 2 * sizeof *found);
    if (found)
        v->found = found;
    if (!slots || !found) {
        free(slots);
        return ORL_ERR_NOMEM;
    }
    free(v->slots);
    v->slots = slots;
    v->n_slots = n;
    for (size_t i = 0; i < v->n_found; i++)
        slots[slot_of(v, found[i].key)] = (uint32_t)i + 1;
    return 0;
}

/* Each visible point keeps one of its hits, sampled in proportion to importance (a reservoir of
 * one). */
int orl_visible_points_add(struct orl_visible_points *v, const struct orl_hit *hit,
                           double importance, struct orl_random *random, uint32_t *ret_found)
{
    uint64_t key = key_of(v, hit, false);
    size_t slot = slot_of(v, key);
    if (v->slots[slot] == 0 && v->n_found >= ORL_VISIBLE_POINTS_MOST_CLUSTERS) {
        key = key_of(v, hit, true);
        slot = slot_of(v, key);
    }
    if (v->slots[slot] == 0) {
        if (2 * (v->n_found + 1) > v->n_slots) {
            if (grow_table(v) < 0)
                return ORL_ERR_NOMEM;
            slot = slot_of(v, key);
        }
        v->found[v->n_found] = (struct orl_hit_cluster){.key = key};
        v->slots[slot] = (uint32_t)++v->n_found;
    }
    struct orl_hit_cluster *found = &v->found[v->slots[slot] - 1];
    found->importance += importance;
    if (orl_random_uniform(random) * found->importance < importance) {
        found->point = hit->point;
        found->facing = orl_hit_facing(hit);
    }
    *ret_found = v->slots[slot] - 1;
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
static double unlikeness(const struct orl_visible_points *v, const struct orl_hit_cluster *a,
                         const struct orl_hit_cluster *b)
{
    static const double facing_counts = 4;
    const double apart = orl_length(orl_sub(a->point, b->point));
    const double far = orl_length(orl_sub(a->point, v->eye));
    return apart / fmax(far, 1e-9) + facing_counts * (1 - orl_dot(a->facing, b->facing));
}

static uint32_t most_like(const struct orl_visible_points *v, const struct orl_hit_cluster *found)
{
    uint32_t best = 0;
    double least = INFINITY;
    for (size_t i = 0; i < v->n_selected; i++) {
        const double here = unlikeness(v, found, &v->found[v->selected[i]]);
        if (here < least) {
            least = here;
            best = (uint32_t)i;
        }
    }
    return best;
}

static int list_sensors(struct orl_visible_points *v)
{
    v->sensors = malloc((v->n_selected + 1) * sizeof *v->sensors);
    if (!v->sensors)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < v->n_selected; i++) {
        const struct orl_hit_cluster *found = &v->found[v->selected[i]];
        v->sensors[i] = (struct orl_visible_point){found->point, found->facing};
    }
    return 0;
}

int orl_visible_points_choose(struct orl_visible_points *v, const struct orl_thread_pool *pool)
{
    const size_t n = v->n_found;
    struct ranked *ranked = malloc((n + 1) * sizeof *ranked);
    v->n_selected = n < ORL_VISIBLE_POINTS_MOST ? n : ORL_VISIBLE_POINTS_MOST;
    v->selected = malloc((v->n_selected + 1) * sizeof *v->selected);
    if (!ranked || !v->selected) {
        free(ranked);
        return ORL_ERR_NOMEM;
    }
    for (size_t i = 0; i < n; i++)
        ranked[i] = (struct ranked){v->found[i].importance, (uint32_t)i};
    qsort(ranked, n, sizeof *ranked, by_importance);
    for (size_t i = 0; i < v->n_selected; i++)
        v->selected[i] = ranked[i].found;
    int code = 0;
    for (size_t i = 0; i < n && code == 0; i++) {
        v->found[ranked[i].found].selected =
            i < v->n_selected ? (uint32_t)i : most_like(v, &v->found[ranked[i].found]);
        code = i % 1024 == 0 && orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : 0;
    }
    free(ranked);
    return code == 0 ? list_sensors(v) : code;
}

void orl_visible_points_trim(struct orl_visible_points *v)
{
    free(v->found);
    free(v->slots);
    v->found = NULL;
    v->slots = NULL;
    v->n_found = v->n_slots = 0;
}
