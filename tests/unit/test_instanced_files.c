/*
 * Files that a scene stores once for all their places (parse/instance/instanced_files.h), and the
 * cases in which each place gets its own surfaces.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/built/scene.h"
#include "scene/surfaces.h"
#include "support/grove.h"

static struct orl_scene *scene_of(const struct grove *grove, const char *text)
{
    struct orl_parsed_scene d = grove_read(grove, text);
    struct orl_scene *scene = NULL;
    struct orl_error err = {0};
    if (orl_scene_new(&d, &scene, &err) < 0)
        fail_msg("%s", err.message);
    return scene;
}

static void test_expand(void **state)
{
    struct grove grove;
    struct orl_error err = {0};
    (void)state;
    grove_init(&grove, GROVE_TRIANGLES, GROVE_ROUND, GROVE_PLACES);
    struct orl_parsed_scene a = grove_read(&grove, grove.shared);
    struct orl_parsed_scene b = grove_read(&grove, grove.expanded);
    assert_int_equal(a.n_surfaces, 1);
    assert_int_equal(a.n_prototypes, 1);
    assert_int_equal(a.n_placements, GROVE_PLACES);
    assert_int_equal(orl_parsed_scene_count_surfaces(&a), b.n_surfaces);
    assert_int_equal(orl_placements_expand(&a, ORL_ALL_PLACEMENTS, &err), 0);
    assert_int_equal(a.n_surfaces, b.n_surfaces);
    assert_int_equal(a.n_placements, 0);
    for (size_t i = 0; i < a.n_surfaces; i++) {
        const struct orl_surface *const p = &a.surfaces[i], *const q = &b.surfaces[i];
        assert_int_equal(p->kind, q->kind);
        assert_string_equal(p->name, q->name);
        assert_string_equal(a.materials[p->material].name, b.materials[q->material].name);
        assert_true(orl_length(orl_sub(p->normal, q->normal)) < 1e-12);
        assert_int_equal(p->n_vertices, q->n_vertices);
        for (uint32_t k = 0; k < p->n_vertices; k++)
            assert_true(orl_length(orl_sub(p->vertices[k], q->vertices[k])) < 1e-12);
        if (p->kind != ORL_SURFACE_POLYGON) {
            const bool two = p->kind == ORL_SURFACE_CONE || p->kind == ORL_SURFACE_CUP;
            assert_true(orl_length(orl_sub(p->quadric->center[0], q->quadric->center[0])) < 1e-12);
            assert_true(!two ||
                        orl_length(orl_sub(p->quadric->center[1], q->quadric->center[1])) < 1e-12);
            assert_true(fabs(p->quadric->radius[0] - q->quadric->radius[0]) < 1e-12);
            assert_true(fabs(p->quadric->radius[1] - q->quadric->radius[1]) < 1e-12);
        }
    }
    orl_parsed_scene_done(&a);
    orl_parsed_scene_done(&b);
    grove_done(&grove);
}

struct fitness {
    const char *head; /* text before the tree's own */
    /* Number of places, and of those that share a prototype. Every fifth place, starting with the
     * third, is inside out. */
    size_t places, kept;
    size_t prototypes;
};

#define BALL "m sphere s 0 0 4 0 0 0 1\n"

