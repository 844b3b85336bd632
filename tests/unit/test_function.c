/*
 * The function language: expressions against rcalc's values, lazy evaluation, eight places at once
 * against one, bounds, error messages.
 *
 * tests/fixtures/functions.tsv has 300 expressions of support/random_expression.h with the value
 * from Radiance's rcalc (17 digits). Both programs add and multiply in the same way and call the
 * same C library. The remaining difference is the rounding of folded constants, 1e-12 of the
 * larger of 1 and the value.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "function/function.h"
#include "support/function_text.h"
#include "support/random_expression.h"

static void test_fixtures(void **state)
{
    FILE *const file = fopen("tests/fixtures/functions.tsv", "r");
    char line[1024];
    int n = 0;
    (void)state;
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        char *expression = NULL;
        const double right = strtod(line, &expression);
        assert_true(*expression == '\t');
        expression[strcspn(expression, "\n")] = '\0';
        function_check_near(expression,
                            function_value(random_expression_definitions, expression, NULL, NULL),
                            right);
        n++;
    }
    fclose(file);
    assert_int_equal(n, 300);
}

/* ---- Lazy evaluation ------------------------------------------------------------------------- */

static const char *const lazy =
    "pick(a, b) = if(a, a, b); climb(x) = pick(x, climb(x+1)); fact(n) = if(n-1.5, n*fact(n-1), 1);"
    "slope(f, x) = (f(x+1e-6) - f(x-1e-6))/2e-6; outer(f, x) = slope(f, x); cube(x) = x*x*x;"
    "many = Px*Px + 1; twice = many + many;";

static void test_lazy(void **state)
{
    double inputs[ORL_RAY_INPUTS] = {0};
    (void)state;
    inputs[ORL_RAY_PX] = -3.5;
    function_check_near("climb", function_value(lazy, "climb(Px)", inputs, NULL), .5);
    function_check_near("fact", function_value(lazy, "fact(5-Px+Px)", inputs, NULL), 120);
    function_check_near("twice", function_value(lazy, "twice", inputs, NULL), 26.5);
    assert_true(fabs(function_value(lazy, "outer(cube, Px)", inputs, NULL) - 36.75) < 1e-6);
    assert_true(fabs(function_value(lazy, "outer(sin, Px)", inputs, NULL) - cos(-3.5)) < 1e-6);
    function_check_near(
        "if", function_value(lazy, "slope(noop, Px) + 0*if(-1, nosuch(1), 2)", inputs, NULL),
        function_value(lazy, "slope(noop, Px)", inputs, NULL));
    function_check_near("arg", function_value("", "if(arg(0) - 3.5, arg(4), 42)", NULL, NULL), 42);
}

/* Expressions that depend on no input are folded to one number. */
static void test_constants(void **state)
{
    static const struct {
        const char *expression;
        bool constant;
    } rows[] = {{"fact(20)/fact(18)", true}, {"cube(3) + PI", true}, {"many", false},
                {"select(2, Px, 3)", true},  {"if(1, 2, Px)", true}, {"Px - Px", false}};
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct orl_error err = {0};
        double value;
        struct orl_function *const function = function_compile(lazy, rows[i].expression, &err);
        assert_non_null(function);
        assert_int_equal(orl_function_is_constant(function, 0, &value), rows[i].constant);
        assert_int_equal(orl_function_inputs(function) == 0, rows[i].constant);
        orl_function_free(function);
    }
}

/* Fixed inputs are constants; the remaining inputs are listed by name. */
static void test_fixed(void **state)
{
    static const char *const names[] = {"s", "t"};
    static const char *const expressions[] = {"x(s,t)", "s*2", "t"};
    const double fixed[] = {3, NAN}, inputs[] = {NAN, 5};
    const struct orl_function_request request = {
        .expressions = expressions, .n_expressions = 3, .fixed = fixed};
    struct orl_functions *const set = orl_functions_new(names, 2);
    struct orl_function *function = NULL;
    double values[3] = {0, 0, 0};
    const char *const text = "x(a,b) = a*10 + b;";
    (void)state;
    assert_int_equal(orl_functions_define(set, 0, NULL, 0, text, strlen(text), NULL), 0);
    assert_true(orl_functions_has(set, 0, "x"));
    assert_false(orl_functions_has(set, 0, "y"));
    assert_int_equal(orl_function_compile(set, &request, &function, NULL), 0);
    orl_functions_free(set);
    assert_int_equal(orl_function_inputs(function), 2);
    orl_function_at(function, function_scratch, inputs, values);
    assert_true(values[0] == 35 && values[1] == 6 && values[2] == 5);
    orl_function_free(function);
}

