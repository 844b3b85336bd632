/*
 * Path coverage, the short form of `make paths`: of each chain of surfaces (support/path_cells.h)
 * one source, all techniques, against plain path tracing, which can leave no path out. A kind of
 * path that no strategy finds, or that two count, shows as a value far beyond its error.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/brute.h"
#include "support/extent.h"
#include "support/path_cells.h"
#include "support/scene_text.h"
#include "support/techniques.h"

enum { TECHNIQUES = 4 };
static const enum orl_technique techniques[TECHNIQUES] = {
    ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_DIRECT, ORL_TECHNIQUE_PRECOMPUTED};

/* Chains without a truth that plain path tracing can tell: what comes is too rare. */
static bool is_too_rare(const char *chain)
{
    return strcmp(chain, "door ajar") == 0 || strcmp(chain, "partition ajar") == 0 ||
           strcmp(chain, "light tube") == 0;
}

struct count {
    size_t values, held, off;
};

static void count_run(const struct orl_result *r, const struct brute_value *truth, const char *name,
                      struct count *count)
{
    for (size_t i = 0; i < PATH_SENSORS; i++) {
        const double lx = r->illuminance_lx[i], *interval = r->interval_95_lx[i];
        const struct path_verdict v = path_judge(lx, interval, &truth[i]);
        const bool off = v.known && fabs(v.z) > 5 && fabs(lx - truth[i].mean) > 0.1 * truth[i].mean;
        count->values += v.known;
        count->held += v.known && v.held;
        count->off += off;
        if (off)
            print_message("%s, sensor %zu: %.4g [%.4g, %.4g], truth %.4g +- %.2g\n", name, i, lx,
                          interval[0], interval[1], truth[i].mean, truth[i].standard_error);
    }
}

static void run_cell(size_t source, size_t chain, struct orl_crew *crew,
                     struct count counts[TECHNIQUES])
{
    char text[PATH_TEXT], name[128];
    struct brute_value truth[PATH_SENSORS];
    if (!path_cell_scene(source, chain, text))
        return;
    struct orl_world *const world = scene_world(text, "pane.xml", path_pane(), NULL);
    brute_sensors(world, path_sensors, PATH_SENSORS, extent(300000, 4000000), crew, truth);
    orl_world_free(world);
    for (int t = 0; t < TECHNIQUES; t++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = text,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = path_pane(),
                                                            .sensors = path_sensors,
                                                            .n_sensors = PATH_SENSORS,
                                                            .technique = techniques[t],
                                                            .samples = 1024,
                                                            .global = 50000,
                                                            .caustic = 50000,
                                                            .bounded = true});
        snprintf(name, sizeof name, "%s, %s, technique %d", path_chain_name(chain),
                 path_source_name(source), (int)techniques[t]);
        count_run(&r, truth, name, &counts[t]);
        orl_result_done(&r);
    }
}

/*
 * A technique has some 150 intervals. 95 in 100 of them hold the truth, with a binomial scatter of
 * 1.8; 89 is three deviations below. No value may be off by more than 5 joint standard errors and a
 * tenth: chance alone makes one of 600 values so in one of 3000 runs.
 */
static void test_every_chain(void **state)
{
    struct count counts[TECHNIQUES] = {{0}};
    struct orl_crew *const crew = orl_crew_start(1);
    (void)state;
    for (size_t chain = 0; chain < path_chain_count(); chain++)
        for (size_t source = 0; source < path_source_count(); source++)
            if (!is_too_rare(path_chain_name(chain)) &&
                (extent_is_long() || source == 1 + chain % (path_source_count() - 1)))
                run_cell(source, chain, crew, counts);
    orl_crew_stop(crew);
    for (int t = 0; t < TECHNIQUES; t++) {
        print_message("technique %d: %zu of %zu intervals hold the truth, %zu values are off\n",
                      (int)techniques[t], counts[t].held, counts[t].values, counts[t].off);
        assert_true(counts[t].values > 60);
        assert_true(counts[t].held * 100 >= counts[t].values * 89);
        assert_int_equal(counts[t].off, 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_chain)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
