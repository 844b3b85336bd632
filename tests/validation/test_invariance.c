/*
 * What must not matter does not: threads, repetition, units, place, orientation, the side a
 * surface's normal points to. And what a photon map is keyed by.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"
#include "support/scene_text.h"

/* A room of 4 x 5 x 3 m with a window in the south, a shelf, sun and an even sky. */
#define GREY "void plastic w 0 0 5 .5 .5 .5 0 0\n"
#define CLEAR "void glass p 0 0 3 .9 .9 .9\n"
#define SHELL                                                                                      \
    "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"                                             \
    "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"                                           \
    "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"                                              \
    "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"                                              \
    "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"                                             \
    "w polygon south 0 0 30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 "                                        \
    "1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1\n"                                                          \
    "w polygon shelf 0 0 12 0 2 1 4 2 1 4 2.4 1 0 2.4 1\n"
#define PANE "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n"
#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
#define SUN "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
#define BSDF "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n"

enum { SENSORS = 5 };
static const struct orl_sensor sensors[SENSORS] = {{{1, 3, 0}, {0, 0, 1}},
                                                   {{3, 3, 0}, {0, 0, 1}},
                                                   {{2, 4, 1.2}, {0, 0, 1}},
                                                   {{2, 4, 1.2}, {0, -1, 0}},
                                                   {{2, 3, 3}, {0, 0, -1}}};

static void assert_within(double value, double expected, double relative)
{
    if (!(fabs(value - expected) <= relative * fabs(expected)))
        fail_msg("%.6g is not within %.2g of %.6g", value, relative, expected);
}

/* ---- The same bytes ---------------------------------------------------------------------------
 */

struct bytes {
    double lx[SENSORS];
    unsigned char *data[3]; /* global map, caustic map, image */
    size_t size[3];
};

static struct bytes run_all(uint32_t threads, uint64_t seed)
{
    static const char view[] = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv 55";
    char xml[2048], folder[64], path[512];
    struct bytes b;
    scene_uniform_bsdf(0.2, xml);
    cli_make_folder(folder);
    struct orl_result result = scene_run(&(struct scene_run){.scene = SKY SUN GREY BSDF SHELL PANE,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = xml,
                                                             .sensors = sensors,
                                                             .n_sensors = SENSORS,
                                                             .view = view,
                                                             .width = 32,
                                                             .height = 24,
                                                             .seed = seed,
                                                             .global = 30000,
                                                             .caustic = 30000,
                                                             .samples = 512,
                                                             .threads = threads,
                                                             .folder = folder});
    memcpy(b.lx, result.illuminance_lx, sizeof b.lx);
    scene_map_path(&result, folder, "global", path);
    b.data[0] = scene_read_bytes(path, &b.size[0]);
    scene_map_path(&result, folder, "caustic", path);
    b.data[1] = scene_read_bytes(path, &b.size[1]);
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    b.data[2] = scene_read_bytes(path, &b.size[2]);
    orl_result_done(&result);
    cli_remove_folder(folder);
    return b;
}

static void free_bytes(struct bytes *b)
{
    for (int i = 0; i < 3; i++)
        free(b->data[i]);
}

static void test_threads(void **state)
{
    static const uint32_t threads[3] = {2, 7, 1};
    struct bytes first = run_all(1, 1);
    (void)state;
    for (int t = 0; t < 3; t++) {
        struct bytes other = run_all(threads[t], 1);
        assert_memory_equal(other.lx, first.lx, sizeof first.lx);
        for (int i = 0; i < 3; i++) {
            assert_int_equal(other.size[i], first.size[i]);
            assert_memory_equal(other.data[i], first.data[i], first.size[i]);
        }
        free_bytes(&other);
    }
    free_bytes(&first);
}

/* Another seed: every number differs, by no more than noise. */
static void test_seeds(void **state)
{
    struct bytes a = run_all(1, 1), b = run_all(1, 2);
    (void)state;
    for (int i = 0; i < SENSORS; i++) {
        assert_true(a.lx[i] != b.lx[i]);
        assert_within(a.lx[i], b.lx[i], 0.25);
    }
    for (int i = 0; i < 3; i++)
        assert_true(a.size[i] != b.size[i] || memcmp(a.data[i], b.data[i], a.size[i]) != 0);
    free_bytes(&a);
    free_bytes(&b);
}

