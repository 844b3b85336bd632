/*
 * Every type of material: parsed parameters, under transforms too. Each of Radiance's types of
 * primitive has its own answer, at least a refusal with a hint.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "fixtures/bsdf_make.h"
#include "scene/material/scatter.h"
#include "scene/parse/parse.h"
#include "support/scene_text.h"

static bool near(double a, double b)
{
    return fabs(a - b) <= 1e-12 * fmax(1, fabs(b));
}

static bool same_rgb(struct orl_rgb c, double r, double g, double b)
{
    return near(c.r, r) && near(c.g, g) && near(c.b, b);
}

static void test_reflectors(void **state)
{
    struct orl_parsed_scene d =
        scene_parse_text("void trans t 0 0 7 .8 .7 .6 .1 .2 .5 .4\n"
                         "void plastic2 p 4 1 2 2 . 0 6 .5 .4 .3 .02 .1 .2\n"
                         "void metal2 m 6 1 0 0 . -rz 90 0 6 .5 .4 .3 .9 .1 .2\n"
                         "void trans2 s 4 0 3 0 . 0 8 .5 .4 .3 .1 .1 .2 .6 .7\n",
                         NULL, NULL);
    const struct orl_material *m = d.materials;
    (void)state;
    assert_int_equal(d.n_materials, 4);
    assert_int_equal(m[0].kind, ORL_MATERIAL_TRANS);
    assert_true(same_rgb(m[0].color, .8, .7, .6) &&
                near(orl_reflector_of(&m[0])->shares.specular, .1));
    assert_true(near(orl_reflector_of(&m[0])->roughness[0], .2) &&
                near(orl_reflector_of(&m[0])->roughness[1], .2));
    assert_true(near(orl_reflector_of(&m[0])->shares.transmitted, .5) &&
                near(orl_reflector_of(&m[0])->shares.transmitted_specular, .4));
    assert_int_equal(m[1].kind, ORL_MATERIAL_PLASTIC);
    assert_true(near(orl_reflector_of(&m[1])->roughness[0], .1) &&
                near(orl_reflector_of(&m[1])->roughness[1], .2));
    assert_true(near(orl_reflector_of(&m[1])->anisotropy_axis.x, 1.0 / 3) &&
                near(orl_reflector_of(&m[1])->anisotropy_axis.y, 2.0 / 3));
    assert_int_equal(m[2].kind, ORL_MATERIAL_METAL);
    assert_true(near(orl_reflector_of(&m[2])->anisotropy_axis.x, 0) &&
                near(orl_reflector_of(&m[2])->anisotropy_axis.y, 1));
    assert_int_equal(m[3].kind, ORL_MATERIAL_TRANS);
    assert_true(near(orl_reflector_of(&m[3])->shares.transmitted, .6) &&
                near(orl_reflector_of(&m[3])->shares.transmitted_specular, .7));
    orl_parsed_scene_done(&d);
}

static void test_clear_materials(void **state)
{
    struct orl_parsed_scene d = scene_parse_text("void dielectric d 0 0 5 .9 .8 .7 1.5 0\n"
                                                 "void interface i 0 0 8 .9 .8 .7 1.5 1 .5 1 1.33\n"
                                                 "void mirror m 0 0 3 .9 .8 1\n",
                                                 NULL, NULL);
    const struct orl_material *m = d.materials;
    (void)state;
    assert_int_equal(m[0].kind, ORL_MATERIAL_DIELECTRIC);
    assert_true(same_rgb(orl_interface_of(&m[0])->media[0].transmissivity, .9, .8, .7) &&
                near(orl_interface_of(&m[0])->media[0].ior, 1.5));
    assert_true(same_rgb(orl_interface_of(&m[0])->media[1].transmissivity, 1, 1, 1) &&
                near(orl_interface_of(&m[0])->media[1].ior, 1));
    assert_int_equal(m[1].kind, ORL_MATERIAL_DIELECTRIC);
    assert_true(same_rgb(orl_interface_of(&m[1])->media[1].transmissivity, 1, .5, 1));
    assert_true(near(orl_interface_of(&m[1])->media[1].ior, 1.33));
    assert_int_equal(m[2].kind, ORL_MATERIAL_MIRROR);
    assert_true(same_rgb(m[2].color, .9, .8, 1));
    assert_int_equal(d.n_warnings, 0);
    orl_parsed_scene_done(&d);
}

/* A window declared as a mirror, so that Radiance finds the suns in it, becomes its glass. */
static void test_mirrors_are_what_they_are_seen_as(void **state)
{
    struct orl_parsed_scene d =
        scene_parse_text("void glass g 0 0 3 .9 .8 .7\n"
                         "void brightfunc f 2 1-abs(Rdot) . 0 0\n"
                         "f mirror m 1 g 0 3 1 1 1\n"
                         "void mirror gone 1 void 0 3 1 1 1\n"
                         "m ring a 0 0 8 0 0 0 0 0 1 0 1\ngone ring b 0 0 8 0 0 2 0 0 1 0 1\n",
                         NULL, NULL);
    (void)state;
    assert_int_equal(d.n_surfaces, 1);
    const struct orl_material *const m = d.materials + d.surfaces[0].material;
    assert_int_equal(m->kind, ORL_MATERIAL_GLASS);
    const struct orl_rgb t = orl_glass_of(&d.materials[0])->transmissivity;
    assert_true(same_rgb(orl_glass_of(m)->transmissivity, t.r, t.g, t.b));
    assert_null(m->pattern);
    assert_int_equal(d.n_warnings, 3); /* two mirrors, and a surface of void */
    assert_non_null(strstr(d.warnings[0], "mirror m at"));
    assert_non_null(strstr(d.warnings[0], "its alternate 'g'"));
    orl_parsed_scene_done(&d);
}

