#include "scene/built/scene.h"

#include <stdlib.h>
#include <string.h>

#include "scene/built/ports.h"
#include "scene/geometry/antimatter/antimatter.h"
#include "scene/geometry/coincidence/coincident.h"
#include "scene/geometry/instances.h"
#include "scene/material/function_brdf/function_brdf_check.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/scatter.h"

/*
 * Sizes per pair of triangles, corner and facet, with their share of the hierarchy. With the labels
 * and the quadrics (twice), the sum is close to the memory of polygons (make bench-polygons).
 */
enum {
    BYTES_A_COUPLE = 102,
    BYTES_A_CORNER = 36,
    BYTES_A_PACKED_CORNER = 15,
    BYTES_A_FACET = 72,
    BYTES_A_PACKED_FACET = 30,
    BYTES_A_PLACE = 512,
    BYTES_A_MESHED_OUTLINE = 160
};

static int list_emissive(struct orl_scene *scene)
{
    const struct orl_geometry *g = scene->geometry;
    scene->emissive = malloc((g->n_facets + 1) * sizeof *scene->emissive);
    if (!scene->emissive)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < g->n_facets; i++) {
        const struct orl_material *m = orl_scene_material(scene, i);
        const bool shines = orl_material_is_lamp(m) || orl_material_glows(m);
        if (shines && orl_facet_area(g, i) > 0 && orl_luma(orl_material_mean_radiance(m)) > 0)
            scene->emissive[scene->n_emissive++] = (uint32_t)i;
    }
    return 0;
}

/* Decides which of two coincident surfaces light meets. Boundaries of participating media are no
 * such surfaces and stay unchanged. */
static int remove_coincident(struct orl_parsed_scene *d, struct orl_error *err)
{
    size_t n = 0, kept = 0;
    for (size_t i = 0; i < d->n_surfaces; i++)
        n += d->materials[d->surfaces[i].material].kind == ORL_MATERIAL_MIST;
    if (n == 0)
        return orl_coincident_resolve(d, err);
    struct orl_surface *const mist = malloc(n * sizeof *mist);
    if (!mist)
        return ORL_ERR_NOMEM;
    n = 0;
    for (size_t i = 0; i < d->n_surfaces; i++)
        if (d->materials[d->surfaces[i].material].kind == ORL_MATERIAL_MIST)
            mist[n++] = d->surfaces[i];
        else
            d->surfaces[kept++] = d->surfaces[i];
    d->n_surfaces = kept;
    int code = orl_coincident_resolve(d, err);
    struct orl_surface *const grown =
        realloc(d->surfaces, (d->n_surfaces + n) * sizeof *d->surfaces);
    if (grown) {
        d->surfaces = grown;
        memcpy(d->surfaces + d->n_surfaces, mist, n * sizeof *mist);
        d->n_surfaces += n;
    } else if (code == 0) {
        code = ORL_ERR_NOMEM;
    }
    free(mist);
    return code;
}

/* Decides about coincident surfaces within each prototype; surfaces of different prototypes are
 * not compared. */
static int remove_coincident_prototypes(struct orl_parsed_scene *d, struct orl_error *err)
{
    const struct orl_parsed_scene whole = *d;
    int code = 0;
    for (size_t i = 0; i < d->n_prototypes && code == 0; i++) {
        struct orl_prototype *const p = &d->prototypes[i];
        d->surfaces = p->surfaces;
        d->n_surfaces = p->n_surfaces;
        d->opposed = p->opposed;
        d->n_opposed = p->n_opposed;
        code = orl_coincident_resolve(d, err);
        p->surfaces = d->surfaces;
        p->n_surfaces = d->n_surfaces;
        p->opposed = d->opposed;
        p->n_opposed = d->n_opposed;
    }
    d->surfaces = whole.surfaces;
    d->n_surfaces = whole.n_surfaces;
    d->opposed = whole.opposed;
    d->n_opposed = whole.n_opposed;
    return code;
}

