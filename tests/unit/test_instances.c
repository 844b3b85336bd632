/*
 * Geometry in several places, stored once, against separate surfaces for each place: rays hit the
 * same, and memory is that of one.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "annual/sun_map/sun_map.h"
#include "base/sampling/sampling.h"
#include "light/lit_scene.h"
#include "photon/surface/footprint.h"
#include "process/limits.h"
#include "render/heat_map/heat_map.h"
#include "scene/geometry/instances.h"
#include "scene/material/patterns/pattern.h"
#include "scene/material/patterns/texture.h"
#include "scene/material/scatter.h"
#include "support/grove.h"
#include "support/meshes.h"

enum { RAYS = 10000 };

static struct orl_scene *scene_of(const struct grove *grove, const char *text)
{
    struct orl_parsed_scene d = grove_read(grove, text);
    struct orl_scene *scene = NULL;
    struct orl_error err = {0};
    if (orl_scene_new(&d, &scene, &err) < 0)
        fail_msg("%s", err.message);
    return scene;
}

/* Both forms of a scene. */
struct pair {
    struct grove grove;
    struct orl_scene *shared, *expanded;
};

static void make_pair_of(struct pair *pair, enum grove_leaves leaves)
{
    grove_init_with(&pair->grove, GROVE_TRIANGLES, GROVE_ROUND, GROVE_PLACES, leaves);
    pair->shared = scene_of(&pair->grove, pair->grove.shared);
    pair->expanded = scene_of(&pair->grove, pair->grove.expanded);
}

static void make_pair(struct pair *pair)
{
    make_pair_of(pair, GROVE_MATT);
}

static void drop_pair(struct pair *pair)
{
    orl_scene_release(pair->shared);
    orl_scene_release(pair->expanded);
    grove_done(&pair->grove);
}

/* Returns a ray into the box around one of the trees, from at most ten units away, or from within.
 */
static struct orl_ray random_ray(const struct orl_geometry *g, struct orl_random *random)
{
    const double number = floor(GROVE_PLACES * orl_random_uniform(random));
    const double x = 2 * orl_random_uniform(random) - 1, y = 2 * orl_random_uniform(random) - 1;
    const struct orl_vec3 there = orl_v3(4 * number + x, y, 2 * orl_random_uniform(random));
    const struct orl_vec3 direction = mesh_direction(random);
    const double away = 10 * orl_random_uniform(random);
    return (struct orl_ray){orl_madd(orl_sub(there, g->center), direction, -away), direction};
}

/* Returns the same facet in the expanded form. Its polygons are in the order of the files, with
 * curved surfaces from the end on. */
static uint32_t same_facet(const struct orl_geometry *shared, const struct orl_geometry *expanded,
                           uint32_t facet)
{
    if (!orl_facet_is_instanced(shared, facet))
        return facet;
    const struct orl_instance *const instance = orl_instance_of(shared, facet);
    const uint32_t place = (uint32_t)(instance - shared->instance),
                   own = facet - instance->first_facet;
    return own < GROVE_TRIANGLES
               ? 1 + GROVE_TRIANGLES * place + own
               : (uint32_t)expanded->n_facets - GROVE_ROUND * (place + 1) + own - GROVE_TRIANGLES;
}

/* Compares the reflection at both hits. With patterns, each place of the expanded form has its own
 * materials, whose functions are rounded differently. Slopes are up to 10, and hits differ by
 * 1e-6. */
static void expect_same_looks(const struct pair *pair, const struct orl_hit *a,
                              const struct orl_hit *b)
{
    const struct orl_material *const m = orl_scene_material(pair->shared, a->facet),
                                     *const n = orl_scene_material(pair->expanded, b->facet);
    const struct orl_vec3 from = orl_normalize(orl_v3(.3, -.5, .7));
    const struct orl_rgb c = orl_material_diffuse(m, a), d = orl_material_diffuse(n, b);
    assert_int_equal(m->kind, n->kind);
    assert_string_equal(m->name, n->name);
    assert_true(fabs(c.r - d.r) + fabs(c.g - d.g) + fabs(c.b - d.b) < 1e-5);
    assert_int_equal(m->texture != NULL, n->texture != NULL);
    if (m->texture)
        assert_true(orl_length(orl_sub(orl_texture_normal(m->texture, a, from),
                                       orl_texture_normal(n->texture, b, from))) < 1e-4);
}

