/*
 * Density estimates: the right photons are found, uniform light is unbiased, nothing is gathered
 * through walls or from other surfaces, and leaf look-ups agree with plain estimates.
 *
 * With k-th nearest distance r, the estimate (k-1) flux / (pi r^2) of uniform photons has mean 1
 * and relative variance 1 / (k-2); tolerances follow from that.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"
#include "light/lit_scene.h"
#include "photon/density/irradiance_tables.h"
#include "photon/map/quantization.h"
#include "photon/surface/footprint.h"
#include "support/cli.h"
#include "support/scene_text.h"

static char folder[64];
static struct orl_search *search;

static int set_up(void **state)
{
    (void)state;
    cli_make_folder(folder);
    search = calloc(1, sizeof *search);
    return sodium_init() < 0 || !search ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    free(search);
    cli_remove_folder(folder);
    return 0;
}

/* A growing list of photons, each of flux 1 unless stated otherwise. */
struct shower {
    struct orl_photon *photons;
    size_t count;
    struct orl_random random;
};

static struct shower shower_new(size_t most, uint64_t seed)
{
    struct shower s = {malloc((most + 1) * sizeof *s.photons), 0,
                       orl_random_stream(seed, ORL_PURPOSE_BENCH, 0)};
    assert_non_null(s.photons);
    return s;
}

static void land(struct shower *s, struct orl_vec3 at, struct orl_vec3 normal, double flux)
{
    s->photons[s->count++] =
        (struct orl_photon){.position = {(float)at.x, (float)at.y, (float)at.z},
                            .flux = {(float)flux, (float)flux, (float)flux},
                            .normal = orl_normal_encode(normal)};
}

/* Adds count photons, uniform over the parallelogram at corner. */
static void rain(struct shower *s, size_t count, struct orl_vec3 corner, struct orl_vec3 a,
                 struct orl_vec3 b, struct orl_vec3 normal)
{
    for (size_t i = 0; i < count; i++) {
        const double u = orl_random_uniform(&s->random), v = orl_random_uniform(&s->random);
        land(s, orl_madd(orl_madd(corner, a, u), b, v), normal, 1);
    }
}

/* Writes the photons to a file, opens it as a map and frees the list. */
static struct orl_photon_map *open_shower_map(struct shower *s)
{
    const struct orl_map_build build = {.kind = "global", .emitted = 1, .seed = 1};
    struct orl_photon_map *map = NULL;
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    char path[128];
    struct orl_error err;
    snprintf(path, sizeof path, "%s/map", folder);
    assert_int_equal(orl_photon_map_write(path, s->photons, s->count, &build, pool, &err), 0);
    assert_int_equal(orl_photon_map_open(path, false, &map, &err), 0);
    orl_thread_pool_stop(pool);
    free(s->photons);
    return map;
}

static struct orl_density estimate_density(const struct orl_photon_map *map, struct orl_vec3 point,
                                           struct orl_vec3 normal, uint32_t k, double max_radius)
{
    const struct orl_density_query query = {
        .point = point, .normal = normal, .k = k, .max_radius = max_radius};
    return orl_density_estimate(map, &query, search);
}

static const struct orl_vec3 zero = {0, 0, 0}, x_axis = {1, 0, 0}, y_axis = {0, 1, 0},
                             z_axis = {0, 0, 1}, down = {0, 0, -1};

/* ---- Comparison with brute force ------------------------------------------------------------- */

struct neighbour {
    double distance2, flux;
};

static int compare_neighbours(const void *a, const void *b)
{
    const struct neighbour *x = a, *y = b;
    return (x->distance2 > y->distance2) - (x->distance2 < y->distance2);
}

/* Returns the estimate over all photons of the map, sorted, with places rounded to cells as in the
 * search. */
static struct orl_density brute_force(const struct orl_photon_map *map,
                                      const struct orl_density_query *q, struct neighbour *list)
{
    const struct orl_map_header *h = orl_photon_map_header(map);
    const uint16_t own = orl_normal_encode(q->normal);
    size_t n = 0;
    struct orl_density density = {.radius = q->max_radius};
    for (size_t i = 0; i < h->count; i++) {
        const struct orl_photon p = orl_photon_map_get(map, i);
        const struct orl_vec3 d =
            orl_sub(orl_v3(p.position[0], p.position[1], p.position[2]), q->point);
        const float chord[3] = {(float)(d.x / h->cell), (float)(d.y / h->cell),
                                (float)(d.z / h->cell)};
        if (orl_length(d) < q->max_radius && orl_same_sheet(q->normal, own, p.normal, chord))
            list[n++] = (struct neighbour){orl_dot(d, d), p.flux[0]};
    }
    qsort(list, n, sizeof *list, compare_neighbours);
    density.found = (uint32_t)n;
    if (n >= q->k) {
        density.found = q->k - 1;
        density.radius = sqrt(list[q->k - 1].distance2);
    }
    for (uint32_t i = 0; i < density.found; i++)
        density.irradiance.r += list[i].flux / (ORL_PI * density.radius * density.radius);
    return density;
}

