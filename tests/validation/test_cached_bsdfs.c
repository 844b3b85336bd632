/*
 * BSDFs in the store: a large one is parsed once and reused by later jobs; results do not depend on
 * it, and damaged files are rebuilt.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"
#include "support/cli.h"
#include "support/room.h"

#define SCENE ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE

enum { LARGE = 1 << 20 };

/*
 * Returns the XML of a tree, padded with white space to the minimum size of stored BSDFs if large.
 */
static char *make_xml(bool large)
{
    struct text t = make_tree_file(3);
    const size_t size = large ? t.size + LARGE : t.size;
    char *xml = realloc(t.data, size + 1);
    assert_non_null(xml);
    memset(xml + t.size, '\n', size - t.size);
    xml[size] = '\0';
    return xml;
}

static struct orl_result run_in(const char *folder, const char *xml)
{
    const struct scene_run run = {.scene = SCENE,
                                  .resource_name = "pane.xml",
                                  .resource_text = xml,
                                  .sensors = room_sensors,
                                  .n_sensors = ROOM_SENSORS,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .samples = 64,
                                  .folder = folder};
    return scene_run(&run);
}

/* Finds the path of the only stored BSDF; returns false if there is none. */
static bool find_kept(const char *folder, char ret_path[512])
{
    DIR *entries = opendir(folder);
    bool found = false;
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        if (strncmp(entry->d_name, "bsdf-", 5) != 0)
            continue;
        assert_false(found);
        snprintf(ret_path, 512, "%s/%s", folder, entry->d_name);
        assert_null(strstr(entry->d_name, ".part"));
        found = true;
    }
    closedir(entries);
    return found;
}

static bool warns_of(const struct orl_result *result, const char *text)
{
    for (size_t i = 0; i < result->n_warnings; i++)
        if (strstr(result->warnings[i], text))
            return true;
    return false;
}

/* Runs again and expects equal numbers, with the warning or without. */
static void check_again(const char *folder, const char *xml, const struct orl_result *first,
                        bool warns)
{
    struct orl_result again = run_in(folder, xml);
    for (size_t i = 0; i < ROOM_SENSORS; i++)
        assert_true(again.illuminance_lx[i] == first->illuminance_lx[i]);
    assert_int_equal(again.health.bsdf_values, first->health.bsdf_values);
    assert_int_equal(warns_of(&again, "is read again"), warns);
    orl_result_done(&again);
}

static void spoil(const char *path, long at, size_t cache_key)
{
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    fseek(f, at, SEEK_SET);
    const int c = fgetc(f);
    fseek(f, at, SEEK_SET);
    fputc(c ^ 4, f);
    fclose(f);
    if (cache_key > 0)
        assert_int_equal(truncate(path, (off_t)cache_key), 0);
}

static void test_large(void **state)
{
    char folder[64], path[512];
    char *xml = make_xml(true);
    size_t size, size_again;
    (void)state;
    cli_make_folder(folder);
    struct orl_result first = run_in(folder, xml);
    assert_true(first.illuminance_lx[0] > 0);
    assert_true(find_kept(folder, path));
    free(scene_read_bytes(path, &size));
    check_again(folder, xml, &first, false);
    /* A flipped bit, a truncated file, and one of an earlier version: each is rebuilt. */
    const long places[] = {(long)size - 100, 5000, 8};
    for (size_t i = 0; i < 3; i++) {
        spoil(path, places[i], i == 1 ? size / 2 : 0);
        check_again(folder, xml, &first, true);
        assert_true(find_kept(folder, path));
        free(scene_read_bytes(path, &size_again));
        assert_int_equal(size, size_again);
        check_again(folder, xml, &first, false);
    }
    orl_result_done(&first);
    cli_remove_folder(folder);
    free(xml);
}

/* A small BSDF is not stored, since parsing is as fast as a look-up. */
static void test_small(void **state)
{
    char folder[64], path[512];
    char *xml = make_xml(false);
    (void)state;
    cli_make_folder(folder);
    struct orl_result first = run_in(folder, xml);
    assert_false(find_kept(folder, path));
    orl_result_done(&first);
    cli_remove_folder(folder);
    free(xml);
}

/* A bad file is refused as before, and nothing is stored. */
static void test_bad(void **state)
{
    char folder[64], path[512];
    char *xml = make_xml(true);
    struct orl_error err = {0};
    (void)state;
    *strstr(xml, "{ 0.") = '}';
    cli_make_folder(folder);
    const struct scene_run run = {.scene = SCENE,
                                  .resource_name = "pane.xml",
                                  .resource_text = xml,
                                  .sensors = room_sensors,
                                  .n_sensors = ROOM_SENSORS,
                                  .folder = folder};
    assert_int_equal(scene_run_fails(&run, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "pane.xml");
    assert_true(err.line > 10);
    assert_false(find_kept(folder, path));
    cli_remove_folder(folder);
    free(xml);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_small),
        cmocka_unit_test(test_bad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
