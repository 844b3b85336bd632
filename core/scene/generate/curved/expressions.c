/* Expressions of generators (solids.h): definitions, compilation, values. */
#include "scene/generate/solid/solids.h"

#include <stdlib.h>
#include <string.h>

/* Limit of expression steps over all places of one command. */
#define OPERATIONS_MAX (100UL << 20)

int orl_expressions_begin(struct orl_generator_expressions *expressions, const char *const *inputs,
                          size_t n_inputs, struct orl_error *err)
{
    expressions->functions = orl_functions_new(inputs, n_inputs);
    expressions->scratch = orl_function_scratch_new();
    if (!expressions->functions || !expressions->scratch)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return 0;
}

void orl_expressions_done(struct orl_generator_expressions *expressions)
{
    orl_function_free(expressions->function);
    orl_functions_free(expressions->functions);
    orl_function_scratch_free(expressions->scratch);
}

/* Reads definitions from a file among the scene's, or from the built-in file of that name. */
static int define_file(struct orl_functions *functions, const char *name,
                       const struct orl_generator_files *files, struct orl_error *err)
{
    struct orl_error missing = {0};
    char *text = NULL;
    int context, code = files->read(files->ctx, name, &text, &missing);
    if (code == 0)
        code =
            orl_functions_define(functions, ORL_FUNCTION_GLOBAL, name, 1, text, strlen(text), err);
    else if (orl_functions_load(functions, NULL, name, true, &context, err) == 0)
        code = 0;
    else if (err)
        *err = missing;
    free(text);
    return code;
}

int orl_expressions_define(struct orl_generator_expressions *expressions, const char *option,
                           struct orl_words *words, const struct orl_generator_files *files,
                           struct orl_error *err)
{
    if (strcmp(option, "-e") != 0 && strcmp(option, "-f") != 0)
        return orl_words_refuse(words, option, err);
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: %s needs a word after it", words->program,
                             option);
    const char *const word = orl_words_take(words);
    if (option[1] == 'f')
        return define_file(expressions->functions, word, files, err);
    return orl_functions_define(expressions->functions, ORL_FUNCTION_GLOBAL, NULL, 0, word,
                                strlen(word), err);
}

int orl_expressions_count(struct orl_generator_expressions *expressions, const char *word,
                          const char *what, const char *program, int most, int *ret_count,
                          struct orl_error *err)
{
    const struct orl_function_request request = {.expressions = &word, .n_expressions = 1};
    struct orl_function *function = NULL;
    double value = 0;
    const int code = orl_function_compile(expressions->functions, &request, &function, err);
    if (code < 0)
        return code;
    const bool constant = orl_function_is_constant(function, 0, &value);
    orl_function_free(function);
    if (!constant || !(value + .5 >= 1) || !(value <= most))
        return orl_error_set(err, ORL_ERR_RANGE, "%s: '%.40s' %s; it must be 1 to %d", program,
                             word, what, most);
    *ret_count = (int)(value + .5);
    return 0;
}

int orl_expressions_compile(struct orl_generator_expressions *expressions, const char *const *texts,
                            size_t n, size_t places, struct orl_error *err)
{
    const unsigned long share = OPERATIONS_MAX / (unsigned long)places;
    const struct orl_function_request request = {
        .expressions = texts,
        .n_expressions = n,
        .operations = share < ORL_FUNCTION_OPERATIONS ? (uint32_t)share : 0};
    expressions->n = n;
    return orl_function_compile(expressions->functions, &request, &expressions->function, err);
}

int orl_expressions_at(const struct orl_generator_expressions *expressions, const double *inputs,
                       double *ret_values, struct orl_error *err)
{
    const struct orl_function_outcome outcome =
        orl_function_at(expressions->function, expressions->scratch, inputs, ret_values);
    if (outcome.exceeded)
        return orl_error_set(err, ORL_ERR_LIMIT, "its expressions take too many steps at %g",
                             inputs[0]);
    for (size_t i = 0; i < expressions->n; i++)
        if (!isfinite(ret_values[i]))
            return orl_error_set(err, ORL_ERR_RANGE, "expression %zu is not finite at %g", i + 1,
                                 inputs[0]);
    return 0;
}