/*
 * A floor and a wall that meet, with a different flux per photon. Radii agree within the rounding
 * of places to floats (2e-7 of 2 m); sums within the effect on the disc's area.
 */
static void test_brute_force(void **state)
{
    static const uint32_t ks[] = {2, 16, 64, 300, 4096};
    struct shower s = shower_new(20000, 1);
    (void)state;
    rain(&s, 10000, zero, orl_scale(x_axis, 2), orl_scale(y_axis, 2), z_axis);
    rain(&s, 6000, zero, orl_scale(x_axis, 2), orl_scale(z_axis, 2), y_axis);
    for (size_t i = 0; i < s.count; i++)
        for (int c = 0; c < 3; c++)
            s.photons[i].flux[c] *= (float)(1 + orl_random_uniform(&s.random));
    struct orl_random random = s.random;
    struct neighbour *list = malloc(s.count * sizeof *list);
    struct orl_photon_map *map = open_shower_map(&s);
    assert_non_null(list);
    for (int i = 0; i < 300; i++) {
        const double u = 2 * orl_random_uniform(&random), v = 2 * orl_random_uniform(&random);
        const bool floor = i % 2 == 0;
        const struct orl_density_query q = {.point = floor ? orl_v3(u, v, 0) : orl_v3(u, 0, v),
                                            .normal = floor ? z_axis : y_axis,
                                            .k = ks[i / 2 % 5],
                                            .max_radius = i % 3 == 0 ? 0.05 : 0.7};
        const struct orl_density is = orl_density_estimate(map, &q, search);
        const struct orl_density should = brute_force(map, &q, list);
        assert_int_equal(is.found, should.found);
        assert_true(fabs(is.radius - should.radius) <= 1e-6);
        assert_true(fabs(is.irradiance.r - should.irradiance.r) <=
                    should.irradiance.r * 4e-6 / should.radius);
    }
    free(list);
    orl_photon_map_free(map);
}

/* ---- Few photons ------------------------------------------------------------------------------
 */

static void test_few_photons(void **state)
{
    const double reach = 0.5, area = ORL_PI * reach * reach;
    (void)state;
    for (size_t n = 0; n <= 3; n++) {
        struct shower s = shower_new(n, 2);
        for (size_t i = 0; i < n; i++)
            land(&s, orl_v3(0.1 * (double)i, 0, 0), z_axis, 1);
        struct orl_photon_map *map = open_shower_map(&s);
        const struct orl_density many = estimate_density(map, zero, z_axis, 64, reach);
        assert_int_equal(many.found, n);
        /* Fluxes are rounded to at most 1/256, places to a cell. */
        assert_true(fabs(many.irradiance.g - (double)n / area) <= (double)n / area / 256);
        for (uint32_t k = 1; k <= 4; k++) {
            const struct orl_density d =
                estimate_density(map, orl_v3(0.01, 0.02, 0), z_axis, k, reach);
            assert_true(orl_rgb_is_finite(d.irradiance));
            assert_true(d.irradiance.r >= 0 && (n == 0) == (d.irradiance.r == 0));
        }
        struct orl_leaf_irradiance *leaf_irradiance =
            orl_leaf_irradiance_new(map, NULL, 64, reach, NULL);
        assert_non_null(leaf_irradiance);
        const struct orl_rgb e =
            orl_leaf_irradiance_estimate(leaf_irradiance, zero, z_axis, NULL, search, NULL, NULL);
        assert_true(orl_rgb_is_finite(e) && e.r >= 0);
        orl_leaf_irradiance_free(leaf_irradiance);
        orl_photon_map_free(map);
    }
}

/* A thousand photons on one spot give the value of a cell-sized disc: finite. */
static void test_coincident_photons(void **state)
{
    struct shower s = shower_new(1000, 3);
    (void)state;
    for (int i = 0; i < 1000; i++)
        land(&s, orl_v3(0.25, 0.5, 1), z_axis, 1);
    struct orl_photon_map *map = open_shower_map(&s);
    const struct orl_density d = estimate_density(map, orl_v3(0.25, 0.5, 1), z_axis, 64, 0.1);
    assert_int_equal(d.found, 63);
    assert_true(orl_rgb_is_finite(d.irradiance) && d.irradiance.r > 0);
    assert_int_equal(estimate_density(map, orl_v3(0.25, 0.5, 1), down, 64, 0.1).found, 0);
    orl_photon_map_free(map);
}

