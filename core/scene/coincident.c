#include "scene/coincident.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/crew.h>

#include "scene/overlap.h"
#include "scene/storage.h"

enum { MOST_TOLD = 8 };
/* Pairs of boxes compared, and work of arrangements: some seconds. */
static const uint64_t most_looks = 400000000, most_work = 400000000;

/* A polygon in its plane. */
struct flat {
    double key; /* alike for all of one plane */
    struct orl_vec3 low, high;
    uint32_t surface;
};

/* loser is cut by winner, or the two are opposed. */
struct pair {
    uint32_t loser, winner;
};

struct settling {
    struct orl_description *d;
    struct orl_vec3 middle; /* of the scene */
    double reach, tolerance;
    struct flat *flats;
    size_t n_flats;
    struct pair *losses;
    size_t n_losses, losses_room, opposed_room;
    struct orl_overlap overlap;
    uint64_t looks, told;
    bool cut_short;
};

/* ---- The rule -------------------------------------------------------------------------------- */

static int class_of(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_VOID:
        return 0;
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_DIELECTRIC:
        return 1;
    case ORL_MATERIAL_BSDF:
        return m->peak ? 1 : 2;
    default:
        return 2;
    }
}

/* Positive: a wins, from both sides; negative: b does; 0: each from its front. */
static int compare(const struct orl_description *d, const struct orl_surface *a,
                   const struct orl_surface *b)
{
    const int class_a = class_of(&d->materials[a->material]);
    const int class_b = class_of(&d->materials[b->material]);
    if (class_a != class_b)
        return class_a - class_b;
    if (orl_dot(a->normal, b->normal) < 0)
        return 0;
    if (a->modifier_order != b->modifier_order)
        return a->modifier_order > b->modifier_order ? 1 : -1;
    return a > b ? 1 : -1;
}

/* ---- Finding pairs --------------------------------------------------------------------------- */

static struct orl_outline outline_of(const struct orl_surface *s)
{
    return (struct orl_outline){s->vertices, s->n_vertices, s->normal};
}

static bool is_looked_at(const struct orl_description *d, const struct orl_surface *s)
{
    return s->kind == ORL_SURFACE_POLYGON && d->materials[s->material].thickness == 0;
}

/* A number that tells planes apart: their distance, and their direction by a slope like no other's.
 */
static double key_of(const struct settling *t, const struct orl_surface *s)
{
    const struct orl_vec3 odd = {0.5257311121191336, 0.3090169943749474, 0.7925302842541783};
    const double sign = orl_dot(s->normal, odd) < 0 ? -1 : 1;
    const double distance = orl_dot(s->normal, orl_sub(s->vertices[0], t->middle));
    return sign * (distance + t->reach * orl_dot(s->normal, odd));
}

static void include(struct orl_vec3 p, struct orl_vec3 *low, struct orl_vec3 *high)
{
    *low = orl_v3(fmin(low->x, p.x), fmin(low->y, p.y), fmin(low->z, p.z));
    *high = orl_v3(fmax(high->x, p.x), fmax(high->y, p.y), fmax(high->z, p.z));
}

static void box_of(const struct orl_surface *s, struct orl_vec3 *low, struct orl_vec3 *high)
{
    *low = *high = s->vertices[0];
    for (uint32_t i = 1; i < s->n_vertices; i++)
        include(s->vertices[i], low, high);
}

static bool list_flats(struct settling *t)
{
    const struct orl_description *d = t->d;
    struct orl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = orl_neg(low);
    t->flats = malloc((d->n_surfaces + 1) * sizeof *t->flats);
    if (!t->flats)
        return false;
    for (size_t i = 0; i < d->n_surfaces; i++) {
        struct flat *f = &t->flats[t->n_flats];
        if (!is_looked_at(d, &d->surfaces[i]))
            continue;
        box_of(&d->surfaces[i], &f->low, &f->high);
        f->surface = (uint32_t)i;
        include(f->low, &low, &high);
        include(f->high, &low, &high);
        t->n_flats++;
    }
    t->middle = orl_scale(orl_add(low, high), 0.5);
    t->reach = 0.5 * orl_length(orl_sub(high, low));
    t->tolerance = fmax(1e-6, t->reach * 0x1p-21);
    for (size_t i = 0; i < t->n_flats; i++)
        t->flats[i].key = key_of(t, &d->surfaces[t->flats[i].surface]);
    return true;
}

