/*
 * Path coverage, the short form of `make paths`: for each chain of surfaces (support/path_cells.h)
 * one source, all techniques, compared with plain path tracing, which omits no path. A kind of path
 * that no strategy finds, or that two count, shows as a value far beyond its error.
 *
 * Truths of the short form are stored in tests/fixtures/path_truths.txt, each under the digest of
 * its scene; the long form traces all of them itself, and compares the stored ones. After an
 * intended change of a scene or a material, this writes the file anew, in some minutes:
 *
 *     ORIEL_PATH_TRUTHS=tests/fixtures/path_truths.txt build/tests/validation/test_paths
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
#include <oriel/base/sha256.h>

#include "support/brute.h"
#include "support/extent.h"
#include "support/path_cells.h"
#include "support/scene_text.h"
#include "support/techniques.h"

enum { TECHNIQUES = 4 };
static const enum orl_technique techniques[TECHNIQUES] = {
    ORL_TECHNIQUE_BACKWARD, ORL_TECHNIQUE_GATHER, ORL_TECHNIQUE_DIRECT, ORL_TECHNIQUE_PRECOMPUTED};

/* Chains whose light is too rare for plain path tracing. */
static bool is_too_rare(const char *chain)
{
    return strcmp(chain, "door ajar") == 0 || strcmp(chain, "partition ajar") == 0 ||
           strcmp(chain, "light tube") == 0;
}

/* ---- Truths ---------------------------------------------------------------------------------- */

static const char kept_truths[] = "tests/fixtures/path_truths.txt";
enum { DIGEST_TEXT = 17 };

/* Writes the first eight bytes of the digest of scene and sensors, in hexadecimal. */
static void digest_of(const char *scene, char ret_text[DIGEST_TEXT])
{
    unsigned char digest[ORL_SHA256_BYTES];
    struct orl_sha256 hash;
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, scene, strlen(scene));
    orl_sha256_add(&hash, path_pane(), strlen(path_pane()));
    orl_sha256_add(&hash, path_sensors, sizeof path_sensors);
    orl_sha256_finish(&hash, digest);
    for (int i = 0; i < (DIGEST_TEXT - 1) / 2; i++)
        snprintf(ret_text + 2 * (size_t)i, 3, "%02x", digest[i]);
}

static void trace_truth(const char *scene, uint64_t paths, struct orl_thread_pool *pool,
                        struct brute_value truth[PATH_SENSORS])
{
    struct orl_lit_scene *const lit_scene = build_lit_scene(scene, "pane.xml", path_pane(), NULL);
    brute_sensors(lit_scene, path_sensors, PATH_SENSORS, paths, pool, truth);
    orl_lit_scene_free(lit_scene);
}

/* Reads a scene's truths; returns false if the file has none. */
static bool read_truth(const char *scene, struct brute_value truth[PATH_SENSORS])
{
    char line[512], digest[DIGEST_TEXT];
    bool found = false;
    digest_of(scene, digest);
    FILE *file = fopen(kept_truths, "r");
    assert_non_null(file);
    while (!found && fgets(line, sizeof line, file)) {
        const char *at = line + DIGEST_TEXT - 1;
        if (strncmp(line, digest, DIGEST_TEXT - 1) != 0)
            continue;
        for (size_t i = 0; i < PATH_SENSORS; i++) {
            char *end;
            truth[i].mean = strtod(at, &end);
            truth[i].standard_error = strtod(end, &end);
            assert_true(end > at && truth[i].standard_error >= 0);
            at = end;
        }
        found = true;
    }
    fclose(file);
    return found;
}

static void write_truth(FILE *file, const char *scene, const char *name,
                        struct orl_thread_pool *pool)
{
    struct brute_value truth[PATH_SENSORS];
    char digest[DIGEST_TEXT];
    trace_truth(scene, 1000000, pool, truth);
    digest_of(scene, digest);
    fprintf(file, "%s", digest);
    for (size_t i = 0; i < PATH_SENSORS; i++)
        fprintf(file, " %.6g %.3g", truth[i].mean, truth[i].standard_error);
    fprintf(file, " # %s\n", name);
    fflush(file);
}

/* Compares with stored truths of other path counts: five joint standard errors, and 2 % because a
 * few paths with much light distort the error. */
static void compare_truths(const char *name, const struct brute_value *truth,
                           const struct brute_value *kept)
{
    for (size_t i = 0; i < PATH_SENSORS; i++) {
        const double joint = hypot(truth[i].standard_error, kept[i].standard_error);
        if (!(fabs(truth[i].mean - kept[i].mean) <= 5 * joint + 0.02 * truth[i].mean))
            fail_msg("%s, sensor %zu: %.5g +- %.2g, but %s has %.5g +- %.2g", name, i,
                     truth[i].mean, truth[i].standard_error, kept_truths, kept[i].mean,
                     kept[i].standard_error);
    }
}

