/*
 * What a scene of many polygons keeps in memory: bytes a polygon, resident, against bounds, and
 * against what the scene itself says of it, by which shelves count.
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

#include "light/scene.h"
#include "process/sanitized.h"
#include "support/polygons.h"
#include "support/scene_text.h"

enum { POLYGONS = 100000, FEW = 1000 };

struct bytes {
    double resident, said; /* a polygon */
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
    struct orl_description description = scene_parse_text(text, NULL, NULL);
    assert_int_equal(orl_scene_new(&description, &scene, &err), 0);
    return scene;
}

static struct bytes bytes_here(bool apart)
{
    char *const text = whole_text(POLYGONS, apart), *const few = whole_text(FEW, apart);
    /* What Embree and its library of tasks keep for themselves. */
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

/* In a process that has held no other scene. */
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

/* The bounds are what was measured, and a twentieth. */
static void test_bytes(void **state)
{
    static const double most[2] = {265, 362};
    (void)state;
    for (int apart = 0; apart < 2; apart++) {
        const struct bytes bytes = bytes_of(apart != 0);
        print_message("corners %s: %.1f bytes a polygon resident, %.1f said\n",
                      apart ? "apart" : "shared", bytes.resident, bytes.said);
        if (ORL_SANITIZED)
            continue; /* which keeps more beside it */
        assert_true(bytes.resident < most[apart]);
        assert_true(bytes.said > 0.95 * bytes.resident);
        assert_true(bytes.said < 1.1 * bytes.resident);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bytes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
