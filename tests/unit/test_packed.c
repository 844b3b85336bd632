/*
 * Packed facets and corners of many polygons (scene/geometry/packed.h): compared with the files,
 * with curved surfaces among them; rays that leave them; and copies of such geometries.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "scene/built/scene.h"
#include "scene/geometry/instances.h"
#include "scene/geometry/packed.h"
#include "support/grove.h"
#include "support/meshes.h"
#include "support/scene_text.h"

/* Leaves are triangles and parallelograms of a few centimetres, with some balls and discs among
 * them. */
enum { LEAVES = 150000, A_ROUND = 1000, LETTERS = 320, PREFIX = 256 };

static const double forest_m = 100;

static struct orl_vec3 vector_of(struct orl_random *random, double most)
{
    const double x = orl_random_uniform(random), y = orl_random_uniform(random),
                 z = orl_random_uniform(random);
    return orl_v3((2 * x - 1) * most, (2 * y - 1) * most, (2 * z - 1) * most);
}

static char *write_point(char *at, struct orl_vec3 p)
{
    return at + sprintf(at, " %.17g %.17g %.17g", p.x, p.y, p.z);
}

static char *write_leaf(char *at, int i, struct orl_random *random)
{
    const struct orl_vec3 from = vector_of(random, forest_m), a = vector_of(random, 0.04),
                          b = vector_of(random, 0.04);
    const bool four = i % 2 == 0;
    at += sprintf(at, "%s polygon l%d 0 0 %d", i % 3 ? "m" : "n", i, four ? 12 : 9);
    at = write_point(write_point(at, from), orl_add(from, a));
    at = write_point(at, orl_add(from, orl_add(a, b)));
    at = four ? write_point(at, orl_add(from, b)) : at;
    if (i % A_ROUND == 0)
        at += sprintf(at, "\nm sphere s%d 0 0 4 %d 0 60 0.5", i, i / A_ROUND);
    if (i % A_ROUND == 1)
        at += sprintf(at, "\nn ring r%d 0 0 8 %d 0 70 .6 0 .8 0 .25", i, i / A_ROUND);
    *at++ = '\n';
    return at;
}

struct forest {
    struct orl_parsed_scene parsed_scene;
    struct orl_geometry *geometry;
};

static struct forest forest_of(void)
{
    struct forest forest;
    struct orl_error err = {0};
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 0);
    char *const text = malloc((size_t)LEAVES * LETTERS + PREFIX), *at = text;
    assert_non_null(text);
    at += sprintf(at, "void plastic m 0 0 5 .5 .5 .5 0 0\nvoid plastic n 0 0 5 .2 .5 .2 0 0\n");
    for (int i = 0; i < LEAVES; i++)
        at = write_leaf(at, i, &random);
    *at = '\0';
    forest.parsed_scene = scene_parse_text(text, NULL, NULL);
    assert_int_equal(orl_geometry_new(&forest.parsed_scene, &forest.geometry, &err), 0);
    assert_non_null(forest.geometry->packed);
    free(text);
    return forest;
}

static void drop(struct forest *forest)
{
    orl_geometry_free(forest->geometry);
    orl_parsed_scene_done(&forest->parsed_scene);
}

/* ---- Comparison with the files --------------------------------------------------------------- */

/* The error of a corner is half a step, at most 2^-33 of the next lower power of two. */
static void check_corner(struct orl_vec3 is, struct orl_vec3 ought)
{
    const double most = 0x1p-31;
    assert_true(fabs(is.x - ought.x) <= most * fabs(ought.x));
    assert_true(fabs(is.y - ought.y) <= most * fabs(ought.y));
    assert_true(fabs(is.z - ought.z) <= most * fabs(ought.z));
}

static void check_polygon(const struct orl_geometry *g, uint32_t facet, const struct orl_surface *s)
{
    struct orl_facet own;
    const struct orl_facet *const f = orl_facet_get_own(g, facet, &own);
    const struct orl_facet_outline outline = orl_outline_of_facet(g, facet);
    double reach = 0, area = 0;
    assert_int_equal(outline.n, s->n_vertices);
    for (uint32_t i = 0; i < outline.n; i++) {
        const struct orl_vec3 at = orl_sub(s->vertices[i], g->center);
        check_corner(orl_outline_corner(&outline, i), at);
        reach = fmax(reach, fmax(fabs(at.x), fmax(fabs(at.y), fabs(at.z))));
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        area += orl_triangle_area(&t);
        assert_int_equal(orl_triangle_facet(g, orl_facet_triangle(f, i)), facet);
    }
    /* Sides are centimetres long, with corners accurate to 100 m * 2^-31. */
    assert_true(fabs(area - f->area) < 1e-8);
    assert_true(f->offset >= reach * 0x1p-20 * (1 - 1e-9));
    assert_true(f->offset < reach * 0x1p-20 * 1.19);
}