static void test_fitness(void **state)
{
    static const struct fitness table[] = {
        {"", 4, 4, 1},
        {"", 3, 0, 0},
        {"void metal m 0 0 5 .5 .5 .5 0 0\n" BALL, 4, 4, 1},
        {"void sphere s 0 0 4 0 0 0 1\n", 4, 4, 1}, /* surfaces of void are absent */
        {"void plastic m 0 0 5 .5 .5 .5 .1 0\n" BALL, 4, 4, 1},
        {"void metal2 m 4 1 0 0 . 0 6 .5 .5 .5 .1 .1 .2\n" BALL, 4, 0, 0},
        {"void glass m 0 0 3 .5 .5 .5\n" BALL, 4, 0, 0},
        {"void light m 0 0 3 5 5 5\n" BALL, 4, 0, 0},
        {"void trans m 0 0 7 .5 .5 .5 0 0 .5 0\n" BALL, 4, 4, 1},
        {"void trans m 0 0 7 .5 .5 .5 0 0 .5 .1\n" BALL, 4, 0, 0},
        {"void trans m 0 0 7 .5 .5 .5 .1 0 .5 0\n" BALL, 4, 4, 1},
        {"void light m 0 0 3 5 5 5\nm source s 0 0 4 0 0 1 1\n", 4, 0, 0},
        /* With functions, inside-out places are separate, two places are enough, and all functions
         * stay in the frame in which they are read. */
        {"void brightfunc f 2 Px . 0 0\nf plastic m 0 0 5 .5 .5 .5 0 0\n" BALL, 4, 3, 1},
        {"void brightfunc f 2 Px . 0 0\nf plastic m 0 0 5 .5 .5 .5 0 0\n" BALL, 8, 8, 2},
        {"void brightfunc f 2 Px . 0 0\nf plastic m 0 0 5 .5 .5 .5 0 0\n" BALL, 2, 2, 1},
        {"void texfunc f 4 Px 0 0 . 0 0\nf plastic m 0 0 5 .5 .5 .5 0 0\n" BALL, 4, 3, 1},
        {"void brightfunc f 2 Px+Tx . 0 0\nf plastic m 0 0 5 .5 .5 .5 0 0\n" BALL, 4, 0, 0},
        {"void plastic a 0 0 5 .1 .2 .3 .1 .1\nvoid mixfunc m 4 a void Px . 0 0\n" BALL, 4, 0, 0},
    };
    (void)state;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        struct grove grove;
        grove_init(&grove, GROVE_TRIANGLES, 0, table[i].places);
        const size_t size = strlen(table[i].head) + strlen(grove.tree) + 1;
        char *const tree = malloc(size);
        assert_non_null(tree);
        snprintf(tree, size, "%s%s", table[i].head, grove.tree);
        free(grove.tree);
        grove.tree = tree;
        struct orl_parsed_scene d = grove_read(&grove, grove.shared);
        if (d.n_prototypes != table[i].prototypes || d.n_placements != table[i].kept)
            fail_msg("%zu: %zu prototypes in %zu places", i, d.n_prototypes, d.n_placements);
        orl_parsed_scene_done(&d);
        grove_done(&grove);
    }
}

/* A pair of trees in five places is ten trees; so is a pair in a file that is not stored once. */
static void test_nested(void **state)
{
    struct grove grove;
    (void)state;
    grove_init(&grove, GROVE_TRIANGLES, 0, 1);
    struct orl_parsed_scene d = grove_read(&grove, "void instance a 1 pair.oct 0 0\n"
                                                   "void instance b 5 pair.oct -t 5 0 0 0 0\n"
                                                   "void instance c 5 pair.oct -t 9 0 0 0 0\n"
                                                   "void instance d 5 pair.oct -t 15 0 0 0 0\n"
                                                   "void instance e 5 pair.oct -t 20 0 0 0 0\n");
    assert_int_equal(d.n_prototypes, 1);
    assert_int_equal(d.n_placements, 10);
    assert_int_equal(d.n_surfaces, 0);
    orl_parsed_scene_done(&d);
    grove_done(&grove);
}

static const char prefixed[] = "void plastic floor 0 0 5 .5 .5 .5 0 0\n"
                               "!xform -n a once.rad\n!xform -n bc -t 3 0 0 once.rad\n"
                               "floor sphere ball 0 0 4 0 0 0 1\n"
                               "!xform -n d -t 6 0 0 once.rad\n!xform -t 9 0 0 once.rad\n";