static bool is_same(const struct pair *pair, const struct orl_hit *a, const struct orl_hit *b)
{
    const struct orl_geometry *const s = pair->shared->geometry, *const e =
                                                                     pair->expanded->geometry;
    struct orl_quadric room;
    if (same_facet(s, e, a->facet) != b->facet)
        return false;
    const struct orl_facet f = orl_instance_facet(s, a->facet, &room);
    assert_int_equal(f.kind, e->facets[b->facet].kind);
    expect_same_looks(pair, a, b);
    assert_true(fabs(f.area - e->facets[b->facet].area) < 1e-9 * f.area);
    assert_int_equal(a->front, b->front);
    assert_true(fabs(a->distance - b->distance) < 1e-6);
    assert_true(orl_length(orl_sub(a->point, b->point)) < 1e-6);
    assert_true(orl_length(orl_sub(a->normal, b->normal)) < 1e-6);
    if (f.kind == ORL_SURFACE_POLYGON) {
        const struct orl_triangle t = orl_triangle_get(s, a->triangle);
        assert_true(fabs(orl_dot(orl_sub(a->point, t.a), a->normal)) < 1e-9);
        assert_true(a->triangle >= f.first_triangle &&
                    a->triangle <= orl_facet_triangle(&f, f.n_triangles - 1));
    }
    return true;
}

/*
 * If a ray passes an edge within the rounding of floats, either form is right. Places are up to 90
 * from the middle, with a rounding of 4e-6, and some more in the tree's coordinates: 1e-5 either
 * way. A tree has 200 leaves with some 1.3 edges each, 260 in 8 square units. A ray passes one
 * that near with a probability of 260 * 2e-5 / 8, or 6.5e-4, for each tree on its way. The bound
 * is fewer than 20 of 10 000 rays, 5 standard deviations off for two trees.
 */
static void expect_same_hits(enum grove_leaves leaves)
{
    struct pair pair;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_PILOT, 1);
    unsigned other = 0, found = 0, instance = 0, mirrored = 0;
    make_pair_of(&pair, leaves);
    const struct orl_geometry *const s = pair.shared->geometry, *const e = pair.expanded->geometry;
    assert_int_equal(s->n_instances, GROVE_PLACES);
    assert_int_equal(s->n_facets, 1);
    assert_int_equal(e->n_facets, 1 + GROVE_PLACES * (GROVE_TRIANGLES + GROVE_ROUND));
    assert_true(orl_length(orl_sub(s->low, e->low)) < 1e-9);
    assert_true(orl_length(orl_sub(s->high, e->high)) < 1e-9);
    for (int i = 0; i < RAYS; i++) {
        const struct orl_ray ray = random_ray(s, &random);
        struct orl_hit a, b;
        const bool met = orl_geometry_intersect(s, ray.origin, ray.direction, INFINITY, &a);
        const bool meets = orl_geometry_intersect(e, ray.origin, ray.direction, INFINITY, &b);
        assert_int_equal(orl_geometry_occluded(s, ray.origin, ray.direction, INFINITY), met);
        found += met;
        if (met != meets || (met && !is_same(&pair, &a, &b)))
            other++;
        else if (met) {
            instance += a.instance > 0;
            mirrored += a.instance > 0 && s->instance[a.instance - 1].to.mirrored;
        }
    }
    print_message("%u of %d rays meet something, %u what is placed, %u of it mirrored; %u differ\n",
                  found, RAYS, instance, mirrored, other);
    assert_true(instance > RAYS / 10 && mirrored > RAYS / 100);
    assert_true(other <= 2 * RAYS / 1000);
    drop_pair(&pair);
}

static void test_hits(void **state)
{
    (void)state;
    for (int leaves = GROVE_MATT; leaves <= GROVE_VARIED; leaves++)
        expect_same_hits((enum grove_leaves)leaves);
}

