/* Kd-tree over the centers of an interpolant. */
#include "bsdf/fit/scan/scan_light.h"

static float coordinate_along(const struct orl_fit_center *k, unsigned axis)
{
    return axis == 0 ? k->x : axis == 1 ? k->y : k->z;
}

static unsigned widest_axis(const struct orl_fit_rbf *t, size_t begin, size_t end)
{
    float least[3] = {2, 2, 2}, most[3] = {-2, -2, -2};
    unsigned widest = 0;
    for (size_t i = begin; i < end; i++)
        for (unsigned axis = 0; axis < 3; axis++) {
            const float v = coordinate_along(&t->centers[t->tree[i]], axis);
            least[axis] = v < least[axis] ? v : least[axis];
            most[axis] = v > most[axis] ? v : most[axis];
        }
    for (unsigned axis = 1; axis < 3; axis++)
        if (most[axis] - least[axis] > most[widest] - least[widest])
            widest = axis;
    return widest;
}

/* Compares along an axis; ties are broken by number, so the order is total. */
static bool is_less(const struct orl_fit_rbf *t, unsigned axis, uint32_t a, uint32_t b)
{
    const float x = coordinate_along(&t->centers[a], axis),
                y = coordinate_along(&t->centers[b], axis);
    return x < y || (x == y && a < b);
}

/* Moves the k-th center into its place, smaller ones before it (Hoare 1961). */
static void select_nth(const struct orl_fit_rbf *t, unsigned axis, size_t begin, size_t end,
                       size_t k)
{
    while (end - begin > 1) {
        const uint32_t pivot = t->tree[begin + (end - begin - 1) / 2];
        size_t i = begin, j = end - 1;
        for (;; i++, j--) {
            while (is_less(t, axis, t->tree[i], pivot))
                i++;
            while (is_less(t, axis, pivot, t->tree[j]))
                j--;
            if (i >= j)
                break;
            const uint32_t other = t->tree[i];
            t->tree[i] = t->tree[j];
            t->tree[j] = other;
        }
        if (k <= j)
            end = j + 1;
        else
            begin = j + 1;
    }
}

/* Orders a range of the tree. The recursion depth is the logarithm of the number of centers. */
static void build_range(const struct orl_fit_rbf *t, size_t begin, size_t end)
{
    if (end - begin < 2)
        return;
    const size_t middle = begin + (end - begin) / 2;
    const unsigned axis = widest_axis(t, begin, end);
    select_nth(t, axis, begin, end, middle);
    t->axes[middle] = (unsigned char)axis;
    build_range(t, begin, middle);
    build_range(t, middle + 1, end);
}

void orl_fit_kd_tree_build(struct orl_fit_rbf *centers)
{
    for (size_t i = 0; i < centers->n; i++) {
        centers->tree[i] = (uint32_t)i;
        centers->axes[i] = 0;
    }
    build_range(centers, 0, centers->n);
}

struct search {
    const struct orl_fit_rbf *centers;
    float place[3];
    struct orl_fit_nearest *found;
};

static void offer_knot(struct search *s, uint32_t center)
{
    const struct orl_fit_center *k = &s->centers->centers[center];
    const float x = k->x - s->place[0], y = k->y - s->place[1], z = k->z - s->place[2];
    const float distance2 = x * x + y * y + z * z;
    struct orl_fit_nearest *f = s->found;
    unsigned at = f->count;
    if (at == ORL_FIT_NEIGHBOURS) {
        if (!(distance2 < f->distance2[at - 1]))
            return;
        at--;
    } else {
        f->count++;
    }
    for (; at > 0 && f->distance2[at - 1] > distance2; at--) {
        f->distance2[at] = f->distance2[at - 1];
        f->center[at] = f->center[at - 1];
    }
    f->distance2[at] = distance2;
    f->center[at] = center;
}

static void search_range(struct search *s, size_t begin, size_t end)
{
    while (end > begin) {
        const size_t middle = begin + (end - begin) / 2;
        const uint32_t center = s->centers->tree[middle];
        const unsigned axis = s->centers->axes[middle];
        const float off = s->place[axis] - coordinate_along(&s->centers->centers[center], axis);
        offer_knot(s, center);
        if (off < 0)
            search_range(s, begin, middle);
        else
            search_range(s, middle + 1, end);
        if (s->found->count == ORL_FIT_NEIGHBOURS &&
            off * off >= s->found->distance2[ORL_FIT_NEIGHBOURS - 1])
            return;
        if (off < 0)
            begin = middle + 1;
        else
            end = middle;
    }
}

void orl_fit_kd_tree_find(const struct orl_fit_rbf *centers, struct orl_vec3 place,
                          struct orl_fit_nearest *ret_found)
{
    struct search s = {centers, {(float)place.x, (float)place.y, (float)place.z}, ret_found};
    ret_found->count = 0;
    search_range(&s, 0, centers->n);
}
