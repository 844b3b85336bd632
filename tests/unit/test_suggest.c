/* Suggestions for unknown words. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/suggest.h>

static const char *const commands[] = {"run", "plan", "project", "annual", "submit", "status"};
enum { COMMANDS = sizeof commands / sizeof *commands };

static void assert_suggests(const char *word, const char *wanted)
{
    const char *const best = orl_suggest(word, commands, COMMANDS);
    if (wanted && !best)
        fail_msg("%s suggests nothing, not %s", word, wanted);
    if (wanted)
        assert_string_equal(best, wanted);
    else
        assert_null(best);
}

/* One insertion, deletion, replacement, or swap of neighbours is recognised. */
static void test_slips_are_recognised(void **state)
{
    (void)state;
    assert_suggests("rnu", "run");
    assert_suggests("plann", "plan");
    assert_suggests("anual", "annual");
    assert_suggests("sumbit", "submit");
    assert_suggests("stutas", "status");
    assert_suggests("PROJECT", "project");
}

/* The first letters of a word suggest it, from the third letter on. */
static void test_first_letters_suggest(void **state)
{
    (void)state;
    assert_suggests("proj", "project");
    assert_suggests("ann", "annual");
    assert_suggests("pr", NULL);
}

static void test_other_words_suggest_nothing(void **state)
{
    (void)state;
    char longest[3 * ORL_SUGGEST_LETTERS];
    memset(longest, 'a', sizeof longest);
    longest[sizeof longest - 1] = '\0';
    assert_suggests("teapot", NULL);
    assert_suggests("", NULL);
    assert_suggests(longest, NULL);
    assert_suggests("xyz", NULL);
}

/* The distance is that of optimal string alignment: no letter is changed twice, so "ca" and "abc"
 * are three changes apart, and the nearer word wins. */
static void test_nearest_word_wins(void **state)
{
    (void)state;
    struct orl_suggestion suggestion = {.word = "gathr"};
    orl_suggestion_add(&suggestion, "feather");
    assert_null(suggestion.best);
    orl_suggestion_add(&suggestion, "gatherer");
    orl_suggestion_add(&suggestion, "gather");
    assert_string_equal(suggestion.best, "gather");
    assert_int_equal(suggestion.distance, 1);
    suggestion = (struct orl_suggestion){.word = "gather_sampels"};
    orl_suggestion_add(&suggestion, "gather-samples");
    assert_int_equal(suggestion.distance, 1);
}

/* The hint precedes an earlier one. */
static void test_hint(void **state)
{
    (void)state;
    struct orl_error err = {0};
    struct orl_suggestion suggestion = {.word = "rnu"};
    orl_suggestion_hint(&suggestion, &err);
    assert_string_equal(err.hint, "");
    orl_suggestion_add(&suggestion, "run");
    orl_suggestion_hint(&suggestion, &err);
    assert_string_equal(err.hint, "did you mean \"run\"?");
    orl_error_hint(&err, "Known here: run");
    orl_suggestion_hint(&suggestion, &err);
    assert_string_equal(err.hint, "did you mean \"run\"? Known here: run");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_slips_are_recognised),
        cmocka_unit_test(test_first_letters_suggest),
        cmocka_unit_test(test_other_words_suggest_nothing),
        cmocka_unit_test(test_nearest_word_wins),
        cmocka_unit_test(test_hint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