/* Names are those that each place would have given. */
static void test_names(void **state)
{
    static const char *const prefixes[4] = {"a.", "bc.", "d.", ""};
    struct grove grove;
    struct orl_error err = {0};
    size_t at = 0;
    (void)state;
    grove_init(&grove, GROVE_TRIANGLES, GROVE_ROUND, 1);
    struct orl_parsed_scene d = grove_read(&grove, prefixed);
    assert_int_equal(d.n_placements, 4);
    assert_int_equal(d.placements[1].before, 0);
    assert_int_equal(d.placements[2].before, 1);
    const struct orl_surface *const leaf = &d.prototypes[0].surfaces[7];
    assert_true(orl_placement_has_name(&d, &d.placements[1], leaf->name, "bc.leaf7"));
    assert_false(orl_placement_has_name(&d, &d.placements[1], leaf->name, "a.leaf7"));
    assert_true(orl_placement_has_name(&d, &d.placements[3], leaf->name, "leaf7"));
    assert_int_equal(orl_placements_expand(&d, ORL_ALL_PLACEMENTS, &err), 0);
    for (size_t place = 0; place < 4; place++) {
        const size_t n = GROVE_TRIANGLES + GROVE_ROUND;
        char name[32];
        snprintf(name, sizeof name, "%sleaf7", prefixes[place]);
        assert_string_equal(d.surfaces[at + 7].name, name);
        at += n;
        if (place == 1)
            assert_string_equal(d.surfaces[at++].name, "ball");
    }
    assert_int_equal(d.n_surfaces, at);
    orl_parsed_scene_done(&d);
    grove_done(&grove);
}

/* A material override for one of the places gives each its own surfaces; an override for anything
 * else does not. */
static void test_swaps(void **state)
{
    char *names[2] = {"bc.leaf7", "ball"};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct grove grove;
        struct orl_error err = {0};
        unsigned swapped = 0;
        grove_init(&grove, GROVE_TRIANGLES, 0, 1);
        struct orl_parsed_scene d = grove_read(&grove, prefixed);
        const struct orl_material_override override = {
            .of = "shade", .names = &names[k], .n_names = 1, .kind = ORL_OVERRIDE_BLACK};
        assert_int_equal(
            orl_material_overrides_apply(
                &(struct orl_material_overrides){.at = &override, .count = 1}, 1, &d, &err),
            0);
        assert_int_equal(d.n_placements, k == 0 ? 0 : 4);
        for (size_t i = 0; i < d.n_surfaces; i++) {
            const bool dark = d.surfaces[i].material == d.n_materials - 1;
            assert_int_equal(dark, strcmp(d.surfaces[i].name, names[k]) == 0);
            swapped += dark;
        }
        assert_int_equal(swapped, 1);
        orl_parsed_scene_done(&d);
        grove_done(&grove);
    }
}

/* If the scene has antimatter or mist, each place has its own surfaces. */
static void test_apart(void **state)
{
    static const char *const more[2] = {
        "void antimatter hole 1 floor 0 0\nhole sphere h 0 0 4 50 50 -2 1\n",
        "void mist fog 0 0 3 .01 .01 .01\nfog sphere h 0 0 4 50 50 20 1\n"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct grove grove;
        char *text = NULL;
        size_t size = 0;
        grove_init(&grove, GROVE_TRIANGLES, 0, GROVE_PLACES);
        FILE *f = open_memstream(&text, &size);
        assert_non_null(f);
        fprintf(f, "%s%s", grove.shared, more[i]);
        assert_int_equal(fclose(f), 0);
        struct orl_scene *const scene = scene_of(&grove, text);
        assert_int_equal(scene->geometry->n_instances, 0);
        assert_int_equal(scene->geometry->n_facets, 2 + GROVE_PLACES * GROVE_TRIANGLES);
        orl_scene_release(scene);
        free(text);
        grove_done(&grove);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_expand), cmocka_unit_test(test_fitness),
        cmocka_unit_test(test_nested), cmocka_unit_test(test_names),
        cmocka_unit_test(test_swaps),  cmocka_unit_test(test_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
