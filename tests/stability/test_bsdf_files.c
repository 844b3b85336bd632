/*
 * Hard cases of BSDF files: invalid numbers, text cut short or nested without end, an up vector
 * parallel to the normal, the order of loading.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>
#include <sodium.h>

#include "base/sampling/sampling.h"
#include "fixtures/bsdf_make.h"
#include "scene/parse/parse.h"
#include "support/cli.h"
#include "support/scene_text.h"
#include "support/stability.h"

/* ---- 14: values that are not numbers --------------------------------------------------------- */

enum verdict { REFUSED, CLAMPED };

static const struct {
    const char *word;
    enum verdict wanted;
} words[] = {{"nan", REFUSED},    {"NaN", REFUSED},    {"-nan", REFUSED},     {"nan(123)", REFUSED},
             {"inf", REFUSED},    {"-inf", REFUSED},   {"Infinity", REFUSED}, {"1e400", REFUSED},
             {"-1e400", REFUSED}, {"1e39", REFUSED},   {"1#QNAN", REFUSED},   {"0x1p3", REFUSED},
             {"1e", REFUSED},     {"--1", REFUSED},    {"-1", CLAMPED},       {"-1e-3", CLAMPED},
             {"-1e30", CLAMPED},  {"-3.4e29", CLAMPED}};

/* Returns a file of that structure with the word among its values; the word is on line 13. */
static struct text spoilt(int structure, const char *word)
{
    struct text data, file;
    const int counts[3] = {16, 8, 41 * 41};
    text_open(&data);
    fputs(structure < 2 ? "{" : "", data.stream);
    for (int i = 0; i < counts[structure]; i++)
        fprintf(data.stream, "%s ", i == 3 ? word : "0.1");
    fputs(structure < 2 ? "}" : "", data.stream);
    text_close(&data);
    file = structure == 0 ? make_file("TensorTree4", "Reflection Front", NULL, data.data)
           : structure == 1
               ? make_file("TensorTree3", "Reflection Front", NULL, data.data)
               : make_file("Columns", "Reflection Front", "LBNL/Klems Quarter", data.data);
    free(data.data);
    return file;
}

/* Returns true if the file is refused with the place and the word; or is loaded, the value
 * counted, and no result is negative or non-finite. */
static bool is_handled(const char *word, enum verdict wanted, struct text file)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_bsdf_info info;
    struct orl_error err = {0};
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 14);
    const int code = orl_bsdf_load_xml("spoilt.xml", file.data, file.size, &bsdf, &err);
    bool good = true;
    if (code < 0)
        return wanted == REFUSED && err.line > 10 && strstr(err.message, word) && !bsdf;
    orl_bsdf_describe(bsdf, &info);
    for (int i = 0; i < 5000; i++) {
        const double x = 2 * orl_random_uniform(&random) - 1,
                     y = 2 * orl_random_uniform(&random) - 1;
        const struct orl_vec3 in = orl_normalize(orl_v3(x, y, -0.5));
        const struct orl_vec3 out = orl_normalize(orl_v3(y, orl_random_uniform(&random) - .5, -.5));
        const double f = orl_bsdf_eval(bsdf, in, out).g;
        good = good && isfinite(f) && f >= 0;
    }
    orl_bsdf_unref(bsdf);
    return good && wanted == CLAMPED && info.clamped == 1;
}

static void test_14_no_numbers(void **state)
{
    int silent = 0;
    (void)state;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        for (int structure = 0; structure < 3; structure++) {
            struct text file = spoilt(structure, words[i].word);
            if (!is_handled(words[i].word, words[i].wanted, file)) {
                print_message("# '%s' in structure %d\n", words[i].word, structure);
                silent++;
            }
            free(file.data);
        }
    }
    stability_row(14, "NaN, inf, 1e400, negative in XML",
                  "files neither refused with line nor clamped and counted", silent, 0);
}

/* ---- 19: cut short, nested without end ------------------------------------------------------- */

static struct text nested(const char *structure, int depth, bool closed)
{
    struct text data, file;
    text_open(&data);
    for (int i = 0; i < depth; i++)
        putc('{', data.stream);
    fputs("0.1", data.stream);
    for (int i = 0; i < depth && closed; i++)
        putc('}', data.stream);
    text_close(&data);
    file = make_file(structure, "Reflection Front", NULL, data.data);
    free(data.data);
    return file;
}

static int load(const struct text *file, size_t size, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    const int code = orl_bsdf_load_xml("odd.xml", file->data, size, &bsdf, err);
    orl_bsdf_unref(bsdf);
    return code;
}

static void test_19_deep_nesting(void **state)
{
    const int depths[] = {10, 100, 10000, stability_full() ? 50000000 : 1000000};
    int loaded = 0;
    (void)state;
    for (int k = 0; k < 16; k++) {
        struct orl_error err = {0};
        struct text file = nested(k & 1 ? "TensorTree3" : "TensorTree4", depths[k >> 2], k & 2);
        const int code = load(&file, file.size, &err);
        loaded += code != ORL_ERR_LIMIT || err.line == 0 || !strstr(err.message, "deeper");
        free(file.data);
    }
    stability_row(19, "truncated or nested tree", "trees 10 to 1e6 deep not refused as too deep",
                  loaded, 0);
}

