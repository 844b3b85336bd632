/*
 * Loads a BSDF: turns the file's sides into the surface's frame and drops a placeholder
 * transmission. It fills a missing transmission by reciprocity, makes colour and peaks, and fills
 * the description.
 */
#include <oriel/base/thread_pool.h>
#include <oriel/bsdf/bsdf.h>

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bsdf/bsdf_internal.h"

void orl_bsdf_set_views(struct orl_bsdf *bsdf)
{
    const struct orl_component *parts = bsdf->document.parts;
    memset(bsdf->views, 0, sizeof bsdf->views);
    for (int front = 0; front < 2; front++) {
        /* Front in the file is the exterior, which is the back here. */
        const struct orl_component *reflection =
            &parts[front ? ORL_COMPONENT_REFLECTION_BACK : ORL_COMPONENT_REFLECTION_FRONT];
        const struct orl_component *own =
            &parts[front ? ORL_COMPONENT_TRANSMISSION_BACK : ORL_COMPONENT_TRANSMISSION_FRONT];
        const struct orl_component *other =
            &parts[front ? ORL_COMPONENT_TRANSMISSION_FRONT : ORL_COMPONENT_TRANSMISSION_BACK];
        bsdf->info.has[front][0] = reflection->present;
        bsdf->info.has[front][1] = own->present;
        if (reflection->present)
            bsdf->views[front][0].component = reflection;
        if (own->present)
            bsdf->views[front][1].component = own;
        else if (other->present && bsdf->document.structure != ORL_STRUCTURE_TREE3)
            bsdf->views[front][1] = (struct orl_component_view){other, true};
    }
}

static bool is_black(const struct orl_bsdf *bsdf, const struct orl_component *c)
{
    const struct orl_matrix *m = &c->matrix;
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_is_leaf(c->tree.root) && !(c->tree.minimum > 0);
    for (int i = 0; i < m->basis[ORL_AXIS_A].n_cells; i++)
        if (m->total[ORL_AXIS_A][i] > 0)
            return false;
    return true;
}

static bool is_same(const struct orl_bsdf *bsdf, const struct orl_component *c,
                    const struct orl_component *d)
{
    if (bsdf->document.structure == ORL_STRUCTURE_TREE4)
        return orl_tree_equal(&c->tree, &d->tree);
    return orl_matrix_equal(&c->matrix, &d->matrix);
}

/* Returns true if the transmissions are exact copies but not reciprocal. The one called Back then
 * has no data of its own. */
static bool is_senseless_copy(const struct orl_bsdf *bsdf, const struct orl_component *front,
                              const struct orl_component *back)
{
    return is_same(bsdf, front, back) && orl_bsdf_irreciprocal_transmission(bsdf) > 0.02;
}

/* Drops a placeholder transmission (enum orl_bsdf_placeholder). The views must be set before; they
 * are set again. */
static void drop_dummy(struct orl_bsdf *bsdf)
{
    struct orl_component *front = &bsdf->document.parts[ORL_COMPONENT_TRANSMISSION_FRONT];
    struct orl_component *back = &bsdf->document.parts[ORL_COMPONENT_TRANSMISSION_BACK];
    struct orl_component *dropped;
    enum orl_bsdf_placeholder kind = ORL_BSDF_PLACEHOLDER_ZERO;
    /* Rank 3: a dropped transmission would not be filled in by reciprocity. */
    if (!front->present || !back->present || bsdf->document.structure == ORL_STRUCTURE_TREE3)
        return;
    if (is_black(bsdf, front) != is_black(bsdf, back)) {
        dropped = is_black(bsdf, front) ? front : back;
    } else if (is_senseless_copy(bsdf, front, back)) {
        dropped = back;
        kind = ORL_BSDF_PLACEHOLDER_COPY;
    } else {
        return;
    }
    bsdf->info.dummy[dropped == back] = kind;
    orl_component_done(dropped);
    orl_bsdf_set_views(bsdf);
}

/*
 * Finds the largest R + T as filed, over all directions that the data distinguish. Also sets
 * bsdf->bound, the largest R plus the largest T: if it is at most 1, R + T needs no check.
 */
static void find_gain(void *arg, size_t front, uint32_t member)
{
    struct orl_bsdf *bsdf = arg;
    double largest = 0, parts[2] = {0, 0}, omega;
    (void)member;
    for (int t = 0; t < 2; t++) {
        const struct orl_component_view *view = &bsdf->views[front][t];
        for (size_t i = 0; i < orl_view_cells(bsdf, view); i++) {
            const struct orl_vec3 in = orl_view_incident(bsdf, view, i, front > 0, &omega);
            double total[2];
            orl_bsdf_filed_totals(bsdf, in, total);
            largest = fmax(largest, total[0] + total[1]);
            parts[t] = fmax(parts[t], orl_rgb_max(orl_bsdf_filed_color(
                                          bsdf, in, t ? ORL_BSDF_TRANSMIT : ORL_BSDF_REFLECT)));
        }
    }
    bsdf->info.max_albedo[front] = largest;
    bsdf->bound[front] = parts[0] + parts[1];
}

