/*
 * Memory of a scene of many polygons: resident bytes per polygon, against bounds and against the
 * size that the scene reports, which caches count. Also its ray hits.
 */
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

#include "base/sampling/sampling.h"
#include "process/limits.h"
#include "scene/built/scene.h"
#include "support/polygons.h"
#include "support/scene_text.h"

enum { POLYGONS = 100000, FEW = 1000 };

struct bytes {
    double resident, said; /* bytes per polygon */
};

static char *whole_text(size_t count, bool apart)
{
    size_t size;
    char *const polygons = polygons_text(0, count, apart, &size);
    char *const text = malloc(size + strlen(polygons_materials) + 1);
    assert_non_null(polygons);
    assert_non_null(text);
    memcpy(text, polygons_materials, strlen(polygons_materials));
    memcpy(text + strlen(polygons_materials), polygons, size + 1);
    free(polygons);
    return text;
}

static struct orl_scene *scene_of(const char *text)
{
    struct orl_scene *scene = NULL;
    struct orl_error err = {0};
    struct orl_parsed_scene parsed_scene = scene_parse_text(text, NULL, NULL);
    assert_int_equal(orl_scene_new(&parsed_scene, &scene, &err), 0);
    return scene;
}

static struct bytes bytes_here(bool apart)
{
    char *const text = whole_text(POLYGONS, apart), *const few = whole_text(FEW, apart);
    /* Embree and its task library keep some memory of their own. */
    orl_scene_release(scene_of(few));
    const double before = (double)polygons_resident_bytes();
    struct orl_scene *const scene = scene_of(text);
    const struct bytes bytes = {((double)polygons_resident_bytes() - before) / POLYGONS,
                                (double)orl_scene_bytes(scene) / POLYGONS};
    assert_int_equal(scene->geometry->n_facets, POLYGONS);
    orl_scene_release(scene);
    free(text);
    free(few);
    return bytes;
}

/* Returns bytes per polygon, measured in a process that has held no other scene. */
static struct bytes bytes_of(bool apart)
{
    struct bytes bytes;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        bytes = bytes_here(apart);
        _exit(write(ends[1], &bytes, sizeof bytes) == sizeof bytes ? 0 : 1);
    }
    assert_int_equal(read(ends[0], &bytes, sizeof bytes), sizeof bytes);
    assert_int_equal(waitpid(child, NULL, 0), child);
    close(ends[0]);
    close(ends[1]);
    return bytes;
}

/* The bounds are measured values plus a twentieth. */
static void test_bytes(void **state)
{
    static const double most[2] = {131, 195};
    (void)state;
    for (int apart = 0; apart < 2; apart++) {
        const struct bytes bytes = bytes_of(apart != 0);
        print_message("corners %s: %.1f bytes a polygon resident, %.1f said\n",
                      apart ? "apart" : "shared", bytes.resident, bytes.said);
        if (ORL_SANITIZED)
            continue; /* sanitizers keep additional memory */
        assert_true(bytes.resident < most[apart]);
        assert_true(bytes.said > 0.95 * bytes.resident);
        assert_true(bytes.said < 1.1 * bytes.resident);
    }
}

/* ---- Hits ------------------------------------------------------------------------------------ */

/* Returns half of the polygons: few enough to use Embree's own triangles. */
static struct orl_geometry *half_of(const struct orl_geometry *whole, int half)
{
    struct orl_geometry *part = NULL;
    struct orl_error err = {0};
    bool *const keep = calloc(whole->n_facets, sizeof *keep);
    assert_non_null(keep);
    for (size_t i = 0; i < whole->n_facets; i++)
        keep[i] = (int)(i % 2) == half;
    assert_int_equal(orl_geometry_subset(whole, keep, &part, &err), 0);
    free(keep);
    assert_false(orl_geometry_is_vast(part));
    return part;
}

static struct orl_ray ray_into(const struct orl_geometry *g, struct orl_random *random)
{
    double u[6];
    for (int i = 0; i < 6; i++)
        u[i] = orl_random_uniform(random);
    const struct orl_vec3 from = {(1.8 * u[0] - 0.9) * g->high.x, (1.8 * u[1] - 0.9) * g->high.y,
                                  g->high.z + 1};
    return (struct orl_ray){from, orl_normalize(orl_v3(2 * u[3] - 1, 2 * u[4] - 1, -0.05 - u[5]))};
}

/* Checks that the reported triangle belongs to its facet, and that the point is on it. */
static void check_triangle(const struct orl_geometry *g, const struct orl_hit *hit)
{
    double uv[2];
    struct orl_facet room;
    const struct orl_facet *const f = orl_facet_get_own(g, hit->facet, &room);
    bool own = false;
    for (uint32_t i = 0; i < f->n_triangles; i++)
        own = own || orl_facet_triangle(f, i) == hit->triangle;
    assert_true(own);
    assert_int_equal(orl_triangle_facet(g, hit->triangle), hit->facet);
    orl_hit_uv(g, hit, uv);
    assert_true(fmin(fmin(uv[0], uv[1]), 1 - uv[0] - uv[1]) > -1e-3);
}

/*
 * Hits equal those of two halves that each use Embree's triangles. Rays are floats, with a
 * rounding of 4e-6 at 60 from the middle: within that distance of an edge, the neighbouring
 * polygon may be hit at the same place.
 */
static void test_hits(void **state)
{
    enum { RAYS = 100000 };
    const double near = 4e-5;
    char *const text = whole_text(POLYGONS, false);
    struct orl_scene *const scene = scene_of(text);
    const struct orl_geometry *const whole = scene->geometry;
    struct orl_geometry *const halves[2] = {half_of(whole, 0), half_of(whole, 1)};
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    int met = 0, elsewhere = 0;
    (void)state;
    assert_true(orl_geometry_is_vast(whole));
    for (int i = 0; i < RAYS; i++) {
        const struct orl_ray ray = ray_into(whole, &random);
        struct orl_hit hit, many, hits[2], *first = NULL;
        bool found;
        for (int half = 0; half < 2; half++)
            if (orl_geometry_intersect(halves[half], ray.origin, ray.direction, INFINITY,
                                       &hits[half]) &&
                (!first || hits[half].distance < first->distance))
                first = &hits[half];
        orl_geometry_intersect_many(whole, &ray, 1, false, &many, &found);
        const bool one = orl_geometry_intersect(whole, ray.origin, ray.direction, INFINITY, &hit);
        if (!one || !first || !found) { /* past the rim */
            elsewhere += one || first || found;
            continue;
        }
        met++;
        check_triangle(whole, &hit);
        check_triangle(whole, &many);
        elsewhere += hit.facet != first->facet;
        if (hit.facet == first->facet)
            assert_true(fabs(hit.distance - first->distance) < 1e-9);
        else
            assert_true(orl_length(orl_sub(hit.point, first->point)) < 0.05);
        if (hit.facet == many.facet)
            assert_memory_equal(&hit.point, &many.point, sizeof hit.point);
    }
    print_message("%d rays met, %d of them another polygon than by triangles\n", met, elsewhere);
    assert_true(met > RAYS / 4);
    /* With an edge every 5 cm, one ray in a thousand is that near to one. */
    assert_true(elsewhere < met * near / 0.05 * 4);
    orl_geometry_free(halves[0]);
    orl_geometry_free(halves[1]);
    orl_scene_release(scene);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bytes), cmocka_unit_test(test_hits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