int orl_scene_remove_coincident(struct orl_parsed_scene *parsed_scene, struct orl_error *err)
{
    struct orl_parsed_scene *const d = parsed_scene;
    if (d->coincidences_resolved)
        return 0;
    d->n_read = orl_parsed_scene_count_surfaces(d) + d->n_degenerate;
    int code =
        orl_parsed_scene_must_split(d) ? orl_placements_expand(d, ORL_ALL_PLACEMENTS, err) : 0;
    if (code == 0)
        code = remove_coincident(d, err);
    if (code == 0)
        code = remove_coincident_prototypes(d, err);
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    d->coincidences_resolved = code == 0;
    return code;
}

/* Decides which linings of antimatter apply. */
static int remove_linings(struct orl_scene *scene)
{
    const struct orl_parsed_scene *const d = &scene->parsed_scene;
    if (orl_linings_count(scene->geometry) == 0)
        return 0;
    bool *const windows = malloc((d->n_materials + 1) * sizeof *windows);
    if (!windows)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < d->n_materials; i++)
        windows[i] = orl_material_is_window(&d->materials[i]);
    orl_linings_resolve(scene->geometry, windows);
    free(windows);
    return 0;
}

int orl_scene_new(struct orl_parsed_scene *parsed_scene, struct orl_scene **ret_scene,
                  struct orl_error *err)
{
    struct orl_scene *scene = calloc(1, sizeof *scene);
    int code = ORL_ERR_NOMEM;
    if (!scene) {
        orl_parsed_scene_done(parsed_scene);
        goto done;
    }
    atomic_init(&scene->holders, 1);
    scene->parsed_scene = *parsed_scene;
    memset(parsed_scene, 0, sizeof *parsed_scene);
    code = orl_scene_remove_coincident(&scene->parsed_scene, err);
    if (code == 0)
        code = orl_geometry_new(&scene->parsed_scene, &scene->geometry, err);
    if (code == 0)
        code = orl_scene_glaze_openings(scene, err);
    if (code == 0 && scene->parsed_scene.n_patterns > 0)
        code = orl_patterns_measure(&scene->parsed_scene, scene->geometry, err);
    if (code == 0)
        code = orl_function_brdf_check(&scene->parsed_scene, scene->geometry, err);
    if (code == 0)
        code = remove_linings(scene);
    if (code == 0)
        code = orl_volume_split(scene, err);
    if (code == 0)
        code = orl_proxies_split(scene, err);
    if (code == 0)
        code = list_emissive(scene);
    if (code == 0)
        code = orl_parsed_scene_free_surfaces(&scene->parsed_scene);
    scene->parsed_scene.cancel = NULL;
done:
    if (code == ORL_ERR_NOMEM)
        orl_error_set(err, code, "out of memory for the scene");
    if (code == 0)
        *ret_scene = scene;
    else
        orl_scene_release(scene);
    return code;
}

struct orl_scene *orl_scene_hold(struct orl_scene *scene)
{
    atomic_fetch_add_explicit(&scene->holders, 1, memory_order_relaxed);
    return scene;
}

void orl_scene_release(struct orl_scene *scene)
{
    if (!scene || atomic_fetch_sub_explicit(&scene->holders, 1, memory_order_acq_rel) > 1)
        return;
    orl_geometry_free(scene->geometry);
    orl_geometry_free(scene->seen);
    orl_geometry_free(scene->mist);
    orl_geometry_free(scene->proxies);
    orl_parsed_scene_done(&scene->parsed_scene);
    free(scene->hidden);
    free(scene->emissive);
    free(scene->ports);
    free(scene->port_of_facet);
    free(scene);
}

static int by_address(const void *a, const void *b)
{
    const uintptr_t x = (uintptr_t) * (struct orl_bsdf *const *)a;
    const uintptr_t y = (uintptr_t) * (struct orl_bsdf *const *)b;
    return (x > y) - (x < y);
}

/* Returns the size of all BSDFs. Materials may share a BSDF, which is counted once. */
static uint64_t bsdf_bytes(const struct orl_parsed_scene *d)
{
    struct orl_bsdf **found = malloc((d->n_materials + 1) * sizeof(struct orl_bsdf *));
    struct orl_bsdf_info info;
    size_t count = 0;
    uint64_t bytes = 0;
    for (size_t i = 0; found && i < d->n_materials; i++)
        if (orl_material_bsdf(&d->materials[i]))
            found[count++] = orl_material_bsdf(&d->materials[i]);
    if (count > 0)
        qsort(found, count, sizeof(struct orl_bsdf *), by_address);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || found[i] != found[i - 1]) {
            orl_bsdf_describe(found[i], &info);
            bytes += info.bytes;
        }
    free(found);
    return bytes;
}