/* The long form cuts at every byte, the short form at every 199th. */
static void test_19_cut_short(void **state)
{
    const size_t step = stability_full() ? 1 : 199;
    struct text files[2] = {make_tree_file(2), make_iso_file(2)};
    long loaded = 0;
    (void)state;
    for (int f = 0; f < 2; f++) {
        size_t end = files[f].size;
        while (end > 0 && files[f].data[end - 1] != '>')
            end--;
        for (size_t size = 0; size < end; size += step) {
            struct orl_error err = {0};
            loaded += load(&files[f], size, &err) != ORL_ERR_SYNTAX;
        }
        free(files[f].data);
    }
    stability_row(19, "truncated or nested tree", "files cut short that are not refused",
                  (double)loaded, 0);
}

/* Random braces and values: any error has a line and a reason. Both ranks share one parser. An
 * accepted tree of rank 3 is expanded, which takes most of the time, so the short form has fewer
 * of these. */
static void test_19_braces_at_random(void **state)
{
    const long rounds = stability_full() ? 20000 : 600, rank_3_each = stability_full() ? 2 : 10;
    struct orl_random random = orl_random_stream(2, ORL_PURPOSE_BENCH, 19);
    long mute = 0, refused = 0;
    (void)state;
    for (long i = 0; i < rounds; i++) {
        static const char *const pieces[] = {"{",  "}", "0.1 ", "{0.1}", "{0 .1 .2 .3 .4 .5 .6 .7}",
                                             "-1 "};
        struct text data, file;
        struct orl_error err = {0};
        const int n = 1 + (int)(40 * orl_random_uniform(&random));
        text_open(&data);
        for (int k = 0; k < n; k++)
            fputs(pieces[(int)(6 * orl_random_uniform(&random))], data.stream);
        text_close(&data);
        file = make_file(i % rank_3_each == 1 ? "TensorTree3" : "TensorTree4", "Reflection Front",
                         NULL, data.data);
        if (load(&file, file.size, &err) < 0) {
            refused++;
            mute += err.line == 0 || err.message[0] == '\0';
        }
        free(data.data);
        free(file.data);
    }
    assert_true(refused > rounds / 2);
    stability_row(19, "truncated or nested tree", "braces at random: errors without line or reason",
                  (double)mute, 0);
}

/* ---- 20: up along the normal ----------------------------------------------------------------- */

static int parse_pane(const char *up, const char *shape, struct orl_error *err)
{
    char scene[512], xml[2048];
    const struct orl_sensor sensor = {{0, 0, 1}, {0, 0, 1}};
    struct scene_run run = {.scene = scene,
                            .resource_name = "pane.xml",
                            .resource_text = xml,
                            .sensors = &sensor,
                            .n_sensors = 1};
    scene_uniform_bsdf(0.2, xml);
    snprintf(scene, sizeof scene,
             "void BSDF p 6 0 pane.xml %s . 0 0\n%s\n"
             "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n",
             up, shape);
    return scene_run_fails(&run, err);
}

/* The up vector is written as in Radiance's examples, on skylights and on rings, turned or not. */
static void test_20_up_along_the_normal(void **state)
{
    static const char *const cases[][2] = {
        {"0 0 1", "p polygon skylight 0 0 12 0 0 3 1 0 3 1 1 3 0 1 3"},
        {"0 0 1", "p polygon skylight 0 0 12 0 1 3 1 1 3 1 0 3 0 0 3"},
        {"0 0 -1e-20", "p polygon skylight 0 0 12 0 0 3 1 0 3 1 1 3 0 1 3"},
        {"1e9 0 0", "p ring skylight 0 0 8 0 0 0 1 0 0 0 1"},
        {"1 1 0", "p polygon skylight 0 0 12 0 0 0 1 -1 0 1 -1 1 0 0 1"},
        {"0 1e-9 1", "p polygon skylight 0 0 12 0 0 3 1 0 3 1 1 3 0 1 3"},
    };
    int silent = 0;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_error err = {0};
        const int code = parse_pane(cases[i][0], cases[i][1], &err);
        const bool told = code == ORL_ERR_RANGE && strstr(err.primitive, "skylight") &&
                          err.line == 2 && strstr(err.message, "up vector");
        if (!told)
            print_message("# pane %zu: %d, %s, line %d: %s\n", i, code, err.primitive, err.line,
                          err.message);
        silent += !told;
    }
    stability_row(20, "up vector along the normal", "panes not refused with file, line and name",
                  silent, 0);
}

/* ---- 21: order of loading -------------------------------------------------------------------- */