/* ---- Files ------------------------------------------------------------------------------------
 */

/* Each file has its own names; undefined ones come from the standard file. */
static void test_contexts(void **state)
{
    static const char *const names[] = {"a.cal", "b.cal"};
    static const char a[] =
        "c = 1; abs(x) = 7; f = c + abs(-2); g = `c; h = abs`(-2); later = q; q = 9;";
    static const char b[] = "f = c + abs(-2); c = 100; other = c`a;";
    const struct orl_file contents[] = {{a, sizeof a - 1, NULL}, {b, sizeof b - 1, NULL}};
    struct orl_memory_files memory = {names, contents, 2};
    const struct orl_files files = orl_files_from_memory(&memory);
    static const char *const expressions[] = {"f", "abs(-2)"};
    struct orl_functions *const set = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    static const double right[2][2] = {{8, 7}, {102, 2}};
    int context[3];
    (void)state;
    assert_int_equal(orl_functions_load(set, &files, "a.cal", false, &context[0], NULL), 0);
    assert_int_equal(orl_functions_load(set, &files, "b.cal", false, &context[1], NULL), 0);
    assert_int_equal(orl_functions_load(set, &files, "a.cal", false, &context[2], NULL), 0);
    assert_int_equal(context[0], context[2]);
    for (int i = 0; i < 2; i++) {
        const struct orl_function_request request = {
            .context = context[i], .expressions = expressions, .n_expressions = 2};
        struct orl_function *function = NULL;
        double values[2];
        assert_int_equal(orl_function_compile(set, &request, &function, NULL), 0);
        orl_function_at(function, function_scratch, NULL, values);
        assert_true(values[0] == right[i][0] && values[1] == right[i][1]);
        orl_function_free(function);
    }
    static const char *const marked[] = {"g", "h", "later", "c`b"};
    const struct orl_function_request request = {
        .context = context[0], .expressions = marked, .n_expressions = 4};
    struct orl_function *function = NULL;
    double values[4];
    assert_int_equal(orl_function_compile(set, &request, &function, NULL), 0);
    orl_function_at(function, function_scratch, NULL, values);
    assert_true(values[0] == 1 && values[1] == 2 && values[2] == 9 && values[3] == 100);
    orl_function_free(function);
    orl_functions_free(set);
}

/* ---- Eight at once ----------------------------------------------------------------------------
 */

/* Lanes take different branches; each has the same value as evaluated alone, undefined values
 * included. */
static void test_lanes(void **state)
{
    static const char *const expressions[] = {
        "if(Px, if(Py, climb(Py-2), many), fact(4-Px) + twice)",
        "select(Px+3, 1, Py, sin(Py), climb(Py-1), fact(3)) + noise3(Px,Py,.5)",
        "pick(Px, pick(Py, Px*Py)) + sqrt(Px) + if(Py, 1/Px, log(Py))",
        "outer(cube, Px) + outer(cos, Py) + rand(Px+10*Py) + select(Px+4, 1, 2, 3, 4, 5, 6)",
        "turbulence(Px/3, Py/7, .1, if(Px, .05, .3)) + arg(Px) + -Px^(Py/2)",
    };
    (void)state;
    for (size_t e = 0; e < sizeof expressions / sizeof *expressions; e++) {
        struct orl_error err = {0};
        struct orl_function *const function = function_compile(lazy, expressions[e], &err);
        if (!function)
            fail_msg("%s: %s", expressions[e], err.message);
        for (unsigned lanes = 1; lanes < 256; lanes++) {
            struct orl_function_lanes inputs[ORL_RAY_INPUTS], values;
            for (int l = 0; l < ORL_FUNCTION_LANES; l++) {
                inputs[ORL_RAY_PX].at[l] = (l * 5 + (int)lanes) % 7 - 3;
                inputs[ORL_RAY_PY].at[l] = (l * 3 + (int)lanes / 7) % 5 - 2;
                values.at[l] = 1234;
            }
            const struct orl_function_outcome all =
                orl_function_evaluate(function, function_scratch, inputs, lanes, &values);
            assert_false(all.exceeded);
            for (int l = 0; l < ORL_FUNCTION_LANES; l++) {
                double alone[ORL_RAY_INPUTS] = {0}, value = 1234;
                struct orl_function_outcome one = {0};
                alone[ORL_RAY_PX] = inputs[ORL_RAY_PX].at[l];
                alone[ORL_RAY_PY] = inputs[ORL_RAY_PY].at[l];
                if (lanes >> l & 1)
                    one = orl_function_at(function, function_scratch, alone, &value);
                assert_memory_equal(&value, &values.at[l], sizeof value);
                assert_int_equal(all.undefined >> l & 1, one.undefined);
            }
        }
        orl_function_free(function);
    }
}

