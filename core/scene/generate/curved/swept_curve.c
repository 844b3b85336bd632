#include "scene/generate/curved/swept_curve.h"

#include <string.h>

enum { SEGMENTS_MAX = 50000 };

int orl_curve_read(struct orl_generator_curve *curve, struct orl_words *words, size_t n,
                   bool may_smooth, const struct orl_generator_files *files, struct orl_error *err)
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
    const char *const *texts = words->at;
    words->at += n + 1;
    words->left -= n + 1;
    code = orl_expressions_begin(&curve->expressions, inputs, 1, err);
    while (code == 0 && words->left > 0) {
        const char *option = *words->at++;
        words->left--;
        if (may_smooth && strcmp(option, "-s") == 0)
            curve->smooth = true;
        else
            code = orl_expressions_define(&curve->expressions, option, words, files, err);
    }
    if (code == 0)
        code = orl_expressions_count(&curve->expressions, texts[n], "segments", words->program,
                                     SEGMENTS_MAX, &curve->segments, err);
    return code < 0 ? code
                    : orl_expressions_compile(&curve->expressions, texts, n,
                                              (size_t)curve->segments, err);
}

int orl_curve_at(const struct orl_generator_curve *curve, int step,
                 double ret_values[ORL_CURVE_EXPRESSIONS_MAX], struct orl_error *err)
{
    const double t = (double)step / curve->segments;
    return orl_expressions_at(&curve->expressions, &t, ret_values, err);
}