/* ---- Bias -------------------------------------------------------------------------------------
 */

/*
 * 400 discs that do not overlap, on a square of 4e5 photons. Their mean is within 3 standard
 * errors of the true density, and their spread is the theoretical one (chi-square of 399, 4
 * sigma).
 */
static void test_uniform_plane(void **state)
{
    enum { COUNT = 400000, SIDE = 20, QUERIES = SIDE * SIDE, K = 64 };
    struct shower s = shower_new(COUNT, 4);
    double sum = 0, sum2 = 0;
    (void)state;
    rain(&s, COUNT, zero, x_axis, y_axis, z_axis);
    struct orl_photon_map *map = open_shower_map(&s);
    for (int i = 0; i < QUERIES; i++) {
        const struct orl_vec3 at =
            orl_v3((i % SIDE + 0.5) / SIDE, (double)(i / SIDE) / SIDE + 0.025, 0);
        const double e = estimate_density(map, at, z_axis, K, 0.02).irradiance.r / COUNT;
        sum += e;
        sum2 += (e - 1) * (e - 1);
    }
    const double variance = 1.0 / (K - 2);
    assert_true(fabs(sum / QUERIES - 1) < 3 * sqrt(variance / QUERIES));
    assert_true(fabs(sum2 / QUERIES / variance - 1) < 4 * sqrt(2.0 / QUERIES) + 4.0 / K);
    orl_photon_map_free(map);
}

/*
 * On a sphere a chord c cuts off a cap of area pi c^2, exactly: the plane's estimate holds. 1000
 * queries of k = 128: standard error 0.28 %, so 1 % is more than 3 sigma.
 */
static void test_sphere(void **state)
{
    enum { COUNT = 400000, QUERIES = 1000, K = 128 };
    struct shower s = shower_new(COUNT, 5);
    double sum = 0;
    (void)state;
    for (int i = 0; i < COUNT; i++) {
        const double z = 2 * orl_random_uniform(&s.random) - 1, r = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * orl_random_uniform(&s.random);
        const struct orl_vec3 n = orl_v3(r * cos(phi), r * sin(phi), z);
        land(&s, orl_scale(n, 2), orl_neg(n), 1);
    }
    struct orl_random random = s.random;
    struct orl_photon_map *map = open_shower_map(&s);
    for (int i = 0; i < QUERIES; i++) {
        const double z = 2 * orl_random_uniform(&random) - 1, r = sqrt(1 - z * z);
        const double phi = 2 * ORL_PI * orl_random_uniform(&random);
        const struct orl_vec3 n = orl_v3(r * cos(phi), r * sin(phi), z);
        sum += estimate_density(map, orl_scale(n, 2), orl_neg(n), K, 0.5).irradiance.r;
    }
    const double expected = COUNT / (16 * ORL_PI);
    assert_true(fabs(sum / QUERIES / expected - 1) < 0.01);
    orl_photon_map_free(map);
}

/* ---- Other surfaces ---------------------------------------------------------------------------
 */

/* Light is on one sheet and the query on another: the estimate finds nothing within 14 cm. */
static void check_no_leak(struct orl_vec3 corner, struct orl_vec3 a, struct orl_vec3 b,
                          struct orl_vec3 lit, struct orl_vec3 point, struct orl_vec3 normal)
{
    struct shower s = shower_new(100000, 6);
    rain(&s, 100000, corner, a, b, lit);
    struct orl_photon_map *map = open_shower_map(&s);
    const struct orl_density d = estimate_density(map, point, normal, 64, 0.14);
    assert_int_equal(d.found, 0);
    assert_true(d.irradiance.r == 0);
    struct orl_leaf_irradiance *leaf_irradiance =
        orl_leaf_irradiance_new(map, NULL, 64, 0.14, NULL);
    assert_non_null(leaf_irradiance);
    assert_true(
        orl_leaf_irradiance_estimate(leaf_irradiance, point, normal, NULL, search, NULL, NULL).r ==
        0);
    orl_leaf_irradiance_free(leaf_irradiance);
    orl_photon_map_free(map);
}

/* A wall 1 mm thick, lit on the other side. */
static void test_through_a_wall(void **state)
{
    (void)state;
    check_no_leak(zero, x_axis, y_axis, z_axis, orl_v3(0.5, 0.5, -0.001), down);
}