/* ---- The same numbers -------------------------------------------------------------------------
 */

/*
 * A transform of the room's text: every vertex goes through it, sensors and sun too. Polygons only.
 */
struct change {
    double scale, turn_deg;
    struct orl_vec3 shift;
};

static struct orl_vec3 turned(const struct change *c, struct orl_vec3 v)
{
    const double s = sin(c->turn_deg * ORL_DEG_TO_RAD), k = cos(c->turn_deg * ORL_DEG_TO_RAD);
    return orl_v3(k * v.x - s * v.y, s * v.x + k * v.y, v.z);
}

static struct orl_vec3 moved(const struct change *c, struct orl_vec3 p)
{
    return orl_add(orl_scale(turned(c, p), c->scale), c->shift);
}

static void run_changed(const struct change *c, double ret_lx[SENSORS])
{
    struct orl_sensor places[SENSORS];
    char text[16384];
    struct orl_description room = scene_parse_text(GREY CLEAR SHELL PANE, NULL, NULL);
    const struct orl_vec3 sun = turned(c, orl_v3(0, -1, 1));
    size_t at = (size_t)snprintf(text, sizeof text,
                                 SKY GREY CLEAR "void light l 0 0 3 1e6 1e6 1e6\n"
                                                "l source sun 0 0 4 %.17g %.17g %.17g .533\n",
                                 sun.x, sun.y, sun.z);
    for (size_t s = 0; s < room.n_surfaces; s++) {
        const struct orl_surface *surface = &room.surfaces[s];
        at += (size_t)snprintf(text + at, sizeof text - at, "%s polygon %s 0 0 %u",
                               room.materials[surface->material].name, surface->name,
                               3 * surface->n_vertices);
        for (uint32_t v = 0; v < surface->n_vertices; v++) {
            const struct orl_vec3 p = moved(c, surface->vertices[v]);
            at +=
                (size_t)snprintf(text + at, sizeof text - at, " %.17g %.17g %.17g", p.x, p.y, p.z);
        }
        at += (size_t)snprintf(text + at, sizeof text - at, "\n");
    }
    assert_true(at < sizeof text);
    orl_description_done(&room);
    for (int i = 0; i < SENSORS; i++)
        places[i] =
            (struct orl_sensor){moved(c, sensors[i].position), turned(c, sensors[i].direction)};
    scene_run_lx(
        &(struct scene_run){
            .scene = text, .sensors = places, .n_sensors = SENSORS, .global = 200000},
        ret_lx);
}

/*
 * Millimetres, kilometres, 100 km from the origin, turned by 37 degrees. Rounding sends photons
 * other ways, so that results are new draws rather than equal: single sensors of this room scatter
 * by 1 % at 2e5 photons, which makes 3 sigma of a difference 4.2 %.
 */
static void test_units_and_place(void **state)
{
    static const struct change changes[5] = {{1, 0, {0, 0, 0}},
                                             {0.001, 0, {0, 0, 0}},
                                             {1000, 0, {0, 0, 0}},
                                             {1, 0, {1e5, -1e5, 1e3}},
                                             {1, 37, {10, 20, 0}}};
    double first[SENSORS], lx[SENSORS];
    (void)state;
    run_changed(&changes[0], first);
    for (int c = 1; c < 5; c++) {
        run_changed(&changes[c], lx);
        for (int i = 0; i < SENSORS; i++)
            assert_within(lx[i], first[i], 0.042);
    }
}

/* Every wall inside out: plastic is two-sided, so nothing but the draws may change. */
static void test_flipped_normals(void **state)
{
    static const char flipped[] =
        SKY SUN GREY CLEAR "w polygon floor 0 0 12 0 5 0 4 5 0 4 0 0 0 0 0\n"
                           "w polygon ceiling 0 0 12 4 0 3 4 5 3 0 5 3 0 0 3\n"
                           "w polygon west 0 0 12 0 0 3 0 5 3 0 5 0 0 0 0\n"
                           "w polygon east 0 0 12 4 5 0 4 5 3 4 0 3 4 0 0\n"
                           "w polygon north 0 0 12 0 5 3 4 5 3 4 5 0 0 5 0\n"
                           "w polygon south 0 0 30 1 0 1 1 0 2.5 3 0 2.5 3 0 1 1 0 1 0 0 0 4 0 0 "
                           "4 0 3 0 0 3 0 0 0\n"
                           "w polygon shelf 0 0 12 0 2.4 1 4 2.4 1 4 2 1 0 2 1\n" PANE;
    struct scene_run run = {.scene = SKY SUN GREY CLEAR SHELL PANE,
                            .sensors = sensors,
                            .n_sensors = SENSORS,
                            .global = 200000};
    double a[SENSORS], b[SENSORS];
    (void)state;
    scene_run_lx(&run, a);
    run.scene = flipped;
    scene_run_lx(&run, b);
    for (int i = 0; i < SENSORS; i++)
        assert_within(b[i], a[i], 0.042);
}

