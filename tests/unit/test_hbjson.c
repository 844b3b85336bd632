/* Honeybee models as Radiance files: their contents, and refusals. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <jansson.h>

#include "honeybee/hbjson.h"
#include "project/project.h"

static json_t *load_model(void)
{
    json_error_t where;
    json_t *model = json_load_file("tests/fixtures/honeybee/two_rooms.hbjson", 0, &where);
    if (!model)
        fail_msg("%s:%d: %s", where.source, where.line, where.text);
    return model;
}

static struct orl_text_files translate(const json_t *model)
{
    struct orl_text_files files = {0};
    struct orl_error err = {0};
    if (orl_hbjson_translate(model, &files, &err))
        fail_msg("%s", err.message);
    return files;
}

static const char *text_of(const struct orl_text_files *files, const char *name)
{
    for (size_t i = 0; i < files->count; i++)
        if (strcmp(files->items[i].name, name) == 0)
            return files->items[i].text;
    fail_msg("there is no file %s", name);
    return NULL;
}

static void assert_has(const struct orl_text_files *files, const char *name, const char *part)
{
    if (!strstr(text_of(files, name), part))
        fail_msg("%s has no \"%s\"", name, part);
}

static size_t count_substrings(const char *text, const char *part)
{
    size_t n = 0;
    for (; (text = strstr(text, part)); text += strlen(part))
        n++;
    return n;
}

/* ---- Files ----------------------------------------------------------------------------------- */

static void test_surfaces_are_in_their_files(void **state)
{
    (void)state;
    json_t *model = load_model();
    struct orl_text_files files = translate(model);
    const char *envelope = text_of(&files, "model/scene/envelope.rad");
    /* Six faces of each room, and the door between them once. */
    assert_int_equal(count_substrings(envelope, " polygon "), 13);
    assert_int_equal(count_substrings(envelope, "polygon glass_door\n"), 1);
    assert_null(strstr(envelope, "glass_door_back"));
    assert_has(&files, "model/scene/envelope.rad", "carpet polygon office_floor\n");
    assert_has(&files, "model/scene/envelope.rad", "white_wall polygon office_north\n");
    assert_has(&files, "model/scene/envelope.rad", "generic_wall_0.50 polygon store_north\n");
    assert_has(&files, "model/aperture/aperture.rad",
               "generic_exterior_window_vis_0.64 polygon side_window\n");
    assert_null(strstr(text_of(&files, "model/aperture/aperture.rad"), "view_window"));
    assert_has(&files, "model/scene/shades.rad", "generic_context_0.20 polygon neighbour\n");
    assert_has(&files, "model/scene/shades.rad", "generic_exterior_shade_0.35 polygon overhang\n");
    assert_has(&files, "model/scene/shade_meshes.rad", "leaves polygon hedge_1\n");
    assert_has(&files, "model/scene/envelope.mat", "void plastic carpet\n0\n0\n5 0.25 ");
    assert_int_equal(count_substrings(text_of(&files, "model/scene/envelope.mat"), "white_wall"),
                     1);
    orl_text_files_done(&files);
    json_decref(model);
}

/* Reads the numbers between the polygon's name and the next. */
static size_t read_corners(const struct orl_text_files *files, const char *name,
                           double ret_corners[][3], size_t room)
{
    char line[100];
    snprintf(line, sizeof line, "polygon %s\n", name);
    const char *at = strstr(text_of(files, "model/scene/envelope.rad"), line);
    size_t numbers = 0;
    int length = 0;
    assert_non_null(at);
    assert_int_equal(sscanf(at + strlen(line), "0 0 %zu%n", &numbers, &length), 1);
    assert_true(numbers % 3 == 0 && numbers / 3 <= room);
    at += strlen(line) + (size_t)length;
    for (size_t i = 0; i < numbers; i++)
        ret_corners[i / 3][i % 3] = strtod(at, (char **)(uintptr_t)&at);
    return numbers / 3;
}

/* Returns the area of the polygon in x and z by its outline, seams to holes included. */
static double area_across(double (*c)[3], size_t n)
{
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        const double *a = c[i], *b = c[(i + 1) % n];
        sum += a[0] * b[2] - b[0] * a[2];
    }
    return sum / 2;
}

