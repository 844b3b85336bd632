/* JSON objects decoded by tables of members: kinds, bounds, names, lists; and failing allocations.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "job/study_json.h"
#include "json/decode.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
#define FAILING 0 /* sanitizers replace the allocator; so does clang's static analysis */
#else
#define FAILING 1
static int calls, failing = -1; /* index of the allocation that fails; -1: none */
static long live;               /* blocks that are not freed */

extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void __libc_free(void *memory);

static bool fail_allocation(void)
{
    if (calls++ != failing) {
        live++;
        return false;
    }
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size)
{
    return fail_allocation() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return fail_allocation() ? NULL : __libc_calloc(count, size);
}

void free(void *memory)
{
    live -= memory != NULL;
    __libc_free(memory);
}
#endif

enum color { RED, GREEN, BLUE };

struct thing {
    double real, above_zero;
    uint64_t whole;
    uint32_t whole_32;
    int whole_int;
    bool flag;
    char *text;
    enum color color;
    double inner;
    double *reals;
    size_t n_reals;
    double sum;
};

static int decode_real(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_real(value, path, into, err);
}

static int add_real(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    double real = 0;
    const int rc = orl_json_real(value, path, &real, err);
    *(double *)into += real;
    return rc;
}

static const struct orl_json_schema any_number = {.least = -INFINITY, .most = INFINITY};

static int decode_sum(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    static const struct orl_json_schema sum = {.most_items = 2, .items = &any_number};
    return orl_json_each(value, path, &sum, add_real, into, err);
}

static const char *const colors[] = {"red", "green", "blue", NULL};
static const struct orl_json_schema real = {.least = -1, .most = 1, .meaning = "It is real."},
                                    above_zero = {.most = 5, .above = true, .below = true},
                                    positive = {.least = 0, .most = INFINITY, .above = true},
                                    whole = {.from = 1, .to = UINT64_MAX}, up_to_7 = {.to = 7},
                                    month = {.from = 1, .to = 12}, flag = {0},
                                    text_of_5 = {.longest = 5}, color = {.words = colors},
                                    one_to_3 = {
                                        .fewest_items = 1, .most_items = 3, .items = &any_number};
static const struct orl_json_schema inner_schema = {
    .members = (const struct orl_json_described[]){{"x", true, &any_number}, {0}}};
static const struct orl_json_schema thing_schema = {
    .members = (const struct orl_json_described[]){{"real", false, &real},
                                                   {"above", false, &above_zero},
                                                   {"positive", false, &positive},
                                                   {"whole", false, &whole},
                                                   {"whole_32", false, &up_to_7},
                                                   {"whole_int", false, &month},
                                                   {"flag", false, &flag},
                                                   {"text", true, &text_of_5},
                                                   {"color", false, &color},
                                                   {"inner", false, &inner_schema},
                                                   {"reals", false, &one_to_3},
                                                   {"sum", false, &flag},
                                                   {"elsewhere", false, &flag},
                                                   {0}}};