/* Room, sky and sun are mirror images of themselves about x = 2: so are results. */
static void test_symmetry(void **state)
{
    static const struct orl_sensor pairs[6] = {{{0.5, 3, 0}, {0, 0, 1}}, {{3.5, 3, 0}, {0, 0, 1}},
                                               {{1, 4.5, 1}, {1, 0, 0}}, {{3, 4.5, 1}, {-1, 0, 0}},
                                               {{0, 4, 1.5}, {1, 0, 0}}, {{4, 4, 1.5}, {-1, 0, 0}}};
    double lx[6];
    (void)state;
    scene_run_lx(&(struct scene_run){.scene = SKY SUN GREY CLEAR SHELL PANE,
                                     .sensors = pairs,
                                     .n_sensors = 6,
                                     .global = 300000},
                 lx);
    for (int i = 0; i < 6; i += 2)
        assert_within(lx[i], lx[i + 1], 0.035);
}

/* ---- Windows ----------------------------------------------------------------------------------
 */

/*
 * A clear pane across the middle of the room (index 1, nothing absorbed) is no port: it passes what
 * is there, and adds nothing. Two such panes in the window, one behind the other, pass light once.
 */
static void test_panes_that_are_no_ports(void **state)
{
    static const char none[] = "void glass q 0 0 4 1 1 1 1\n";
    char text[4096];
    struct scene_run run = {
        .scene = text, .sensors = sensors, .n_sensors = SENSORS, .global = 200000};
    double plain[SENSORS], inner[SENSORS], twice[SENSORS];
    (void)state;
    snprintf(text, sizeof text, "%s", SKY SUN GREY CLEAR SHELL PANE);
    scene_run_lx(&run, plain);
    snprintf(text, sizeof text, "%s%sq polygon inner 0 0 12 0 2.5 0 0 2.5 3 4 2.5 3 4 2.5 0\n",
             SKY SUN GREY CLEAR SHELL PANE, none);
    scene_run_lx(&run, inner);
    snprintf(text, sizeof text,
             "%s%sq polygon second 0 0 12 1 .01 1 1 .01 2.5 3 .01 2.5 3 .01 1\n"
             "q polygon third 0 0 12 1 -.01 1 1 -.01 2.5 3 -.01 2.5 3 -.01 1\n"
             "w polygon rim1 0 0 12 1 .01 1 3 .01 1 3 -.01 1 1 -.01 1\n"
             "w polygon rim2 0 0 12 1 .01 2.5 3 .01 2.5 3 -.01 2.5 1 -.01 2.5\n"
             "w polygon rim3 0 0 12 1 .01 1 1 .01 2.5 1 -.01 2.5 1 -.01 1\n"
             "w polygon rim4 0 0 12 3 .01 1 3 .01 2.5 3 -.01 2.5 3 -.01 1\n",
             SKY SUN GREY CLEAR SHELL PANE, none);
    scene_run_lx(&run, twice);
    for (int i = 0; i < SENSORS; i++) {
        assert_within(inner[i], plain[i], 0.042);
        /* The frame is two centimetres deep: it takes 1 % and more of slanting light. */
        assert_within(twice[i], plain[i], 0.06);
    }
}

/*
 * A window at the bottom of a light well, that sees a sliver of sky only: it is a port, and what
 * comes in is what comes through an open hole. Well and room share no plane, so that the hole's
 * density estimates cannot reach round the wall. Most light at the sensors has been reflected in
 * the well, and is found from inside by paths of few: seeds scatter by 5 % and more.
 */
