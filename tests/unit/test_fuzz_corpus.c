/*
 * Runs the fuzz corpus. Every committed input, including those that once failed, goes through its
 * target, which aborts if a promise is broken. Each target must accept some input and refuse some,
 * so that a change of format cannot make the corpus useless unnoticed.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/fuzz.h"
#include "support/scene_text.h"

typedef bool (*fuzz_target)(const uint8_t *data, size_t size);

/* Runs one file, copied to a block of its exact size so that AddressSanitizer detects reads beyond
 * its end. */
static bool repeat(fuzz_target target, const char *folder, const char *name)
{
    char path[512];
    size_t size;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    unsigned char *bytes = scene_read_bytes(path, &size);
    uint8_t *exact = malloc(size ? size : 1);
    assert_non_null(exact);
    for (size_t i = 0; i < size; i++)
        exact[i] = bytes[i];
    free(bytes);
    /* Printed before the call, because nothing is printed after an abort. */
    fprintf(stderr, "# %s\n", path);
    const bool accepted = target(exact, size);
    free(exact);
    return accepted;
}

static void repeat_all(const char *folder, fuzz_target target)
{
    size_t accepted = 0, refused = 0;
    DIR *entries = opendir(folder);
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        if (entry->d_name[0] == '.')
            continue;
        if (repeat(target, folder, entry->d_name))
            accepted++;
        else
            refused++;
    }
    closedir(entries);
    assert_true(accepted > 0);
    assert_true(refused > 0);
}

/* Runs empty input, and a short run of every byte value, which the corpus need not store. */
static void repeat_trifles(fuzz_target target)
{
    target((const uint8_t *)"", 0);
    for (int value = 0; value < 256; value++) {
        uint8_t bytes[8];
        for (size_t i = 0; i < sizeof bytes; i++)
            bytes[i] = (uint8_t)value;
        target(bytes, 1);
        target(bytes, sizeof bytes);
    }
}

static void test_scene(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/scene", fuzz_scene);
    repeat_trifles(fuzz_scene);
}

static void test_bsdf(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/bsdf", fuzz_bsdf);
    repeat_trifles(fuzz_bsdf);
}

static void test_job(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/job", fuzz_job);
    repeat_trifles(fuzz_job);
}

static void test_map(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/map", fuzz_map);
    repeat_trifles(fuzz_map);
}

static void test_grid(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/grid", fuzz_grid);
    repeat_trifles(fuzz_grid);
}

static void test_hdr(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/hdr", fuzz_hdr);
    repeat_trifles(fuzz_hdr);
}

static void test_function(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/function", fuzz_function);
    repeat_trifles(fuzz_function);
}

static void test_scanner(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/scanner", fuzz_scanner);
    repeat_trifles(fuzz_scanner);
}

static void test_sensors(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/sensors", fuzz_sensors);
    repeat_trifles(fuzz_sensors);
}

static void test_view_file(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/view_file", fuzz_view_file);
    repeat_trifles(fuzz_view_file);
}

static void test_weather(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/weather", fuzz_weather);
    repeat_trifles(fuzz_weather);
}

static void test_bsdf_make(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/bsdf_make", fuzz_bsdf_make);
    repeat_trifles(fuzz_bsdf_make);
}

static void test_annual(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/annual", fuzz_annual);
    repeat_trifles(fuzz_annual);
}

static void test_occupancy(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/occupancy", fuzz_occupancy);
    repeat_trifles(fuzz_occupancy);
}

static void test_schedule(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/schedule", fuzz_schedule);
    repeat_trifles(fuzz_schedule);
}

static void test_mgf(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/mgf", fuzz_mgf);
    repeat_trifles(fuzz_mgf);
}

static void test_matrix(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/measured", fuzz_measured);
    repeat_trifles(fuzz_measured);
    repeat_all("tests/fuzz/corpus/matrix", fuzz_matrix);
    repeat_trifles(fuzz_matrix);
}

static void test_rif(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/rif", fuzz_rif);
    repeat_trifles(fuzz_rif);
    repeat_all("tests/fuzz/corpus/frads", fuzz_frads);
    repeat_trifles(fuzz_frads);
}

static void test_zip(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/zip", fuzz_zip);
    repeat_trifles(fuzz_zip);
}

static void test_hbjson(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/hbjson", fuzz_hbjson);
    repeat_trifles(fuzz_hbjson);
}

static void test_gltf(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/gltf", fuzz_gltf);
    repeat_trifles(fuzz_gltf);
}

static void test_mesh(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/mesh", fuzz_mesh);
    repeat_trifles(fuzz_mesh);
}

static void test_compiled(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/compiled", fuzz_compiled);
    repeat_trifles(fuzz_compiled);
}

static void test_framing(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/framing", fuzz_framing);
    repeat_trifles(fuzz_framing);
}

static void test_multipart(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/multipart", fuzz_multipart);
    repeat_trifles(fuzz_multipart);
}

static void test_range(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/range", fuzz_range);
    repeat_trifles(fuzz_range);
}

static void test_route(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/route", fuzz_route);
    repeat_trifles(fuzz_route);
}

static void test_origin_policy(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/origin_policy", fuzz_origin_policy);
    repeat_trifles(fuzz_origin_policy);
}

static void test_token(void **state)
{
    (void)state;
    repeat_all("tests/fuzz/corpus/token", fuzz_token);
    repeat_trifles(fuzz_token);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scene),     cmocka_unit_test(test_bsdf),
        cmocka_unit_test(test_job),       cmocka_unit_test(test_map),
        cmocka_unit_test(test_grid),      cmocka_unit_test(test_hdr),
        cmocka_unit_test(test_scanner),   cmocka_unit_test(test_sensors),
        cmocka_unit_test(test_function),  cmocka_unit_test(test_weather),
        cmocka_unit_test(test_zip),       cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_compiled),  cmocka_unit_test(test_framing),
        cmocka_unit_test(test_multipart), cmocka_unit_test(test_range),
        cmocka_unit_test(test_route),     cmocka_unit_test(test_origin_policy),
        cmocka_unit_test(test_token),     cmocka_unit_test(test_view_file),
        cmocka_unit_test(test_annual),    cmocka_unit_test(test_bsdf_make),
        cmocka_unit_test(test_occupancy), cmocka_unit_test(test_hbjson),
        cmocka_unit_test(test_schedule),  cmocka_unit_test(test_mgf),
        cmocka_unit_test(test_matrix),    cmocka_unit_test(test_rif),
        cmocka_unit_test(test_gltf),
    };
    if (sodium_init() < 0)
        return 1;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
