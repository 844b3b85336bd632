#include "scene/geometry/coincidence/coincident.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

#include "scene/geometry/coincidence/coincident_pairs.h"
#include "scene/geometry/coincidence/cutting.h"

/* Limits for opposed pairs, whose overlap is computed only for messages: number of pairs, and
 * work. */
enum { MOST_OPPOSED = 20000, RING_CORNERS = 64 };
static const uint64_t most_work_of_words = 40000000;

struct resolving {
    struct orl_parsed_scene *d;
    struct orl_coincidence_scale scale;
    struct orl_pairs pairs;
    struct orl_coincidence_warnings warnings;
    struct orl_cutting cutting;
    bool *cut; /* by material: true if antimatter cuts it */
};

/* ---- Polygons -------------------------------------------------------------------------------- */

static int keep_opposed(struct orl_parsed_scene *d, const struct orl_pairs *opposed)
{
    d->opposed = malloc((opposed->n + 1) * sizeof *d->opposed);
    if (!d->opposed)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < opposed->n; i++)
        d->opposed[i] = (struct orl_opposed_pair){{opposed->items[i].a, opposed->items[i].b}};
    d->n_opposed = opposed->n;
    return 0;
}

/* Warns of opposed polygons, as they are before any is cut. Pairs of one two-sided material are
 * skipped, because their orientation does not matter. */
static int warn_of_opposed(struct resolving *t, const struct orl_pairs *opposed)
{
    struct orl_cutting testing = {.d = t->d, .tolerance = t->scale.tolerance};
    int code = 0;
    for (size_t i = 0, looked = 0; i < opposed->n && code == 0; i++) {
        if (orl_is_cancelled(t->d->cancel)) {
            code = ORL_ERR_CANCELLED;
            break;
        }
        const struct orl_surface *a = &t->d->surfaces[opposed->items[i].a];
        const struct orl_surface *b = &t->d->surfaces[opposed->items[i].b];
        if (orl_surfaces_alike(t->d, a, b) &&
            orl_material_is_two_sided(&t->d->materials[a->material]) &&
            !orl_coincidence_is_double_pane(t->d, a, b))
            continue;
        if (looked++ == MOST_OPPOSED || testing.overlap.work > most_work_of_words)
            break;
        const struct orl_outline first = orl_outline_of(a), second = orl_outline_of(b);
        code = orl_cutting_test(&testing, &first, &second);
        if (code == 0 && testing.overlap.shared)
            orl_coincidence_warn(&t->warnings, t->d, ORL_COINCIDENCE_OPPOSED, a, b, false);
    }
    orl_cutting_done(&testing);
    return code;
}

/* ---- Unresolved pairs ------------------------------------------------------------------------ */

/* Returns the outline of a polygon, or a polygon inscribed in a ring. */
static struct orl_outline outline_within(const struct orl_surface *s,
                                         struct orl_vec3 corners[2 * RING_CORNERS + 2])
{
    if (s->kind != ORL_SURFACE_RING)
        return orl_outline_of(s);
    const struct orl_frame frame = orl_frame_about(s->normal);
    const double inner = s->quadric->radius[0] / cos(ORL_PI / RING_CORNERS);
    uint32_t n = 0;
    for (int loop = 0; loop < (inner > 0 ? 2 : 1) && inner < s->quadric->radius[1]; loop++)
        for (int i = 0; i < RING_CORNERS + (inner > 0); i++) {
            const double phi = 2 * ORL_PI * (loop ? -i : i) / RING_CORNERS;
            const double r = loop ? inner : s->quadric->radius[1];
            corners[n++] = orl_add(s->quadric->center[0],
                                   orl_to_world(&frame, orl_v3(r * cos(phi), r * sin(phi), 0)));
        }
    return (struct orl_outline){corners, n, s->normal};
}

