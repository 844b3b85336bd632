#include <stdlib.h>
#include <string.h>

#include "base/text/number.h"
#include "scene/generate/curved/gensurf.h"

/* Limits of cells along one side, and in total. */
enum { SIDE_MAX = 20000, FIELDS_MAX = 1000000 };

void orl_gensurf_done(struct orl_gensurf *surface)
{
    orl_expressions_done(&surface->expressions);
    free(surface->data.values);
}

/* ---- Data files ------------------------------------------------------------------------------ */

static int read_values(struct orl_gensurf_data *data, size_t most, const char *text,
                       const char *name, size_t *ret_n, struct orl_error *err)
{
    static const char blanks[] = " \t\r\n\v\f";
    size_t n = 0;
    data->values = malloc(most * sizeof *data->values);
    if (!data->values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (const char *at = text + strspn(text, blanks); *at; at += strspn(at, blanks)) {
        const size_t length = strcspn(at, blanks);
        if (n == most)
            return orl_error_set(err, ORL_ERR_SYNTAX, "gensurf: '%.80s' has more than %zu numbers",
                                 name, most);
        if (orl_number_read(at, length, &data->values[n++]) != ORL_NUMBER_OK)
            return orl_error_set(err, ORL_ERR_SYNTAX,
                                 "gensurf: '%.*s' in '%.80s' is not a finite number",
                                 length < 40 ? (int)length : 40, at, name);
        at += length;
    }
    *ret_n = n;
    return 0;
}

static int read_data(struct orl_gensurf *surface, size_t each, const char *text, const char *name,
                     struct orl_error *err)
{
    struct orl_gensurf_data *data = &surface->data;
    const size_t m = (size_t)surface->m, n = (size_t)surface->n;
    const size_t at_vertices = (m + 1) * (n + 1) * each, in_middles = m * n * each;
    size_t found = 0;
    const int code = read_values(data, at_vertices, text, name, &found, err);
    if (code < 0)
        return code;
    data->middles = found == in_middles;
    data->n_s = surface->m + (data->middles ? 0 : 1);
    data->n_t = surface->n + (data->middles ? 0 : 1);
    data->each = each;
    if ((found != at_vertices && found != in_middles) || data->n_s < 2 || data->n_t < 2)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "gensurf: '%.80s' has %zu numbers; of %d x %d fields there are %zu, "
                             "or %zu with the edges",
                             name, found, surface->m, surface->n, in_middles, at_vertices);
    return 0;
}

static double interpolate_data(const struct orl_gensurf_data *data, size_t coordinate, double s,
                               double t)
{
    const double u = data->middles ? s * data->n_s - .5 : s * (data->n_s - 1);
    const double v = data->middles ? t * data->n_t - .5 : t * (data->n_t - 1);
    const int i = u < 0 ? 0 : u >= data->n_s - 1 ? data->n_s - 2 : (int)u;
    const int j = v < 0 ? 0 : v >= data->n_t - 1 ? data->n_t - 2 : (int)v;
    const size_t each = data->each, row = each * (size_t)data->n_s;
    const double *at = data->values + (size_t)j * row + (size_t)i * each + coordinate;
    return (j + 1 - v) * ((i + 1 - u) * at[0] + (u - i) * at[each]) +
           (v - j) * ((i + 1 - u) * at[row] + (u - i) * at[row + each]);
}

/* ---- Words ----------------------------------------------------------------------------------- */

static int read_option(struct orl_gensurf *surface, struct orl_words *words,
                       const struct orl_generator_files *files, struct orl_error *err)
{
    const char *option = *words->at++;
    words->left--;
    if (strcmp(option, "-s") == 0)
        surface->smooth = true;
    else if (strcmp(option, "-i") == 0)
        surface->inverted = true;
    else if (strcmp(option, "-o") == 0)
        surface->object = true;
    else
        return orl_expressions_define(&surface->expressions, option, words, files, err);
    return 0;
}

/* Reads z's word as a file if it exists; it gives all three coordinates if their words are
 * equal. */