/* Under a table top 5 mm above the floor, and above it. */
static void test_parallel_sheets(void **state)
{
    (void)state;
    check_no_leak(zero, x_axis, y_axis, z_axis, orl_v3(0.5, 0.5, -0.005), z_axis);
    check_no_leak(zero, x_axis, y_axis, z_axis, orl_v3(0.5, 0.5, 0.005), z_axis);
    /* Tilted, so that normals are not exactly representable codes. */
    const double c = cos(0.3), t = sin(0.3);
    const struct orl_vec3 n = orl_v3(0, -t, c), along = orl_v3(0, c, t);
    const struct orl_vec3 middle = orl_madd(orl_scale(x_axis, 0.5), along, 0.5);
    check_no_leak(zero, x_axis, along, n, orl_madd(middle, n, 0.005), n);
    check_no_leak(zero, x_axis, along, n, orl_madd(middle, n, -0.005), n);
}

/* A lit floor that meets a dark wall, and the other way round. */
static void test_around_a_corner(void **state)
{
    (void)state;
    check_no_leak(zero, x_axis, y_axis, z_axis, orl_v3(0.5, 0, 0.001), y_axis);
    check_no_leak(zero, x_axis, z_axis, y_axis, orl_v3(0.5, 0.001, 0), z_axis);
}

/* ---- Leaves -----------------------------------------------------------------------------------
 */

/*
 * Leaf values are estimates with k = 64 at their photons. The 12500 leaves' discs overlap
 * four-fold (64 photons to 16), so the variance of their mean is 4 / 12500 * 1/62: 3 sigma are
 * 0.68 %. A leaf's middle is not a random place; the tolerance includes 0.5 % for that.
 */
static void test_leaves_agree(void **state)
{
    enum { COUNT = 200000, QUERIES = 40000 };
    struct shower s = shower_new(COUNT, 7);
    double sum = 0, plain = 0;
    (void)state;
    rain(&s, COUNT, zero, x_axis, y_axis, z_axis);
    struct orl_random random = s.random;
    struct orl_photon_map *map = open_shower_map(&s);
    struct orl_leaf_irradiance *leaf_irradiance = orl_leaf_irradiance_new(map, NULL, 64, 0.1, NULL);
    assert_non_null(leaf_irradiance);
    for (int i = 0; i < QUERIES; i++) {
        const double u = 0.05 + 0.9 * orl_random_uniform(&random);
        const struct orl_vec3 at = orl_v3(u, 0.05 + 0.9 * orl_random_uniform(&random), 0);
        sum +=
            orl_leaf_irradiance_estimate(leaf_irradiance, at, z_axis, NULL, search, NULL, NULL).r /
            COUNT / QUERIES;
        plain += estimate_density(map, at, z_axis, 64, 0.1).irradiance.r / COUNT / QUERIES;
    }
    print_message("leaves %.4f, plain estimates %.4f\n", sum, plain);
    assert_true(fabs(plain - 1) < 0.0068);
    assert_true(fabs(sum - 1) < 0.0068 + 0.005);
    assert_true(orl_leaf_irradiance_estimate(leaf_irradiance, orl_v3(0.5, 0.5, 0), down, NULL,
                                             search, NULL, NULL)
                    .r == 0);
    orl_leaf_irradiance_free(leaf_irradiance);
    orl_photon_map_free(map);
}

struct looking {
    struct orl_leaf_irradiance *leaf_irradiance;
    struct orl_search *searches;
    struct orl_rgb *values;
    size_t count, step;
};

/*
 * Small separate facets in one plane, with a few photons each: a leaf of sixteen lies on several.
 * The mean of leaf values over all facets, at equally many points of each, is the photons' flux
 * over their area. Each estimate includes a facet as a whole, so the only random part is which
 * leaves serve a point at their rims.
 */
