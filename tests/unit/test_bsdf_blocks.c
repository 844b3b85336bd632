/* Trees of a BSDF file whose data blocks are deferred and parsed in parallel: the same BSDF and
 * the same errors as in sequence. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <oriel/base/thread_pool.h>

#include "fixtures/bsdf_ask.h"
#include "fixtures/bsdf_make.h"

enum { FAR = 100000 }; /* lines before a block's data: beyond the first slice */

static const char *const parts[] = {"Transmission Front", "Transmission Back", "Reflection Front",
                                    "Reflection Back"};

/* Returns a file of four blocks, one data text each, then the rest. */
static struct text make_blocks(const char *const data[4], const char *rest)
{
    struct text t;
    text_open(&t);
    fputs("<WindowElement>\n<Optical>\n<Layer>\n<DataDefinition>\n"
          "<IncidentDataStructure>TensorTree4</IncidentDataStructure>\n</DataDefinition>\n",
          t.stream);
    for (int i = 0; i < 4; i++) {
        fprintf(t.stream,
                "<WavelengthData><Wavelength>Visible</Wavelength>\n<WavelengthDataBlock>\n"
                "<WavelengthDataDirection>%s</WavelengthDataDirection>\n"
                "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n<ScatteringData>\n",
                parts[i]);
        for (int k = 0; k < FAR; k++)
            fputs("             \n", t.stream); /* expat reports line ends apart from text */
        fprintf(t.stream, "%s</ScatteringData></WavelengthDataBlock></WavelengthData>\n", data[i]);
    }
    fputs(rest, t.stream);
    text_close(&t);
    return t;
}

static int load(const struct text *t, uint32_t threads, const atomic_bool *cancel,
                struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    struct orl_thread_pool *pool = threads > 1 ? orl_thread_pool_start(threads) : NULL;
    const struct orl_bsdf_xml xml = {
        .name = "blocks.xml", .data = t->data, .size = t->size, .cancel = cancel, .pool = pool};
    const int code = orl_bsdf_load(&xml, ret_bsdf, err);
    orl_thread_pool_stop(pool);
    return code;
}

#define WHOLE "</Layer>\n</Optical>\n</WindowElement>\n"

/* Expat sees some blocks, not others; the fourth continues behind a comment and a reference. */
static void each_block_comes_to_its_part(void **state)
{
    static const char *const data[] = {"{.125}", "{.125}", "{0.0625}", "{.03<!-- -->12&#53;}"};
    const struct text t = make_blocks(data, WHOLE);
    (void)state;
    for (uint32_t threads = 1; threads <= 3; threads++) {
        struct orl_bsdf *bsdf = NULL;
        assert_int_equal(load(&t, threads, NULL, &bsdf, NULL), 0);
        const struct orl_vec3 front = direction(0.1, 0.2, 1), back = direction(0.1, 0.2, -1);
        assert_close(eval(bsdf, front, back), 0.125, 0);
        assert_close(eval(bsdf, back, direction(0.3, 0, -1)), 0.0625, 0);
        assert_close(eval(bsdf, front, direction(0.3, 0, 1)), 0.03125, 0);
        orl_bsdf_unref(bsdf);
    }
    free(t.data);
}

/* The first error in the file is reported, whichever thread finds another one first. */
static void the_first_error_is_told(void **state)
{
    enum { LINES_BEFORE = 6, HEAD = 5, TAIL = 1 };
    static const struct {
        const char *data[4], *rest, *message;
        int block; /* 0 to 3; 4: behind them */
    } bad[] = {
        {{"{.1}", "{.1x}", "{.2 .3}", "{.1}"}, "</Wrong>", "'.1x' is not a number", 1},
        {{"{.1}", "{.1}", "{.2 .3}", "{.1}"}, "</Wrong>", "a grid of 2 values", 2},
        {{"{.1}", "{.1}", "{.2", "{.1y}"}, WHOLE, "ends with 1 braces open", 2},
        {{"{.1}", "{.1}", "{.2}", "{.1&#48;}}"}, "</Wrong>", "'}' without a matching '{'", 3},
        {{"{.1}", "{.1}", "{.2}", "{.1}"}, "</Wrong>", "XML", 4},
    };
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (uint32_t threads = 1; threads <= 2; threads++) {
            const struct text t = make_blocks(bad[i].data, bad[i].rest);
            struct orl_bsdf *bsdf = NULL;
            struct orl_error err = {0};
            assert_int_equal(load(&t, threads, NULL, &bsdf, &err), ORL_ERR_SYNTAX);
            assert_non_null(strstr(err.message, bad[i].message));
            assert_int_equal(err.line, LINES_BEFORE + bad[i].block * (HEAD + FAR + TAIL) +
                                           (bad[i].block < 4 ? HEAD + FAR : 0) + 1);
            if (bad[i].block < 4)
                assert_non_null(strstr(err.primitive, parts[bad[i].block]));
            assert_null(bsdf);
            free(t.data);
        }
}

static void a_cancelled_one_says_so(void **state)
{
    static const char *const data[] = {"{.1}", "{.1}", "{.1}", "{.1}"};
    const struct text t = make_blocks(data, WHOLE);
    struct orl_bsdf *bsdf = NULL;
    atomic_bool cancel = true;
    (void)state;
    assert_int_equal(load(&t, 2, &cancel, &bsdf, NULL), ORL_ERR_CANCELLED);
    free(t.data);
}

/* Sets the flag when the reader reports slice number `at`. */
struct trap {
    atomic_bool cancel;
    atomic_int calls;
    int at;
};

static void step(void *ctx, size_t begin, size_t end)
{
    struct trap *trap = ctx;
    (void)begin, (void)end;
    if (atomic_fetch_add(&trap->calls, 1) == trap->at)
        atomic_store(&trap->cancel, true);
}

/* Cancels between any two slices, also between the last of a block and the first of the next: the
 * error names no line. */
static void cancels_anywhere_blame_no_line(void **state)
{
    static const char *const data[] = {"{.1}", "{.1}", "{.1}", "{.1}"};
    const struct text t = make_blocks(data, WHOLE);
    int cancelled = 0, code = ORL_ERR_CANCELLED;
    (void)state;
    for (int at = 0; code != 0; at++) {
        struct trap trap = {.at = at};
        struct orl_bsdf *bsdf = NULL;
        struct orl_error err = {0};
        const struct orl_bsdf_xml xml = {.name = "blocks.xml",
                                         .data = t.data,
                                         .size = t.size,
                                         .cancel = &trap.cancel,
                                         .passed = step,
                                         .ctx = &trap};
        code = orl_bsdf_load(&xml, &bsdf, &err);
        assert_true(code == ORL_ERR_CANCELLED || (code == 0 && trap.calls <= at + 1));
        assert_int_equal(err.line, 0);
        assert_int_equal(bsdf != NULL, code == 0);
        cancelled += code != 0;
        orl_bsdf_unref(bsdf);
    }
    assert_in_range(cancelled, 4, 1000);
    free(t.data);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_block_comes_to_its_part),
        cmocka_unit_test(the_first_error_is_told),
        cmocka_unit_test(a_cancelled_one_says_so),
        cmocka_unit_test(cancels_anywhere_blame_no_line),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
