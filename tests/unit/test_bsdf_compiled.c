/* Compiled BSDF files (the in-memory layout): they evaluate as the XML does, or are refused. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <unistd.h>

#include "bsdf/loaded_bsdf.h"
#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"
#include "support/scene_text.h"

static const unsigned char content[ORL_COMPILED_DIGEST] = {1, 2, 3};

/* Returns a file with values of one component in each channel: a tree of either rank, or a matrix.
 */
static struct text make_colored_file(const char *structure, const char *basis)
{
    static const char *const of_trees[] = {"Visible", "CIE-u", "CIE-v"};
    static const char *const of_matrices[] = {"Visible", "CIE-X", "CIE-Z"};
    static const double values[] = {0.2, 0.25, 0.5};
    static const double origin[4] = {0, 0, 0, 0};
    struct text t;
    text_open(&t);
    make_head(t.stream, structure);
    for (int k = 0; k < 3; k++) {
        make_block_head(t.stream, (basis ? of_matrices : of_trees)[k], "Transmission Front", basis);
        if (basis)
            for (int i = 0; i < 41 * 41; i++)
                fprintf(t.stream, "%g ", values[k] * (1 + i % 7));
        else if (k == 0 && strcmp(structure, "TensorTree4") == 0)
            make_tree_node(t.stream, origin, 1, 0.125);
        else
            fprintf(t.stream, "{ %g }\n", values[k]);
        make_block_tail(t.stream);
    }
    make_tail(t.stream);
    text_close(&t);
    return t;
}

static void make_path(char path[64])
{
    snprintf(path, 64, "/tmp/oriel-test-XXXXXX");
    const int fd = mkstemp(path);
    assert_true(fd >= 0);
    close(fd);
}

static struct orl_bsdf *load(struct text t)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    if (orl_bsdf_load_xml("made.xml", t.data, t.size, &bsdf, &err) < 0)
        fail_msg("%s", err.message);
    free(t.data);
    return bsdf;
}

static void write_to(const struct orl_bsdf *bsdf, const char *path)
{
    uint64_t bytes = 0;
    struct orl_error err = {0};
    if (orl_bsdf_write(bsdf, content, path, &bytes, &err) < 0)
        fail_msg("%s", err.message);
    size_t size;
    free(scene_read_bytes(path, &size));
    assert_int_equal(size, bytes);
}

/* ---- Equal values ---------------------------------------------------------------------------- */

struct answers {
    struct orl_rgb f, albedo, straight, weight[2];
    struct orl_vec3 drawn[2];
    double pdf[2], part;
};

static struct answers evaluate_all(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                   struct orl_vec3 out, const double u[3])
{
    struct answers a;
    memset(&a, 0, sizeof a);
    a.f = orl_bsdf_eval(bsdf, in, out);
    a.albedo = orl_bsdf_albedo(bsdf, in, ORL_BSDF_BOTH);
    a.straight = orl_bsdf_straight(bsdf, in);
    a.part = orl_bsdf_straight_part(bsdf, in, out);
    orl_bsdf_sample(bsdf, in, ORL_BSDF_BOTH, u, &a.drawn[0], &a.weight[0], &a.pdf[0]);
    orl_bsdf_sample_adjoint(bsdf, in, ORL_BSDF_BOTH, u, &a.drawn[1], &a.weight[1], &a.pdf[1]);
    return a;
}

static void assert_same_bsdf(const struct orl_bsdf *a, const struct orl_bsdf *b)
{
    static const double places[] = {-0.9, -0.35, 0.01, 0.2, 0.6};
    struct orl_bsdf_check check[2];
    for (int i = 0; i < 2 * 2 * 625; i++) {
        const double ax = places[i % 5], ay = places[i / 5 % 5] * sqrt(1 - ax * ax);
        const double bx = places[i / 25 % 5], by = places[i / 125 % 5] * sqrt(1 - bx * bx);
        const struct orl_vec3 in = direction(ax, ay, i % 2 ? 1 : -1);
        const struct orl_vec3 out = direction(bx, by, i / 2 % 2 ? 1 : -1);
        const double u[3] = {i % 97 / 97.0, i % 89 / 89.0, i % 83 / 83.0};
        const struct answers x = evaluate_all(a, in, out, u), y = evaluate_all(b, in, out, u);
        assert_memory_equal(&x, &y, sizeof x);
    }
    memset(check, 0, sizeof check);
    orl_bsdf_examine(a, &check[0]);
    orl_bsdf_examine(b, &check[1]);
    assert_memory_equal(&check[0], &check[1], sizeof check[0]);
}

