/* JSON values to text and back: all of it, or none if memory runs out anywhere. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/json_read.h>

#include "json/encode.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(__clang__)
#define FAILING 0 /* sanitizers replace the allocator; so does clang's static analysis */
#else
#define FAILING 1
static int calls, failing = -1; /* index of the malloc call that fails; -1: none */

extern void *__libc_malloc(size_t size);

void *malloc(size_t size)
{
    if (calls++ != failing)
        return __libc_malloc(size);
    errno = ENOMEM;
    return NULL;
}
#endif

static int allocations, fails_at; /* index of jansson's allocation that fails; -1: none */

static void *allocate(size_t size)
{
    return allocations++ == fails_at ? NULL : malloc(size);
}

static json_t *make_document(void)
{
    json_t *doc = json_object();
    for (int i = 0; i < 40; i++) {
        char key[200];
        snprintf(key, sizeof key, "%*s%d", 3 * i, "a key", i);
        json_object_set_new(doc, key, json_pack("{s:[i,f], s:s}", "numbers", i, 0.5, "text", key));
    }
    return doc;
}

static void test_text(void **state)
{
    json_t *doc = make_document(), *again;
    (void)state;
    char *text = orl_json_text(doc, JSON_COMPACT | JSON_SORT_KEYS);
    char *wanted = json_dumps(doc, JSON_COMPACT | JSON_SORT_KEYS);
    assert_string_equal(text, wanted);
    again = json_loads(text, 0, NULL);
    assert_true(json_equal(doc, again));
    assert_null(orl_json_text(NULL, 0));
    json_decref(again);
    json_decref(doc);
    free(text);
    free(wanted);
}

/* If any single allocation fails, the result is no text or all of it. */
static void test_memory(void **state)
{
    json_t *doc = make_document();
    char *whole = orl_json_text(doc, JSON_COMPACT | JSON_SORT_KEYS);
    (void)state;
    assert_non_null(whole);
    json_set_alloc_funcs(allocate, free);
    allocations = 0, fails_at = -1;
    free(orl_json_text(doc, JSON_COMPACT | JSON_SORT_KEYS));
    const int most = allocations;
    for (fails_at = 0; fails_at < most; fails_at++) {
        allocations = 0;
        char *text = orl_json_text(doc, JSON_COMPACT | JSON_SORT_KEYS);
        if (text)
            assert_string_equal(text, whole);
        free(text);
    }
    fails_at = -1;
    json_set_alloc_funcs(malloc, free);
    json_decref(doc);
    free(whole);
    assert_true(most > 0);
}

/* Strings and keys are not cut if memory runs out; later numbers do not hide the error. */
static void test_reading_without_memory(void **state)
{
    (void)state;
#if FAILING
    json_t *doc = make_document();
    char *text = orl_json_text(doc, JSON_COMPACT);
    assert_non_null(text);
    calls = 0;
    json_decref(orl_json_read_stored(text));
    const int most = calls;
    assert_true(most > 100);
    for (int i = 0; i < most; i++) {
        failing = i, calls = 0;
        json_t *read = orl_json_read_stored(text);
        failing = -1;
        assert_true(read ? json_equal(read, doc) : errno == ENOMEM);
        json_decref(read);
    }
    json_decref(doc);
    free(text);
#else
    skip();
#endif
}

static void test_reading(void **state)
{
    json_error_t where;
    (void)state;
    assert_null(orl_json_read_stored(NULL));
    assert_int_equal(errno, 0);
    assert_null(orl_json_read("{\"a\": 1,}", 9, 0, &where));
    assert_int_equal(errno, 0);
    assert_int_equal(where.line, 1);
    assert_null(orl_json_read("{\"a\": 1, \"a\": 2}", 16, JSON_REJECT_DUPLICATES, NULL));
    json_t *read = orl_json_read("[1, 2]garbage", 6, 0, NULL);
    assert_int_equal(json_array_size(read), 2);
    json_decref(read);
}

int main(void)
{
    /* The last test replaces the reader's allocator. */
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text), cmocka_unit_test(test_reading),
        cmocka_unit_test(test_reading_without_memory), cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