/* ---- Undefined values, and limits ------------------------------------------------------------ */

static void test_undefined(void **state)
{
    static const char *const expressions[] = {"1/0",
                                              "log(0)",
                                              "sqrt(-1)",
                                              "asin(2)",
                                              "exp(1000)",
                                              "(-8)^(1/3)",
                                              "0^-1",
                                              "select(4,1,2,3)",
                                              "select(-1,1,2)",
                                              "10^400",
                                              "log10(-1)",
                                              "arg(3+Px)",
                                              "noise3(1e300,0,0)",
                                              "noise3x(1e300,0,0)",
                                              "noise3y(0,1e300,0)",
                                              "noise3z(0,0,1e300)"};
    double inputs[ORL_RAY_INPUTS] = {0};
    (void)state;
    inputs[ORL_RAY_PX] = 4;
    for (size_t i = 0; i < sizeof expressions / sizeof *expressions; i++) {
        struct orl_function_outcome outcome = {0};
        assert_true(function_value("", expressions[i], inputs, &outcome) == 0);
        assert_int_equal(outcome.undefined, 1);
        assert_false(outcome.exceeded);
    }
}

static void test_exceeded(void **state)
{
    static const char *const definitions = "a = b; b = a; count(n) = if(n, 1 + count(n-1), 0); "
                                           "grow(n) = if(n, grow(n-1)+grow(n-1), 1);";
    static const char *const expressions[] = {"a", "count(1e5+Px)", "grow(60+Px)", "grow(70)"};
    double inputs[ORL_RAY_INPUTS] = {0};
    (void)state;
    function_check_near("count", function_value(definitions, "count(900+Px)", inputs, NULL), 900);
    for (size_t i = 0; i < sizeof expressions / sizeof *expressions; i++) {
        struct orl_function_outcome outcome = {0};
        assert_true(function_value(definitions, expressions[i], inputs, &outcome) == 0);
        assert_true(outcome.exceeded);
    }
}