static int compare_keys(const void *left, const void *right)
{
    const struct flat *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return a->surface < b->surface ? -1 : a->surface > b->surface;
}

/* Along the sum of all three axes: no plane of a building stands across it. */
static double start_of(const struct flat *f)
{
    return f->low.x + f->low.y + f->low.z;
}

static double end_of(const struct flat *f)
{
    return f->high.x + f->high.y + f->high.z;
}

static int compare_starts(const void *left, const void *right)
{
    const struct flat *a = left, *b = right;
    const double first = start_of(a), second = start_of(b);
    if (first != second)
        return first < second ? -1 : 1;
    return a->surface < b->surface ? -1 : a->surface > b->surface;
}

/* Whether the corners of one lie in the other's plane. */
static bool lies_in(const struct settling *t, const struct orl_surface *s,
                    const struct orl_surface *plane)
{
    for (uint32_t i = 0; i < s->n_vertices; i++)
        if (!(fabs(orl_dot(orl_sub(s->vertices[i], plane->vertices[0]), plane->normal)) <=
              t->tolerance))
            return false;
    return true;
}

static bool boxes_within(const struct flat *a, const struct flat *b, double pad)
{
    return a->low.x <= b->high.x + pad && b->low.x <= a->high.x + pad &&
           a->low.y <= b->high.y + pad && b->low.y <= a->high.y + pad &&
           a->low.z <= b->high.z + pad && b->low.z <= a->high.z + pad;
}

static bool boxes_meet(const struct settling *t, const struct flat *a, const struct flat *b)
{
    return boxes_within(a, b, t->tolerance);
}

/* By more than a seam; they lie in one plane, and may be thin across any one axis. */
static bool boxes_overlap(struct settling *t, const struct flat *a, const struct flat *b)
{
    const double pad = t->tolerance;
    if (!boxes_within(a, b, pad))
        return false;
    const struct orl_vec3 common = {fmin(a->high.x, b->high.x) - fmax(a->low.x, b->low.x),
                                    fmin(a->high.y, b->high.y) - fmax(a->low.y, b->low.y),
                                    fmin(a->high.z, b->high.z) - fmax(a->low.z, b->low.z)};
    return (common.x > pad) + (common.y > pad) + (common.z > pad) >= 2;
}

static bool grow(void *array, size_t *room, size_t count, size_t item)
{
    void **pointer = array;
    if (count < *room)
        return true;
    const size_t more = 2 * *room + 16;
    void *grown = realloc(*pointer, more * item);
    if (!grown)
        return false;
    *pointer = grown;
    *room = more;
    return true;
}

static bool add_pair(struct settling *t, uint32_t a, uint32_t b, int order)
{
    struct orl_description *d = t->d;
    if (order == 0) {
        if (!grow(&d->opposed, &t->opposed_room, d->n_opposed, sizeof *d->opposed))
            return false;
        d->opposed[d->n_opposed++] = (struct orl_opposed){{a, b}};
        return true;
    }
    if (!grow(&t->losses, &t->losses_room, t->n_losses, sizeof *t->losses))
        return false;
    t->losses[t->n_losses++] = order > 0 ? (struct pair){b, a} : (struct pair){a, b};
    return true;
}

static bool look(struct settling *t, const struct flat *a, const struct flat *b)
{
    const struct orl_surface *s = &t->d->surfaces[a->surface];
    const struct orl_surface *other = &t->d->surfaces[b->surface];
    if (!boxes_meet(t, a, b) || fabs(orl_dot(s->normal, other->normal)) < 1 - 1e-6 ||
        (!lies_in(t, s, other) && !lies_in(t, other, s)))
        return true;
    const struct orl_outline first = outline_of(s), second = outline_of(other);
    t->looks += (first.n + second.n) * 4;
    return orl_outlines_apart(&first, &second, t->tolerance) ||
           add_pair(t, a->surface, b->surface, compare(t->d, s, other));
}

/* All pairs of one plane, which lie in a row. */
static bool look_within(struct settling *t, struct flat *flats, size_t n)
{
    qsort(flats, n, sizeof *flats, compare_starts);
    for (size_t i = 0; i < n && !t->cut_short; i++) {
        const double end = end_of(&flats[i]) + 3 * t->tolerance;
        for (size_t j = i + 1; j < n && start_of(&flats[j]) <= end; j++) {
            if (!look(t, &flats[i], &flats[j]))
                return false;
            t->cut_short = ++t->looks > most_looks;
            if (t->cut_short)
                break;
        }
    }
    return true;
}

