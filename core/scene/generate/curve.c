#include "scene/generate/curve.h"

#include <stdlib.h>
#include <string.h>

enum { SEGMENTS_MAX = 50000 };
/* Steps of expressions that all segments of one command may take. */
#define OPERATIONS_MAX (100UL << 20)

void orl_curve_done(struct orl_generator_curve *curve)
{
    orl_function_free(curve->function);
    orl_functions_free(curve->functions);
    orl_function_scratch_free(curve->scratch);
}

/* A file as it is found, or one of our own of that name. */
static int define_file(struct orl_generator_curve *curve, const char *name,
                       const struct orl_generator_files *files, struct orl_error *err)
{
    struct orl_error missing = {0};
    char *text = NULL;
    int context, code = files->read(files->ctx, name, &text, &missing);
    if (code == 0)
        code = orl_functions_define(curve->functions, ORL_FUNCTION_GLOBAL, name, 1, text,
                                    strlen(text), err);
    else if (orl_functions_load(curve->functions, NULL, name, true, &context, err) == 0)
        code = 0;
    else if (err)
        *err = missing;
    free(text);
    return code;
}

static int read_option(struct orl_generator_curve *curve, struct orl_words *words,
                       const struct orl_generator_files *files, struct orl_error *err)
{
    const char *option = *words->at++, *word;
    words->left--;
    if (strcmp(option, "-s") == 0) {
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "%s: option '-s' is not supported", words->program);
        orl_error_hint(err, "leave it out: normals do not vary over a surface yet, and more "
                            "segments are as smooth");
        return ORL_ERR_UNSUPPORTED;
    }
    if (strcmp(option, "-e") != 0 && strcmp(option, "-f") != 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' is no option", words->program,
                             option);
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: %s needs a word after it", words->program,
                             option);
    word = *words->at++;
    words->left--;
    if (option[1] == 'f')
        return define_file(curve, word, files, err);
    return orl_functions_define(curve->functions, ORL_FUNCTION_GLOBAL, NULL, 0, word, strlen(word),
                                err);
}

/* A number, or an expression of one. */
static int read_segments(struct orl_generator_curve *curve, const char *word, const char *program,
                         struct orl_error *err)
{
    const struct orl_function_request request = {.expressions = &word, .n_expressions = 1};
    struct orl_function *function = NULL;
    double value = 0;
    const int code = orl_function_compile(curve->functions, &request, &function, err);
    if (code < 0)
        return code;
    const bool constant = orl_function_is_constant(function, 0, &value);
    orl_function_free(function);
    if (!constant || !(value + .5 >= 1) || !(value <= SEGMENTS_MAX))
        return orl_error_set(err, ORL_ERR_RANGE, "%s: '%.40s' segments; it must be 1 to %d",
                             program, word, SEGMENTS_MAX);
    curve->segments = (int)(value + .5);
    return 0;
}

static int compile(struct orl_generator_curve *curve, const char *const *expressions,
                   struct orl_error *err)
{
    const unsigned long share = OPERATIONS_MAX / (unsigned long)curve->segments;
    const struct orl_function_request request = {
        .expressions = expressions,
        .n_expressions = curve->n,
        .operations = share < ORL_FUNCTION_OPERATIONS ? (uint32_t)share : 0};
    return orl_function_compile(curve->functions, &request, &curve->function, err);
}

int orl_curve_read(struct orl_generator_curve *curve, struct orl_words *words, size_t n,
                   const struct orl_generator_files *files, struct orl_error *err)
{
    static const char *const inputs[] = {"t"};
    int code = orl_words_name(words, "the material", &curve->material, err);
    if (code == 0)
        code = orl_words_name(words, "the surface", &curve->name, err);
    if (code == 0 && words->left < n + 1)
        code =
            orl_error_set(err, ORL_ERR_SYNTAX, "%s needs %zu expressions and a number of segments",
                          words->program, n);
    if (code < 0)
        return code;
    const char *const *expressions = words->at;
    words->at += n + 1;
    words->left -= n + 1;
    curve->n = n;
    curve->functions = orl_functions_new(inputs, 1);
    curve->scratch = orl_function_scratch_new();
    if (!curve->functions || !curve->scratch)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    while (code == 0 && words->left > 0)
        code = read_option(curve, words, files, err);
    if (code == 0)
        code = read_segments(curve, expressions[n], words->program, err);
    return code < 0 ? code : compile(curve, expressions, err);
}

int orl_curve_at(const struct orl_generator_curve *curve, int step,
                 double ret_values[ORL_CURVE_MOST], struct orl_error *err)
{
    const double t = (double)step / curve->segments;
    const struct orl_function_outcome outcome =
        orl_function_at(curve->function, curve->scratch, &t, ret_values);
    if (outcome.exceeded)
        return orl_error_set(err, ORL_ERR_LIMIT, "its expressions take too many steps at t = %g",
                             t);
    for (size_t i = 0; i < curve->n; i++)
        if (!isfinite(ret_values[i]))
            return orl_error_set(err, ORL_ERR_RANGE, "expression %zu is not finite at t = %g",
                                 i + 1, t);
    return 0;
}