static void test_openings_are_cut_out(void **state)
{
    (void)state;
    json_t *model = load_model();
    struct orl_text_files files = translate(model);
    double corners[40][3];
    const size_t n = read_corners(&files, "office_south", corners, 40);
    /* 4 corners + 2 windows of 4 + 2 x 2 for seams; 4 x 3 m less two of 1.3 x 1.2 m, up to
     * rounding. */
    assert_int_equal(n, 16);
    assert_true(area_across(corners, n) > 12 - 2 * 1.3 * 1.2 - 1e-9);
    assert_true(area_across(corners, n) < 12 - 2 * 1.3 * 1.2 + 1e-9);
    orl_text_files_done(&files);
    json_decref(model);
}

/* The second side is moved back by twice the tolerance of 1 cm, into its own room. */
static void test_the_second_side_stands_back(void **state)
{
    (void)state;
    json_t *model = load_model();
    struct orl_text_files files = translate(model);
    double corners[40][3];
    size_t n = read_corners(&files, "office_north", corners, 40);
    for (size_t i = 0; i < n; i++)
        assert_float_equal(corners[i][1], 5, 1e-12);
    n = read_corners(&files, "store_south", corners, 40);
    for (size_t i = 0; i < n; i++)
        assert_float_equal(corners[i][1], 5.02, 1e-12);
    orl_text_files_done(&files);
    json_decref(model);
}

/* ---- Orientation ----------------------------------------------------------------------------- */

static json_t *find_object(json_t *list, const char *identifier)
{
    json_t *object;
    size_t i;
    json_array_foreach(list, i, object)
    {
        const char *own = json_string_value(json_object_get(object, "identifier"));
        if (own && strcmp(own, identifier) == 0)
            return object;
    }
    fail_msg("there is no %s", identifier);
    return NULL;
}

static json_t *find_face(json_t *model, size_t room, const char *identifier)
{
    const json_t *rooms = json_object_get(model, "rooms");
    return find_object(json_object_get(json_array_get(rooms, room), "faces"), identifier);
}

static void reverse(json_t *object)
{
    json_t *geometry = json_object_get(object, "geometry"), *turned = json_array();
    const json_t *boundary = json_object_get(geometry, "boundary");
    for (size_t i = json_array_size(boundary); i-- > 0;)
        json_array_append(turned, json_array_get(boundary, i));
    json_object_set_new(geometry, "boundary", turned);
}

/* A face that its room lists the wrong way round is turned inwards, and its openings, like those
 * of a right face, have the correct orientation. */
static void test_faces_look_outwards(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *north = find_face(model, 0, "office_north");
    reverse(find_face(model, 1, "store_south"));
    reverse(north);
    reverse(find_object(json_object_get(north, "doors"), "glass_door"));
    reverse(find_object(json_object_get(find_face(model, 0, "office_south"), "apertures"),
                        "view_window"));
    struct orl_text_files files = translate(model);
    double corners[40][3];
    size_t n = read_corners(&files, "store_south", corners, 40);
    for (size_t i = 0; i < n; i++)
        assert_float_equal(corners[i][1], 5.02, 1e-12);
    /* Outwards is along y: from right to left. */
    n = read_corners(&files, "glass_door", corners, 40);
    assert_int_equal(n, 4);
    assert_true(corners[1][0] - corners[0][0] < 0);
    /* Seen from the south: from left to right. */
    assert_has(&files, "model/aperture_group/south_glass..default..0.rad",
               "\n0.5 0 1\n1.8 0 1\n1.8 0 2.2");
    orl_text_files_done(&files);
    json_decref(model);
}

static void test_a_plane_says_which_way(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *shade = json_array_get(json_object_get(model, "orphaned_shades"), 0);
    json_t *plane = json_pack("{s:[f,f,f], s:[f,f,f]}", "n", 0.0, 1.0, 0.0, "o", 0.0, -12.0, 0.0);
    json_object_set_new(json_object_get(shade, "geometry"), "plane", plane);
    struct orl_text_files files = translate(model);
    assert_has(&files, "model/scene/shades.rad", "\n-2 -12 6\n6 -12 6\n6 -12 0\n-2 -12 0\n");
    orl_text_files_done(&files);
    json_object_set_new(plane, "n", json_string("up"));
    struct orl_error err = {0};
    assert_int_equal(orl_hbjson_translate(model, &files, &err), ORL_ERR_INVALID);
    assert_non_null(strstr(err.message, "orphaned_shades[0].geometry.plane.n"));
    json_decref(model);
}