static bool find_pairs(struct settling *t)
{
    qsort(t->flats, t->n_flats, sizeof *t->flats, compare_keys);
    for (size_t first = 0, next; first < t->n_flats && !t->cut_short; first = next) {
        for (next = first + 1;
             next < t->n_flats && t->flats[next].key - t->flats[next - 1].key <= 4 * t->tolerance;
             next++)
            ;
        if (next - first > 1 && !look_within(t, t->flats + first, next - first))
            return false;
        if (orl_is_cancelled(t->d->cancel))
            break;
    }
    return true;
}

/* ---- Cutting --------------------------------------------------------------------------------- */

static int compare_losses(const void *left, const void *right)
{
    const struct pair *a = left, *b = right;
    if (a->loser != b->loser)
        return a->loser < b->loser ? -1 : 1;
    return a->winner < b->winner ? -1 : a->winner > b->winner;
}

static void warn(struct settling *t, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void warn(struct settling *t, const char *format, ...)
{
    char text[640];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    orl_description_warn(t->d, text);
}

static void tell(struct settling *t, const struct orl_surface *loser,
                 const struct orl_surface *winner, bool wholly)
{
    if (t->told++ >= MOST_TOLD)
        return;
    warn(t,
         "polygon %.100s at %.120s:%d lies %sin one place with polygon %.100s at %.120s:%d: there "
         "light meets %.100s, as in Radiance",
         loser->name, loser->file, loser->line, wholly ? "wholly " : "", winner->name, winner->file,
         winner->line, winner->name);
}

/* Keeps the winners that do share an area with the loser, and tells them. */
static int sift(struct settling *t, const struct orl_surface *loser, struct pair *losses, size_t *n)
{
    const struct orl_outline first = outline_of(loser);
    const uint32_t layer = 0;
    size_t kept = 0;
    for (size_t i = 0; i < *n && !t->cut_short; i++) {
        const struct orl_surface *winner = &t->d->surfaces[losses[i].winner];
        const struct orl_outline second = outline_of(winner);
        const int code =
            orl_outline_subtract(&t->overlap, &first, &second, &layer, 1, t->tolerance);
        t->cut_short = t->overlap.work > most_work || code == ORL_ERR_LIMIT;
        if (code == ORL_ERR_NOMEM)
            return code;
        if (code < 0 || !t->overlap.shared)
            continue;
        tell(t, loser, winner, t->overlap.n == 0);
        losses[kept++] = losses[i];
    }
    *n = kept;
    return 0;
}

/* A layer for each of some winners, such that of one layer none overlap: the number of them that
 * got one. Those come first. */
static size_t lay(struct settling *t, struct orl_outline *others, struct flat *boxes, size_t n,
                  uint32_t *ret_layers)
{
    size_t laid = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t taken = 0, layer = 0;
        for (size_t k = 0; k < laid; k++)
            if (boxes_overlap(t, &boxes[i], &boxes[k]))
                taken |= (uint32_t)1 << ret_layers[k];
        t->looks += laid;
        while (layer < ORL_OVERLAP_LAYERS && (taken >> layer & 1))
            layer++;
        if (layer == ORL_OVERLAP_LAYERS)
            continue;
        const struct orl_outline outline = others[i];
        const struct flat box = boxes[i];
        others[i] = others[laid];
        boxes[i] = boxes[laid];
        others[laid] = outline;
        boxes[laid] = box;
        ret_layers[laid++] = layer;
    }
    return laid;
}

/* The outline that is left becomes the surface's own. */
static int take_outline(struct settling *t, struct orl_surface *left)
{
    const size_t bytes = t->overlap.n * sizeof *left->vertices;
    left->n_vertices = t->overlap.n;
    left->vertices = orl_storage_take(t->d->storage, bytes + 1);
    if (!left->vertices)
        return ORL_ERR_NOMEM;
    if (bytes > 0)
        memcpy(left->vertices, t->overlap.vertices, bytes);
    return 0;
}

