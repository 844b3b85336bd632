/*
 * make paths, make rare-rooms: every cell of support/path_cells.h, or every room of
 * support/rare_rooms.h, by every technique, against plain path tracing. For each and technique it
 * prints the sensor that is furthest off: z, its difference from the
 * truth in joint standard errors (of the interval, and of the truth), and its ratio to the truth;
 * '*' stands where |z| is above 4, 'w' where there were warnings. At the end it prints the shares
 * of intervals that hold the truth, and the rms of z. Truths are kept in the build folder.
 *
 * In the environment: ORIEL_PATHS_SENSORS prints every sensor, ORIEL_PATHS_WARNINGS all warnings of
 * the first seed, ORIEL_PATHS_TEXT the scenes.
 *
 * usage: paths cells|rooms [MILLIONS OF PATHS A SENSOR [SEEDS [TEXT IN THE NAME OF THE CELL]]]
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>
#include <oriel/base/sha256.h>

#include "support/brute.h"
#include "support/path_cells.h"
#include "support/rare_rooms.h"
#include "support/scene_text.h"

static const struct {
    enum orl_technique technique;
    const char *name;
} techniques[] = {{ORL_TECHNIQUE_BACKWARD, "backward"},
                  {ORL_TECHNIQUE_GATHER, "gather"},
                  {ORL_TECHNIQUE_DIRECT, "direct"},
                  {ORL_TECHNIQUE_PRECOMPUTED, "precomputed"},
                  {ORL_TECHNIQUE_AUTO, "auto"}};
enum { TECHNIQUES = sizeof techniques / sizeof *techniques };

struct cell {
    char name[128], text[PATH_TEXT];
    struct orl_sensor sensors[PATH_SENSORS];
};

/* Sums over all cells for one technique. */
struct tally {
    size_t values, held,
        off; /* sensors; sensors whose interval holds the truth; cells with |z| above the limit */
    double squares, worst; /* sum of squares and largest size of z */
};

/* Result of a technique in one cell. */
struct outcome {
    double z, ratio; /* those of the sensor furthest off */
    size_t warnings;
};

/* Compares one run with the truth, without sensors whose truth is unknown. */
static void compare_result(const struct orl_result *result, const struct brute_value *truth,
                           struct tally *tally, struct outcome *outcome)
{
    for (size_t i = 0; i < PATH_SENSORS; i++) {
        const double lx = result->illuminance_lx[i];
        const struct path_verdict v = path_judge(lx, result->interval_95_lx[i], &truth[i]);
        if (!v.known)
            continue;
        tally->values++;
        tally->held += v.held;
        tally->squares += v.z * v.z;
        tally->worst = fmax(tally->worst, fabs(v.z));
        if (fabs(v.z) > fabs(outcome->z)) {
            outcome->z = v.z;
            outcome->ratio = lx / truth[i].mean;
        }
    }
    outcome->warnings += result->n_warnings;
}

/* Reads the truths of a cell from the build folder, or computes and stores them, under the digest
 * of the scene's text and the number of paths. */
static void find_truth(const struct cell *cell, uint64_t paths, struct orl_thread_pool *pool,
                       struct brute_value truth[PATH_SENSORS])
{
    const char *const build = getenv("ORIEL_BUILD");
    unsigned char digest[32];
    char path[512];
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, cell->text, strlen(cell->text));
    orl_sha256_add(&hash, cell->sensors, sizeof cell->sensors);
    orl_sha256_add(&hash, &paths, sizeof paths);
    orl_sha256_finish(&hash, digest);
    snprintf(path, sizeof path, "%s/paths", build ? build : "build");
    mkdir(path, 0777);
    size_t length = strlen(path);
    length += (size_t)snprintf(path + length, sizeof path - length, "/");
    for (int i = 0; i < 12; i++)
        length += (size_t)snprintf(path + length, sizeof path - length, "%02x", digest[i]);
    FILE *file = fopen(path, "rb");
    const size_t found = file ? fread(truth, sizeof *truth, PATH_SENSORS, file) : 0;
    if (file)
        fclose(file);
    if (found == PATH_SENSORS)
        return;
    struct orl_lit_scene *const lit_scene =
        build_lit_scene(cell->text, "pane.xml", path_pane(), NULL);
    brute_sensors(lit_scene, cell->sensors, PATH_SENSORS, paths, pool, truth);
    orl_lit_scene_free(lit_scene);
    file = fopen(path, "wb");
    if (!file)
        return;
    fwrite(truth, sizeof *truth, PATH_SENSORS, file);
    fclose(file);
}