/* Returns maximum and mean of a pattern over all places, in either form. In the expanded form each
 * place has its own pattern. Each is estimated from 1 024 places; 20 times as many would tell
 * more. */
static struct orl_rgb widest(const struct orl_scene *scene, struct orl_rgb *ret_mean)
{
    struct orl_rgb maximum = {0, 0, 0}, sum = {0, 0, 0};
    double n = 0;
    for (size_t i = 0; i < scene->parsed_scene.n_patterns; i++) {
        const struct orl_pattern *const p = scene->parsed_scene.patterns[i];
        if (p->role == ORL_PATTERN_TEXTURE)
            continue;
        maximum.g = fmax(maximum.g, p->maximum.g);
        sum.g += p->mean.g;
        n++;
    }
    ret_mean->g = sum.g / n;
    return maximum;
}

static void test_bounds_of_patterns(void **state)
{
    struct pair pair;
    struct orl_rgb means[2];
    (void)state;
    make_pair_of(&pair, GROVE_VARIED);
    const double shared = widest(pair.shared, &means[0]).g,
                 expanded = widest(pair.expanded, &means[1]).g;
    print_message("most %.5f and %.5f, mean %.5f and %.5f\n", shared, expanded, means[0].g,
                  means[1].g);
    assert_true(pair.expanded->parsed_scene.n_patterns > 5 * pair.shared->parsed_scene.n_patterns);
    assert_true(shared > 0.99 && shared <= 1 && expanded > 0.99 && expanded <= 1);
    assert_true(fabs(means[0].g - means[1].g) < 3 * 0.28 / sqrt(2 * 1024));
    drop_pair(&pair);
}

/* Batches of rays hit the same as single rays. */
static void test_many(void **state)
{
    enum { N = 1000 };
    struct grove grove;
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_PILOT, 1);
    static struct orl_ray rays[N];
    static struct orl_hit hits[N];
    static bool found[N];
    unsigned instance = 0;
    (void)state;
    for (size_t rounds = 0; rounds <= GROVE_ROUND; rounds += GROVE_ROUND) {
        grove_init(&grove, GROVE_TRIANGLES, rounds, GROVE_PLACES);
        struct orl_scene *const scene = scene_of(&grove, grove.shared);
        for (int i = 0; i < N; i++)
            rays[i] = random_ray(scene->geometry, &random);
        orl_geometry_intersect_many(scene->geometry, rays, N, false, hits, found);
        for (int i = 0; i < N; i++) {
            struct orl_hit hit;
            assert_int_equal(orl_geometry_intersect(scene->geometry, rays[i].origin,
                                                    rays[i].direction, INFINITY, &hit),
                             found[i]);
            instance += found[i] && hit.instance > 0;
            assert_true(!found[i] ||
                        (hit.facet == hits[i].facet && hit.point.x == hits[i].point.x &&
                         hit.instance == hits[i].instance));
        }
        orl_scene_release(scene);
        grove_done(&grove);
    }
    assert_true(instance > 100);
}

/* A ray that leaves a surface does not hit it again, on either side, also after arriving from far
 * away. */
static void test_leave(void **state)
{
    struct pair pair;
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_PILOT, 1);
    unsigned left = 0;
    (void)state;
    make_pair(&pair);
    const struct orl_geometry *const g = pair.shared->geometry;
    for (int i = 0; i < RAYS; i++) {
        struct orl_ray ray = random_ray(g, &random);
        struct orl_hit hit, next;
        if (i % 2 == 1)
            ray.origin = orl_madd(ray.origin, ray.direction, -100);
        if (!orl_geometry_intersect(g, ray.origin, ray.direction, INFINITY, &hit))
            continue;
        const struct orl_vec3 back = mesh_direction(&random);
        const struct orl_vec3 from = orl_hit_ray_origin(g, &hit, back);
        left++;
        if (orl_geometry_intersect(g, from, back, INFINITY, &next) && next.facet == hit.facet)
            assert_true(orl_facet_kind(g, hit.facet) != ORL_SURFACE_POLYGON);
    }
    assert_true(left > RAYS / 3);
    drop_pair(&pair);
}