static void test_lights(void **state)
{
    struct orl_parsed_scene d = scene_parse_text("void glass g 0 0 3 .9 .9 .9\n"
                                                 "void spotlight s 0 0 7 1 2 3 60 0 0 -2\n"
                                                 "void illum a 0 0 3 1 2 3\n"
                                                 "void illum b 1 void 0 3 1 2 3\n"
                                                 "void illum c 1 g 0 3 1 2 3\n"
                                                 "void illum d 1 c 0 3 1 2 3\n",
                                                 NULL, NULL);
    const struct orl_material *m = d.materials;
    (void)state;
    assert_int_equal(m[1].kind, ORL_MATERIAL_SPOTLIGHT);
    assert_true(near(orl_spotlight_of(&m[1])->focus, 2) &&
                near(orl_spotlight_of(&m[1])->beam_axis.z, -1) &&
                near(orl_spotlight_of(&m[1])->cos_cone, sqrt(.75)));
    assert_int_equal(m[2].kind, ORL_MATERIAL_ILLUM);
    assert_int_equal(orl_material_seen_as(&m[2]), ORL_SEEN_AS_NOTHING);
    assert_int_equal(orl_material_seen_as(&m[3]), ORL_SEEN_AS_NOTHING);
    assert_int_equal(orl_material_seen_as(&m[4]), 0);
    assert_int_equal(orl_material_seen_as(&m[5]), 0);
    for (int i = 1; i < 6; i++)
        assert_true(orl_material_is_lamp(&m[i]) && orl_material_emits(&m[i]));
    orl_parsed_scene_done(&d);
}

/* Materials that are accepted but not simulated as written give a warning. */
static void test_warnings(void **state)
{
    static const char *const texts[3][2] = {
        {"void dielectric d 0 0 5 1 1 1 1.5 8e5\n", "dispersion"},
        {"void plastic p 0 0 5 0 0 0 0 0\nvoid mirror m 1 p 0 3 .9 .8 1\n", "'p' is ignored"},
        {"void illum i 0 0 3 1 1 1\n", "only light from suns and lamps passes"}};
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct orl_parsed_scene d = scene_parse_text(texts[i][0], NULL, NULL);
        assert_int_equal(d.n_warnings, 1);
        assert_non_null(strstr(d.warnings[0], texts[i][1]));
        orl_parsed_scene_done(&d);
    }
}

/* Rotated by 90 degrees about z and scaled by ten, as by xform. */
static void test_transforms(void **state)
{
    static const char materials[] = "void dielectric d 0 0 5 .5 .5 .5 1.5 0\n"
                                    "void spotlight s 0 0 7 1 2 3 60 2 0 0\n"
                                    "void glow w 0 0 4 1 1 1 3\n"
                                    "void metal2 m 4 1 0 0 . 0 6 .5 .4 .3 .9 .1 .2\n";
    static const char *const names[] = {"a.rad", "m.rad"};
    static const char main_text[] = "!xform -rz 90 -s 10 m.rad\n";
    const struct orl_file contents[] = {{main_text, sizeof main_text - 1, NULL},
                                        {materials, sizeof materials - 1, NULL}};
    struct orl_memory_files memory = {names, contents, 2};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_scene_parse(names, 1, &files, &d, &err), 0);
    assert_true(near(orl_interface_of(&d.materials[0])->media[0].transmissivity.g, pow(.5, .1)));
    const struct orl_spotlight *const spot = orl_spotlight_of(&d.materials[1]);
    assert_true(near(spot->focus, 20) && near(spot->beam_axis.y, 1));
    assert_true(near(orl_glow_of(&d.materials[2])->max_radius, 30));
    assert_true(near(orl_reflector_of(&d.materials[3])->anisotropy_axis.y, 1));
    orl_parsed_scene_done(&d);
}

