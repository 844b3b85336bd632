/*
 * Panels from BSDF files (pkgBSDF): their faces and geometry in the scene, in metres and placed as
 * by Radiance's pkgBSDF; geometry in MGF files; and refusals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"

#define SIZE "<Width unit=\"Millimeter\">500</Width><Height unit=\"Millimeter\">300</Height>"
#define DEPTH "<Thickness unit=\"Millimeter\">40</Thickness>"
#define MGF "m slat =\n rd .5\nv a =\n p -2 1 -3\nv b =\n p 2 1 -3\nv c =\n p 2 1 -1\nf a b c\n"

/* Returns a panel whose tensor tree has one value for light from behind: 0.1 per steradian. */
static const char *panel(const char *sizes, const char *geometry, const char *direction)
{
    static char xml[4096];
    snprintf(xml, sizeof xml,
             "<?xml version=\"1.0\"?>\n<WindowElement><WindowElementType>System"
             "</WindowElementType><FileType>BSDF</FileType><Optical><Layer>\n"
             "<Material><Name>slats</Name><Manufacturer>us</Manufacturer>%s</Material>\n%s"
             "<DataDefinition><IncidentDataStructure>TensorTree4</IncidentDataStructure>"
             "</DataDefinition><WavelengthData><LayerNumber>System</LayerNumber>"
             "<Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>"
             "<WavelengthDataDirection>%s</WavelengthDataDirection>"
             "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF"
             "</ScatteringDataType><ScatteringData>{ 0.1 }</ScatteringData>"
             "</WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>\n",
             sizes, geometry, direction);
    return xml;
}

static int parse(const char *scene, const char *other, const char *text,
                 struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    const char *const names[2] = {"a.rad", other};
    const struct orl_file contents[2] = {{scene, strlen(scene), NULL}, {text, strlen(text), NULL}};
    struct orl_memory_files memory = {(const char **)names, (struct orl_file *)contents, 2};
    struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse((const char **)names, 1, &files, ret_parsed_scene, err);
}

static void assert_near(double a, double b)
{
    if (fabs(a - b) > 1e-9)
        fail_msg("%.12g instead of %.12g", a, b);
}

/* Without geometry, a panel is one face of plain material in the middle. */
static void a_panel_alone_is_its_face(void **state)
{
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse("!pkgBSDF -s x/p.xml | xform -t 0 0 7\n", "x/p.xml",
                           panel(SIZE DEPTH, "<Geometry></Geometry>", "Transmission Back"), &d,
                           &err),
                     0);
    assert_int_equal(d.n_surfaces, 1);
    assert_string_equal(d.materials[0].name, "m_p");
    assert_near(orl_material_thickness(&d.materials[0]), 0);
    const struct orl_vec3 *corner = d.surfaces[0].vertices;
    assert_near(corner[0].x, -0.25);
    assert_near(corner[0].y, -0.15);
    assert_near(corner[2].x, 0.25);
    assert_near(corner[2].y, 0.15);
    assert_near(corner[2].z, 7);
    orl_parsed_scene_done(&d);
}

/* With geometry, there is a face in front of it; and one behind, if light arrives from behind. */
static void a_panel_with_geometry_is_a_proxy(void **state)
{
    static const char geometry[] =
        "<Geometry format=\"MGF\">\n<MGFblock unit=\"Centimeter\">\n" MGF "</MGFblock></Geometry>";
    static const char *const directions[2] = {"Transmission Back", "Reflection Front"};
    (void)state;
    for (size_t behind = 0; behind < 2; behind++) {
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        assert_int_equal(parse("!pkgBSDF -s p.xml\n", "p.xml",
                               panel(SIZE DEPTH, geometry, directions[behind]), &d, &err),
                         0);
        assert_int_equal(d.n_surfaces, 2 + behind);
        const struct orl_vec3 *face = d.surfaces[0].vertices;
        assert_near(orl_material_thickness(&d.materials[0]), 0.0400016);
        assert_near(face->z, 8e-7);
        if (behind) {
            assert_near(orl_material_thickness(&d.materials[1]), -0.0400016);
            assert_near(d.surfaces[1].vertices[0].z, -0.0400008);
        }
        const struct orl_vec3 *slat = d.surfaces[1 + behind].vertices;
        assert_near(slat[1].x, 0.02);
        assert_near(slat[2].y, 0.01);
        assert_near(slat[0].z, -0.03);
        orl_parsed_scene_done(&d);
    }
}

