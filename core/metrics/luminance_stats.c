#include "metrics/luminance_stats.h"

#include <stdlib.h>

static int by_size(const void *a, const void *b)
{
    const float p = *(const float *)a, q = *(const float *)b;
    return (p > q) - (p < q);
}

/* Returns the percentile of sorted values by nearest rank. */
static double percentile(const float *values, size_t count, double share)
{
    const double rank = ceil(share * (double)count);
    return (double)values[rank < 1 ? 0 : (size_t)rank - 1];
}

static double deviation_of(const float *values, size_t count)
{
    double mean = 0, squares = 0;
    for (size_t i = 0; i < count; i++)
        mean += (double)values[i] / (double)count;
    for (size_t i = 0; i < count; i++)
        squares += ((double)values[i] - mean) * ((double)values[i] - mean);
    return count > 1 ? sqrt(squares / (double)(count - 1)) : 0;
}

int orl_glare_masked_stats(const struct orl_luminances *picture, const float *mask,
                           struct orl_glare_part *ret_part, struct orl_error *err)
{
    static const float inside = 0.1F;
    const struct orl_view_field *field = picture->field;
    const size_t count = (size_t)field->width * field->height;
    struct orl_glare_part part = {0};
    float *values = malloc(count * sizeof *values);
    if (!values)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a mask");
    for (size_t i = 0; i < count; i++) {
        const double sr = (double)field->solid_angle[i], light = sr * (double)picture->cd_m2[i];
        if (sr == 0 || !(mask[i] > inside))
            continue;
        values[part.pixels++] = picture->cd_m2[i];
        part.solid_angle_sr += sr;
        part.mean += light;
        part.illuminance_lx += light * (double)field->direction[i][2];
    }
    if (part.pixels > 0) {
        qsort(values, part.pixels, sizeof *values, by_size);
        part.mean /= part.solid_angle_sr;
        part.median = percentile(values, part.pixels, 0.5);
        part.percentile_75 = percentile(values, part.pixels, 0.75);
        part.percentile_95 = percentile(values, part.pixels, 0.95);
        part.least = (double)values[0];
        part.most = (double)values[part.pixels - 1];
        part.deviation = deviation_of(values, part.pixels);
    }
    free(values);
    *ret_part = part;
    return 0;
}

int orl_glare_band_stats(const struct orl_luminances *picture, double angle_rad,
                         struct orl_glare_part *ret_part, struct orl_error *err)
{
    const struct orl_view_field *field = picture->field;
    const uint32_t middle = field->height / 2;
    const double least = cos(fmin(angle_rad, ORL_PI));
    float *mask = calloc((size_t)field->width * field->height, sizeof *mask);
    if (!mask)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a band");
    for (uint32_t x = 0; x < field->width; x++) {
        const struct orl_vec3 level = orl_view_field_direction_at(field, x + 0.5, middle + 0.5);
        for (uint32_t y = 0; y < field->height; y++) {
            const size_t at = (size_t)y * field->width + x;
            mask[at] = y == middle || orl_dot(orl_view_field_direction(field, at), level) >= least;
        }
    }
    const int code = orl_glare_masked_stats(picture, mask, ret_part, err);
    free(mask);
    return code;
}
