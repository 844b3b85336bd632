#include "support/text_readers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/annual/annual_metrics.h>
#include <oriel/annual/annual_report.h>
#include <oriel/bsdf/bsdf.h>
#include <oriel/job/run.h>

#include "annual/matrices/imported_matrices.h"
#include "bsdf/fit/measurements/measurements.h"
#include "light/daylight/weather.h"
#include "project/project.h"
#include "run/run_state.h"
#include "scene/generate/mgf/mgf.h"
#include "scene/grid/ies.h"
#include "scene/parse/luminaire/luminaires.h"
#include "scene/parse/mesh/mesh_formats.h"
#include "scene/parse/parse.h"

static void note_value(struct text_values *values, double value)
{
    const size_t left = sizeof values->text - values->length;
    const int n = snprintf(values->text + values->length, left, "%.17g ", value);
    assert_true(n > 0 && (size_t)n < left);
    values->length += (size_t)n;
}

static void note_all(struct text_values *values, const double *from, size_t n)
{
    for (size_t i = 0; i < n; i++)
        note_value(values, from[i]);
}

/* NULL counts as the empty text. */
static void note_text(struct text_values *values, const char *text)
{
    const int n = snprintf(values->text, sizeof values->text, "%s", text ? text : "");
    assert_true(n >= 0 && (size_t)n < sizeof values->text);
    values->length = (size_t)n;
}

/* ---- Readers --------------------------------------------------------------------------------- */

static int note_sensor(void *ctx, const double v[6])
{
    note_all(ctx, v, 6);
    return 0;
}

static int read_sensors(const char *text, size_t size, struct text_values *values,
                        struct orl_error *err)
{
    return orl_sensors_read("a.pts", text, size, note_sensor, values, err);
}

static int read_weather(const char *text, size_t size, struct text_values *values,
                        struct orl_error *err)
{
    struct orl_weather weather = {0};
    const int code = orl_weather_parse("a.epw", text, size, 0, &weather, err);
    note_value(values, weather.latitude_deg);
    note_value(values, weather.longitude_deg);
    for (size_t i = 0; i < weather.n_rows; i++) {
        const struct orl_weather_row *row = &weather.rows[i];
        note_all(values, (const double[]){row->month, row->day, row->hour, row->line}, 4);
        note_all(values, (const double[]){row->direct, row->diffuse}, 2);
    }
    orl_weather_done(&weather);
    return code;
}

/* Reads occupancy marks for a year of two steps. */
static int read_occupancy(const char *text, size_t size, struct text_values *values,
                          struct orl_error *err)
{
    static const struct orl_annual_steps two = {2, 1};
    unsigned char marks[2] = {0};
    const int code = orl_occupancy_read("use.csv", text, size, &two, marks, err);
    note_all(values, (const double[]){marks[0], marks[1]}, 2);
    return code;
}

