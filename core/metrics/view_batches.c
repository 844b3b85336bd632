#include "metrics/glare.h"

#include <stdlib.h>

#include "base/statistics/estimate.h"

/* Merges two batches into the first. */
static void merge_batches(struct orl_view_batches *b, size_t first, size_t second)
{
    const double all = b->weight[first] + b->weight[second];
    const float share = (float)(b->weight[second] / all);
    for (size_t i = 0; i < b->pixels; i++)
        b->cd_m2[first][i] += share * (b->cd_m2[second][i] - b->cd_m2[first][i]);
    b->weight[first] = all;
    free(b->cd_m2[second]);
    b->cd_m2[second] = NULL;
}

static void merge_pairs(struct orl_view_batches *b)
{
    for (size_t i = 0; i < ORL_VIEW_BATCHES / 2; i++) {
        merge_batches(b, 2 * i, 2 * i + 1);
        float *const merged = b->cd_m2[2 * i];
        b->cd_m2[2 * i] = NULL;
        b->cd_m2[i] = merged;
        b->weight[i] = b->weight[2 * i];
    }
    b->count = ORL_VIEW_BATCHES / 2;
}

int orl_view_batches_add(struct orl_view_batches *batches, const struct orl_film *film,
                         double weight, struct orl_error *err)
{
    float *cd_m2 = orl_film_luminances(film);
    if (!cd_m2)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a batch of a view");
    if (batches->count == ORL_VIEW_BATCHES)
        merge_pairs(batches);
    batches->pixels = (size_t)film->width * film->height;
    batches->weight[batches->count] = weight;
    batches->cd_m2[batches->count++] = cd_m2;
    return 0;
}

void orl_view_batches_done(struct orl_view_batches *batches)
{
    for (uint32_t i = 0; i < batches->count; i++)
        free(batches->cd_m2[i]);
    *batches = (struct orl_view_batches){0};
}

/* ---- The jackknife --------------------------------------------------------------------------- */

static double total_weight(const struct orl_view_batches *b)
{
    double sum = 0;
    for (uint32_t i = 0; i < b->count; i++)
        sum += b->weight[i];
    return sum;
}

/* Computes the mean of all batches except one; of all batches if left_out is not an index. */
static void mean_without(const struct orl_view_batches *b, uint32_t left_out, float *ret_cd_m2)
{
    const double all = total_weight(b) - (left_out < b->count ? b->weight[left_out] : 0);
    for (size_t i = 0; i < b->pixels; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < b->count; k++)
            if (k != left_out)
                sum += b->weight[k] * (double)b->cd_m2[k][i];
        ret_cd_m2[i] = (float)(sum / all);
    }
}

/* Metrics without each batch in turn, followed by those of all batches. */
typedef double found_values[ORL_VIEW_BATCHES + 1][ORL_GLARE_METRICS];

static int evaluate_without(const struct orl_view_batches *b, const struct orl_view_field *field,
                            const struct orl_glare_settings *settings, const atomic_bool *cancel,
                            found_values ret_found, struct orl_error *err)
{
    struct orl_glare_settings of_values = *settings;
    float *cd_m2 = malloc((b->pixels + 1) * sizeof *cd_m2);
    const struct orl_luminances luminances = {field, cd_m2, cancel};
    int code = 0;
    if (!cd_m2)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for errors of glare");
    of_values.band_rad = 0; /* errors are not estimated for parts */
    for (uint32_t i = 0; i <= b->count && code == 0; i++) {
        struct orl_glare glare = {0};
        mean_without(b, i, cd_m2);
        code = orl_glare_evaluate(&luminances, NULL, &of_values, &glare, err);
        for (int m = 0; m < ORL_GLARE_METRICS; m++)
            ret_found[i][m] = glare.values[m].value;
        orl_glare_done(&glare);
    }
    free(cd_m2);
    return code;
}

/* Computes the errors of one metric. If it has no value without some batch, its error is not
 * known. */
static void compute_errors(const struct orl_view_batches *b, found_values found, int metric,
                           struct orl_glare_value *value)
{
    const double all = total_weight(b), whole = found[b->count][metric];
    const double n = b->count;
    double corrected = n * whole, variance = 0, cube = 0;
    for (uint32_t i = 0; i < b->count; i++)
        corrected -= (1 - b->weight[i] / all) * found[i][metric];
    for (uint32_t i = 0; i < b->count; i++) {
        const double share = all / b->weight[i];
        const double pseudo = share * whole - (share - 1) * found[i][metric];
        const double off = pseudo - corrected;
        variance += off * off / (share - 1) / n;
        cube += off * off * off;
    }
    const struct orl_estimate estimate = {.standard_error = sqrt(variance),
                                          .degrees_of_freedom = b->count - 1.0,
                                          .bias = fabs(whole - corrected),
                                          .third_cumulant =
                                              n > 2 ? cube / (n * (n - 1) * (n - 2)) : 0};
    const struct orl_margins margins = orl_estimate_margins(&estimate);
    value->standard_error = estimate.standard_error;
    value->interval_95[0] = value->value - margins.below;
    value->interval_95[1] = value->value + margins.above;
}

/* Clamps intervals: no probability is below 0 or above 1, and no light below 0. */
static void clamp_intervals(struct orl_glare_value values[ORL_GLARE_METRICS])
{
    static const double most[ORL_GLARE_METRICS] = {/* others have no upper end */
                                                   [ORL_GLARE_DGP] = 1,
                                                   [ORL_GLARE_DGPS] = 1,
                                                   [ORL_GLARE_VCP] = 100};
    for (int m = 0; m < ORL_GLARE_METRICS; m++) {
        double *interval = values[m].interval_95;
        const bool logarithmic =
            m == ORL_GLARE_DGI || m == ORL_GLARE_UGR || m == ORL_GLARE_CGI || m == ORL_GLARE_UGP;
        if (!logarithmic && interval[0] < 0)
            interval[0] = 0;
        if (most[m] > 0 && interval[1] > most[m])
            interval[1] = most[m];
    }
}

int orl_glare_errors(const struct orl_view_batches *batches,
                     const struct orl_glare_picture *glare_picture,
                     const struct orl_glare_settings *settings, struct orl_glare *glare,
                     struct orl_error *err)
{
    struct orl_view_field field;
    found_values found = {{0}};
    if (batches->count < 2)
        return 0;
    int code = orl_view_field_init(&field, glare_picture->view, glare_picture->width,
                                   glare_picture->height, glare->turned_deg, err);
    if (code == 0)
        code = evaluate_without(batches, &field, settings, glare_picture->cancel, found, err);
    orl_view_field_done(&field);
    for (int m = 0; m < ORL_GLARE_METRICS && code == 0; m++)
        compute_errors(batches, found, m, &glare->values[m]);
    if (code == 0) {
        clamp_intervals(glare->values);
        glare->class_of = orl_glare_class_of(&glare->values[ORL_GLARE_DGP]);
    }
    return code;
}