static int decode(const char *text, struct thing *thing, struct orl_error *err)
{
    const struct orl_json_list reals = {.items = &thing->reals,
                                        .count = &thing->n_reals,
                                        .size = sizeof *thing->reals,
                                        .each = decode_real};
    const struct orl_json_member inner[] = {{"x", .real = &thing->inner}, {0}};
    const struct orl_json_member members[] = {{"real", .real = &thing->real},
                                              {"above", .real = &thing->above_zero},
                                              {"positive", .real = &thing->above_zero},
                                              {"whole", .whole = &thing->whole},
                                              {"whole_32", .whole_32 = &thing->whole_32},
                                              {"whole_int", .whole_int = &thing->whole_int},
                                              {"flag", .flag = &thing->flag},
                                              {"text", .text = &thing->text},
                                              {"color", .word = &thing->color},
                                              {"inner", .members = inner},
                                              {"reals", .list = &reals},
                                              {"sum", .decode = decode_sum, .into = &thing->sum},
                                              {.name = "elsewhere"},
                                              {0}};
    json_t *doc = NULL;
    *thing = (struct thing){.color = BLUE, .whole_32 = 99};
    int rc = orl_json_parse(NULL, text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_json_members(doc, "it", &thing_schema, members, err);
    json_decref(doc);
    return rc;
}

static void done(struct thing *thing)
{
    free(thing->text);
    free(thing->reals);
}

static void test_every_kind(void **state)
{
    (void)state;
    struct thing t;
    struct orl_error err = {0};
    assert_int_equal(decode("{\"real\": 1, \"above\": 4.5, \"whole\": 2e6, \"whole_32\": 7,"
                            " \"whole_int\": 12, \"flag\": true, \"text\": \"hello\","
                            " \"color\": \"green\", \"inner\": {\"x\": 3}, \"reals\": [1, 2, 4],"
                            " \"sum\": [1, 2], \"elsewhere\": [[7]]}",
                            &t, &err),
                     0);
    assert_true(t.real == 1 && t.above_zero == 4.5 && t.whole == 2000000 && t.whole_32 == 7);
    assert_true(t.whole_int == 12 && t.flag && t.color == GREEN && t.inner == 3 && t.sum == 3);
    assert_string_equal(t.text, "hello");
    assert_true(t.n_reals == 3 && t.reals[2] == 4);
    done(&t);
}

static void test_absent_ones_are_left_alone(void **state)
{
    (void)state;
    struct thing t;
    struct orl_error err = {0};
    assert_int_equal(decode("{\"text\": \"a\"}", &t, &err), 0);
    assert_true(t.color == BLUE && t.whole_32 == 99 && !t.reals && t.n_reals == 0);
    done(&t);
}

static void test_mistakes(void **state)
{
    (void)state;
    static const struct {
        const char *text, *message, *hint;
        int code;
    } cases[] = {
        {"[]", "it: an object is expected here, not an array", "", ORL_ERR_INVALID},
        {"{}", "it.text: a string is expected here, not nothing", "", ORL_ERR_INVALID},
        {"{\"txt\": \"a\"}", "it.txt: there is no such member",
         "did you mean \"text\"? Known here: real, above, positive, whole, whole_32, whole_int, "
         "flag, text, color, inner, "
         "reals, "
         "sum, elsewhere",
         ORL_ERR_INVALID},
        {"{\"real\": null}", "it.real: a number is expected here, not null", "", ORL_ERR_INVALID},
        {"{\"real\": 1.01}", "it.real: it must be from -1 to 1", "It is real.", ORL_ERR_RANGE},
        {"{\"above\": 0}", "it.above: it must be above 0 and below 5", "", ORL_ERR_RANGE},
        {"{\"above\": 5}", "it.above: it must be above 0 and below 5", "", ORL_ERR_RANGE},
        {"{\"positive\": 0}", "it.positive: it must be above 0", "", ORL_ERR_RANGE},
        {"{\"whole\": 0}", "it.whole: a whole number from 1 to 18446744073709551615 is expected",
         "", ORL_ERR_RANGE},
        {"{\"whole_32\": 8}", "it.whole_32: a whole number from 0 to 7 is expected", "",
         ORL_ERR_RANGE},
        {"{\"whole_int\": 1.5}", "it.whole_int: a whole number from 1 to 12 is expected", "",
         ORL_ERR_RANGE},
        {"{\"flag\": 1}", "it.flag: true or false is expected here, not a number", "",
         ORL_ERR_INVALID},
        {"{\"text\": \"abcdef\"}", "it.text: 6 bytes; the limit is 5", "", ORL_ERR_LIMIT},
        {"{\"text\": \"\"}", "it.text: the string is empty", "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"color\": \"Red\"}",
         "it.color: \"red\", \"green\" or \"blue\" is expected here, not \"Red\"",
         "did you mean \"red\"?", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"color\": 0}",
         "it.color: \"red\", \"green\" or \"blue\" is expected here", "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"inner\": {}}", "it.inner.x: a number is expected here, not nothing",
         "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"inner\": {\"y\": 1}}", "it.inner.y: there is no such member",
         "Known here: x", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"reals\": []}", "it.reals: the list is empty", "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"reals\": {}}", "it.reals: an array is expected here, not an object",
         "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"reals\": [1, 2, 3, 4]}", "it.reals: 4 elements; the limit is 3", "",
         ORL_ERR_LIMIT},
        {"{\"text\": \"a\", \"reals\": [1, \"b\"]}",
         "it.reals[1]: a number is expected here, not a string", "", ORL_ERR_INVALID},
        {"{\"text\": \"a\", \"sum\": [1, 2, 3]}", "it.sum: 3 elements; the limit is 2", "",
         ORL_ERR_LIMIT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct thing t;
        struct orl_error err = {0};
        const int rc = decode(cases[i].text, &t, &err);
        done(&t);
        if (rc != cases[i].code || strcmp(err.message, cases[i].message) != 0 ||
            strcmp(err.hint, cases[i].hint) != 0)
            fail_msg("%s: %d, %s (%s)", cases[i].text, rc, err.message, err.hint);
    }
}

/* A row without a description is a fault of the program, even if the document lacks the member. */
static void test_rows_are_described(void **state)
{
    (void)state;
    double value = 0;
    const struct orl_json_member members[] = {{"y", .real = &value}, {0}};
    struct orl_error err = {0};
    json_t *doc = json_object();
    assert_int_equal(orl_json_members(doc, "it", &inner_schema, members, &err), ORL_ERR_INTERNAL);
    assert_string_equal(err.primitive, "it.y");
    json_decref(doc);
}

/* Very long names: paths are cut, and nothing is written past their end. */
static void test_long_names(void **state)
{
    (void)state;
    char text[1200], *end = text;
    struct thing t;
    struct orl_error err = {0};
    end += sprintf(text, "{\"");
    memset(end, 'n', 1000);
    strcpy(end + 1000, "\": 1}");
    assert_int_equal(decode(text, &t, &err), ORL_ERR_INVALID);
    assert_true(strncmp(err.primitive, "it.nnn", 6) == 0 && strlen(err.primitive) < 100);
    done(&t);
}

static const char whole_job[] =
    "{\"scene\": {\"files\": [\"a.rad\", \"b.rad\"]}, \"effects\": {\"caustics\": \"skip\"},"
    " \"sensors\": [[1, 2, 3, 0, 0, 1]], \"views\": [{\"name\": \"a\", \"file\": \"a.vf\","
    " \"entry\": 2, \"width\": 4, \"height\": 3, \"false_color\": {\"label\": \"lx\", \"points\":"
    " [{\"name\": \"p\", \"x\": 1, \"y\": 1}]}, \"metrics\": [\"dgp\"]}, {\"name\": \"b\","
    " \"view\": \"-vtv\", \"width\": 4, \"height\": 3}], \"heat_map\": {\"thresholds\": [1],"
    " \"length_unit\": \"ft\"}, \"skies\": ";
static const char *const some_skies[] = {
    "[{\"name\": \"n\", \"weather\": {\"file\": \"a.epw\", \"month\": 1, \"day\": 1, \"hour\": 9}},"
    " {\"cie\": {\"type\": \"overcast\", \"diffuse_horizontal_lx\": 1}}]}",
    "{\"weather\": {\"file\": \"a.epw\"}, \"normalise\": \"flux\", \"from\": {\"month\": 1, "
    "\"day\":"
    " 1, \"hour\": 9}, \"to\": {\"month\": 1, \"day\": 1, \"hour\": 11}}}"};
static const char whole_study[] =
    "{\"kind\": \"study\", \"title\": \"A room\", \"note\": \"Made up.\", \"scene\": {\"files\":"
    " [\"room.rad\"]}, \"sky\": {\"weather\": {\"file\": \"a.epw\", \"month\": 1, \"day\": 1,"
    " \"hour\": 9}}, \"sensors\": {\"file\": \"s.txt\"}, \"techniques\": [\"backward\","
    " \"direct\"], \"photons\": [1e4], \"gather_samples\": [64], \"reference\": {\"samples\": 5},"
    " \"points\": [{\"name\": \"By hand\", \"seconds\": 3600, \"rms\": 0.5}]}";

#if FAILING
static int decode_document(const json_t *doc, bool study, struct orl_error *err)
{
    struct orl_study_request request;
    struct orl_job job;
    const int rc = study ? orl_study_from_json(doc, ORL_JOB_LOCAL, &request, NULL, err)
                         : orl_job_from_json(doc, ORL_JOB_LOCAL, &job, NULL, err);
    if (rc == 0 && study)
        orl_study_request_done(&request);
    else if (rc == 0)
        orl_job_done(&job);
    return rc;
}

/* Each allocation fails once, alone: the result is an error, and all memory is freed. */
static void refuse_each(const char *text, bool study)
{
    struct orl_error err = {0};
    json_t *doc = NULL;
    assert_int_equal(orl_json_parse(NULL, text, strlen(text), &doc, &err), 0);
    calls = 0;
    if (decode_document(doc, study, &err) != 0)
        fail_msg("%s", err.message);
    const int most = calls;
    assert_true(most > 8);
    for (int i = 0; i < most; i++) {
        const long before = live;
        calls = 0;
        failing = i;
        const int rc = decode_document(doc, study, &err);
        failing = -1;
        if (rc != ORL_ERR_NOMEM || live != before)
            fail_msg("allocation %d of %d: %d, %s; %ld blocks are left", i, most, rc, err.message,
                     live - before);
    }
    json_decref(doc);
}

static void test_no_memory(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof some_skies / sizeof *some_skies; i++) {
        char text[2048];
        snprintf(text, sizeof text, "%s%s", whole_job, some_skies[i]);
        refuse_each(text, false);
    }
    refuse_each(whole_study, true);
}
#else
static void test_no_memory(void **state)
{
    (void)state, (void)whole_job, (void)some_skies, (void)whole_study;
    skip();
}
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_kind), cmocka_unit_test(test_absent_ones_are_left_alone),
        cmocka_unit_test(test_mistakes),   cmocka_unit_test(test_rows_are_described),
        cmocka_unit_test(test_long_names), cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
