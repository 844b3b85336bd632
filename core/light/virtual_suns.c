#include "light/virtual_suns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/direct.h"
#include "light/path.h"
#include "scene/geometry/instances.h"
#include "scene/material/scatter.h"

enum { MOST_CLASSES = 256 };
enum { PILOT_RAYS = 1 << 14, MOST_CANDIDATES = 256, MOST_SHOWN_DEEP = 32 };

/* cosine of the largest angle between normals of a class: a milliradian */
static const double alike = 1 - 5e-7;
/* cosine of the largest angle between directions of a node */
static const double same_place = 1 - 2e-6;
/* An image by several reflections needs this share of the light on mirrors, or a chain of mirrors
 * that reflects this much together: it may light a dark place, however small the mirrors are. Two
 * panes reflect 0.03. */
static const double least_share = 1e-3, bright_chain = 0.05;

/* ---- Classes of mirrors ---------------------------------------------------------------------- */

struct class
{
    struct orl_vec3 normal;
    double weight; /* area times reflectance at 60 degrees */
    size_t facets;
    int16_t index; /* index among the selected classes; -1: not selected */
};

/* Counts mirrors in instances, which have as many orientations as they have instances. */
static size_t count_placed_mirrors(const struct orl_lit_scene *lit_scene)
{
    size_t n = 0;
    for (struct orl_facet_iterator walk = orl_facet_iterator(lit_scene->geometry);
         orl_facet_iterator_next(&walk);) {
        struct orl_facet room;
        if (orl_facet_is_instanced(lit_scene->geometry, walk.facet) &&
            orl_is_flat_mirror(lit_scene, orl_facet_get(lit_scene->geometry, walk.facet, &room)))
            n += walk.places;
    }
    return n;
}

static size_t find_class(struct class *classes, size_t n, struct orl_vec3 normal)
{
    size_t k = 0;
    while (k < n && fabs(orl_dot(normal, classes[k].normal)) < alike)
        k++;
    return k;
}

/* Selects the classes of largest weight, in their original order. */
static void keep_heaviest(struct orl_virtual_suns *images, struct class *classes, size_t n)
{
    for (size_t kept = 0; kept < ORL_MOST_MIRRORS && kept < n; kept++) {
        size_t best = n;
        for (size_t i = 0; i < n; i++)
            if (classes[i].index < 0 && (best == n || classes[i].weight > classes[best].weight))
                best = i;
        classes[best].index = 0;
    }
    for (size_t i = 0; i < n; i++) {
        if (classes[i].index < 0) {
            images->n_left_out += classes[i].facets;
            continue;
        }
        classes[i].index = (int16_t)images->n_mirrors;
        images->mirrors[images->n_mirrors++] = classes[i].normal;
    }
}

static int find_mirrors(struct orl_virtual_suns *images, const struct orl_lit_scene *lit_scene)
{
    const size_t n_facets = images->n_facets = lit_scene->geometry->n_facets;
    images->n_left_out = count_placed_mirrors(lit_scene);
    struct class *classes = orl_arrays_new(&images->arrays, MOST_CLASSES, sizeof *classes);
    size_t n = 0;
    images->mirrors = orl_arrays_new(&images->arrays, ORL_MOST_MIRRORS, sizeof *images->mirrors);
    images->class_of = orl_arrays_new(&images->arrays, n_facets, sizeof *images->class_of);
    if (images->arrays.failed)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < n_facets; i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(lit_scene->geometry, i, &own);
        images->class_of[i] = -1;
        if (!orl_is_flat_mirror(lit_scene, f))
            continue;
        const size_t k = find_class(classes, n, f->normal);
        if (k == MOST_CLASSES) {
            images->n_left_out++;
            continue;
        }
        if (k == n)
            classes[n++] = (struct class){.normal = f->normal, .index = -1};
        classes[k].weight +=
            f->area * orl_material_max_mirrored(orl_lit_scene_material_of(lit_scene, i), true, 0.5);
        classes[k].facets++;
        images->class_of[i] = (int16_t)k;
    }
    keep_heaviest(images, classes, n);
    for (size_t i = 0; i < n_facets; i++)
        if (images->class_of[i] >= 0)
            images->class_of[i] = classes[images->class_of[i]].index;
    return 0;
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

