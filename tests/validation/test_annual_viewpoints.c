/*
 * Views of glare viewpoints in which light has many paths: between half-mirrors, through panes in
 * series, and in scenes of many surfaces. Pixels are unbiased; rays, terms, spots and positions are
 * bounded; cancelling takes effect at once.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "annual/coefficients/trace_sensor.h"
#include "annual/panes/bsdf_panes.h"
#include "annual/viewpoints/viewpoints.h"
#include "support/scene_text.h"

enum { PANES = 20, RAYS = 4 };

static char viewpoint_name[] = "desk";
static const struct orl_viewpoint viewpoint = {viewpoint_name, {0, -1, 0}, {0, 1, 0}};

/* Writes half-mirrors one behind the other, which absorb nothing: only the sky is visible. */
static char *write_panes(void)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    assert_non_null(f);
    fputs("void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
          "void trans half 0 0 7 1 1 1 .5 0 1 1\n",
          f);
    for (int i = 0; i < PANES; i++)
        fprintf(f,
                "half polygon pane%d 0 0 12 -1000 %d -1000 1000 %d -1000 1000 %d 1000 -1000 %d "
                "1000\n",
                i, i, i, i, i);
    fclose(f);
    return text;
}

struct viewed {
    struct orl_bins bins;
    struct orl_lit_scene *lit_scene;
    struct orl_viewpoint_image view;
    int code;
};

static void view_scene(const char *text, struct orl_thread_pool *pool, struct viewed *v)
{
    struct orl_error err = {0};
    memset(v, 0, sizeof *v);
    orl_bins_init(&v->bins);
    v->lit_scene = build_lit_scene(text, NULL, NULL, NULL);
    const struct orl_annual_scene scene = {
        .lit_scene = v->lit_scene, .bins = &v->bins, .north = orl_sky_rotation_by_north(0)};
    v->code = orl_viewpoint_image_init(&v->view, &scene, &viewpoint, 7, pool, &err);
}

static void viewed_done(struct viewed *v)
{
    orl_viewpoint_image_done(&v->view);
    orl_lit_scene_free(v->lit_scene);
}

/* Computes the mean, and its standard error, of the pixels' weights of the sky. */
static void find_mean(const struct orl_viewpoint_image *view, double *ret_mean, double *ret_se)
{
    double n = 0, sum = 0, squares = 0;
    for (size_t i = 0; i < ORL_VIEWPOINT_PIXELS; i++) {
        double pixel = 0;
        if (!(view->field.solid_angle[i] > 0))
            continue;
        for (uint32_t k = view->first[i]; k < view->first[i + 1]; k++)
            pixel += view->terms[k].which < ORL_BINS ? (double)view->terms[k].weight : 0;
        sum += pixel;
        squares += pixel * pixel;
        n++;
    }
    *ret_mean = sum / n;
    *ret_se = sqrt(fmax(squares / n - *ret_mean * *ret_mean, 0) / n);
}

/* Each path carries its share of a sky of radiance 1 all around, so a pixel is 1 on average. */
static void test_half_mirrors(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    char *text = write_panes();
    struct viewed v;
    double mean, se;
    (void)state;
    view_scene(text, pool, &v);
    assert_int_equal(v.code, 0);
    find_mean(&v.view, &mean, &se);
    print_message("mean %.5f +- %.5f, %.1f steps a ray\n", mean, se,
                  (double)v.view.n_steps / RAYS / ORL_VIEWPOINT_PIXELS);
    assert_true(fabs(mean - 1) <= 4 * se + 1e-5);
    assert_true(v.view.n_steps < (uint64_t)RAYS * ORL_VIEWPOINT_PIXELS * 8 * PANES);
    for (size_t i = 0; i < ORL_VIEWPOINT_PIXELS; i++)
        assert_true(v.view.first[i + 1] - v.view.first[i] <= ORL_VIEWPOINT_PIXEL_TERMS);
    viewed_done(&v);
    free(text);
    orl_thread_pool_stop(pool);
}

/* A cancel flag is seen before the next pixel is traced. */
static void test_cancelled(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    const atomic_bool cancel = true;
    char *text = write_panes();
    struct viewed v;
    (void)state;
    orl_thread_pool_set_cancel(pool, &cancel);
    view_scene(text, pool, &v);
    assert_int_equal(v.code, ORL_ERR_CANCELLED);
    assert_int_equal(v.view.n_steps, 0);
    viewed_done(&v);
    free(text);
    orl_thread_pool_stop(pool);
}