static uint64_t geometry_bytes(const struct orl_geometry *g)
{
    const uint64_t corner = g->packed ? BYTES_A_PACKED_CORNER : BYTES_A_CORNER;
    const uint64_t facet = g->packed ? BYTES_A_PACKED_FACET : BYTES_A_FACET;
    return g->n_quads * (uint64_t)BYTES_A_COUPLE + g->n_corners * corner + g->n_facets * facet +
           g->n_quadrics * 2 * sizeof(struct orl_quadric) +
           g->n_instances * (sizeof(struct orl_instance) + BYTES_A_PLACE);
}

uint64_t orl_scene_bytes(const struct orl_scene *scene)
{
    enum { PARTS = 4 };
    const struct orl_geometry *const parts[PARTS] = {scene->geometry, scene->seen, scene->proxies,
                                                     scene->mist};
    uint64_t bytes = sizeof *scene + scene->parsed_scene.n_materials * sizeof(struct orl_material);
    for (size_t i = 0; i < PARTS; i++)
        bytes += parts[i] ? geometry_bytes(parts[i]) : 0;
    for (size_t i = 0; parts[0] && i < parts[0]->n_prototypes; i++)
        bytes += geometry_bytes(parts[0]->prototypes[i]) +
                 orl_surface_labels_bytes(scene->parsed_scene.prototypes[i].labels);
    for (size_t i = 0; i < scene->parsed_scene.n_grids; i++)
        bytes += orl_grid_bytes(scene->parsed_scene.grids[i]);
    if (scene->parsed_scene.surfaces)
        bytes += scene->parsed_scene.n_surfaces *
                 (uint64_t)(sizeof(struct orl_surface) + BYTES_A_MESHED_OUTLINE);
    return bytes + orl_surface_labels_bytes(scene->parsed_scene.labels) +
           bsdf_bytes(&scene->parsed_scene);
}

struct orl_surface_label orl_scene_label_of(const struct orl_scene *scene, uint32_t facet)
{
    const struct orl_geometry *const g = scene->geometry;
    const struct orl_parsed_scene *const d = &scene->parsed_scene;
    const uint32_t surface = orl_facet_surface(g, facet);
    if (!orl_facet_is_instanced(g, facet))
        return orl_surface_label_of(d->labels, surface);
    const struct orl_placement *const p = &d->placements[orl_instance_of(g, facet) - g->instance];
    return orl_surface_label_of(d->prototypes[p->prototype].labels, surface);
}

void orl_scene_digest_build(const struct orl_scene *scene, struct orl_sha256 *hash)
{
    static const char vast[] = "couples 3", unlined[] = "linings 2", glazed[] = "openings 1";
    bool found = orl_geometry_is_vast(scene->geometry);
    for (size_t i = 0; i < scene->geometry->n_prototypes && !found; i++)
        found = orl_geometry_is_vast(scene->geometry->prototypes[i]);
    if (found)
        orl_sha256_add(hash, vast, sizeof vast);
    found = false;
    for (size_t i = 0; i < orl_linings_count(scene->geometry) && !found; i++)
        found = orl_lining_is_omitted(scene->geometry, i);
    if (found)
        orl_sha256_add(hash, unlined, sizeof unlined);
    if (scene->n_openings > 0)
        orl_sha256_add(hash, glazed, sizeof glazed);
}

const char *orl_scene_name_of(const struct orl_scene *scene, uint32_t facet)
{
    return orl_scene_label_of(scene, facet).name;
}

bool orl_scene_has_name(const struct orl_scene *scene, uint32_t facet, const char *name)
{
    const struct orl_geometry *const g = scene->geometry;
    const char *const modifier = orl_scene_material(scene, facet)->name;
    if (modifier && strcmp(modifier, name) == 0)
        return true;
    const char *const kept = orl_scene_name_of(scene, facet);
    if (!orl_facet_is_instanced(g, facet))
        return strcmp(kept, name) == 0;
    const struct orl_placement *const p =
        &scene->parsed_scene.placements[orl_instance_of(g, facet) - g->instance];
    return orl_placement_has_name(&scene->parsed_scene, p, kept, name);
}