/* Returns the node of a sun in that direction; -1: none. */
static int find_node(const struct orl_virtual_suns *images, uint32_t sun, struct orl_vec3 direction)
{
    for (size_t i = 0; i < images->n_nodes; i++)
        if (images->nodes[i].sun == sun &&
            orl_dot(images->nodes[i].frame.n, direction) > same_place)
            return (int)i;
    return -1;
}

static struct orl_frame turned_frame(struct orl_frame f, struct orl_vec3 mirror)
{
    return (struct orl_frame){orl_virtual_sun_reflect(f.u, mirror),
                              orl_virtual_sun_reflect(f.v, mirror),
                              orl_virtual_sun_reflect(f.n, mirror)};
}

static int add_node(struct orl_virtual_suns *images, struct orl_frame frame, uint32_t sun)
{
    const int there = find_node(images, sun, frame.n);
    if (there >= 0 || images->n_nodes == ORL_MOST_VIRTUAL_SUNS)
        return there;
    images->nodes[images->n_nodes] = (struct orl_virtual_sun){.frame = frame, .sun = sun};
    return (int)images->n_nodes++;
}

/* ---- Pilot: images by several reflections ---------------------------------------------------- */

/* Directions from which light arrives after several reflections, with its flux. */
struct pilot {
    const struct orl_lit_scene *lit_scene;
    const struct orl_virtual_suns *images;
    uint32_t sun;
    size_t n;
    struct orl_frame frames[MOST_CANDIDATES];
    double flux[MOST_CANDIDATES], throughput[MOST_CANDIDATES]; /* throughput: of the best chain */
    double fallen;                                             /* flux of this sun on mirrors */
    bool overflown; /* there was no room for a candidate by bright mirrors */
};

static void add_candidate(struct pilot *pilot, const struct orl_frame *frame, double flux,
                          double throughput)
{
    size_t i = 0;
    while (i < pilot->n && orl_dot(pilot->frames[i].n, frame->n) <= same_place)
        i++;
    if (i == MOST_CANDIDATES) {
        pilot->overflown |= throughput >= bright_chain;
        return;
    }
    if (i == pilot->n) {
        pilot->frames[i] = *frame;
        pilot->flux[i] = pilot->throughput[i] = 0;
        pilot->n++;
    }
    pilot->flux[i] += flux;
    pilot->throughput[i] = fmax(pilot->throughput[i], throughput);
}

/* Follows light between mirrors; it travels against frame.n. At each pane it randomly takes one
 * of two branches. throughput: reflectance of the first mirror. */