/* With the flag set, no more paths of a year's sensors are traced. */
static void test_cancelled_paths(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    const atomic_bool cancel = true;
    const struct orl_annual_batch batch = {.seed = 1, .samples = 64, .pool = pool};
    struct orl_path_sums sums = {.bins = NULL};
    const struct orl_annual_scene scene = {.lit_scene = NULL};
    const struct orl_shading_point place = {.normal = {0, 0, 1}};
    struct orl_health health = {0};
    (void)state;
    orl_thread_pool_set_cancel(pool, &cancel);
    orl_annual_trace(&scene, &place, &batch, &sums, &health);
    assert_int_equal(health.paths, 0);
    orl_thread_pool_stop(pool);
}

/* With the flag set, no BSDF pane is read. */
static void test_cancelled_panes(void **state)
{
    struct orl_thread_pool *pool = orl_thread_pool_start(1);
    const atomic_bool cancel = true;
    const struct orl_bsdf_panes bsdf_panes = {.count =
                                                  1}; /* there is no pane: reading it would fail */
    const struct orl_shading_point place = {.normal = {0, 0, 1}};
    unsigned char lit = 0;
    const struct orl_sensor_sunlight sunlight = {.lit = &lit};
    (void)state;
    orl_thread_pool_set_cancel(pool, &cancel);
    orl_bsdf_panes_add(&bsdf_panes, &place, 1, pool, &sunlight);
    assert_int_equal(lit, 0);
    orl_thread_pool_stop(pool);
}

/* Thinning keeps the sum exactly, and each weight on average. */
static void test_thinned_terms(void **state)
{
    enum { ALL = 200, MOST = 16, TRIES = 4000 };
    double sums[ALL] = {0};
    struct orl_pixel_terms terms = {.count = 0};
    (void)state;
    for (uint32_t t = 0; t < TRIES; t++) {
        struct orl_random random = orl_random_stream(t, ORL_PURPOSE_ANNUAL, 0);
        double all = 0;
        orl_pixel_terms_clear(&terms);
        for (uint32_t i = 0; i < ALL; i++)
            assert_int_equal(orl_pixel_terms_add(&terms, 7 * i, i == 3 ? 50 : 1 + i % 5), 0);
        assert_int_equal(orl_pixel_terms_thin(&terms, MOST, &random), 0);
        assert_true(terms.count <= MOST + 1);
        for (size_t k = 0; k < terms.count; k++) {
            all += (double)terms.at[k].weight;
            sums[terms.at[k].which / 7] += (double)terms.at[k].weight;
        }
        assert_true(fabs(all - (50 + 200 * 3 - 4)) < 0.01 * all);
    }
    for (uint32_t i = 0; i < ALL; i++) {
        const double weight = i == 3 ? 50 : 1 + i % 5, threshold = 596.0 / (MOST - 1);
        assert_true(fabs(sums[i] / TRIES - weight) <= 5 * sqrt(weight * threshold / TRIES));
    }
    orl_pixel_terms_done(&terms);
}

/* Adding n different terms, and the n terms again, touches each once: there is no search among
 * existing terms. */
static void test_many_terms(void **state)
{
    enum { MANY = 1 << 20 };
    struct orl_pixel_terms terms = {.count = 0};
    (void)state;
    for (uint32_t i = 0; i < 2 * MANY; i++)
        assert_int_equal(orl_pixel_terms_add(&terms, i % MANY, 0.5), 0);
    assert_int_equal(terms.count, MANY);
    for (uint32_t i = 0; i < MANY; i += 1000)
        assert_true(terms.at[i].weight == 1);
    orl_pixel_terms_done(&terms);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_half_mirrors),    cmocka_unit_test(test_cancelled),
        cmocka_unit_test(test_cancelled_paths), cmocka_unit_test(test_cancelled_panes),
        cmocka_unit_test(test_thinned_terms),   cmocka_unit_test(test_many_terms)};
    return cmocka_run_group_tests_name("annual_seats", tests, NULL, NULL);
}