/* All of Radiance's types of primitive: those read here, and those refused by name, with a hint. */
static void test_every_type_has_an_answer(void **state)
{
    static const char *const read[] = {
        "polygon",   "cone",      "sphere",     "ring",      "cylinder",   "cup",
        "bubble",    "tube",      "source",     "alias",     "plastic",    "metal",
        "glass",     "trans",     "plastic2",   "metal2",    "trans2",     "interface",
        "glow",      "light",     "illum",      "mirror",    "dielectric", "BSDF",
        "aBSDF",     "spotlight", "brightfunc", "colorfunc", "brightdata", "colordata",
        "colorpict", "mixfunc",   "mixdata",    "mixpict",   "instance",   "mesh",
        "texfunc",   "texdata",   "spectrum",   "specfile",  "specfunc",   "specdata",
        "ashik2",    "BRTDfunc",  "brighttext", "colortext", "mixtext",    "antimatter",
        "prism1",    "prism2",    "plasfunc",   "metfunc",   "transfunc",  "plasdata",
        "metdata",   "transdata", "WGMDfunc",   "mist",      "specpict"};
    static const char *const names[] = {"a.rad"};
    (void)state;
    assert_int_equal(sizeof read / sizeof *read, 59);
    for (size_t i = 0; i < 59; i++) {
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        char text[64];
        snprintf(text, sizeof text, "\nvoid %s x\n", read[i]);
        const struct orl_file file = {text, strlen(text), NULL};
        struct orl_memory_files memory = {names, &file, 1};
        const struct orl_files files = orl_files_from_memory(&memory);
        const int code = orl_scene_parse(names, 1, &files, &d, &err);
        /* Without arguments the text ends too soon. */
        assert_int_equal(code, ORL_ERR_SYNTAX);
        assert_null(strstr(err.message, "not a primitive type"));
    }
}

/* The memory size of a scene includes its BSDFs; a second material with the same file adds only
 * itself. */
static void test_bytes_of_bsdfs(void **state)
{
    static const char *const bsdfs[3] = {"", "void BSDF a 6 0 a.xml 0 1 0 . 0 0\n",
                                         ("void BSDF a 6 0 a.xml 0 1 0 . 0 0\n"
                                          "void BSDF b 6 0 a.xml 1 0 0 . 0 0\n")};
    struct text file = make_file("TensorTree4", "Transmission Back", NULL,
                                 "{0 .25 .125 .375 .0625 .3125 .1875 .4375 .03125 .28125 .15625 "
                                 ".40625 .09375 .34375 .21875 .46875}");
    uint64_t bytes[3];
    struct orl_bsdf_info info = {0};
    (void)state;
    for (int i = 0; i < 3; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "void plastic grey 0 0 5 .5 .5 .5 0 0\n%s"
                 "grey polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n",
                 bsdfs[i]);
        struct orl_lit_scene *lit_scene =
            build_lit_scene(text, i > 0 ? "a.xml" : NULL, file.data, NULL);
        bytes[i] = orl_scene_bytes(lit_scene->scene);
        if (i == 1)
            orl_bsdf_describe(orl_material_bsdf(&lit_scene->scene->parsed_scene.materials[1]),
                              &info);
        orl_lit_scene_free(lit_scene);
    }
    assert_true(info.bytes > 64);
    assert_int_equal(bytes[1] - bytes[0], sizeof(struct orl_material) + info.bytes);
    assert_int_equal(bytes[2] - bytes[1], sizeof(struct orl_material));
    free(file.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reflectors),
        cmocka_unit_test(test_clear_materials),
        cmocka_unit_test(test_mirrors_are_what_they_are_seen_as),
        cmocka_unit_test(test_lights),
        cmocka_unit_test(test_warnings),
        cmocka_unit_test(test_transforms),
        cmocka_unit_test(test_every_type_has_an_answer),
        cmocka_unit_test(test_bytes_of_bsdfs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