static int read_file(struct orl_gensurf *surface, const char *const texts[3],
                     const struct orl_generator_files *files, struct orl_error *err)
{
    struct orl_error missing = {0};
    char *text = NULL;
    if (strcmp(texts[2], "-") == 0)
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "gensurf: nothing is there to read at '-': name the file of numbers");
    if (files->read(files->ctx, texts[2], &text, &missing) < 0)
        return 0;
    const bool all = strcmp(texts[0], texts[2]) == 0 && strcmp(texts[1], texts[2]) == 0;
    const int code = read_data(surface, all ? 3 : 1, text, texts[2], err);
    free(text);
    return code;
}

static int compile_expressions(struct orl_gensurf *surface, const char *const texts[3],
                               struct orl_error *err)
{
    static const char valid[] = "valid(s,t)";
    const size_t places = (size_t)(surface->m + 3) * (size_t)(surface->n + 3);
    const char *all[4];
    size_t n = 0;
    for (; n + surface->data.each < 3; n++)
        all[n] = texts[n];
    surface->checked =
        orl_functions_has(surface->expressions.functions, ORL_FUNCTION_GLOBAL, "valid") &&
        orl_functions_arity(surface->expressions.functions, ORL_FUNCTION_GLOBAL, "valid") == 2;
    if (surface->checked)
        all[n++] = valid;
    if (n == 0)
        return 0;
    return orl_expressions_compile(&surface->expressions, all, n, places, err);
}

static int read_counts(struct orl_gensurf *surface, const char *const words[2],
                       struct orl_error *err)
{
    int code = orl_expressions_count(&surface->expressions, words[0], "fields along s", "gensurf",
                                     SIDE_MAX, &surface->m, err);
    if (code == 0)
        code = orl_expressions_count(&surface->expressions, words[1], "fields along t", "gensurf",
                                     SIDE_MAX, &surface->n, err);
    if (code == 0 && (long)surface->m * surface->n > FIELDS_MAX)
        return orl_error_set(err, ORL_ERR_LIMIT, "gensurf: %d x %d fields are more than %d",
                             surface->m, surface->n, FIELDS_MAX);
    return code;
}

int orl_gensurf_read(struct orl_gensurf *surface, struct orl_words *words,
                     const struct orl_generator_files *files, struct orl_error *err)
{
    static const char *const inputs[] = {"s", "t"};
    int code = orl_words_name(words, "the material", &surface->material, err);
    if (code == 0)
        code = orl_words_name(words, "the surface", &surface->name, err);
    if (code == 0 && words->left < 5)
        code = orl_error_set(err, ORL_ERR_SYNTAX,
                             "gensurf needs three expressions and two numbers of fields");
    if (code < 0)
        return code;
    const char *const *texts = words->at;
    words->at += 5;
    words->left -= 5;
    code = orl_expressions_begin(&surface->expressions, inputs, 2, err);
    while (code == 0 && words->left > 0)
        code = read_option(surface, words, files, err);
    if (code == 0)
        code = read_counts(surface, texts + 3, err);
    if (code == 0)
        code = read_file(surface, texts, files, err);
    return code < 0 ? code : compile_expressions(surface, texts, err);
}

/* ---- Values ---------------------------------------------------------------------------------- */

int orl_gensurf_at(const struct orl_gensurf *surface, int i, int j,
                   struct orl_gensurf_vertex *ret_vertex, struct orl_error *err)
{
    const double at[2] = {(double)i / surface->m, (double)j / surface->n};
    const struct orl_gensurf_data *data = &surface->data;
    double values[4] = {0}, place[3];
    const size_t given = 3 - data->each; /* number of coordinates by expressions */
    const int code = surface->expressions.function
                         ? orl_expressions_at(&surface->expressions, at, values, err)
                         : 0;
    ret_vertex->valid = !surface->checked || values[given] > 0;
    ret_vertex->place = orl_v3(0, 0, 0);
    ret_vertex->s = ret_vertex->t = 0;
    if (code < 0 || !ret_vertex->valid)
        return code;
    for (size_t k = 0; k < 3; k++)
        place[k] = k < given ? values[k] : interpolate_data(data, k - given, at[0], at[1]);
    ret_vertex->place = orl_v3(place[0], place[1], place[2]);
    ret_vertex->s = at[0];
    ret_vertex->t = at[1];
    return 0;
}