static void test_leaves_on_small_facets(void **state)
{
    enum { SIDE = 40, FACETS = SIDE * SIDE, EACH = 4, POINTS = 4 };
    const double size = 0.05, area = FACETS * size * size;
    struct shower s = shower_new(FACETS * EACH, 11);
    struct text scene;
    double mean = 0;
    (void)state;
    text_open(&scene);
    fputs("void plastic w 0 0 5 .5 .5 .5 0 0\n", scene.stream);
    for (int i = 0; i < FACETS; i++) {
        const double x = 0.1 * (i % SIDE), y = 0.1 * (i / SIDE);
        fprintf(scene.stream, "w polygon f%d 0 0 12 %g %g 0 %g %g 0 %g %g 0 %g %g 0\n", i, x, y,
                x + size, y, x + size, y + size, x, y + size);
    }
    text_close(&scene);
    struct orl_lit_scene *lit_scene = build_lit_scene(scene.data, NULL, NULL, NULL);
    free(scene.data);
    const struct orl_geometry *g = lit_scene->geometry;
    for (int n = 0; n < FACETS * EACH; n++) {
        const uint32_t facet = (uint32_t)(FACETS * orl_random_uniform(&s.random));
        const double u[2] = {orl_random_uniform(&s.random), orl_random_uniform(&s.random)};
        struct orl_vec3 point, normal;
        orl_facet_sample(g, facet, u, &point, &normal);
        land(&s, point, normal, 1);
    }
    struct orl_random random = s.random;
    struct orl_photon_map *map = open_shower_map(&s);
    struct orl_leaf_irradiance *leaf_irradiance =
        orl_leaf_irradiance_new(map, lit_scene, 64, 1, NULL);
    assert_non_null(leaf_irradiance);
    for (uint32_t i = 0; i < FACETS * POINTS; i++) {
        const double u[2] = {orl_random_uniform(&random), orl_random_uniform(&random)};
        struct orl_surface_point surface_point = {.lit_scene = lit_scene, .facet = i / POINTS};
        orl_facet_sample(g, surface_point.facet, u, &surface_point.point, &surface_point.normal);
        mean +=
            orl_leaf_irradiance_estimate(leaf_irradiance, surface_point.point, surface_point.normal,
                                         &surface_point, search, NULL, NULL)
                .r /
            (FACETS * POINTS);
    }
    if (!(fabs(mean * area / (FACETS * EACH) - 1) < 0.01))
        fail_msg("%g of the light", mean * area / (FACETS * EACH));
    orl_leaf_irradiance_free(leaf_irradiance);
    orl_photon_map_free(map);
    orl_lit_scene_free(lit_scene);
}

static void look_up_leaf(void *arg, size_t index, uint32_t member)
{
    struct looking *l = arg;
    const size_t i = index * l->step % l->count;
    struct orl_random random = orl_random_stream(8, ORL_PURPOSE_BENCH, i);
    const double u = orl_random_uniform(&random), v = orl_random_uniform(&random);
    l->values[i] = orl_leaf_irradiance_estimate(l->leaf_irradiance, orl_v3(u, v, 0), z_axis, NULL,
                                                &l->searches[member], NULL, NULL);
}

/* Results are equal to the bit in another order of queries, and with several threads at once. */
static void test_leaves_in_any_order(void **state)
{
    enum { COUNT = 50000, QUERIES = 10007 };
    static const struct {
        uint32_t threads;
        size_t step;
    } ways[3] = {{1, 1}, {1, 4231}, {4, 77}};
    struct shower s = shower_new(COUNT, 9);
    struct orl_rgb *first = NULL;
    (void)state;
    rain(&s, COUNT, zero, x_axis, y_axis, z_axis);
    struct orl_photon_map *map = open_shower_map(&s);
    for (int w = 0; w < 3; w++) {
        struct orl_thread_pool *pool = orl_thread_pool_start(ways[w].threads);
        struct looking l = {orl_leaf_irradiance_new(map, NULL, 64, 0.1, NULL),
                            calloc(ways[w].threads, sizeof *l.searches),
                            malloc(QUERIES * sizeof *l.values), QUERIES, ways[w].step};
        assert_true(l.leaf_irradiance && l.searches && l.values && pool);
        orl_parallel_for(pool, QUERIES, look_up_leaf, &l);
        orl_thread_pool_stop(pool);
        orl_leaf_irradiance_free(l.leaf_irradiance);
        free(l.searches);
        if (first)
            assert_memory_equal(l.values, first, QUERIES * sizeof *first);
        else
            first = l.values;
        if (l.values != first)
            free(l.values);
    }
    free(first);
    orl_photon_map_free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brute_force),
        cmocka_unit_test(test_few_photons),
        cmocka_unit_test(test_coincident_photons),
        cmocka_unit_test(test_uniform_plane),
        cmocka_unit_test(test_sphere),
        cmocka_unit_test(test_through_a_wall),
        cmocka_unit_test(test_parallel_sheets),
        cmocka_unit_test(test_around_a_corner),
        cmocka_unit_test(test_leaves_agree),
        cmocka_unit_test(test_leaves_on_small_facets),
        cmocka_unit_test(test_leaves_in_any_order),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