/* The loser without all its winners, of which the outlines are the original ones. */
static int cut(struct settling *t, struct pair *losses, size_t n, struct orl_surface *left)
{
    struct orl_outline *others = malloc((n + 1) * sizeof *others);
    struct flat *boxes = malloc((n + 1) * sizeof *boxes);
    uint32_t *layers = malloc((n + 1) * sizeof *layers);
    int code = others && boxes && layers ? sift(t, left, losses, &n) : ORL_ERR_NOMEM;
    for (size_t i = 0; i < n && code == 0; i++) {
        others[i] = outline_of(&t->d->surfaces[losses[i].winner]);
        box_of(&t->d->surfaces[losses[i].winner], &boxes[i].low, &boxes[i].high);
    }
    for (size_t first = 0; first < n && code == 0 && left->n_vertices > 0 && !t->cut_short;) {
        const struct orl_outline outline = outline_of(left);
        const size_t laid = lay(t, others + first, boxes + first, n - first, layers);
        code =
            orl_outline_subtract(&t->overlap, &outline, others + first, layers, laid, t->tolerance);
        t->cut_short = t->overlap.work > most_work || t->looks > most_looks;
        if (code == 0)
            code = take_outline(t, left);
        if (code == ORL_ERR_LIMIT) {
            t->cut_short = true;
            code = 0;
        }
        first += laid;
    }
    free(others);
    free(boxes);
    free(layers);
    return code;
}

/* Cuts all, each by what the others were before any was cut. */
static int cut_all(struct settling *t)
{
    struct orl_description *d = t->d;
    struct orl_surface *cuts = malloc((t->n_losses + 1) * sizeof *cuts);
    size_t n_cuts = 0;
    int code = cuts ? 0 : ORL_ERR_NOMEM;
    qsort(t->losses, t->n_losses, sizeof *t->losses, compare_losses);
    for (size_t first = 0, next; first < t->n_losses && code == 0; first = next) {
        for (next = first; next < t->n_losses && t->losses[next].loser == t->losses[first].loser;)
            next++;
        cuts[n_cuts] = d->surfaces[t->losses[first].loser];
        code = cut(t, t->losses + first, next - first, &cuts[n_cuts++]);
        if (orl_is_cancelled(d->cancel))
            code = ORL_ERR_CANCELLED;
    }
    for (size_t first = 0, k = 0; first < t->n_losses && code == 0; first++)
        if (first == 0 || t->losses[first].loser != t->losses[first - 1].loser)
            d->surfaces[t->losses[first].loser] = cuts[k++];
    free(cuts);
    return code;
}

/* Takes out surfaces of which nothing is left, and renumbers the opposed ones. */
static int compact(struct orl_description *d)
{
    uint32_t *places = malloc((d->n_surfaces + 1) * sizeof *places);
    size_t kept = 0, pairs = 0;
    if (!places)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < d->n_surfaces; i++) {
        const bool gone =
            d->surfaces[i].kind == ORL_SURFACE_POLYGON && d->surfaces[i].n_vertices == 0;
        places[i] = gone ? UINT32_MAX : (uint32_t)kept;
        if (!gone)
            d->surfaces[kept++] = d->surfaces[i];
    }
    for (size_t i = 0; i < d->n_opposed; i++) {
        const uint32_t a = places[d->opposed[i].surfaces[0]], b = places[d->opposed[i].surfaces[1]];
        if (a != UINT32_MAX && b != UINT32_MAX)
            d->opposed[pairs++] = (struct orl_opposed){{a, b}};
    }
    d->n_surfaces = kept;
    d->n_opposed = pairs;
    free(places);
    return 0;
}

int orl_coincident_settle(struct orl_description *description, struct orl_error *err)
{
    struct settling t = {.d = description};
    int code = list_flats(&t) && find_pairs(&t) ? 0 : ORL_ERR_NOMEM;
    if (code == 0 && t.n_losses > 0)
        code = cut_all(&t);
    if (code == 0 && t.n_losses > 0)
        code = compact(description);
    if (t.told > MOST_TOLD)
        warn(&t, "%llu more pairs of polygons lie in one place",
             (unsigned long long)t.told - MOST_TOLD);
    if (t.cut_short)
        warn(&t, "so many polygons share planes that not all were looked at: where two lie in one "
                 "place, light may meet either");
    orl_overlap_done(&t.overlap);
    free(t.flats);
    free(t.losses);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while reading the scene");
    return code;
}
