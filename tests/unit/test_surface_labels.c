/*
 * Labels of surfaces in built geometry: their names, files and lines; and the outlines of
 * polygons, corner by corner, from stored geometry.
 */
#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/sampling/sampling.h"
#include "scene/surfaces.h"
#include "support/scene_text.h"

static double uniform(struct orl_random *random)
{
    return orl_random_uniform(random);
}

/* Line numbers that rise, fall and jump; empty and long names; alternating files. */
static void test_surface_labels(void **state)
{
    enum { N = 1000, LONGEST = 300 };
    static char names[N][LONGEST + 1];
    static struct orl_surface surfaces[N];
    static const char *const files[3] = {"a.rad", "b.rad", "c.rad"};
    static const int lines[4] = {0, 1, INT_MAX, 127};
    struct orl_random random = orl_random_stream(7, ORL_PURPOSE_PILOT, 0);
    (void)state;
    for (int i = 0; i < N; i++) {
        const size_t length = i % 10 == 9 ? LONGEST : (size_t)(uniform(&random) * 8);
        memset(names[i], 'a' + i % 26, length);
        surfaces[i] = (struct orl_surface){.name = names[i],
                                           .line = i % 7 == 6 ? lines[i / 7 % 4]
                                                              : (int)(uniform(&random) * 1e6),
                                           .file = files[(int)(uniform(&random) * 3)]};
    }
    for (size_t n = 0; n <= N; n += n < 40 ? 1 : 160) {
        struct orl_surface_labels *const labels = orl_surface_labels_new(surfaces, n);
        assert_non_null(labels);
        for (size_t i = 0; i < n; i++) {
            const struct orl_surface_label label = orl_surface_label_of(labels, i);
            assert_string_equal(label.name, surfaces[i].name);
            assert_ptr_equal(label.file, surfaces[i].file);
            assert_int_equal(label.line, surfaces[i].line);
        }
        orl_surface_labels_free(labels);
    }
}

/* Writes a closed polygon about the origin of a tilted plane: a star, a convex one, or a scribble.
 */
static void write_polygon(FILE *f, int number, struct orl_random *random)
{
    const int n = 3 + (int)(uniform(random) * 6), sort = number % 3;
    fprintf(f, "m polygon p%d 0 0 %d", number, 3 * n);
    for (int i = 0; i < n; i++) {
        const double phi = sort == 2 ? 7 * uniform(random) : 2 * ORL_PI * i / n;
        const double r = sort == 0 ? 1 : 0.3 + uniform(random);
        const double x = r * cos(phi) + 3 * number, y = r * sin(phi);
        fprintf(f, " %.17g %.17g %.17g", x, y, 0.3 * x - 0.7 * y);
    }
    fprintf(f, "\n");
}

/* Packed corners agree to a step, 1/256 of a float's last bit, or 2^-31 of its size. */
static void expect_corner(const struct orl_geometry *geometry, struct orl_vec3 is,
                          struct orl_vec3 was)
{
    if (geometry->corners)
        assert_memory_equal(&is, &was, sizeof is);
    assert_true(fabs(is.x - was.x) <= 0x1p-31 * fabs(was.x) &&
                fabs(is.y - was.y) <= 0x1p-31 * fabs(was.y) &&
                fabs(is.z - was.z) <= 0x1p-31 * fabs(was.z));
}

/* Checks outlines against the files, relative to the scene's middle; for few polygons to the last
 * bit. Returns the number of listed outlines. */
static size_t check_outlines(int n)
{
    struct orl_random random = orl_random_stream(8, ORL_PURPOSE_PILOT, 0);
    struct orl_geometry *geometry = NULL;
    struct orl_error err = {0};
    char *text = NULL;
    size_t size = 0, own = 0;
    FILE *const f = open_memstream(&text, &size);
    assert_non_null(f);
    fprintf(f, "void plastic m 0 0 5 .5 .5 .5 0 0\n");
    for (int i = 0; i < n; i++)
        write_polygon(f, i, &random);
    assert_int_equal(fclose(f), 0);
    struct orl_parsed_scene d = scene_parse_text(text, NULL, NULL);
    assert_int_equal(orl_geometry_new(&d, &geometry, &err), 0);
    assert_int_equal(d.n_surfaces, n);
    for (uint32_t i = 0; i < d.n_surfaces; i++) {
        const struct orl_facet_outline outline = orl_outline_of_facet(geometry, i);
        const struct orl_surface *const surface = &d.surfaces[i];
        assert_int_equal(outline.n, surface->n_vertices);
        own += outline.own != NULL;
        for (uint32_t k = 0; k < outline.n; k++) {
            const struct orl_vec3 is = orl_outline_corner(&outline, k);
            const struct orl_vec3 was = orl_sub(surface->vertices[k], geometry->center);
            expect_corner(geometry, is, was);
        }
    }
    orl_geometry_free(geometry);
    orl_parsed_scene_done(&d);
    free(text);
    return own;
}

/* For few polygons outlines are listed; for many they are derived from triangles, where possible.
 */
static void test_outlines(void **state)
{
    enum { FEW = 600, MANY = 30000 };
    (void)state;
    assert_int_equal(check_outlines(FEW), FEW);
    const size_t own = check_outlines(MANY);
    assert_true(own > MANY / 2 && own < MANY - MANY / 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_surface_labels),
                                       cmocka_unit_test(test_outlines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