static void run_cell(const struct cell *cell, const struct brute_value *truth, uint64_t seeds,
                     int t, struct tally *tally)
{
    struct outcome outcome = {0};
    for (uint64_t seed = 1; seed <= seeds; seed++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = cell->text,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = path_pane(),
                                                            .sensors = cell->sensors,
                                                            .n_sensors = PATH_SENSORS,
                                                            .seed = seed,
                                                            .technique = techniques[t].technique,
                                                            .by_plan = true,
                                                            .global = 200000,
                                                            .caustic = 200000,
                                                            .bounded = true,
                                                            .threads = 2});
        compare_result(&r, truth, tally, &outcome);
        for (int i = 0; i < PATH_SENSORS && getenv("ORIEL_PATHS_SENSORS"); i++)
            printf("\n    %-12s sensor %d: %.5g +- %.2g [%.5g, %.5g], truth %.5g +- %.2g",
                   techniques[t].name, i, r.illuminance_lx[i], r.standard_error_lx[i],
                   r.interval_95_lx[i][0], r.interval_95_lx[i][1], truth[i].mean,
                   truth[i].standard_error);
        if (getenv("ORIEL_PATHS_WARNINGS") && seed == 1)
            for (size_t i = 0; i < r.n_warnings; i++)
                printf("\n    %s: %s", techniques[t].name, r.warnings[i]);
        orl_result_done(&r);
    }
    const bool off = fabs(outcome.z) > 4;
    tally->off += off;
    printf(" %+7.1f %5.2f %c%c", outcome.z, outcome.ratio, off ? '*' : ' ',
           outcome.warnings ? 'w' : ' ');
    fflush(stdout);
}

/* Prints a cell's line: the truth of its first sensor, the largest error of truths, and each
 * technique's outcome. */
static void print_cell(const struct cell *cell, uint64_t paths, uint64_t seeds,
                       struct orl_thread_pool *pool, struct tally tallies[TECHNIQUES])
{
    struct brute_value truth[PATH_SENSORS];
    double error = 0;
    find_truth(cell, paths, pool, truth);
    if (getenv("ORIEL_PATHS_TEXT"))
        printf("%s", cell->text);
    for (size_t i = 0; i < PATH_SENSORS; i++)
        error = fmax(error, truth[i].standard_error / fmax(truth[i].mean, 1e-9));
    printf("%-40s %8.3g %6.2f", cell->name, truth[0].mean, 100 * error);
    for (int t = 0; t < TECHNIQUES; t++)
        run_cell(cell, truth, seeds, t, &tallies[t]);
    printf("\n");
}

/* Fills in a cell of the paths, or a rare room; returns false if that number does not exist. */
static bool find_cell(bool rooms, size_t number, struct cell *ret_cell)
{
    const size_t source = number % path_source_count(), chain = number / path_source_count();
    if (rooms) {
        rare_room_scene(number, ret_cell->text, ret_cell->sensors);
        snprintf(ret_cell->name, sizeof ret_cell->name, "%s", rare_room_name(number));
        return true;
    }
    snprintf(ret_cell->name, sizeof ret_cell->name, "%s: %s", path_chain_name(chain),
             path_source_name(source));
    memcpy(ret_cell->sensors, path_sensors, sizeof path_sensors);
    return path_cell_scene(source, chain, ret_cell->text);
}

int main(int argc, char **argv)
{
    const bool rooms = argc > 1 && strcmp(argv[1], "rooms") == 0;
    const uint64_t paths = (uint64_t)(1e6 * (argc > 2 ? atof(argv[2]) : 4));
    const uint64_t seeds = argc > 3 ? (uint64_t)atoi(argv[3]) : 3;
    const char *const only = argc > 4 ? argv[4] : "";
    const size_t count = rooms ? rare_room_count() : path_chain_count() * path_source_count();
    struct tally tallies[TECHNIQUES] = {{0}};
    struct orl_thread_pool *const pool = orl_thread_pool_start(2);
    static struct cell cell;
    printf("%-40s %8s %6s", "", "truth lx", "%");
    for (int t = 0; t < TECHNIQUES; t++)
        printf(" %-16s", techniques[t].name);
    printf("\n");
    for (size_t i = 0; i < count; i++)
        if (find_cell(rooms, i, &cell) && strstr(cell.name, only))
            print_cell(&cell, paths, seeds, pool, tallies);
    for (int t = 0; t < TECHNIQUES; t++)
        printf("%-12s intervals hold %.1f %% of %zu, rms z %.2f, worst %.1f, cells off %zu\n",
               techniques[t].name, 100 * (double)tallies[t].held / (double)tallies[t].values,
               tallies[t].values, sqrt(tallies[t].squares / (double)tallies[t].values),
               tallies[t].worst, tallies[t].off);
    orl_thread_pool_stop(pool);
    return 0;
}