static int read_schedule(const char *text, size_t size, struct text_values *values,
                         struct orl_error *err)
{
    static char name[] = "s.csv", south[] = "south", open[] = "open", shut[] = "shut";
    static const char *const names[] = {name};
    const struct orl_file contents[] = {{text, size, NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_shade_state states[2] = {{.name = open}, {.name = shut}};
    struct orl_window_group group = {
        .name = south, .states = states, .n_states = 2, .schedule_file = name};
    struct orl_annual_request request = {.groups = &group, .n_groups = 1};
    const int code = orl_annual_schedules_read(&request, &files, err);
    for (size_t i = 0; i < group.n_series; i++)
        note_value(values, group.series[i]);
    free(group.series);
    return code;
}

static int read_matrix(const char *text, size_t size, struct text_values *values,
                       struct orl_error *err)
{
    struct orl_rgb_matrix matrix = {.rows = 0};
    const int code = orl_rgb_matrix_read("a.mtx", text, size, &matrix, err);
    note_all(values, (const double[]){(double)matrix.rows, (double)matrix.columns}, 2);
    for (size_t i = 0; i < 3 * matrix.rows * matrix.columns; i++)
        note_value(values, (double)matrix.values[i]);
    orl_rgb_matrix_done(&matrix);
    return code;
}

static int read_grid(const char *text, size_t size, struct text_values *values,
                     struct orl_error *err)
{
    struct orl_grid *grid = NULL;
    const int code = orl_grid_read_data("a.dat", text, size, &grid, err);
    for (size_t i = 0; grid && i < grid->n_values; i++)
        note_value(values, (double)grid->values[i]);
    for (size_t i = 0; grid && i < grid->n_axes; i++)
        note_all(values, (const double[]){grid->axes[i].origin, grid->axes[i].size}, 2);
    orl_grid_free(grid);
    return code;
}

static int read_ies(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    struct orl_ies ies = {0};
    const int code = orl_ies_read("a.ies", text, size, &ies, err);
    note_all(values, (const double[]){ies.year, ies.factor, ies.length, ies.width}, 4);
    for (uint32_t i = 0; code == 0 && i < ies.n_vertical; i++)
        note_all(values, (const double[]){ies.vertical[i], (double)ies.candela[i]}, 2);
    if (code == 0)
        orl_ies_done(&ies);
    return code;
}

static int note_face(void *ctx, const struct orl_wavefront_face *face, struct orl_error *err)
{
    (void)err;
    note_value(ctx, face->line);
    for (size_t i = 0; i < face->n_corners; i++)
        note_all(ctx, (const double[]){face->corners[i].x, face->corners[i].y, face->corners[i].z},
                 3);
    return 0;
}

static int read_obj(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    const struct orl_wavefront_sink sink = {note_face, values};
    struct orl_wavefront_ignored rest;
    return orl_wavefront_read("a.obj", text, size, &sink, &rest, err);
}

static int note_facet(void *ctx, const struct orl_vec3 corners[3], int line, struct orl_error *err)
{
    (void)err;
    note_value(ctx, line);
    for (size_t i = 0; i < 3; i++)
        note_all(ctx, (const double[]){corners[i].x, corners[i].y, corners[i].z}, 3);
    return 0;
}

static int read_stl(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    const struct orl_stl_sink sink = {note_facet, values};
    return orl_stl_read("a.stl", text, size, &sink, err);
}

static int read_measured(const char *text, size_t size, struct text_values *values,
                         struct orl_error *err)
{
    const struct orl_fit_read_options reading = {.reversed = false};
    struct orl_fit_data data = {0};
    const int code = orl_fit_read("a.txt", 0, text, size, &reading, &data, err);
    for (size_t i = 0; i < data.n_scans; i++)
        for (size_t k = 0; k < data.scans[i].n_rows; k++) {
            const struct orl_fit_row *row = &data.scans[i].rows[k];
            note_all(values, (const double[]){data.scans[i].theta_deg, row->line}, 2);
            note_all(values, (const double[]){(double)row->x, (double)row->value}, 2);
        }
    orl_fit_data_done(&data);
    return code;
}

static int read_mgf(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    const struct orl_mgf mgf = {.text = {"a.mgf", "", 1, text, size}, .unit_m = 1, .emission = 1};
    struct orl_text scene = {.data = NULL};
    const int code = orl_mgf_write(&mgf, &scene, err);
    note_text(values, scene.data);
    orl_text_done(&scene);
    return code;
}

static int read_rif(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    json_t *project = NULL;
    const int code = orl_rif_read("a.rif", text, size, &project, err);
    char *const dump = json_dumps(project, JSON_COMPACT);
    note_text(values, dump);
    free(dump);
    json_decref(project);
    return code;
}

static int read_xml(const char *text, size_t size, struct text_values *values,
                    struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_info info;
    const int code = orl_bsdf_load_xml("a.xml", text, size, &bsdf, err);
    if (code < 0)
        return code;
    orl_bsdf_describe(bsdf, &info);
    note_all(values, (const double[]){info.max_albedo[0], info.max_albedo[1]}, 2);
    note_all(values, (const double[]){info.thickness_m, (double)info.values}, 2);
    note_value(values, (double)info.skipped_bytes);
    orl_bsdf_unref(bsdf);
    return code;
}

static int read_scene(const char *text, size_t size, struct text_values *values,
                      struct orl_error *err)
{
    static const char *const names[] = {"a.rad"};
    const struct orl_file contents[] = {{text, size, NULL}};
    struct orl_memory_files memory = {names, contents, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, err);
    for (uint32_t i = 0; code == 0 && i < parsed_scene.n_surfaces; i++) {
        const struct orl_vec3 *v = parsed_scene.surfaces[i].vertices;
        for (uint32_t k = 0; v && k < parsed_scene.surfaces[i].n_vertices; k++)
            note_all(values, (const double[]){v[k].x, v[k].y, v[k].z}, 3);
        note_value(values, parsed_scene.surfaces[i].line);
    }
    orl_parsed_scene_done(&parsed_scene);
    return code;
}

static int read_view(const char *text, size_t size, struct text_values *values,
                     struct orl_error *err)
{
    char *view = NULL;
    const int code = orl_view_file_read("a.vf", text, size, "1", &view, err);
    note_text(values, view);
    free(view);
    return code;
}

static int read_frads(const char *text, size_t size, struct text_values *values,
                      struct orl_error *err)
{
    json_t *project = NULL;
    const int code = orl_frads_read("a.cfg", text, size, &project, err);
    char *const dump = json_dumps(project, JSON_COMPACT);
    note_text(values, dump);
    free(dump);
    json_decref(project);
    return code;
}

static int read_lamps(const char *text, size_t size, struct text_values *values,
                      struct orl_error *err)
{
    struct orl_lamp_table table = {.name = "a.tab", .text = text, .size = size, .steps = 1 << 20};
    struct orl_lamp_entry lamp = {.x = 0};
    const int code = orl_lamp_find(&table, "halogen", 7, &lamp, err);
    note_all(values, (const double[]){lamp.x, lamp.y, lamp.share}, 3);
    return code < 0 ? code : 0;
}

static int read_rules(const char *text, size_t size, struct text_values *values,
                      struct orl_error *err)
{
    static const char red[] = "red";
    struct orl_material_rules *rules = NULL;
    const int code = orl_material_rules_read("a.map", text, size, &rules, err);
    if (code < 0)
        return code;
    for (uint64_t number = 1; number <= 3; number++) {
        struct orl_wavefront_face face = {.number = number};
        const char *const name = orl_material_rules_choose(rules, &face);
        note_value(values, name && strcmp(name, red) == 0);
    }
    orl_material_rules_free(rules);
    return 0;
}

#define PAB(rows) "#format: theta phi DSF\n#incident_angle 30 180\n" rows
#define FIT_COLUMNS "theta_in,phi_in,theta_out,phi_out,bsdf\n"

#define EPW(city)                                                                                  \
    "LOCATION," city ",-,TST,made up,000000,38.42,27.14,2.0,25.0\n"                                \
    "DATA PERIODS,1,1,Data,Sunday,1/1,12/31\n"
#define EPW_TO_DIRECT "2020,3,22,12,0,flags,9,7,87,101300,0,0,305,0,"
#define WEA(place)                                                                                 \
    "place " place "\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\nsite_elevation 25\n"        \
    "weather_data_file_units 1\n"

#define IES(lamp) "IESNA91\n[LAMP] " lamp "\nTILT=NONE\n"
#define STL(name, x)                                                                               \
    "solid " name "\nfacet normal 0 0 1\nouter loop\nvertex 0 0.5 0\nvertex " x                    \
    " 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"

const struct text_reader text_readers[] = {
    {"sensors",
     read_sensors,
     "# desks\n0 0.5 0.8 0 0 1\n1,0.5,0.8,0,0,1\n",
     "# Schreibtische f\xfcr zwei\n0 0.5 0.8 0 0 1\n1,0.5,0.8,0,0,1 # \xe9\n",
     {"0 0 0 0 0 1\n0,5 0,8 0,0\n", 2, "column 1: 0,5: a decimal comma; write 0.5"},
     {"0,0,0,0,0,1\n0,,0,0.8,0,0,1\n", 2, "column 3: an empty cell"}},
    {"sensors, by semicolons",
     read_sensors,
     "0;0.5;0.8;0;0;1\n",
     "0;0.5;0.8;0;0;1#\xe9\n",
     {"0;0,5;0,8;0;0;1\n", 1, "column 3: 0,5: a decimal comma; write 0.5"},
     {"0;0.5;0.8;0;0;\n", 1, "column 15: an empty cell"}},
    {"EPW",
     read_weather,
     EPW("Zurich") EPW_TO_DIRECT "800.5,120,0\n",
     EPW("Z\xfcrich") EPW_TO_DIRECT "800.5,120,0\n",
     {EPW("A") "2020,3,22,12,0,flags,9,7,87,101300,0,0,305,0,800,5,1,2,3,4,5,6,7,8,9,1,2,3,4,5,6,7,"
               "8,9,0,1\n",
      3, "write 21.5, not 21,5"},
     {EPW("A") EPW_TO_DIRECT ",120,0\n", 3, "column 46: direct light is missing: an empty cell"}},
    {"EPW of a spreadsheet",
     read_weather,
     EPW("Zurich") EPW_TO_DIRECT "800.5,120,0\n",
     "\xef\xbb\xbf" EPW("Z\xfcrich") EPW_TO_DIRECT "800.5,120,0\n",
     {"LOCATION;A;-;TST;made up;000000;38,42;27,14;2,0;25,0\n", 1, "save it with commas"},
     {"LOCATION,A,-,TST,made up,000000,38.42,,2.0,25.0\n", 1, "the longitude is missing"}},
    {"WEA",
     read_weather,
     WEA("Zurich") "3 22 11.500 800.5 120\n",
     WEA("Z\xfcrich") "3 22 11.500 800.5 120\n",
     {WEA("A") "3 22 11,500 800.5 120\n", 7,
      "column 6: the hour: 11,500: a decimal comma; write "
      "11.500"},
     {WEA("A") "3 22 11.500 800.5\n", 7, "a row has five values: month, day, hour, direct"}},
    {"occupancy",
     read_occupancy,
     "# use\n1,1,0.5,0\n1,1,1.5,0.2\n",
     "# f\xfcr\n1,1,0.5,0\n1,1,1.5,0.2\n",
     {"0\n0,5\n", 2, "column 1: 0,5: a decimal comma; write 0.5"},
     {"1,1,0.5,0\n1,,1.5,0.2\n", 2, "column 3: an empty cell"}},
    {"occupancy, by semicolons",
     read_occupancy,
     "1;1;0.5;0\n1;1;1.5;0.2\n",
     "m\xe4rz;1;1;1\n1;1;0.5;0\n1;1;1.5;0.2\n",
     {"1;1;0,5;0\n", 1, "column 5: 0,5: a decimal comma; write 0.5"},
     {"1;;0.5;0\n1;1;1.5;0.2\n", 1, "column 3: an empty cell"}},
    {"schedule",
     read_schedule,
     "month,south\n1,open\n1,1\n",
     "m\xe4rz,south\n1,open\n# \xe9\n1,1\n",
     {"0\n0,5\n", 2, "this is a decimal comma"},
     {"month,south\n1,open\n1,\n", 3, "this is an empty cell"}},
    {"schedule, by semicolons",
     read_schedule,
     "month;\"south\"\n1,5;open\n1,5;1\n",
     "m\xe4rz;\"south\"\n1,5;open\n1,5;1\n",
     {"month;south\n1;0,5\n", 2, "this is a decimal comma"},
     {"month;south\n1;\n", 2, "this is an empty cell"}},
    {"matrix",
     read_matrix,
     "#?RADIANCE\nNROWS=2\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n1 2.5 3\n4\t5 6\n",
     "#?RADIANCE\nrcontrib f\xfcr\nNROWS=2\nNCOLS=1\nNCOMP=3\nFORMAT=ascii\n\n1 2.5 3\n4\t5 6\n",
     {"#?RADIANCE\nNCOLS=1\nFORMAT=ascii\n\n1 2 3\n4 0,5 6\n", 6,
      "column 3: 0,5: a decimal comma; write 0.5"},
     {"#?RADIANCE\nNCOLS=1\nFORMAT=ascii\n\n1 2 3\n4 ,, 6\n", 6, "column 3: ',,' is not"}},
    {"data file",
     read_grid,
     "# a lamp\n1\n0 90 3\n0.5 1 2 # end\n",
     "# f\xfcr\n1\n0 90 3\n0.5 1 2# \xe9\n",
     {"1\n0 90 3\n0,5 1 2\n", 3, "column 1: 0,5: a decimal comma"},
     {"1\n0 90 3\n0.5 , 2\n", 3, "column 5: ',' is not a number"}},
    {"IES",
     read_ies,
     IES("a") "1 1000 1 2 1 1 2 .3 .6 0\n1,1,40\n0,90\n0\n1.5,\n0.5\n",
     IES("f\xfcr") "1 1000 1 2 1 1 2 .3 .6 0\n1 1 40\n0 90\n0\n1.5 0.5\n",
     {IES("a") "1 1000 1 2 1 1 2 0,3 .6 0\n1 1 40\n0 90\n0\n1 0\n", 4,
      "column 18: 0,3: a decimal comma; write 0.3"},
     {IES("a") "1 1000 1 2 1 1 2 .3 .6 0\n1 1 40\n0,,90\n0\n1 0\n", 6, "column 3: an empty cell"}},
    {"measurements of pab-opto",
     read_measured,
     PAB("60 0 0.5\n# more\n45.5 10 1e-3\n"),
     PAB("60 0 0.5\n# f\xfcr\n45.5 10 1e-3\n"),
     {PAB("60 0 0,5\n"), 3, "column 6: the value: 0,5: a decimal comma; write 0.5"},
     {PAB("60 0\n"), 3, "the value is missing: an empty cell"}},
    {"measurements as CSV",
     read_measured,
     FIT_COLUMNS "30,180,60,0,0.5\n30,180,45.5,10,1e-3\n",
     FIT_COLUMNS "30,180,60,0,0.5\n30,180,45.5,10,1e-3\n# \xe9\n",
     {"theta_in;phi_in;theta_out;phi_out;bsdf\n30;180;60;0;0,5\n", 2,
      "column 13: bsdf: 0,5: a decimal comma; write 0.5"},
     {FIT_COLUMNS "30,180,,0,0.5\n", 2, "column 8: theta_out is missing: an empty cell"}},
    {"MGF",
     read_mgf,
     "# a\nm w =\n\trd 0.5\nv a =\n\tp 0 0 0\nv b =\n\tp 1.5 0 0\nv c =\n\tp 0 1 0\nf a b \\\nc\n",
     "# f\xfcr\nm w =\n\trd 0.5\nv a =\n\tp 0 0 0\nv b =\n\tp 1.5 0 0\nv c =\n\tp 0 1 0\nf a b "
     "c\n",
     {"v a =\n\tp 0 0,5 0\n", 2, "0,5: a decimal comma"},
     {"v a =\n\tp 0 0\n", 2, "it takes 3 words, not 2"}},
    {"rif",
     read_rif,
     "# a\nscene= a.rad \\\n 'b c.rad' # b\nRES= 400 300 0.5\nview= up -vp 0 0.5 0\n",
     "# f\xfcr\nscene= a.rad \\\n 'b c.rad' # \xe9\nRES= 400 300 0.5\nview= up -vp 0 0.5 0\n",
     {"scene= a.rad\nRES= 400 300 0,5\n", 2, "this is a decimal comma: 0,5 (Write a point)"},
     {"scene= a.rad\nscene= \"\"\n", 2, "a file has no name"}},
    {"BSDF XML",
     read_xml,
     TWO_CELL_XML("a", "0.5", "0.1,\n0.2, 0.1\n0.05"),
     "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>" TWO_CELL_XML("f\xfcr", "0.5",
                                                                    "0.1,\n0.2, 0.1\n0.05"),
     {TWO_CELL_XML("a", "0.5", "0,1 0,2 0,1 0,05"), 11, "write 0.5, not 0,5"},
     {TWO_CELL_XML("a", "0.5", "0.1,0.2,0.1,"), 11, "3 values instead of the matrix's 4"}},
    {"scene",
     read_scene,
     "void plastic w\n0\n0\n5 .5 .5 .5 0 0\n# b\nw polygon p 0 0 9 0 0 0.5 1 0 0 0 1 0\n"
     "!genbox w b 1 2 \\\n 3.5\n",
     "void plastic w\n0\n0\n5 .5 .5 .5 0 0\n# f\xfcr\nw polygon p 0 0 9 0 0 0.5 1 0 0 0 1 0\n"
     "!genbox w b 1 2 \\\n 3.5\n",
     {"void plastic w 0 0 5\n.5 0,5 .5 0 0\n", 2, "this is a decimal comma: write a point"},
     {"void plastic w 0 0 5\n.5 .5 .5 0 , 0\n", 2, "an argument is not a number: ','"}},
    {"view file",
     read_view,
     "rvu -vtv -vp 0 0.5 0 -vd 0 1 0\n",
     "# f\xfcr\nrvu -vtv -vp 0 0.5 0 -vd 0 1 0\n",
     {"rvu -vtv -vp 0 0,5 0\n", 1, "this is a decimal comma"},
     {"rvu -vtv -vp 0 0.5\n", 1, "needs 3 numbers"}},
    {"table of lamps",
     read_lamps,
     "# lamps\n/tube/ .4 .4 1\n/halogen/ 0.45 0.4 0.9\n",
     "# f\xfcr\n/r\xf6hre/ .4 .4 1\n/halogen/ 0.45 0.4 0.9\n",
     {"/halogen/ 0,5 0.4 0.9\n", 1, "0,5: a decimal comma; write 0.5"},
     {"/halogen/ 0.45 0.4\n", 1, "x, y and the share of light"}},
    {"rules of materials",
     read_rules,
     "# rules\nred (Face [1:2]);\nblue;\n",
     "# f\xfcr\nred (Face [1:2]);\nblue;\n",
     {NULL, 0, NULL},
     {"red;\n();\n", 2, "a rule must begin with a material"}},
    {"frads",
     read_frads,
     "[Model]\nname = a\nscene = a.rad\n b.rad\n",
     "# f\xfcr\n[Model]\nname = a\nscene = a.rad\n b.rad\n",
     {NULL, 0, NULL},
     {NULL, 0, NULL}},
    {"OBJ",
     read_obj,
     "# a\nv 0 0 0.5\nv 1 0 0 # b\nv 0 1 \\\n 0\ng x\nf 1 2 3\n",
     "# \xfc\nv 0 0 0.5\nv 1 0 0 # \xe9\nv 0 1 \\\n 0\ng \xe4\nf 1 2 3\n",
     {"v 0 0 0\nv 0,5 0 0\n", 2,
      "column 3: a vertex or normal needs three numbers: 0,5: a decimal "
      "comma; write 0.5"},
     {"v 0 0 0\nv 0 0\n", 2, "a vertex or normal needs three numbers"}},
    {"STL",
     read_stl,
     STL("a", "1.5"),
     STL("f\xfcr", "1.5"),
     {STL("a", "1,5"), 5,
      "column 8: a vertex needs three numbers: 1,5: a decimal comma; write 1.5"},
     {STL("a", ""), 6, "column 1: a vertex needs three numbers: 'vertex' is not a number"}},
};

const size_t n_text_readers = sizeof text_readers / sizeof *text_readers;

bool text_reader_takes_utf16(const struct text_reader *reader)
{
    return reader->read == read_xml;
}