static void test_light_well(void **state)
{
    static const char well[] =
        "w polygon well_s 0 0 12 -.5 -2 -.2 4.5 -2 -.2 4.5 -2 6 -.5 -2 6\n"
        "w polygon well_w 0 0 12 -.5 -2 -.2 -.5 -2 6 -.5 .1 6 -.5 .1 -.2\n"
        "w polygon well_e 0 0 12 4.5 -2 -.2 4.5 .1 -.2 4.5 .1 6 4.5 -2 6\n"
        "w polygon well_n 0 0 12 -.5 .1 3 4.5 .1 3 4.5 .1 6 -.5 .1 6\n"
        "w polygon well_f 0 0 12 -.5 -2 -.2 4.5 -2 -.2 4.5 .1 -.2 -.5 .1 -.2\n"
        "w polygon gap_w 0 0 12 -.5 .1 -.2 0 .1 -.2 0 .1 3 -.5 .1 3\n"
        "w polygon gap_e 0 0 12 4 .1 -.2 4.5 .1 -.2 4.5 .1 3 4 .1 3\n";
    char text[4096];
    double hole[SENSORS], pane[SENSORS];
    struct scene_run run = {
        .scene = text, .sensors = sensors, .n_sensors = SENSORS, .global = 300000};
    (void)state;
    /* The pane that is not there against the open hole: the one as a port, the other from the sky.
     */
    snprintf(text, sizeof text, "%s%s%s", SKY GREY "void glass p 0 0 4 1 1 1 1\n" SHELL, well,
             PANE);
    scene_run_lx(&run, pane);
    snprintf(text, sizeof text, "%s%s", SKY GREY SHELL, well);
    run.global = 1000000;
    scene_run_lx(&run, hole);
    for (int i = 0; i < SENSORS; i++) {
        assert_true(pane[i] > 0);
        assert_within(pane[i], hole[i], 0.17);
    }
}

/* ---- Keys -------------------------------------------------------------------------------------
 */

static void expect_cached(const struct scene_run *run, bool global, bool caustic)
{
    struct orl_result result = scene_run(run);
    assert_int_equal(result.n_maps, 2);
    assert_int_equal(result.maps[0].cached, global);
    assert_int_equal(result.maps[1].cached, caustic);
    orl_result_done(&result);
}

/* A new sensor list or view is a hit; a new seed, count or scene is not. */
static void test_map_keys(void **state)
{
    char folder[64];
    (void)state;
    cli_make_folder(folder);
    struct scene_run run = {.scene = SKY SUN GREY CLEAR SHELL PANE,
                            .sensors = sensors,
                            .n_sensors = 2,
                            .global = 5000,
                            .caustic = 5000,
                            .samples = 64,
                            .folder = folder};
    expect_cached(&run, false, false);
    expect_cached(&run, true, true);
    run.n_sensors = 4;
    run.samples = 128;
    expect_cached(&run, true, true);
    run.view = "-vtv -vp 2 4 1.5 -vd 0 -1 0";
    run.width = run.height = 8;
    run.threads = 2;
    expect_cached(&run, true, true);
    run.view = NULL;
    run.caustic = 6000;
    expect_cached(&run, true, false);
    run.seed = 2;
    expect_cached(&run, false, false);
    run.scene = SKY SUN GREY CLEAR SHELL PANE "# said twice\n";
    expect_cached(&run, false, false);
    cli_remove_folder(folder);
}

/* What a cached map gives is what a new one gave, to the bit. */
static void test_cached_results(void **state)
{
    char folder[64];
    double first[SENSORS], second[SENSORS];
    (void)state;
    cli_make_folder(folder);
    const struct scene_run run = {.scene = SKY SUN GREY CLEAR SHELL PANE,
                                  .sensors = sensors,
                                  .n_sensors = SENSORS,
                                  .caustic = 5000,
                                  .folder = folder};
    scene_run_lx(&run, first);
    scene_run_lx(&run, second);
    assert_memory_equal(first, second, sizeof first);
    cli_remove_folder(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_threads),         cmocka_unit_test(test_seeds),
        cmocka_unit_test(test_units_and_place), cmocka_unit_test(test_flipped_normals),
        cmocka_unit_test(test_symmetry),        cmocka_unit_test(test_panes_that_are_no_ports),
        cmocka_unit_test(test_light_well),      cmocka_unit_test(test_map_keys),
        cmocka_unit_test(test_cached_results),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