static void follow_light(struct pilot *pilot, struct orl_vec3 origin, struct orl_frame frame,
                         double flux, double throughput, struct orl_random *random)
{
    const struct orl_lit_scene *lit_scene = pilot->lit_scene;
    struct orl_path path = orl_path_from(origin, orl_neg(frame.n));
    int reflections = 1;
    for (int step = 0; step < 4 * ORL_MOST_SUN_REFLECTIONS; step++) {
        struct orl_hit hit;
        if (reflections > 1)
            add_candidate(pilot, &frame, flux, throughput);
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return;
        const struct orl_material *m = orl_lit_scene_material(lit_scene, &hit);
        const int16_t class = orl_virtual_suns_class(pilot->images, hit.facet);
        const double back =
            class < 0 ? 0 : orl_luma(orl_material_mirrored(m, &hit, orl_path_back(&path)));
        const double on = orl_luma(orl_material_straight(m, &hit, orl_path_back(&path)));
        if (!(back + on > 0))
            return;
        flux *= back + on;
        const bool mirrored = orl_random_uniform(random) * (back + on) < back;
        throughput *= mirrored ? back : on;
        if (throughput < ORL_VIRTUAL_SUN_LEAST)
            return;
        if (mirrored && ++reflections > ORL_MOST_SUN_REFLECTIONS)
            return;
        if (mirrored)
            frame = turned_frame(frame, pilot->images->mirrors[class]);
        path.direction = orl_neg(frame.n);
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
}

/* Traces light of the pilot's sun onto one mirror, divided into `rays` rays. */
static void light_mirror(struct pilot *pilot, uint32_t facet, uint32_t rays)
{
    const struct orl_lit_scene *lit_scene = pilot->lit_scene;
    const struct orl_geometry *g = lit_scene->geometry;
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_get_own(g, facet, &own);
    const struct orl_sun *sun = &lit_scene->suns[pilot->sun];
    const double cosine = orl_dot(sun->frame.n, f->normal);
    const struct orl_vec3 lit = cosine > 0 ? f->normal : orl_neg(f->normal);
    const struct orl_vec3 mirror = pilot->images->mirrors[pilot->images->class_of[facet]];
    const double each = f->area * fabs(cosine) * orl_luma(sun->irradiance) / rays;
    for (uint32_t i = 0; i < rays; i++) {
        struct orl_random random =
            orl_random_stream(facet, ORL_PURPOSE_PILOT, ((uint64_t)pilot->sun << 32) + i);
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_hit hit = {.facet = facet, .front = cosine > 0};
        orl_facet_sample(g, facet, u, &hit.point, &hit.normal);
        const struct orl_vec3 start = orl_hit_ray_origin(g, &hit, lit);
        const double share =
            orl_luma(orl_transmittance(lit_scene, start, sun->frame.n, INFINITY, true));
        pilot->fallen += each * share;
        const double mirrored = orl_luma(
            orl_material_mirrored(orl_lit_scene_material(lit_scene, &hit), &hit, sun->frame.n));
        if (share * mirrored > 0)
            follow_light(pilot, start, turned_frame(sun->frame, mirror), each * share * mirrored,
                         mirrored, &random);
    }
}

static int light_mirrors(struct pilot *pilot, const struct orl_thread_pool *pool)
{
    const struct orl_geometry *g = pilot->lit_scene->geometry;
    size_t mirrors = 0;
    for (size_t i = 0; i < g->n_facets; i++)
        mirrors += pilot->images->class_of[i] >= 0;
    const size_t each = mirrors > 0 ? PILOT_RAYS / mirrors : 0;
    const uint32_t rays = (uint32_t)(each > 1024 ? 1024 : each < 4 ? 4 : each);
    for (size_t i = 0; i < g->n_facets; i++) {
        if (pilot->images->class_of[i] < 0)
            continue;
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        light_mirror(pilot, (uint32_t)i, rays);
    }
    return 0;
}

static bool is_needed(const struct pilot *pilot, size_t candidate)
{
    return pilot->flux[candidate] > least_share * pilot->fallen ||
           (pilot->flux[candidate] > 0 && pilot->throughput[candidate] >= bright_chain);
}

/* Makes the needed candidates nodes that are shown, the brightest first. */
static void show_brightest(struct orl_virtual_suns *images, struct pilot *pilot)
{
    images->n_images_left_out += pilot->overflown;
    for (int taken = 0;; taken++) {
        size_t best = pilot->n;
        for (size_t i = 0; i < pilot->n; i++)
            if (is_needed(pilot, i) && (best == pilot->n || pilot->flux[i] > pilot->flux[best]))
                best = i;
        if (best == pilot->n)
            return;
        const int node = taken < MOST_SHOWN_DEEP
                             ? add_node(images, pilot->frames[best], pilot->sun)
                             : find_node(images, pilot->sun, pilot->frames[best].n);
        images->n_images_left_out += node < 0;
        if (node >= 0)
            images->nodes[node].shown = true;
        pilot->flux[best] = 0;
    }
}

/* ---- Building -------------------------------------------------------------------------------- */

static int connect_nodes(struct orl_virtual_suns *images)
{
    images->next =
        orl_arrays_new(&images->arrays, images->n_nodes * images->n_mirrors, sizeof *images->next);
    if (!images->next)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < images->n_nodes; i++)
        for (size_t m = 0; m < images->n_mirrors; m++)
            images->next[i * images->n_mirrors + m] = (int16_t)find_node(
                images, images->nodes[i].sun,
                orl_virtual_sun_reflect(images->nodes[i].frame.n, images->mirrors[m]));
    return 0;
}