static const char *kind_of(enum orl_structure structure, const struct orl_component *component)
{
    const char *basis = component->matrix.basis[ORL_AXIS_A].name;
    if (structure == ORL_STRUCTURE_MATRIX)
        return strncasecmp(basis, "LBNL/", 5) ? basis : basis + 5;
    return structure == ORL_STRUCTURE_TREE3 ? "TensorTree3" : "TensorTree4";
}

static void describe_component(struct orl_bsdf_info *info, enum orl_structure structure,
                               const struct orl_component *component)
{
    const int resolution = orl_component_resolution(structure, component);
    strncpy(info->kind, kind_of(structure, component), sizeof info->kind - 1);
    info->resolution = info->resolution < resolution ? resolution : info->resolution;
    info->values += orl_component_values(structure, component);
    info->bytes += orl_component_bytes(structure, component);
    info->clamped += orl_component_clamped(structure, component);
    info->colored = info->colored || component->chroma.present;
    info->color_left_out =
        info->color_left_out ||
        (!component->chroma.present && (component->chroma.given[0] || component->chroma.given[1]));
}

static void describe_bsdf(struct orl_bsdf *bsdf, struct orl_thread_pool *pool)
{
    struct orl_bsdf_info *info = &bsdf->info;
    memcpy(info->name, bsdf->document.name, sizeof info->name);
    info->thickness_m = bsdf->document.thickness_m;
    info->skipped_bytes = bsdf->document.skipped_bytes;
    info->bytes = sizeof *bsdf;
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++)
        if (bsdf->document.parts[i].present)
            describe_component(info, bsdf->document.structure, &bsdf->document.parts[i]);
    orl_parallel_for(pool, 2, find_gain, bsdf);
}

/* Makes the colour of all components and the peaks of the transmissions. */
static int finish_components(struct orl_bsdf *bsdf, const char *name, struct orl_error *err)
{
    const enum orl_structure structure = bsdf->document.structure;
    int code = 0;
    for (int i = 0; i < ORL_COMPONENT_COUNT && code == 0; i++) {
        struct orl_component *part = &bsdf->document.parts[i];
        if (!part->present)
            continue;
        code = orl_chroma_finish(structure, part, &bsdf->info.out_of_gamut, err);
        if (code == 0 &&
            (i == ORL_COMPONENT_TRANSMISSION_FRONT || i == ORL_COMPONENT_TRANSMISSION_BACK))
            code = orl_peak_make(structure, part, err);
    }
    if (code < 0)
        orl_error_at(err, name, 0, NULL);
    return code;
}

int orl_bsdf_load(const struct orl_bsdf_xml *xml, struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    struct orl_bsdf *bsdf = calloc(1, sizeof *bsdf);
    int code;
    if (!bsdf) {
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the BSDF");
        orl_error_at(err, xml->name, 0, NULL);
        return code;
    }
    atomic_init(&bsdf->references, 1);
    code = orl_document_read(xml, &bsdf->document, err);
    if (code == 0) {
        orl_bsdf_set_views(bsdf);
        drop_dummy(bsdf);
        code = finish_components(bsdf, xml->name, err);
    }
    if (code < 0) {
        orl_bsdf_unref(bsdf);
        return code;
    }
    describe_bsdf(bsdf, xml->pool);
    *ret_bsdf = bsdf;
    return 0;
}

int orl_bsdf_load_xml(const char *name, const char *xml, size_t size, struct orl_bsdf **ret_bsdf,
                      struct orl_error *err)
{
    const struct orl_bsdf_xml whole = {.name = name, .data = xml, .size = size};
    return orl_bsdf_load(&whole, ret_bsdf, err);
}

struct orl_bsdf *orl_bsdf_ref(struct orl_bsdf *bsdf)
{
    atomic_fetch_add_explicit(&bsdf->references, 1, memory_order_relaxed);
    return bsdf;
}

void orl_bsdf_unref(struct orl_bsdf *bsdf)
{
    if (!bsdf || atomic_fetch_sub_explicit(&bsdf->references, 1, memory_order_acq_rel) > 1)
        return;
    if (bsdf->file.data)
        orl_checked_file_close(&bsdf->file);
    else
        orl_document_done(&bsdf->document);
    free(bsdf);
}

void orl_bsdf_describe(const struct orl_bsdf *bsdf, struct orl_bsdf_info *ret_info)
{
    *ret_info = bsdf->info;
}