static void find_truth(const char *scene, const char *name, struct orl_thread_pool *pool,
                       struct brute_value truth[PATH_SENSORS])
{
    struct brute_value kept[PATH_SENSORS];
    const bool has_kept = read_truth(scene, kept);
    if (extent_is_long()) {
        trace_truth(scene, 4000000, pool, truth);
        if (has_kept)
            compare_truths(name, truth, kept);
        return;
    }
    if (!has_kept)
        fail_msg("%s: %s has no truth of this scene; how to write it anew is said at the top of %s",
                 name, kept_truths, __FILE__);
    memcpy(truth, kept, sizeof kept);
}

/* ---- Techniques ------------------------------------------------------------------------------ */

static bool is_of_short_form(size_t source, size_t chain)
{
    return source == 1 + chain % (path_source_count() - 1);
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

static void run_cell(size_t source, size_t chain, struct orl_thread_pool *pool,
                     struct count counts[TECHNIQUES])
{
    char text[PATH_TEXT], name[128];
    struct brute_value truth[PATH_SENSORS];
    if (!path_cell_scene(source, chain, text))
        return;
    snprintf(name, sizeof name, "%s, %s", path_chain_name(chain), path_source_name(source));
    find_truth(text, name, pool, truth);
    for (int t = 0; t < TECHNIQUES; t++) {
        struct orl_result r = scene_run(&(struct scene_run){.scene = text,
                                                            .resource_name = "pane.xml",
                                                            .resource_text = path_pane(),
                                                            .sensors = path_sensors,
                                                            .n_sensors = PATH_SENSORS,
                                                            .technique = techniques[t],
                                                            .samples = 1024,
                                                            .global = extent(20000, 50000),
                                                            .caustic = extent(20000, 50000),
                                                            .bounded = true});
        snprintf(name, sizeof name, "%s, %s, technique %d", path_chain_name(chain),
                 path_source_name(source), (int)techniques[t]);
        count_run(&r, truth, name, &counts[t]);
        orl_result_done(&r);
    }
}

/*
 * A technique has some 150 intervals. 95 in 100 of them hold the truth, with a binomial scatter
 * of 1.8; 89 is three deviations below. No value may be off by more than 5 joint standard errors
 * and a tenth: by chance one of 600 values is in one of 3000 runs.
 */
static void test_every_chain(void **state)
{
    struct count counts[TECHNIQUES] = {{0}};
    struct orl_thread_pool *const pool = orl_thread_pool_start(1);
    (void)state;
    for (size_t chain = 0; chain < path_chain_count(); chain++)
        for (size_t source = 0; source < path_source_count(); source++)
            if (!is_too_rare(path_chain_name(chain)) &&
                (extent_is_long() || is_of_short_form(source, chain)))
                run_cell(source, chain, pool, counts);
    orl_thread_pool_stop(pool);
    for (int t = 0; t < TECHNIQUES; t++) {
        print_message("technique %d: %zu of %zu intervals hold the truth, %zu values are off\n",
                      (int)techniques[t], counts[t].held, counts[t].values, counts[t].off);
        assert_true(counts[t].values > 60);
        assert_true(counts[t].held * 100 >= counts[t].values * 89);
        assert_int_equal(counts[t].off, 0);
    }
}

static void write_truths(const char *path)
{
    char text[PATH_TEXT], name[128];
    struct orl_thread_pool *const pool = orl_thread_pool_start(2);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "# Written by tests/validation/test_paths.c: the digest of a scene, and of each "
                  "sensor the illuminance by plain path tracing and its standard error, in lx.\n");
    for (size_t chain = 0; chain < path_chain_count(); chain++)
        for (size_t source = 0; source < path_source_count(); source++) {
            if (is_too_rare(path_chain_name(chain)) || !is_of_short_form(source, chain) ||
                !path_cell_scene(source, chain, text))
                continue;
            snprintf(name, sizeof name, "%s, %s", path_chain_name(chain), path_source_name(source));
            write_truth(file, text, name, pool);
        }
    fclose(file);
    orl_thread_pool_stop(pool);
}

int main(void)
{
    const char *truths = getenv("ORIEL_PATH_TRUTHS");
    if (truths && truths[0]) {
        write_truths(truths);
        return 0;
    }
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_chain)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