static int warn_of_open(struct resolving *t, const struct orl_pairs *open)
{
    struct orl_cutting testing = {.d = t->d, .tolerance = t->scale.tolerance};
    int code = 0;
    for (size_t i = 0; i < open->n && code == 0; i++) {
        if (orl_is_cancelled(t->d->cancel)) {
            code = ORL_ERR_CANCELLED;
            break;
        }
        struct orl_vec3 corners[2][2 * RING_CORNERS + 2];
        const struct orl_surface *a = &t->d->surfaces[open->items[i].a];
        const struct orl_surface *b = &t->d->surfaces[open->items[i].b];
        const bool flat = orl_surface_kind_is_flat(a->kind);
        const bool alike = orl_surfaces_alike(t->d, a, b) &&
                           orl_material_is_two_sided(&t->d->materials[a->material]);
        if (flat) {
            const struct orl_outline first = outline_within(a, corners[0]),
                                     second = outline_within(b, corners[1]);
            testing.overlap.shared = false;
            if (testing.overlap.work <= most_work_of_words && first.n > 0 && second.n > 0)
                code = orl_cutting_test(&testing, &first, &second);
        }
        if (code == 0 && (!flat || testing.overlap.shared))
            orl_coincidence_warn(&t->warnings, t->d,
                                 alike ? ORL_COINCIDENCE_SAME_MATERIAL : ORL_COINCIDENCE_AMBIGUOUS,
                                 a, b, false);
    }
    orl_cutting_done(&testing);
    return code;
}

/* ---- All pairs ------------------------------------------------------------------------------- */

enum lot { LOSSES, OPPOSED, OPEN, NOTHING };

/*
 * Classifies a pair. A proxy may coincide with the geometry that it represents, and with another
 * proxy that faces the other way.
 */
static enum lot lot_of(const struct orl_parsed_scene *d, const struct orl_surface *a,
                       const struct orl_surface *b, int *ret_order)
{
    const int proxies = orl_surface_is_proxy(d, a) + orl_surface_is_proxy(d, b);
    *ret_order = 1;
    if (orl_surface_is_hole(d, a) || orl_surface_is_hole(d, b))
        return NOTHING;
    if (proxies == 1 || (proxies == 2 && orl_dot(a->normal, b->normal) < 0))
        return NOTHING;
    if (proxies == 2 || a->kind != ORL_SURFACE_POLYGON || b->kind != ORL_SURFACE_POLYGON)
        return OPEN;
    *ret_order = orl_coincidence_compare(d, a, b);
    return *ret_order == 0 ? OPPOSED : LOSSES;
}

/* Lists the materials that any antimatter cuts. */
static bool *list_cut(const struct orl_parsed_scene *d)
{
    bool *const cut = calloc(d->n_materials + 1, sizeof *cut);
    for (size_t i = 0; cut && i < d->n_materials; i++) {
        if (d->materials[i].kind != ORL_MATERIAL_ANTIMATTER)
            continue;
        const struct orl_antimatter *const antimatter = orl_antimatter_of(&d->materials[i]);
        for (size_t k = 0; k < antimatter->n_cut; k++)
            cut[antimatter->cut[k]] = true;
    }
    for (size_t i = 0; cut && i < d->n_materials; i++)
        cut[i] = cut[orl_material_origin(&d->materials[i], (uint32_t)i)];
    return cut;
}

/* Refuses a pane in the plane of a wall that antimatter cuts: the pane loses to the wall, and would
 * be missing from the hole. */
static int check_pane(const struct resolving *t, const struct orl_surface *pane,
                      const struct orl_surface *wall, struct orl_error *err)
{
    const struct orl_parsed_scene *const d = t->d;
    if (orl_coincidence_class(&d->materials[pane->material]) != 1 || !t->cut[wall->material])
        return 0;
    struct orl_cutting testing = {.d = t->d, .tolerance = t->scale.tolerance};
    const struct orl_outline first = orl_outline_of(pane), second = orl_outline_of(wall);
    const int code = orl_cutting_test(&testing, &first, &second);
    const bool shared = testing.overlap.shared;
    orl_cutting_done(&testing);
    if (code < 0 || !shared)
        return code;
    orl_error_set(err, ORL_ERR_RANGE,
                  "'%.100s' lies in the plane of '%.100s', which antimatter cuts: it is undefined "
                  "which of the two light hits",
                  pane->name, wall->name);
    orl_error_at(err, pane->file, pane->line, NULL);
    orl_error_hint(err, "move it into the hole by a millimetre");
    return ORL_ERR_RANGE;
}

