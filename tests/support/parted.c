#include "support/parted.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "support/room.h"

const char *const parted_render = "render.json";
const char *const parted_skies = "skies.json";
const char *const parted_middle = "middle.json";
const char *const parted_long = "long.json";
const char *const parted_goal = "goal.json";
const char *const parted_annual = "annual.json";
const char *const parted_study = "study-job.json";
const char *const parted_panel = "panel.json";
const char *const parted_tree = "tree.json";
const char *const parted_colors = "colors.json";

#define LIT "\"scene\": {\"files\": [\"room.rad\", \"sky.rad\"]}"
#define UNLIT "\"scene\": {\"files\": [\"room.rad\"]}"
#define SENSORS "\"sensors\": {\"file\": \"desks.pts\"}"
#define VIEW(NAME)                                                                                 \
    "{\"name\": \"" NAME "\", \"view\": \"-vtv -vp 2 4.5 1.5 -vd 0 -1 -0.2 -vu 0 0 1 -vh 80"       \
    " -vv 60\", \"width\": 40, \"height\": 30}"

static const char room_text[] = ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE;
static const char sky_text[] = ROOM_SKY ROOM_SUN;

static const char render_text[] = "{\"kind\": \"render\", " LIT ", " SENSORS
                                  ", \"technique\": \"gather\", \"gather_samples\": 64, \"photons\""
                                  ": {\"global\": 20000, \"caustic\": 0},"
                                  " \"views\": [" VIEW("one") ", " VIEW("two") "]}";
static const char goal_text[] =
    "{\"kind\": \"render\", " LIT ", \"sensors\": {\"file\": \"few.pts\"}"
    ", \"technique\": \"backward\", \"accuracy\": {\"relative_error\":"
    " 0.5}, \"views\": [" VIEW("one") "]}";

#define CIE(NAME, UP)                                                                              \
    "{\"name\": \"" NAME "\", \"cie\": {\"type\": \"clear\", \"sun_altitude\": " UP                \
    ", \"sun_azimuth\": 10, \"diffuse_horizontal_lx\": 10000, \"direct_normal_lx\": 50000}}"
#define SKIES(SAMPLES, PHOTONS)                                                                    \
    "{\"kind\": \"render\", " UNLIT ", " SENSORS                                                   \
    ", \"technique\": \"precomputed\", \"gather_samples\": " SAMPLES                               \
    ", \"photons\": {\"global\": " PHOTONS                                                         \
    ", \"caustic\": 0}, \"views\": [" VIEW("one") "], \"skies\": [" CIE("a", "10") ", " CIE(       \
        "b", "25") ", " CIE("c", "40") ", " CIE("d", "55") ", " CIE("e", "70") "]}"
static const char skies_text[] = SKIES("64", "10000"), middle_text[] = SKIES("512", "25000"),
                  long_text[] = SKIES("1024", "50000");

static const char annual_text[] =
    "{\"kind\": \"annual\", " UNLIT ", \"weather\": \"place.epw\", \"samples\": 64, \"seed\": 3,"
    " \"grids\": [{\"name\": \"desks\", \"sensors\": {\"file\": \"some.pts\"}}],"
    " \"targets\": [\"sDA300/50 >= 55 %\"]}";

static const char study_text[] =
    "{\"kind\": \"study\", " LIT ", \"sensors\": {\"file\": \"some.pts\"}"
    ", \"techniques\": [\"gather\", \"backward\"], \"photons\": [5000, 20000], \"gather_samples\": "
    "[32],"
    " \"repeats\": 2, \"reference\": {\"samples\": 192, \"runs\": 3},"
    " \"points\": [{\"name\": \"By hand\", \"seconds\": 60, \"rms\": 0.5, \"rays_per_s\": 1e6}]}";

#define PANEL                                                                                      \
    "{\"kind\": \"bsdf_make\", \"scene\": {\"files\": [\"slats.rad\"]}, \"cell\": {\"x\": [0, "    \
    "0.1], \"y\":"                                                                                 \
    " [0, 0.1]}, "
static const char slats_text[] =
    "void plastic slat\n0\n0\n5 .7 .6 .4 0 0\n"
    "slat polygon one\n0\n0\n12 0 0 0  .1 0 0  .1 .06 .06  0 .06 .06\n";
static const char panel_text[] =
    PANEL "\"basis\": \"klems_quarter\", \"paths\": 128, \"paths_most\": 512, \"accuracy\": 0.1}";
static const char tree_text[] =
    PANEL "\"basis\": \"tensor_tree_4\", \"resolution\": 8, \"paths\": 64, \"paths_most\": 256,"
          " \"accuracy\": 0.3}";
static const char colors_text[] =
    PANEL "\"basis\": \"tensor_tree_4\", \"resolution\": 8, \"paths\": 64, \"color\": true}";

static void write_sensors(const char *folder, const char *name, int n)
{
    static char text[16384];
    size_t at = 0;
    for (int i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, sizeof text - at, "%g %g 0.8 0 0 1\n",
                               0.3 + 0.17 * (i % 20), 0.4 + 0.28 * (double)(i / 20));
    cli_write_file(folder, name, text);
}