/* Two openings without faces that bound each other are one opening between rooms. */
static void test_orphaned_pairs_are_one(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *door = json_object_get(find_face(model, 0, "office_north"), "doors");
    json_t *back = json_object_get(find_face(model, 1, "store_south"), "doors");
    json_object_set_new(model, "orphaned_doors",
                        json_pack("[O, O]", json_array_get(door, 0), json_array_get(back, 0)));
    json_array_clear(door);
    json_array_clear(back);
    struct orl_text_files files = translate(model);
    const char *envelope = text_of(&files, "model/scene/envelope.rad");
    assert_int_equal(count_substrings(envelope, " polygon glass_door"), 1);
    assert_non_null(strstr(envelope, "generic_interior_window_vis_0.88 polygon glass_door\n"));
    orl_text_files_done(&files);
    json_decref(model);
}

static void test_the_last_of_two_modifiers_counts(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *radiance = json_object_get(json_object_get(model, "properties"), "radiance");
    json_array_append_new(json_object_get(radiance, "modifiers"),
                          json_pack("{s:s, s:s, s:f, s:f, s:f}", "type", "Plastic", "identifier",
                                    "carpet", "r_reflectance", 0.5, "g_reflectance", 0.5,
                                    "b_reflectance", 0.5));
    struct orl_text_files files = translate(model);
    assert_has(&files, "model/scene/envelope.mat", "void plastic carpet\n0\n0\n5 0.5 0.5 0.5 0 0");
    assert_string_equal(text_of(&files, "model/warnings.txt"),
                        "modifier 'carpet': several different modifiers have this identifier; the "
                        "last in the list is used for all\n");
    orl_text_files_done(&files);
    json_decref(model);
}

static bool has_file(const struct orl_text_files *files, const char *name)
{
    for (size_t i = 0; i < files->count; i++)
        if (strcmp(files->items[i].name, name) == 0)
            return true;
    return false;
}

/* If two views have one name, the last counts. */
static void test_views_of_one_identifier_are_told(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *radiance = json_object_get(json_object_get(model, "properties"), "radiance");
    json_t *views = json_object_get(radiance, "views");
    json_t *other = json_deep_copy(json_array_get(views, 0));
    json_object_set_new(other, "h_size", json_real(33));
    json_array_append_new(views, other);
    struct orl_text_files files = translate(model);
    size_t n = 0;
    for (size_t i = 0; i < files.count; i++)
        n += strcmp(files.items[i].name, "model/view/from_door.vf") == 0;
    assert_int_equal(n, 1);
    assert_has(&files, "model/view/from_door.vf", "-vh 33");
    assert_string_equal(text_of(&files, "model/warnings.txt"),
                        "view 'from_door': several views of the model have this identifier; the "
                        "last one is used\n");
    orl_text_files_done(&files);
    json_decref(model);
}

/* Two grids of one name become one grid, with a warning; a model without faults has none. */
static void test_grids_of_one_identifier_are_told(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *radiance = json_object_get(json_object_get(model, "properties"), "radiance");
    json_t *grids = json_object_get(radiance, "sensor_grids");
    struct orl_text_files files = translate(model);
    assert_false(has_file(&files, "model/warnings.txt"));
    orl_text_files_done(&files);
    for (size_t i = 0; i < json_array_size(grids); i++)
        if (strcmp(json_string_value(json_object_get(json_array_get(grids, i), "identifier")),
                   "desks") == 0) {
            json_array_append(grids, json_array_get(grids, i));
            break;
        }
    files = translate(model);
    assert_int_equal(count_substrings(text_of(&files, "model/grid/desks.pts"), "\n"), 8);
    assert_string_equal(text_of(&files, "model/warnings.txt"),
                        "grid 'desks': 2 sensor grids of the model have this identifier; their "
                        "sensors are joined into one grid, in the order of the model\n");
    orl_text_files_done(&files);
    json_decref(model);
}