/* ---- Other access to facets and triangles ---------------------------------------------------- */

/* Calls a function for pairs of hits of the same ray on both forms, if they are on placed
 * geometry. */
static void for_hits(const struct pair *pair, uint64_t seed,
                     void (*look)(const struct pair *pair, const struct orl_hit *shared,
                                  const struct orl_hit *expanded, void *ctx),
                     void *ctx)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_PILOT, 1);
    const struct orl_geometry *const s = pair->shared->geometry, *const e =
                                                                     pair->expanded->geometry;
    unsigned n = 0;
    for (int i = 0; i < RAYS; i++) {
        const struct orl_ray ray = random_ray(s, &random);
        struct orl_hit a, b;
        if (!orl_geometry_intersect(s, ray.origin, ray.direction, INFINITY, &a) ||
            !orl_geometry_intersect(e, ray.origin, ray.direction, INFINITY, &b) ||
            a.instance == 0 || same_facet(s, e, a.facet) != b.facet)
            continue;
        look(pair, &a, &b, ctx);
        n++;
    }
    assert_true(n > RAYS / 10);
}

static void compare_places(const struct pair *pair, const struct orl_hit *a,
                           const struct orl_hit *b, void *ctx)
{
    const struct orl_lit_scene s = {.scene = pair->shared, .geometry = pair->shared->geometry};
    const struct orl_lit_scene e = {.scene = pair->expanded, .geometry = pair->expanded->geometry};
    const double direction[2] = {0.6, 0.8};
    const struct orl_frame frame = orl_frame_about(b->normal);
    struct orl_line line, other;
    double uv[2][2];
    (void)ctx;
    const double clear = orl_outline_clearance(&e, b->facet, b->point);
    assert_true(fabs(orl_outline_clearance(&s, a->facet, b->point) - clear) < 1e-9);
    const double exit = orl_outline_exit(&e, b->facet, &frame, b->point, direction, 0, &line);
    const double same = orl_outline_exit(&s, a->facet, &frame, b->point, direction, 0, &other);
    assert_true(same == exit || fabs(same - exit) < 1e-9 * (1 + exit));
    assert_true(fabs(line.offset - other.offset) < 1e-9);
    if (pair->expanded->geometry->facets[b->facet].kind != ORL_SURFACE_POLYGON)
        return;
    orl_hit_uv(s.geometry, a, uv[0]);
    orl_hit_uv(e.geometry, b, uv[1]);
    /* Triangles of a mirrored instance are listed backwards, or from another corner. */
    const double third = 1 - uv[0][0] - uv[0][1];
    const double products[2] = {uv[0][0] * uv[0][1] * third,
                                uv[1][0] * uv[1][1] * (1 - uv[1][0] - uv[1][1])};
    assert_true(fabs(products[0] - products[1]) < 1e-5);
}

static void test_outlines(void **state)
{
    struct pair pair;
    (void)state;
    make_pair(&pair);
    for_hits(&pair, 5, compare_places, NULL);
    drop_pair(&pair);
}

struct texels {
    struct orl_sun_texels of[2];
    double areas[2];
};

static void compare_squares(const struct pair *pair, const struct orl_hit *a,
                            const struct orl_hit *b, void *ctx)
{
    struct texels *const texels = ctx;
    (void)pair;
    const double area = orl_sun_texel_area(&texels->of[0], a);
    texels->areas[0] += area;
    texels->areas[1] += orl_sun_texel_area(&texels->of[1], b);
    assert_true(area > 0);
    assert_int_equal(orl_sun_texel_of(&texels->of[0], a) >> 29, (uint64_t)a->facet + 1);
}