int parted_set_up(void **state)
{
    static const struct cli_file files[] = {
        {"render.json", render_text},   {"goal.json", goal_text},
        {"skies.json", skies_text},     {"middle.json", middle_text},
        {"long.json", long_text},       {"annual.json", annual_text},
        {"study-job.json", study_text}, {"panel.json", panel_text},
        {"tree.json", tree_text},       {"slats.rad", slats_text},
        {"colors.json", colors_text},   {"room.rad", room_text},
        {"sky.rad", sky_text},          {NULL, NULL}};
    const int code = cli_desk_set_up(state, files);
    const char *folder = ((struct cli_desk *)*state)->folder;
    char *weather = cli_read_file("tests/fixtures", "weather.epw");
    assert_non_null(weather);
    cli_write_file(folder, "place.epw", weather);
    free(weather);
    write_sensors(folder, "desks.pts", 300);
    write_sensors(folder, "some.pts", 150);
    write_sensors(folder, "few.pts", 40);
    return code;
}

static const char *command_of(const char *document)
{
    return strcmp(document, parted_annual) == 0  ? "annual"
           : strcmp(document, parted_study) == 0 ? "study"
                                                 : "run";
}

void parted_run(struct cli_desk *desk, const char *document, const char *output,
                const char *const *options)
{
    char path[160], to[160];
    const char *args[16] = {command_of(document), path, "-o", to, "--threads", "1"};
    size_t n = 6;
    snprintf(path, sizeof path, "%s/%s", desk->folder, document);
    snprintf(to, sizeof to, "%s/%s", desk->folder, output);
    while (options && *options)
        args[n++] = *options++;
    cli_run(args, &desk->result);
    if (desk->result.exit_code != 0)
        fail_msg("%s: %s", document, desk->result.err);
}

/* ---- Comparison ------------------------------------------------------------------------------ */

/* Returns true if the member depends on the run, not on the job. */
static bool is_of_run(const char *member)
{
    static const char *const members[] = {"timings_s", "seconds",  "cost",   "cost_s",
                                          "health",    "plan",     "maps",   "reuse",
                                          "rays",      "on_front", "here_s", "rays_per_s"};
    for (size_t i = 0; i < sizeof members / sizeof *members; i++)
        if (strcmp(members[i], member) == 0)
            return true;
    return false;
}

static void leave_out(json_t *json)
{
    const char *member;
    json_t *value;
    void *next;
    size_t i;
    json_object_foreach_safe(json, next, member, value)
    {
        if (is_of_run(member))
            json_object_del(json, member);
        else
            leave_out(value);
    }
    json_array_foreach(json, i, value)
    {
        leave_out(value);
    }
}

/* Returns true for files with times, which differ between runs. */
static bool is_of_study(const char *name)
{
    return strncmp(name, "study.", 6) == 0 && strcmp(name, "study.json") != 0;
}

static void assert_same_json(const char *one, const char *other, const char *name)
{
    char *texts[2] = {cli_read_file(one, name), cli_read_file(other, name)};
    json_t *json[2];
    for (int i = 0; i < 2; i++) {
        assert_non_null(texts[i]);
        json[i] = json_loads(texts[i], 0, NULL);
        assert_non_null(json[i]);
        leave_out(json[i]);
    }
    if (!json_equal(json[0], json[1]))
        fail_msg("%s differs:\n%s\n%s", name, json_dumps(json[0], JSON_SORT_KEYS),
                 json_dumps(json[1], JSON_SORT_KEYS));
    for (int i = 0; i < 2; i++) {
        json_decref(json[i]);
        free(texts[i]);
    }
}

static void assert_same_bytes(const char *one, const char *other, const char *name)
{
    char paths[2][500];
    FILE *files[2];
    int a, b;
    snprintf(paths[0], sizeof paths[0], "%s/%s", one, name);
    snprintf(paths[1], sizeof paths[1], "%s/%s", other, name);
    for (int i = 0; i < 2; i++)
        if (!(files[i] = fopen(paths[i], "rb")))
            fail_msg("%s is not there", paths[i]);
    do {
        a = getc(files[0]);
        b = getc(files[1]);
        if (a != b)
            fail_msg("%s differs", name);
    } while (a != EOF);
    fclose(files[0]);
    fclose(files[1]);
}

void parted_assert_same(const struct cli_desk *desk, const char *one, const char *other)
{
    char paths[2][160];
    int compared = 0;
    snprintf(paths[0], sizeof paths[0], "%s/%s", desk->folder, one);
    snprintf(paths[1], sizeof paths[1], "%s/%s", desk->folder, other);
    DIR *folder = opendir(paths[0]);
    assert_non_null(folder);
    for (const struct dirent *file; (file = readdir(folder)) != NULL;) {
        const char *name = file->d_name, *ending = strrchr(name, '.');
        if (name[0] == '.' || strcmp(name, "maps") == 0 || is_of_study(name))
            continue;
        if (ending && strcmp(ending, ".json") == 0)
            assert_same_json(paths[0], paths[1], name);
        else
            assert_same_bytes(paths[0], paths[1], name);
        compared++;
    }
    closedir(folder);
    assert_true(compared > 0);
}

void parted_compare(struct cli_desk *desk, const char *document, const char *const *options)
{
    char whole[160];
    snprintf(whole, sizeof whole, "%s/whole", desk->folder);
    if (access(whole, F_OK) != 0) /* a desk compares runs of one document */
        parted_run(desk, document, "whole", NULL);
    parted_run(desk, document, "parts", options);
    assert_non_null(strstr(desk->result.err, "parts: "));
    parted_assert_same(desk, "whole", "parts");
}
