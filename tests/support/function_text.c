#include "support/function_text.h"

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

const double function_tolerance = 1e-12;
struct orl_function_scratch *function_scratch;

int function_set_up(void **state)
{
    (void)state;
    function_scratch = orl_function_scratch_new();
    return function_scratch ? 0 : -1;
}

int function_tear_down(void **state)
{
    (void)state;
    orl_function_scratch_free(function_scratch);
    return 0;
}

static const double arguments[] = {5, 6, 7};

struct orl_function *function_compile(const char *definitions, const char *expression,
                                      struct orl_error *err)
{
    struct orl_functions *const set = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    struct orl_function *function = NULL;
    const struct orl_function_request request = {.expressions = &expression,
                                                 .n_expressions = 1,
                                                 .arguments = arguments,
                                                 .n_arguments = 3,
                                                 .file = "scene.rad",
                                                 .line = 7};
    assert_non_null(set);
    int code = orl_functions_define(set, ORL_FUNCTION_GLOBAL, "some.cal", 1, definitions,
                                    strlen(definitions), err);
    if (code == 0)
        code = orl_function_compile(set, &request, &function, err);
    assert_int_equal(code == 0, function != NULL);
    if (code < 0)
        assert_int_equal(err->code, code);
    orl_functions_free(set);
    return function;
}

double function_value(const char *definitions, const char *expression, const double *inputs,
                      struct orl_function_outcome *ret_outcome)
{
    struct orl_error err = {0};
    double value = NAN;
    struct orl_function *const function = function_compile(definitions, expression, &err);
    if (!function)
        fail_msg("%s: %s", expression, err.message);
    const struct orl_function_outcome outcome =
        orl_function_at(function, function_scratch, inputs, &value);
    if (ret_outcome)
        *ret_outcome = outcome;
    orl_function_free(function);
    return value;
}

void function_check_near(const char *expression, double value, double right)
{
    if (!(fabs(value - right) <= function_tolerance * fmax(1, fabs(right))))
        fail_msg("%s is %.17g, not %.17g", expression, right, value);
}