static void test_an_air_boundary_is_not_there(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *faces = json_object_get(json_array_get(json_object_get(model, "rooms"), 1), "faces");
    json_object_set_new(json_array_get(faces, 0), "face_type", json_string("AirBoundary"));
    struct orl_text_files files = translate(model);
    assert_null(strstr(text_of(&files, "model/scene/envelope.rad"), "store_floor"));
    assert_null(strstr(text_of(&files, "model/scene/envelope.mat"), "air_boundary"));
    orl_text_files_done(&files);
    json_decref(model);
}

static void test_groups_have_a_file_for_each_state(void **state)
{
    (void)state;
    static const char first[] = "model/aperture_group/south_glass..default..0.rad";
    static const char second[] = "model/aperture_group/south_glass..default..1.rad";
    json_t *model = load_model();
    struct orl_text_files files = translate(model);
    assert_has(&files, first, "generic_exterior_window_vis_0.64 polygon view_window\n");
    assert_has(&files, second, "tinted polygon view_window\n");
    assert_has(&files, second, "void glass tinted\n0\n0\n3 ");
    assert_has(&files, second, "generic_exterior_shade_0.35 polygon louvre\n");
    assert_null(strstr(text_of(&files, first), "louvre"));
    orl_text_files_done(&files);
    json_decref(model);
}

static void test_grids_and_views_have_their_names(void **state)
{
    (void)state;
    json_t *model = load_model();
    struct orl_text_files files = translate(model);
    assert_int_equal(count_substrings(text_of(&files, "model/grid/desks.pts"), "\n"), 4);
    double v[6];
    assert_int_equal(sscanf(text_of(&files, "model/grid/store/floor.pts"),
                            "%lf %lf %lf %lf %lf %lf", &v[0], &v[1], &v[2], &v[3], &v[4], &v[5]),
                     6);
    assert_float_equal(v[0], 2, 1e-12);
    assert_float_equal(v[1], 6.5, 1e-12);
    assert_true(v[3] == 0 && v[4] == 0 && v[5] > 0);
    assert_string_equal(text_of(&files, "model/view/from_door.vf"),
                        "rvu -vtv -vp 1.5 4.5 1.6000000000000001 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv "
                        "60\n");
    orl_text_files_done(&files);
    json_decref(model);
}

/* ---- Errors ---------------------------------------------------------------------------------- */

/* Returns a value by a path of members and indices, such as "rooms 0 faces". */
static json_t *at_path(json_t *value, const char *path)
{
    char word[40];
    int length;
    for (; sscanf(path, "%39s%n", word, &length) == 1; path += length)
        value = json_is_array(value) ? json_array_get(value, (size_t)atoi(word))
                                     : json_object_get(value, word);
    assert_non_null(value);
    return value;
}