static void what_is_kept_answers_as_from_xml(void **state)
{
    struct text made[] = {make_tree_file(4),
                          make_iso_file(4),
                          make_clear_file(5, 0.6, 0.2),
                          make_colored_file("TensorTree4", NULL),
                          make_colored_file("TensorTree3", NULL),
                          make_colored_file("Columns", "LBNL/Klems Quarter"),
                          make_file("TensorTree4", "Reflection Front", NULL, "{0.2}"),
                          {NULL, 0, NULL},
                          {NULL, 0, NULL}};
    static const char *const fixtures[] = {"tests/fixtures/bsdf_lcp8.xml",
                                           "tests/fixtures/bsdf_klems41.xml"};
    const size_t count = sizeof made / sizeof *made;
    (void)state;
    for (size_t i = 0; i < 2; i++)
        made[count - 2 + i].data = (char *)scene_read_bytes(fixtures[i], &made[count - 2 + i].size);
    for (size_t i = 0; i < count; i++) {
        struct orl_bsdf *bsdf = load(made[i]), *kept = NULL;
        struct orl_error err = {0};
        char path[64];
        make_path(path);
        write_to(bsdf, path);
        if (orl_bsdf_open(path, content, &kept, &err) < 0)
            fail_msg("%s", err.message);
        unlink(path); /* an open BSDF outlives its file */
        assert_same_bsdf(bsdf, kept);
        orl_bsdf_unref(bsdf);
        orl_bsdf_unref(orl_bsdf_ref(kept));
        orl_bsdf_unref(kept);
    }
}

/* ---- Damage ---------------------------------------------------------------------------------- */

static void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

static int open_code(const char *path)
{
    struct orl_bsdf *bsdf = NULL;
    struct orl_error err = {0};
    const int code = orl_bsdf_open(path, content, &bsdf, &err);
    if (code < 0) {
        assert_null(bsdf);
        assert_true(err.message[0] != '\0');
    }
    orl_bsdf_unref(bsdf);
    return code;
}

static void a_damaged_file_is_refused(void **state)
{
    char path[64];
    size_t size;
    struct orl_bsdf *bsdf = load(make_tree_file(2));
    (void)state;
    make_path(path);
    write_to(bsdf, path);
    orl_bsdf_unref(bsdf);
    unsigned char *bytes = scene_read_bytes(path, &size);
    for (size_t at = 0; at < size; at += at < 256 ? 1 : 61) {
        bytes[at] ^= (unsigned char)(1U << at % 8);
        write_bytes(path, bytes, size);
        const int code = open_code(path);
        assert_true(code == ORL_ERR_CORRUPT || (code == ORL_ERR_VERSION && at >= 8 && at < 24));
        bytes[at] ^= (unsigned char)(1U << at % 8);
    }
    for (size_t cut = 0; cut < size; cut += 97) {
        write_bytes(path, bytes, cut);
        assert_int_equal(open_code(path), ORL_ERR_CORRUPT);
    }
    write_bytes(path, bytes, size);
    assert_int_equal(open_code(path), 0);
    unlink(path);
    assert_int_equal(open_code(path), ORL_ERR_IO);
    free(bytes);
}

static void another_files_bsdf_is_refused(void **state)
{
    static const unsigned char other[ORL_COMPILED_DIGEST] = {3, 2, 1};
    struct orl_bsdf *bsdf = load(make_tree_file(2)), *kept = NULL;
    char path[64];
    (void)state;
    make_path(path);
    write_to(bsdf, path);
    assert_int_equal(orl_bsdf_open(path, other, &kept, NULL), ORL_ERR_CORRUPT);
    assert_null(kept);
    unlink(path);
    orl_bsdf_unref(bsdf);
}

static void a_path_that_is_none_is_an_error(void **state)
{
    struct orl_bsdf *bsdf = load(make_tree_file(2));
    struct orl_error err = {0};
    uint64_t bytes;
    (void)state;
    assert_int_equal(orl_bsdf_write(bsdf, content, "/nowhere/at/all", &bytes, &err), ORL_ERR_IO);
    orl_bsdf_unref(bsdf);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_kept_answers_as_from_xml),
        cmocka_unit_test(a_damaged_file_is_refused),
        cmocka_unit_test(another_files_bsdf_is_refused),
        cmocka_unit_test(a_path_that_is_none_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
