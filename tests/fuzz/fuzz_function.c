/*
 * Function files: the first line is an expression over the definitions in the rest. Eight places
 * are evaluated together. Where they take different branches, each value must equal, bit for bit,
 * the value of that place evaluated alone.
 */
#include <string.h>

#include "function/function.h"
#include "fuzz/fuzz.h"

static const double arguments[] = {1, -2, .5};

/* Returns NULL if the function is refused. */
static struct orl_function *compile(struct orl_functions *set, const char *text, size_t size)
{
    char expression[512];
    const char *const end = memchr(text, '\n', size);
    const size_t length = end ? (size_t)(end - text) : size;
    const char *const expressions[] = {expression, "x", "y"};
    const struct orl_function_request request = {.expressions = expressions,
                                                 .n_expressions = end ? 1 : 3,
                                                 .arguments = arguments,
                                                 .n_arguments = 3,
                                                 .operations = 3000,
                                                 .file = "scene.rad",
                                                 .line = 1};
    struct orl_function *function = NULL;
    struct orl_error err = {0};
    if (length >= sizeof expression)
        return NULL;
    memcpy(expression, text, length);
    expression[length] = '\0';
    int code = orl_functions_define(set, ORL_FUNCTION_GLOBAL, "some.cal", 2, text + length,
                                    size - length, &err);
    if (code == 0)
        code = orl_function_compile(set, &request, &function, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    return function;
}

static void evaluate(const struct orl_function *function)
{
    struct orl_function_scratch *const scratch = orl_function_scratch_new();
    struct orl_function_lanes inputs[ORL_RAY_INPUTS], values[3];
    double alone[ORL_RAY_INPUTS], value[3];
    FUZZ_PROMISE(scratch != NULL);
    for (int i = 0; i < ORL_RAY_INPUTS; i++)
        for (int l = 0; l < ORL_FUNCTION_LANES; l++)
            inputs[i].at[l] = ((i * 7 + l * 3) % 11 - 5) * .75;
    const struct orl_function_outcome all =
        orl_function_evaluate(function, scratch, inputs, 0xff, values);
    for (int l = 0; !all.exceeded && l < ORL_FUNCTION_LANES; l++) {
        for (int i = 0; i < ORL_RAY_INPUTS; i++)
            alone[i] = inputs[i].at[l];
        const struct orl_function_outcome one = orl_function_at(function, scratch, alone, value);
        FUZZ_PROMISE(!one.exceeded);
        FUZZ_PROMISE(one.undefined == (all.undefined >> l & 1));
        FUZZ_PROMISE(memcmp(&value[0], &values[0].at[l], sizeof value[0]) == 0 ||
                     value[0] != value[0]);
    }
    orl_function_scratch_free(scratch);
}

bool fuzz_function(const uint8_t *data, size_t size)
{
    struct orl_functions *const set = orl_functions_new(orl_function_ray_names, ORL_RAY_INPUTS);
    FUZZ_PROMISE(set != NULL);
    struct orl_function *const function = compile(set, (const char *)data, size);
    orl_functions_free(set);
    if (function)
        evaluate(function);
    orl_function_free(function);
    return function != NULL;
}