static void test_mistakes_are_told_by_their_place(void **state)
{
    (void)state;
    static const struct {
        const char *holder, *member, *value, *wanted;
    } cases[] = {
        {"", "type", "\"Room\"", "type: the document is not a Honeybee model"},
        {"", "units", "\"Miles\"", "units: one of Meters"},
        {"", "rooms", "{}", "rooms: a list is expected"},
        {"rooms 0 properties radiance", "modifier_set", "\"none\"",
         "rooms[0].properties.radiance.modifier_set: the model has no such modifier set"},
        {"rooms 0 faces 0 properties radiance", "modifier", "\"rug\"",
         "rooms[0].faces[0].properties.radiance.modifier: the model has no modifier 'rug'"},
        {"rooms 0 faces 0", "face_type", "\"Slab\"", "rooms[0].faces[0].face_type: one of Wall"},
        {"rooms 0 faces 0 geometry", "boundary", "[[0,0,0],[1,0,0]]",
         "rooms[0].faces[0].geometry.boundary: three points"},
        {"rooms 0 faces 0 geometry", "boundary", "[[0,0,0],[1,0,0],[1,\"a\",0]]",
         "rooms[0].faces[0].geometry.boundary[2][1]: a number"},
        {"rooms 0 faces 0 geometry", "boundary", "[[0,0,0],[1,0,0],[1,1e99,0]]", "boundary[2][1]"},
        {"properties radiance modifiers 0", "type", "\"Wood\"", "carpet.type: modifiers of type"},
        {"properties radiance modifiers 0", "r_reflectance", "2",
         "carpet.r_reflectance: it must be from"},
        {"properties radiance modifiers 0", "identifier", "\"a b\"",
         "properties.radiance.modifiers[0].identifier: an identifier"},
        {"properties radiance modifiers 0", "modifier", "\"carpet\"", "depends on itself"},
        {"properties radiance sensor_grids 0", "identifier", "\"../desks\"",
         "sensor_grids[0].identifier: an identifier"},
        {"properties radiance sensor_grids 0", "group_identifier", "\"a/../b\"",
         "sensor_grids[0].group_identifier: an identifier"},
        {"properties radiance sensor_grids 0 sensors 1", "dir", "[0,0,0]",
         "sensor_grids[0].sensors[1].dir: the direction has no length"},
        {"properties radiance views 0", "view_type", "\"x\"", "views[0].view_type: one of v"},
        {"shade_meshes 0 geometry", "faces", "[[0,1,9]]",
         "shade_meshes[0].geometry.faces[0]: the mesh has corners 0 to 3"},
        {"", "buildings", "[]", "buildings: this is a Dragonfly model"},
        {"properties radiance", "luminaires", "[1]", "luminaires[0].identifier: an identifier"},
        {"properties radiance", "luminaires", "[{\"identifier\": \"a\"}]",
         "luminaires[0].ies_content: the text of an IES"},
        {"properties radiance", "luminaires",
         "[{\"identifier\": \"a\", \"ies_content\": \"IESNA\"}]",
         "luminaires[0].luminaire_zone.instances: the luminaire has no instances"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        json_t *model = load_model();
        struct orl_text_files files = {0};
        struct orl_error err = {0};
        json_t *value = json_loads(cases[i].value, JSON_DECODE_ANY, NULL);
        json_object_set_new(at_path(model, cases[i].holder), cases[i].member, value);
        assert_true(orl_hbjson_translate(model, &files, &err) < 0);
        if (!strstr(err.message, cases[i].wanted))
            fail_msg("\"%s\" is not in: %s", cases[i].wanted, err.message);
        assert_int_equal(files.count, 0);
        json_decref(model);
    }
}

/* ---- Luminaires ------------------------------------------------------------------------------ */

static const char luminaires_text[] =
    "[{\"identifier\": \"spot\", \"ies_content\": \"IESNA:LM-63-2002\\n\", \"light_loss_factor\": "
    "0.5,"
    "  \"candela_multiplier\": 3, \"luminaire_zone\": {\"instances\": ["
    "   {\"point\": {\"type\": \"Point3D\", \"x\": 1, \"y\": 2, \"z\": 2.5}, \"spin\": 30, "
    "\"tilt\": 20},"
    "   {\"point\": [3, 2, 2.5], \"rotation\": 90}]}},"
    " {\"identifier\": \"spot\", \"ies_content\": \"IES\", \"custom_lamp\": {\"name\": \"a b\","
    "  \"depreciation_factor\": 0.5, \"white_xy\": [0.4, 0.3], \"rgb\": null},"
    "  \"luminaire_zone\": {\"instances\": [{\"point\": [0, 0, 1]}]}},"
    " {\"identifier\": \"spot\", \"ies_content\": \"IES\", \"custom_lamp\": {\"rgb\": [1, 0.5, 0]},"
    "  \"luminaire_zone\": {\"instances\": [{\"point\": [0, 0, 2]}]}}]";

/* Luminaires are placed as by Honeybee with ies2rad and xform, each under its own name. */
static void test_luminaires_hang_in_their_places(void **state)
{
    (void)state;
    json_t *model = load_model();
    json_t *radiance = json_object_get(json_object_get(model, "properties"), "radiance");
    json_object_set_new(radiance, "luminaires", json_loads(luminaires_text, 0, NULL));
    json_object_set_new(model, "units", json_string("Feet"));
    struct orl_text_files files = translate(model);
    assert_string_equal(
        text_of(&files, "model/ies/luminaires.rad"),
        "!ies2rad -df -m 1.5 model/ies/0_spot.ies | xform -rz 30 -ry 20 -rz 0 -t 1 2 2.5\n"
        "!ies2rad -df -m 1.5 model/ies/0_spot.ies | xform -rz 0 -ry 0 -rz 90 -t 3 2 2.5\n"
        "!ies2rad -df -m 0.5 -t own -f model/ies/1_spot.tab model/ies/1_spot.ies | xform -rz 0 -ry "
        "0 -rz 0 -t 0 0 1\n"
        "!ies2rad -df -m 1 -t default -c 1 0.5 0 model/ies/2_spot.ies | xform -rz 0 -ry 0 -rz 0 -t "
        "0 0 2\n");
    assert_string_equal(text_of(&files, "model/ies/0_spot.ies"), "IESNA:LM-63-2002\n");
    assert_string_equal(text_of(&files, "model/ies/1_spot.tab"), "/own/ 0.4 0.3 0.5\n");
    orl_text_files_done(&files);
    json_decref(model);
}

/* ---- Projects -------------------------------------------------------------------------------- */

/* Opens files of these names, all with one text. */
static struct orl_files open_names(struct orl_memory_files *memory, const char *const *names,
                                   struct orl_file *contents, size_t n)
{
    *memory = (struct orl_memory_files){names, contents, n};
    return orl_files_from_memory(memory);
}

static const char states_text[] =
    "{\"south\": [{\"identifier\": \"0_south\", \"default\": \"./south..default..0.rad\"},"
    " {\"identifier\": \"1_south\", \"default\": \"./south..default..1.rad\"}]}";

static json_t *find_project(const char *states, const char *sky, struct orl_error *err)
{
    static const char *const names[] = {"p/model/scene/b.rad",
                                        "p/model/scene/b.mat",
                                        "p/model/scene/b.blk",
                                        "p/model/scene/a.rad",
                                        "p/model/aperture/z.mat",
                                        "p/model/aperture/z.rad",
                                        "p/model/aperture_group/states.json",
                                        "p/model/aperture_group/south..default..0.rad",
                                        "p/model/aperture_group/south..default..1.rad",
                                        "p/model/aperture_group/south..direct..0.rad",
                                        "p/model/grid/_info.json",
                                        "p/model/grid/g/desks.pts",
                                        "p/model/grid/old.pts",
                                        "p/model/view/eye.vf",
                                        "p/model/sky/noon.sky",
                                        "p/model/sky/dusk.rad",
                                        "p/notes.rad",
                                        "p/model/ies/spot.rad",
                                        "p/model/ies/__spot__.rad",
                                        "p/model/ies/__lamp__.rad"};
    enum { N = sizeof names / sizeof *names };
    static const char info[] = "[{\"full_id\": \"g/desks\", \"name\": \"Desks\"}]";
    struct orl_file contents[N] = {{0}};
    struct orl_memory_files memory;
    json_t *wishes = states ? json_loads(states, 0, NULL) : NULL, *project = NULL;
    const struct orl_project_choice choice = {wishes, sky};
    contents[6] = (struct orl_file){states_text, sizeof states_text - 1, NULL};
    contents[10] = (struct orl_file){info, sizeof info - 1, NULL};
    const struct orl_files files = open_names(&memory, names, contents, N);
    orl_project_find(names, N, &files, &choice, &project, err);
    json_decref(wishes);
    return project;
}

static void assert_list(const json_t *list, const char *wanted)
{
    char *text = json_dumps(list, JSON_COMPACT);
    assert_string_equal(text, wanted);
    free(text);
}

static void test_a_folder_is_found_by_its_names(void **state)
{
    (void)state;
    struct orl_error err = {0};
    json_t *project = find_project("{\"south\": \"1_south\"}", "noon", &err);
    assert_non_null(project);
    assert_list(json_object_get(project, "files"),
                "[\"p/model/scene/b.mat\",\"p/model/aperture/z.mat\",\"p/model/scene/a.rad\","
                "\"p/model/scene/b.rad\",\"p/model/aperture/z.rad\",\"p/model/ies/__lamp__.rad\","
                "\"p/model/ies/spot.rad\","
                "\"p/model/aperture_group/south..default..1.rad\",\"p/model/sky/noon.sky\"]");
    assert_list(json_object_get(project, "grids"),
                "[{\"name\":\"g/desks\",\"sensors\":{\"file\":\"p/model/grid/g/desks.pts\"}}]");
    assert_list(json_object_get(project, "skies"), "[\"dusk\",\"noon\"]");
    assert_list(json_object_get(project, "states"),
                "{\"south\":{\"chosen\":\"1_south\",\"of\":[\"0_south\",\"1_south\"],\"files\":["
                "\"p/model/aperture_group/south..default..0.rad\","
                "\"p/model/aperture_group/south..default..1.rad\"]}}");
    const json_t *left = json_object_get(project, "left_out");
    assert_int_equal(json_array_size(left), 5);
    assert_list(json_array_get(left, 1),
                "{\"file\":\"p/model/grid/old.pts\",\"why\":\"grid/_info.json does not name it\"}");
    assert_list(json_array_get(left, 2),
                "{\"file\":\"p/model/ies/__spot__.rad\",\"why\":\"another file places it\"}");
    assert_list(json_array_get(left, 4),
                "{\"file\":\"p/notes.rad\",\"why\":\"it lies outside the model's folder\"}");
    json_decref(project);
}

static void test_wishes_that_nothing_meets_are_refused(void **state)
{
    (void)state;
    struct orl_error err = {0};
    assert_null(find_project("{\"south\": \"open\"}", NULL, &err));
    assert_non_null(strstr(err.message, "no state 'open'"));
    assert_null(find_project("{\"north\": \"open\"}", NULL, &err));
    assert_non_null(strstr(err.message, "no group 'north'"));
    assert_null(find_project(NULL, "dawn", &err));
    assert_non_null(strstr(err.message, "no sky 'dawn'"));
    /* With two skies and no choice, neither is used. */
    json_t *project = find_project(NULL, NULL, &err);
    assert_int_equal(json_array_size(json_object_get(project, "files")), 8);
    json_decref(project);
}

/* A model without faces has no folder "scene". */
static void test_openings_alone_are_a_project(void **state)
{
    (void)state;
    static const char *const names[][2] = {
        {"model/aperture/aperture.mat", "model/aperture/aperture.rad"},
        {"model/scene_dynamic/states.json", "model/scene_dynamic/south..default..0.rad"}};
    for (size_t i = 0; i < 2; i++) {
        const struct orl_project_choice choice = {NULL, NULL};
        struct orl_file contents[2] = {{"{}", 2, NULL}, {"", 0, NULL}};
        struct orl_memory_files memory;
        struct orl_error err = {0};
        json_t *project = NULL;
        const struct orl_files files = open_names(&memory, names[i], contents, 2);
        assert_int_equal(orl_project_find(names[i], 2, &files, &choice, &project, &err), 0);
        assert_non_null(project);
        json_decref(project);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surfaces_are_in_their_files),
        cmocka_unit_test(test_openings_are_cut_out),
        cmocka_unit_test(test_the_second_side_stands_back),
        cmocka_unit_test(test_faces_look_outwards),
        cmocka_unit_test(test_a_plane_says_which_way),
        cmocka_unit_test(test_orphaned_pairs_are_one),
        cmocka_unit_test(test_the_last_of_two_modifiers_counts),
        cmocka_unit_test(test_grids_of_one_identifier_are_told),
        cmocka_unit_test(test_views_of_one_identifier_are_told),
        cmocka_unit_test(test_an_air_boundary_is_not_there),
        cmocka_unit_test(test_groups_have_a_file_for_each_state),
        cmocka_unit_test(test_grids_and_views_have_their_names),
        cmocka_unit_test(test_luminaires_hang_in_their_places),
        cmocka_unit_test(test_mistakes_are_told_by_their_place),
        cmocka_unit_test(test_a_folder_is_found_by_its_names),
        cmocka_unit_test(test_openings_alone_are_a_project),
        cmocka_unit_test(test_wishes_that_nothing_meets_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