static void check_round(const struct orl_facet *f, const struct orl_geometry *g,
                        const struct orl_surface *s)
{
    const double area = s->kind == ORL_SURFACE_SPHERE ? ORL_PI : ORL_PI * 0.25 * 0.25;
    assert_true(fabs(f->area / area - 1) < 1e-6);
    assert_true(orl_length(orl_sub(orl_add(f->quadric->center[0], g->center),
                                   s->quadric->center[0])) < 1e-12);
    assert_int_equal(f->n_triangles, 0);
}

static void test_facets(void **state)
{
    struct forest forest = forest_of();
    const struct orl_parsed_scene *const d = &forest.parsed_scene;
    const struct orl_geometry *const g = forest.geometry;
    bool *const seen = calloc(d->n_surfaces, sizeof *seen);
    (void)state;
    assert_non_null(seen);
    assert_int_equal(g->n_facets, d->n_surfaces);
    assert_int_equal(sizeof *g->packed->facets, 24);
    for (uint32_t i = 0; i < g->n_facets; i++) {
        const uint32_t surface = orl_facet_surface(g, i);
        struct orl_facet own;
        const struct orl_facet *const f = orl_facet_get_own(g, i, &own);
        assert_true(surface < d->n_surfaces && !seen[surface]);
        seen[surface] = true;
        const struct orl_surface *const s = &d->surfaces[surface];
        assert_int_equal(f->kind, s->kind);
        assert_int_equal(orl_facet_kind(g, i), s->kind);
        assert_int_equal(orl_facet_material(g, i), s->material);
        assert_true(orl_facet_area(g, i) == f->area && orl_facet_offset(g, i) == f->offset);
        assert_true(s->kind == ORL_SURFACE_SPHERE ||
                    orl_length(orl_sub(f->normal, s->normal)) < 2e-9);
        if (s->kind == ORL_SURFACE_POLYGON)
            check_polygon(g, i, s);
        else
            check_round(f, g, s);
    }
    free(seen);
    drop(&forest);
}

/* Normals along the axes are exact. */
static void test_axes(void **state)
{
    enum { ONE = 1 << 30 };
    static const struct {
        int32_t code[2];
        struct orl_vec3 normal;
    } axes[] = {{{ONE, 0}, {1, 0, 0}},   {{-ONE, 0}, {-1, 0, 0}}, {{0, ONE}, {0, 1, 0}},
                {{0, -ONE}, {0, -1, 0}}, {{0, 0}, {0, 0, 1}},     {{ONE, ONE}, {0, 0, -1}}};
    (void)state;
    for (size_t i = 0; i < sizeof axes / sizeof *axes; i++) {
        struct orl_packed_facet facet = {.n_triangles = 0};
        memcpy(facet.normal, axes[i].code, sizeof facet.normal);
        const struct orl_vec3 n = orl_packed_normal(&facet), ought = axes[i].normal;
        assert_true(n.x == ought.x && n.y == ought.y && n.z == ought.z);
    }
}

/* ---- Rays ------------------------------------------------------------------------------------ */

/* The hit is on its triangle; a ray that leaves it does not hit it again; and batches of rays give
 * equal results. */
static void test_rays(void **state)
{
    enum { RAYS = 100000 };
    struct forest forest = forest_of();
    const struct orl_geometry *const g = forest.geometry;
    struct orl_random random = orl_random_stream(4, ORL_PURPOSE_BENCH, 0);
    int met = 0;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        /* Aimed at a leaf, off its middle. */
        const uint32_t aim = (uint32_t)(orl_random_uniform(&random) * LEAVES);
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_vec3 point, normal;
        struct orl_hit hit, many, next;
        bool found;
        orl_facet_sample(g, aim, u, &point, &normal);
        const struct orl_vec3 direction = orl_normalize(vector_of(&random, 1));
        if (fabs(orl_dot(direction, normal)) < 0.05)
            continue;
        const struct orl_ray ray = {orl_madd(point, direction, -1), direction};
        if (!orl_geometry_intersect(g, ray.origin, ray.direction, INFINITY, &hit))
            continue;
        met += hit.facet == aim;
        if (hit.facet == aim)
            assert_true(orl_length(orl_sub(hit.point, point)) < 1e-6);
        orl_geometry_intersect_many(g, &ray, 1, false, &many, &found);
        assert_true(found && many.facet == hit.facet && many.distance == hit.distance);
        if (orl_facet_kind(g, hit.facet) != ORL_SURFACE_POLYGON)
            continue;
        const struct orl_vec3 away = orl_normalize(vector_of(&random, 1));
        if (orl_geometry_intersect(g, orl_hit_ray_origin(g, &hit, away), away, INFINITY, &next))
            assert_true(next.facet != hit.facet);
    }
    print_message("%d leaves met of %d rays at them\n", met, RAYS);
    assert_true(met > RAYS * 3 / 4);
    drop(&forest);
}