static void test_errors(void **state)
{
    static const struct {
        const char *definitions, *expression, *file;
        int line, code;
        const char *says;
    } rows[] = {
        {"a = 1;\nb = 2 3;", "a", "some.cal", 2, ORL_ERR_SYNTAX, "';' is expected, not '3'"},
        {"a = sin(2;", "a", "some.cal", 1, ORL_ERR_SYNTAX, "')' is expected"},
        {"\n{ b = 1;", "a", "some.cal", 2, ORL_ERR_SYNTAX, "is not closed"},
        {"a = 1e;", "a", "some.cal", 1, ORL_ERR_SYNTAX, "number"},
        {"a = --2;", "a", "some.cal", 1, ORL_ERR_SYNTAX, "expected"},
        {"a 2;", "a", "some.cal", 1, ORL_ERR_SYNTAX, "'=' or ':'"},
        {"f(1) = 2;", "f(1)", "some.cal", 1, ORL_ERR_SYNTAX, "parameter"},
        {"f(a,b) = a;", "f(1)", "scene.rad", 7, ORL_ERR_SYNTAX, "takes 2 arguments, 1 are"},
        {"", "sin()", "scene.rad", 7, ORL_ERR_SYNTAX, "a number, a name"},
        {"", "if(Px,2)", "scene.rad", 7, ORL_ERR_SYNTAX, "takes 3"},
        {"f(g) = g(1);", "f(3)", "scene.rad", 7, ORL_ERR_SYNTAX, "must be a function"},
        {"", "sin", "scene.rad", 7, ORL_ERR_SYNTAX, "is a function"},
        {"\n\nb = nosuch + 1;", "b", "some.cal", 3, ORL_ERR_NOT_FOUND, "'nosuch' is not defined"},
        {"", "nosuch(1)", "scene.rad", 7, ORL_ERR_NOT_FOUND, "'nosuch()' is not defined"},
        {"", "arg(4)", "scene.rad", 7, ORL_ERR_RANGE, "argument 4"},
        {"", "1 2", "scene.rad", 7, ORL_ERR_SYNTAX, "operator"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct orl_error err = {0};
        assert_null(function_compile(rows[i].definitions, rows[i].expression, &err));
        assert_int_equal(err.code, rows[i].code);
        assert_string_equal(err.file, rows[i].file);
        assert_int_equal(err.line, rows[i].line);
        assert_true(err.hint[0] != '\0');
        if (!strstr(err.message, rows[i].says))
            fail_msg("'%s' does not say '%s'", err.message, rows[i].says);
    }
}

/* Nesting to the limit is accepted, and one level deeper is refused. */
static void test_nesting(void **state)
{
    char text[2 * ORL_FUNCTION_NESTING + 8];
    (void)state;
    for (int over = 0; over < 2; over++) {
        const int depth = ORL_FUNCTION_NESTING - 1 + over;
        struct orl_error err = {0};
        memset(text, '(', (size_t)depth);
        text[depth] = '1';
        memset(text + depth + 1, ')', (size_t)depth);
        text[2 * depth + 1] = '\0';
        struct orl_function *const function = function_compile("", text, &err);
        assert_int_equal(err.code, over ? ORL_ERR_LIMIT : 0);
        orl_function_free(function);
    }
}

/* ---- Comparison with rcalc, if it is installed ----------------------------------------------- */

enum { BESIDE = 400 };

/* Gets rcalc's value of an expression. Returns false if rcalc reports an undefined value. */
static bool ask_rcalc(const char *folder, const char *expression, double *ret_value)
{
    char path[128], command[256];
    snprintf(path, sizeof path, "%s/one.cal", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "%s$1 = %s;\n", random_expression_definitions, expression);
    fclose(file);
    snprintf(command, sizeof command, "cd %s && rcalc -n -od -f ./one.cal 2>words", folder);
    FILE *const pipe = popen(command, "r");
    assert_non_null(pipe);
    const size_t n = fread(ret_value, sizeof *ret_value, 1, pipe);
    pclose(pipe);
    snprintf(path, sizeof path, "%s/words", folder);
    FILE *const words = fopen(path, "r");
    const bool complained = words && fgetc(words) != EOF;
    if (words)
        fclose(words);
    return n == 1 && !complained;
}

static void test_beside_rcalc(void **state)
{
    char folder[] = "/tmp/oriel-test-XXXXXX", text[512], command[64];
    int compared = 0;
    (void)state;
    if (system("command -v rcalc >/dev/null 2>&1") != 0)
        skip();
    assert_non_null(mkdtemp(folder));
    for (uint64_t i = 0; i < BESIDE; i++) {
        struct orl_function_outcome outcome = {0};
        double right = 0;
        random_expression_write(1000000 + i, text, sizeof text);
        const double value = function_value(random_expression_definitions, text, NULL, &outcome);
        if (!ask_rcalc(folder, text, &right) || outcome.undefined)
            continue;
        function_check_near(text, value, right);
        compared++;
    }
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
    print_message("# %d of %d expressions have a value, and rcalc's\n", compared, BESIDE);
    assert_true(compared > BESIDE / 3);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fixtures),     cmocka_unit_test(test_lazy),
        cmocka_unit_test(test_constants),    cmocka_unit_test(test_fixed),
        cmocka_unit_test(test_contexts),     cmocka_unit_test(test_lanes),
        cmocka_unit_test(test_undefined),    cmocka_unit_test(test_exceeded),
        cmocka_unit_test(test_errors),       cmocka_unit_test(test_nesting),
        cmocka_unit_test(test_beside_rcalc),
    };
    return cmocka_run_group_tests(tests, function_set_up, function_tear_down);
}
