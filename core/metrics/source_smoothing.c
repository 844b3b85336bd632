#include "metrics/source_smoothing.h"

#include <math.h>
#include <stdlib.h>

#include <oriel/base/thread_pool.h>

/* Share of the disc that a source must fill. */
static const double enough = 0.2;

struct smoothing {
    const struct orl_view_field *field;
    const uint32_t *label;
    double pixels;         /* radius of the disc */
    double *filled;        /* solid angle in the disc, by label; zero between calls */
    uint32_t *disc_labels; /* labels in the disc */
};

/* Returns the radius of the disc in pixels. The diagonal of a pixel is a tenth of the angle from
 * the middle to the point ten pixels up and right of it. */
static double disc_radius(const struct orl_view_field *field, double radius_rad)
{
    const double x = floor(field->width / 2.0) + 0.5;
    const double y = field->height - floor(field->height / 2.0) - 0.5;
    const struct orl_vec3 middle = orl_view_field_direction_at(field, x, y);
    const struct orl_vec3 beside = orl_view_field_direction_at(field, x + 10, y - 10);
    const double diagonal = acos(fmin(orl_dot(middle, beside), 1)) / 10;
    const double pixels = diagonal > 0 ? radius_rad / (2 * diagonal) / 1.75 : 0;
    return fmin(pixels, (double)field->width + field->height); /* covers the whole picture */
}

static void add_disc_row(struct smoothing *s, uint32_t y, int64_t from, int64_t to, double *all,
                         uint32_t *n_disc_labels)
{
    for (int64_t x = from < 0 ? 0 : from; x <= to && x < s->field->width; x++) {
        const size_t at = (size_t)y * s->field->width + (size_t)x;
        const double sr = (double)s->field->solid_angle[at];
        const uint32_t label = s->label[at];
        *all += sr;
        if (label == 0 || sr == 0)
            continue;
        if (s->filled[label] == 0)
            s->disc_labels[(*n_disc_labels)++] = label;
        s->filled[label] += sr;
    }
}

/* Returns the source that fills most of the disc about a pixel, or 0 if none fills enough. */
static uint32_t dominant_source(struct smoothing *s, uint32_t x, uint32_t y)
{
    const int64_t reach = (int64_t)s->pixels;
    double all = 0, most = 0;
    uint32_t n_disc_labels = 0, best = 0;
    for (int64_t dy = -reach; dy <= reach; dy++) {
        if ((int64_t)y + dy < 0 || (int64_t)y + dy >= s->field->height)
            continue;
        const int64_t dx = (int64_t)sqrt(s->pixels * s->pixels - (double)(dy * dy));
        add_disc_row(s, (uint32_t)((int64_t)y + dy), (int64_t)x - dx, (int64_t)x + dx, &all,
                     &n_disc_labels);
    }
    for (uint32_t i = 0; i < n_disc_labels; i++) {
        double *filled = &s->filled[s->disc_labels[i]];
        if (*filled > enough * all && *filled > most) {
            most = *filled;
            best = s->disc_labels[i];
        }
        *filled = 0;
    }
    return best;
}

int orl_glare_sources_smooth(const struct orl_luminances *picture, double radius_rad,
                             uint32_t n_labels, uint32_t *label)
{
    const struct orl_view_field *field = picture->field;
    const size_t count = (size_t)field->width * field->height;
    struct smoothing s = {.field = field, .label = label, .pixels = disc_radius(field, radius_rad)};
    uint32_t *smoothed = malloc(count * sizeof *smoothed);
    s.filled = calloc((size_t)n_labels + 1, sizeof *s.filled);
    s.disc_labels = malloc(((size_t)n_labels + 1) * sizeof *s.disc_labels);
    int code = smoothed && s.filled && s.disc_labels ? 0 : ORL_ERR_NOMEM;
    for (size_t i = 0; i < count && code == 0; i++) {
        const uint32_t x = (uint32_t)(i % field->width), y = (uint32_t)(i / field->width);
        smoothed[i] =
            label[i] == 0 && field->solid_angle[i] > 0 ? dominant_source(&s, x, y) : label[i];
        if (orl_is_cancelled(picture->cancel))
            code = ORL_ERR_CANCELLED;
    }
    for (size_t i = 0; i < count && code == 0; i++)
        label[i] = smoothed[i];
    free(smoothed);
    free(s.filled);
    free(s.disc_labels);
    return code;
}