/* ---- Copies ---------------------------------------------------------------------------------- */

/* A copy of every second facet, packed again or small enough not to be, has the same numbers to
 * the bit. */
static void check_copy(const struct orl_geometry *whole, uint32_t every)
{
    struct orl_geometry *part = NULL;
    struct orl_error err = {0};
    bool *const keep = calloc(whole->n_facets, sizeof *keep);
    assert_non_null(keep);
    for (size_t i = 0; i < whole->n_facets; i++)
        keep[i] = i % every == 0;
    assert_int_equal(orl_geometry_subset(whole, keep, &part, &err), 0);
    assert_true((part->packed != NULL) == (every == 2));
    for (uint32_t i = 0; i < whole->n_facets; i++) {
        struct orl_facet rooms[2];
        const struct orl_facet *const was = orl_facet_get_own(whole, i, &rooms[0]);
        const struct orl_facet *const is = orl_facet_get_own(part, i, &rooms[1]);
        assert_int_equal(orl_facet_surface(part, i), orl_facet_surface(whole, i));
        assert_int_equal(is->kind, was->kind);
        assert_true(is->area == (keep[i] ? was->area : 0));
        if (!keep[i])
            continue;
        assert_true(is->offset == was->offset);
        assert_true(orl_length(orl_sub(is->normal, was->normal)) < 1e-15);
        for (uint32_t k = 0; k < was->n_triangles; k++) {
            const struct orl_triangle a = orl_triangle_get(whole, orl_facet_triangle(was, k));
            const struct orl_triangle b = orl_triangle_get(part, orl_facet_triangle(is, k));
            assert_memory_equal(&a, &b, sizeof a);
        }
    }
    orl_geometry_free(part);
    free(keep);
}

static void test_copies(void **state)
{
    struct forest forest = forest_of();
    (void)state;
    check_copy(forest.geometry, 2);
    check_copy(forest.geometry, 5);
    drop(&forest);
}

/* ---- In several places ----------------------------------------------------------------------- */

static struct orl_scene *scene_of(const struct grove *grove, const char *text)
{
    struct orl_parsed_scene d = grove_read(grove, text);
    struct orl_scene *scene = NULL;
    struct orl_error err = {0};
    assert_int_equal(orl_scene_new(&d, &scene, &err), 0);
    return scene;
}

/* A tree in four places is packed once; ray hits equal those of separate surfaces in each place. */
static void test_places(void **state)
{
    enum { TRIANGLES = 140000, ROUND = 12, PLACES = 4, RAYS = 20000 };
    struct grove grove;
    struct orl_random random = orl_random_stream(5, ORL_PURPOSE_BENCH, 0);
    int met = 0, unlike = 0;
    (void)state;
    grove_init(&grove, TRIANGLES, ROUND, PLACES);
    struct orl_scene *const shared = scene_of(&grove, grove.shared);
    struct orl_scene *const expanded = scene_of(&grove, grove.expanded);
    const struct orl_geometry *const s = shared->geometry, *const e = expanded->geometry;
    assert_int_equal(s->n_prototypes, 1);
    assert_true(s->prototypes[0]->packed && !s->packed && e->packed);
    for (int i = 0; i < RAYS; i++) {
        const double x = 4 * floor(PLACES * orl_random_uniform(&random)),
                     y = 2 * orl_random_uniform(&random) - 1, z = 2 * orl_random_uniform(&random);
        const struct orl_vec3 way = mesh_direction(&random), there = orl_v3(x, y, z);
        struct orl_hit a, b;
        const bool one = orl_geometry_intersect(s, orl_madd(orl_sub(there, s->center), way, -9),
                                                way, INFINITY, &a);
        const bool other = orl_geometry_intersect(e, orl_madd(orl_sub(there, e->center), way, -9),
                                                  way, INFINITY, &b);
        unlike += one != other || (one && fabs(a.distance - b.distance) > 1e-5);
        if (!one || !other || fabs(a.distance - b.distance) > 1e-5)
            continue;
        met++;
        struct orl_quadric room;
        assert_int_equal(orl_instance_facet(s, a.facet, &room).kind, orl_facet_kind(e, b.facet));
        assert_ptr_equal(&shared->parsed_scene.materials[orl_facet_material(s, a.facet)],
                         orl_scene_material(shared, a.facet));
        assert_int_equal(orl_facet_material(s, a.facet), orl_facet_material(e, b.facet));
        assert_true(orl_length(orl_sub(a.normal, b.normal)) < 1e-6);
    }
    print_message("%d of %d rays met, %d unlike\n", met, RAYS, unlike);
    assert_true(met > RAYS / 2 && unlike < met / 500);
    orl_scene_release(shared);
    orl_scene_release(expanded);
    grove_done(&grove);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_facets), cmocka_unit_test(test_axes),
                                       cmocka_unit_test(test_rays), cmocka_unit_test(test_copies),
                                       cmocka_unit_test(test_places)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