static int classify_pairs(const struct resolving *t, struct orl_pairs lots[NOTHING],
                          struct orl_error *err)
{
    for (size_t i = 0; i < t->pairs.n; i++) {
        if (orl_is_cancelled(t->d->cancel))
            return ORL_ERR_CANCELLED;
        const struct orl_pair p = t->pairs.items[i];
        int order;
        const enum lot lot = lot_of(t->d, &t->d->surfaces[p.a], &t->d->surfaces[p.b], &order);
        const bool first_wins = lot == LOSSES && order > 0;
        if (lot != NOTHING &&
            !orl_pairs_add(&lots[lot], first_wins ? p.b : p.a, first_wins ? p.a : p.b))
            return ORL_ERR_NOMEM;
        const int code = lot != LOSSES ? 0
                                       : check_pane(t, &t->d->surfaces[first_wins ? p.b : p.a],
                                                    &t->d->surfaces[first_wins ? p.a : p.b], err);
        if (code < 0)
            return code;
    }
    return 0;
}

/* Removes surfaces that were cut away completely, and renumbers the opposed ones. */
static int remove_cut_surfaces(struct orl_parsed_scene *d)
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
            d->opposed[pairs++] = (struct orl_opposed_pair){{a, b}};
    }
    d->n_surfaces = kept;
    d->n_opposed = pairs;
    free(places);
    return 0;
}

static int resolve_pairs(struct resolving *t, struct orl_pairs lots[NOTHING], struct orl_error *err)
{
    struct orl_comparison_budget *budget = &t->cutting.budget;
    int code = orl_duplicates_drop(t->d, t->cut, &t->warnings);
    orl_cutting_bound(&t->cutting);
    if (code == 0)
        code = orl_coplanar_find(t->d, t->cut, &t->scale, &t->pairs, budget);
    if (code == 0)
        code = classify_pairs(t, lots, err);
    if (code == 0)
        code = orl_concentric_find(t->d, &t->scale, &lots[OPEN], budget);
    t->cutting.cut_short = budget->n > budget->most;
    t->cutting.tolerance = t->warnings.tolerance = t->scale.tolerance;
    if (code == 0)
        code = keep_opposed(t->d, &lots[OPPOSED]);
    if (code == 0)
        code = warn_of_open(t, &lots[OPEN]);
    if (code == 0)
        code = warn_of_opposed(t, &lots[OPPOSED]);
    if (code == 0 && lots[LOSSES].n > 0)
        code = orl_cutting_run(&t->cutting, &lots[LOSSES]);
    return code == 0 && lots[LOSSES].n > 0 ? remove_cut_surfaces(t->d) : code;
}

int orl_coincident_resolve(struct orl_parsed_scene *parsed_scene, struct orl_error *err)
{
    struct resolving t = {.d = parsed_scene, .cutting = {.d = parsed_scene}};
    struct orl_pairs lots[NOTHING] = {{0}};
    t.cutting.warnings = &t.warnings;
    bool *const cut = t.cut = list_cut(parsed_scene);
    const int code = cut ? resolve_pairs(&t, lots, err) : ORL_ERR_NOMEM;
    free(cut);
    orl_coincidence_warn_totals(&t.warnings, parsed_scene);
    if (t.cutting.cut_short)
        orl_parsed_scene_warn(parsed_scene, "too many polygons share planes, so not all were "
                                            "checked: where two coincide, light may hit either");
    orl_cutting_done(&t.cutting);
    for (int lot = 0; lot < NOTHING; lot++)
        free(lots[lot].items);
    free(t.pairs.items);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    if (code == ORL_ERR_CANCELLED)
        orl_error_set(err, code, "cancelled while reading the scene");
    return code;
}