/* Marks the facets whose classes have an edge from the node. */
static void mark_mirrors(const struct orl_virtual_suns *images, size_t node, size_t n_facets,
                         bool *ret_shows)
{
    for (size_t f = 0; f < n_facets; f++)
        ret_shows[f] = images->class_of[f] >= 0 &&
                       orl_virtual_suns_next(images, (int)node, images->class_of[f]) >= 0;
}

static int find_columns(struct orl_virtual_suns *images, const struct orl_lit_scene *lit_scene)
{
    const size_t n_facets = lit_scene->geometry->n_facets;
    size_t shown = 0;
    for (size_t i = 0; i < images->n_nodes; i++)
        shown += images->nodes[i].shown;
    bool *shows = malloc(n_facets + 1);
    images->columns = orl_arrays_new(&images->arrays, shown, sizeof *images->columns);
    images->columns_of =
        orl_arrays_new(&images->arrays, images->n_nodes, sizeof *images->columns_of);
    if (!shows || images->arrays.failed) {
        free(shows);
        return ORL_ERR_NOMEM;
    }
    shown = 0;
    for (size_t i = 0; i < images->n_nodes; i++) {
        const struct orl_virtual_sun *node = &images->nodes[i];
        images->columns_of[i] = node->shown ? (int16_t)shown : -1;
        if (!node->shown)
            continue;
        mark_mirrors(images, i, n_facets, shows);
        orl_virtual_sun_columns_build(&images->columns[shown++], lit_scene->geometry, &node->frame,
                                      acos(lit_scene->suns[node->sun].cos_half_angle), shows);
    }
    free(shows);
    return 0;
}

int orl_virtual_suns_build(struct orl_virtual_suns *images, const struct orl_lit_scene *lit_scene,
                           const struct orl_thread_pool *pool)
{
    struct pilot *pilot = calloc(1, sizeof *pilot);
    *images = (struct orl_virtual_suns){.n_nodes = 0};
    images->nodes = orl_arrays_new(&images->arrays, ORL_MOST_VIRTUAL_SUNS, sizeof *images->nodes);
    int code = pilot && images->nodes ? find_mirrors(images, lit_scene) : ORL_ERR_NOMEM;
    for (size_t s = 0; s < lit_scene->n_suns && s < ORL_MOST_VIRTUAL_SUNS && code == 0; s++)
        images->nodes[add_node(images, lit_scene->suns[s].frame, (uint32_t)s)].is_sun = true;
    for (size_t s = 0; s < lit_scene->n_suns && images->n_mirrors > 0 && code == 0; s++) {
        for (size_t m = 0; m < images->n_mirrors; m++) {
            const int node = add_node(
                images, turned_frame(lit_scene->suns[s].frame, images->mirrors[m]), (uint32_t)s);
            images->n_images_left_out += node < 0;
            if (node >= 0)
                images->nodes[node].shown = true;
        }
        *pilot = (struct pilot){.lit_scene = lit_scene, .images = images, .sun = (uint32_t)s};
        code = light_mirrors(pilot, pool);
        show_brightest(images, pilot);
    }
    free(pilot);
    if (code == 0)
        code = connect_nodes(images);
    return code == 0 ? find_columns(images, lit_scene) : code;
}

void orl_virtual_suns_keep(struct orl_virtual_suns *images, const bool *keep)
{
    for (size_t i = 0; i < images->n_nodes; i++) {
        struct orl_virtual_sun *node = &images->nodes[i];
        uint32_t before = 0;
        const bool kept = keep && keep[node->sun];
        for (uint32_t s = 0; keep && s < node->sun; s++)
            before += keep[s];
        node->sun = before;
        node->shown = node->shown && kept;
        node->is_sun = node->is_sun && kept;
    }
}