/* The axes of mirrored squares are other sides; the total surface is the same. */
static void test_squares(void **state)
{
    struct pair pair;
    struct texels texels = {.areas = {0, 0}};
    (void)state;
    make_pair(&pair);
    assert_int_equal(orl_sun_texels_init(&texels.of[0], pair.shared->geometry, 0.2), 0);
    assert_int_equal(orl_sun_texels_init(&texels.of[1], pair.expanded->geometry, 0.2), 0);
    for_hits(&pair, 6, compare_squares, &texels);
    assert_true(fabs(texels.areas[0] / texels.areas[1] - 1) < 0.02);
    orl_sun_texels_done(&texels.of[0]);
    orl_sun_texels_done(&texels.of[1]);
    drop_pair(&pair);
}

struct outlines {
    double length;
    unsigned n;
};

static void add_piece(void *ctx, const double from[2], const double to[2])
{
    struct outlines *const sum = ctx;
    sum->length += hypot(to[0] - from[0], to[1] - from[1]);
    sum->n++;
}

static void test_section(void **state)
{
    struct pair pair;
    const struct orl_sensor_plane plane = {
        .normal = {0, 0, 1}, .u = {1, 0, 0}, .v = {0, 1, 0}, .offset = 1.3};
    struct outlines sums[2] = {{0, 0}, {0, 0}};
    (void)state;
    make_pair(&pair);
    orl_section_cut(pair.shared->geometry, &plane, add_piece, &sums[0]);
    orl_section_cut(pair.expanded->geometry, &plane, add_piece, &sums[1]);
    assert_true(sums[0].n > 100);
    assert_int_equal(sums[0].n, sums[1].n);
    /* Prisms that stand for curved surfaces have arbitrary rotations about their axes. */
    assert_true(fabs(sums[0].length / sums[1].length - 1) < 1e-3);
    drop_pair(&pair);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static size_t resident_bytes(void)
{
    unsigned long all = 0, resident = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    assert_non_null(f);
    assert_int_equal(fscanf(f, "%lu %lu", &all, &resident), 2);
    fclose(f);
    return resident * (size_t)sysconf(_SC_PAGESIZE);
}

/* Returns the memory of a scene with a tree in so many places, in a process that has held no
 * other. */
static size_t scene_bytes(size_t triangles, size_t places)
{
    int ends[2];
    size_t bytes = 0;
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct grove grove;
        grove_init(&grove, triangles, 0, places);
        const size_t before = resident_bytes();
        struct orl_scene *const scene = scene_of(&grove, grove.shared);
        bytes = resident_bytes() - before;
        if (scene->geometry->n_instances != places ||
            scene->parsed_scene.n_read != 1 + triangles * places ||
            scene->geometry->prototypes[0]->n_facets != triangles)
            bytes = 0;
        _exit(write(ends[1], &bytes, sizeof bytes) == sizeof bytes ? 0 : 1);
    }
    assert_int_equal(read(ends[0], &bytes, sizeof bytes), sizeof bytes);
    assert_int_equal(waitpid(child, NULL, 0), child);
    close(ends[0]);
    close(ends[1]);
    assert_true(bytes > 0);
    return bytes;
}

/*
 * A tree of 100 000 polygons in 1000 places, 100 million surfaces, takes the memory it takes in
 * four places. Each other place adds at most 2 kilobytes: half a kilobyte of this program, and
 * Embree's own. A mebibyte allows for rounding by allocators.
 */
static void test_memory(void **state)
{
    enum { TRIANGLES = 100000, MANY = 1000, FEW = 4, A_PLACE = 2048, ROUNDING = 1 << 20 };
    (void)state;
    if (ORL_SANITIZED)
        skip(); /* sanitizers keep memory of their own for each byte */
    const size_t few = scene_bytes(TRIANGLES, FEW), many = scene_bytes(TRIANGLES, MANY);
    print_message("%d places: %zu bytes resident; %d places: %zu\n", FEW, few, MANY, many);
    assert_true(many < few + (MANY - FEW) * A_PLACE + ROUNDING);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_hits),
        cmocka_unit_test(test_bounds_of_patterns),
        cmocka_unit_test(test_many),
        cmocka_unit_test(test_leave),
        cmocka_unit_test(test_outlines),
        cmocka_unit_test(test_squares),
        cmocka_unit_test(test_section),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