static void hash_draws(const struct orl_bsdf *bsdf, crypto_hash_sha256_state *hash)
{
    struct orl_random random = orl_random_stream(3, ORL_PURPOSE_BENCH, 21);
    for (int i = 0; i < 20000; i++) {
        const double u[3] = {orl_random_uniform(&random), orl_random_uniform(&random),
                             orl_random_uniform(&random)};
        const struct orl_vec3 in =
            orl_normalize(orl_v3(orl_random_uniform(&random) - 0.5,
                                 orl_random_uniform(&random) - 0.5, i & 1 ? 0.3 : -0.3));
        struct {
            struct orl_vec3 out;
            struct orl_rgb weight;
            double pdf;
        } draw = {{0, 0, 0}, {0, 0, 0}, 0};
        orl_bsdf_sample(bsdf, in, ORL_BSDF_BOTH, u, &draw.out, &draw.weight, &draw.pdf);
        crypto_hash_sha256_update(hash, (const unsigned char *)&draw, sizeof draw);
    }
}

/* Samples of all three structures are the same whether they load in one order or in reverse. */
static void test_21_draws(void **state)
{
    unsigned char digest[2][crypto_hash_sha256_BYTES];
    (void)state;
    for (int order = 0; order < 2; order++) {
        struct orl_bsdf *bsdfs[3];
        crypto_hash_sha256_state hash;
        for (int k = 0; k < 3; k++) {
            const int b = order ? 2 - k : k;
            bsdfs[b] = load_text(b == 0   ? make_tree_file(3)
                                 : b == 1 ? make_iso_file(3)
                                          : read_fixture("tests/fixtures/bsdf_klems41.xml"));
            assert_non_null(bsdfs[b]);
        }
        crypto_hash_sha256_init(&hash);
        for (int b = 0; b < 3; b++) {
            hash_draws(bsdfs[b], &hash);
            orl_bsdf_unref(bsdfs[b]);
        }
        crypto_hash_sha256_final(&hash, digest[order]);
    }
    stability_holds(21, "two BSDFs, loaded in either order", "the same bits in 60000 draws",
                    memcmp(digest[0], digest[1], sizeof digest[0]) == 0);
}

/* A whole job with two panes in a room gives the same result with the materials in either order. */
static void test_21_jobs(void **state)
{
    static const char first[] = "void BSDF a 6 0 a.xml 0 0 1 . 0 0\n";
    static const char second[] = "void BSDF b 6 0 b.xml 0 0 1 . 0 0\n";
    static const char rest[] = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"
                               "void light l 0 0 3 1e6 1e6 1e6\nl source sun 0 0 4 0 -1 1 .533\n"
                               "void plastic w 0 0 5 .5 .5 .5 0 0\n"
                               "w polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0\n"
                               "w polygon ceiling 0 0 12 0 0 3 0 5 3 4 5 3 4 0 3\n"
                               "w polygon west 0 0 12 0 0 0 0 5 0 0 5 3 0 0 3\n"
                               "w polygon east 0 0 12 4 0 0 4 0 3 4 5 3 4 5 0\n"
                               "w polygon north 0 0 12 0 5 0 4 5 0 4 5 3 0 5 3\n"
                               "a polygon left 0 0 12 0 0 0 0 0 3 2 0 3 2 0 0\n"
                               "b polygon right 0 0 12 2 0 0 2 0 3 4 0 3 4 0 0\n";
    static const struct orl_sensor sensors[2] = {{{1, 2, 0}, {0, 0, 1}}, {{2, 3, 1}, {0, -1, 0}}};
    static const char *const names[] = {"scene.rad"};
    struct text klems = read_fixture("tests/fixtures/bsdf_klems41.xml"), tree = make_tree_file(3);
    double lx[2][2];
    (void)state;
    for (int order = 0; order < 2; order++) {
        char folder[64], scene[2048];
        cli_make_folder(folder);
        cli_write_file(folder, "a.xml", klems.data);
        cli_write_file(folder, "b.xml", tree.data);
        snprintf(scene, sizeof scene, "%s%s%s", order ? second : first, order ? first : second,
                 rest);
        cli_write_file(folder, "scene.rad", scene);
        scene_run_lx(&(struct scene_run){.source = folder,
                                         .names = names,
                                         .n_names = 1,
                                         .sensors = sensors,
                                         .n_sensors = 2,
                                         .samples = 256,
                                         .global = 10000,
                                         .caustic = 10000},
                     lx[order]);
        cli_remove_folder(folder);
    }
    assert_true(lx[0][0] > 0 && lx[0][1] > 0);
    stability_holds(21, "two BSDFs, loaded in either order",
                    "the same bits in a job's illuminances",
                    memcmp(lx[0], lx[1], sizeof lx[0]) == 0);
    free(klems.data);
    free(tree.data);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_14_no_numbers),
        cmocka_unit_test(test_19_deep_nesting),
        cmocka_unit_test(test_19_cut_short),
        cmocka_unit_test(test_19_braces_at_random),
        cmocka_unit_test(test_20_up_along_the_normal),
        cmocka_unit_test(test_21_draws),
        cmocka_unit_test(test_21_jobs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