static void a_file_of_mgf_is_read(void **state)
{
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse("!mgf2rad -s p.mgf | xform -s .5\n", "p.mgf", MGF, &d, &err), 0);
    assert_int_equal(d.n_surfaces, 1);
    assert_near(d.surfaces[0].vertices[0].x, -1);
    orl_parsed_scene_done(&d);
}

/* An MGF file beside the scene, which includes another file beside itself. */
static void a_file_of_mgf_includes_others(void **state)
{
    static const char *const names[] = {"a.rad", "sub/p.mgf", "sub/q.mgf"};
    static const char *const texts[] = {"!mgf2rad sub/p.mgf\n", "i q.mgf -t 3 0 0 -a 2 -t 0 1 0\n",
                                        MGF};
    struct orl_file contents[3];
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    for (size_t i = 0; i < 3; i++)
        contents[i] = (struct orl_file){texts[i], strlen(texts[i]), NULL};
    struct orl_memory_files memory = {names, contents, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    if (orl_scene_parse(names, 1, &files, &d, &err) < 0)
        fail_msg("%s:%d: %s", err.file, err.line, err.message);
    assert_int_equal(d.n_surfaces, 2);
    assert_near(d.surfaces[1].vertices[0].x, 1);
    assert_near(d.surfaces[1].vertices[0].y - d.surfaces[0].vertices[0].y, 1);
    orl_parsed_scene_done(&d);
}

/* ---- Refused --------------------------------------------------------------------------------- */

static const struct {
    const char *command, *sizes, *geometry;
    int code;
    const char *file;
    int line;
    const char *message; /* part of the message */
} refused[] = {
    {"!pkgBSDF p.xml\n", SIZE, "", ORL_ERR_SYNTAX, "a.rad", 1, "writes a file"},
    {"!pkgBSDF -s\n", SIZE, "", ORL_ERR_SYNTAX, "a.rad", 1, "takes one file"},
    {"!pkgBSDF -s -q p.xml\n", SIZE, "", ORL_ERR_SYNTAX, "a.rad", 1, "'-q'"},
    {"!pkgBSDF -s p.rad\n", SIZE, "", ORL_ERR_SYNTAX, "a.rad", 1, "end in .xml"},
    {"!pkgBSDF -s q.xml\n", SIZE, "", ORL_ERR_NOT_FOUND, "a.rad", 1, "q.xml"},
    {"!pkgBSDF -s p.xml\n", "", "", ORL_ERR_RANGE, "a.rad", 1, "not give the width"},
    {"!pkgBSDF -s p.xml\n", "<Width>wide</Width>", "", ORL_ERR_RANGE, "p.xml", 3, "'wide'"},
    {"!pkgBSDF -s p.xml\n", SIZE DEPTH, "<Geometry format=\"IFC\"></Geometry>", ORL_ERR_UNSUPPORTED,
     "p.xml", 4, "'IFC'"},
    {"!pkgBSDF -s p.xml\n", SIZE DEPTH,
     "<Geometry><MGFblock>\nv a =\n p 0 0 0\nf a b c\n</MGFblock></Geometry>", ORL_ERR_SYNTAX,
     "p.xml", 7, "'b'"},
    {"!pkgBSDF -s p.xml\n", SIZE, "<Geometry><MGFblock>m a =\n</MGFblock></Geometry>",
     ORL_ERR_RANGE, "a.rad", 1, "no thickness"},
    {"!mgf2rad -m x p.xml\n", SIZE, "", ORL_ERR_UNSUPPORTED, "a.rad", 1, "'-m'"},
    {"!mgf2rad\n", SIZE, "", ORL_ERR_SYNTAX, "a.rad", 1, "one file"},
};

static void what_is_refused_has_its_place(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        const int code =
            parse(refused[i].command, "p.xml",
                  panel(refused[i].sizes, refused[i].geometry, "Transmission Back"), &d, &err);
        if (code != refused[i].code || strcmp(err.file, refused[i].file) != 0 ||
            err.line != refused[i].line || !strstr(err.message, refused[i].message))
            fail_msg("%zu: %d, %s:%d: %s", i, code, err.file, err.line, err.message);
        if (code == 0)
            orl_parsed_scene_done(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_panel_alone_is_its_face),
        cmocka_unit_test(a_panel_with_geometry_is_a_proxy),
        cmocka_unit_test(a_file_of_mgf_is_read),
        cmocka_unit_test(a_file_of_mgf_includes_others),
        cmocka_unit_test(what_is_refused_has_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
