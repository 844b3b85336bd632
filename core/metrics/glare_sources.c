/* Finds glare sources: smoothing first, then the search. */
#include "metrics/glare_sources.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "base/memory/memory.h"
#include "metrics/indices.h"

/* ---- Smoothing ------------------------------------------------------------------------------- */

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
    struct orl_arrays arrays = {.failed = false};
    uint32_t *smoothed = orl_arrays_new(&arrays, count, sizeof *smoothed);
    s.filled = orl_arrays_new(&arrays, (size_t)n_labels + 1, sizeof *s.filled);
    s.disc_labels = orl_arrays_new(&arrays, (size_t)n_labels + 1, sizeof *s.disc_labels);
    int code = arrays.failed ? ORL_ERR_NOMEM : 0;
    for (size_t i = 0; i < count && code == 0; i++) {
        const uint32_t x = (uint32_t)(i % field->width), y = (uint32_t)(i / field->width);
        smoothed[i] =
            label[i] == 0 && field->solid_angle[i] > 0 ? dominant_source(&s, x, y) : label[i];
        if (orl_is_cancelled(picture->cancel))
            code = ORL_ERR_CANCELLED;
    }
    for (size_t i = 0; i < count && code == 0; i++)
        label[i] = smoothed[i];
    orl_arrays_free(&arrays);
    return code;
}

/* ---- Search ---------------------------------------------------------------------------------- */

/* State of a search: labels of all pixels, and the list of pixels to be grouped. */
struct search {
    const struct orl_luminances *picture;
    const struct orl_glare_source_rule *rule;
    size_t count;     /* number of pixels in the picture */
    uint32_t *label;  /* source of each pixel, from 1 on; 0: none */
    uint32_t *pixels; /* list of pixels */
    uint32_t *group;  /* group of each pixel in the list */
    uint32_t n_labels;
};

/* Lists the counting pixels brighter than cd_m2; for peaks, only pixels of sources. */
static size_t list_brighter(struct search *s, double cd_m2, bool at_least, bool of_sources)
{
    const float *sr = s->picture->field->solid_angle, *luminance = s->picture->cd_m2;
    size_t n = 0;
    for (size_t i = 0; i < s->count; i++) {
        const double here = (double)luminance[i];
        const bool brighter = at_least ? here >= cd_m2 : here > cd_m2;
        if (sr[i] > 0 && brighter && (!of_sources || s->label[i] > 0))
            s->pixels[n++] = (uint32_t)i;
    }
    return n;
}

/* Groups the pixels of the list under new labels. */
static int label_groups(struct search *s, size_t n)
{
    uint32_t groups = 0;
    const int code = n == 0 ? 0
                            : orl_pixels_cluster(s->picture->field, s->pixels, n,
                                                 s->rule->radius_rad / 2, s->group, &groups);
    for (size_t i = 0; code == 0 && i < n; i++)
        s->label[s->pixels[i]] = s->n_labels + 1 + s->group[i];
    s->n_labels += groups;
    return code;
}

static int label_sources(struct search *s)
{
    int code = label_groups(s, list_brighter(s, s->rule->threshold_cd_m2, false, false));
    if (code == 0 && s->rule->smooth && s->n_labels > 0)
        code = orl_glare_sources_smooth(s->picture, s->rule->radius_rad, s->n_labels, s->label);
    if (code == 0 && isfinite(s->rule->peak_cd_m2))
        code = label_groups(s, list_brighter(s, s->rule->peak_cd_m2, true, true));
    return code;
}

/* Adds a pixel to the sums of a source: luminance times solid angle, and positions weighted by
 * that. */
static void add_pixel(struct orl_glare_source *source, const struct orl_luminances *picture,
                      size_t pixel)
{
    const struct orl_view_field *field = picture->field;
    const double sr = (double)field->solid_angle[pixel], cd_m2 = (double)picture->cd_m2[pixel];
    const size_t column = pixel % field->width, row = pixel / field->width;
    const double weight = sr * cd_m2;
    source->pixels++;
    source->solid_angle_sr += sr;
    source->luminance_cd_m2 += weight;
    source->illuminance_lx += weight * (double)field->direction[pixel][2];
    source->x += weight * (double)column;
    source->y += weight * (double)row;
    source->most_cd_m2 = fmax(source->most_cd_m2, cd_m2);
}

/* Computes a direction as evalglare does: by the view's up itself, which need not be perpendicular
 * to the line of sight. */
static struct orl_vec3 by_tilted_up(const struct orl_view_field *field, struct orl_vec3 to)
{
    const double upright = orl_dot(orl_normalize(field->view.up), field->eye.v);
    const double across = hypot(to.x, to.y), y = upright * to.y;
    return orl_v3(sqrt(fmax(across * across - y * y, 0)), y, to.z);
}

/* Converts sums to means. Until here x and y referred to the pixels' corners. */
static void finish_source(struct orl_glare_source *source, const struct search *s)
{
    const struct orl_view_field *field = s->picture->field;
    double x = source->x / source->luminance_cd_m2, y = source->y / source->luminance_cd_m2;
    if (s->rule->at_whole_pixels) { /* the lower left of the pixels around it */
        x = floor(x);
        y = ceil(y);
    }
    const struct orl_vec3 to = orl_view_field_direction_at(field, x + 0.5, y + 0.5);
    source->luminance_cd_m2 /= source->solid_angle_sr;
    source->x = x + 0.5;
    source->y = field->height - (y + 0.5);
    source->position_index =
        orl_position_index(s->rule->at_whole_pixels ? by_tilted_up(field, to) : to);
    source->direction = orl_to_world(&field->eye, to);
    source->angle_deg = atan2(hypot(to.x, to.y), to.z) / ORL_DEG_TO_RAD;
}

static double glare_weight(const struct orl_glare_source *s)
{
    const double seen = s->luminance_cd_m2 / s->position_index;
    return seen * seen * s->solid_angle_sr;
}

static int by_glare_weight(const void *a, const void *b)
{
    const struct orl_glare_source *p = a, *q = b;
    const double first = glare_weight(p), second = glare_weight(q);
    if (first != second)
        return first > second ? -1 : 1;
    return p->x != q->x ? (p->x > q->x) - (p->x < q->x) : (p->y > q->y) - (p->y < q->y);
}

static int collect_sources(const struct search *s, struct orl_glare_source **ret_sources,
                           size_t *ret_count)
{
    struct orl_glare_source *sources = calloc(s->n_labels + 1, sizeof *sources);
    size_t n = 0;
    if (!sources)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < s->count; i++)
        if (s->label[i] > 0)
            add_pixel(&sources[s->label[i] - 1], s->picture, i);
    for (uint32_t i = 0; i < s->n_labels; i++) {
        if (sources[i].pixels == 0) /* all of it was a peak */
            continue;
        sources[n] = sources[i];
        finish_source(&sources[n++], s);
    }
    qsort(sources, n, sizeof *sources, by_glare_weight);
    *ret_sources = sources;
    *ret_count = n;
    return 0;
}

int orl_glare_sources_find(const struct orl_luminances *picture,
                           const struct orl_glare_source_rule *rule,
                           struct orl_glare_source **ret_sources, size_t *ret_count,
                           struct orl_error *err)
{
    const size_t count = (size_t)picture->field->width * picture->field->height;
    struct search s = {.picture = picture, .rule = rule, .count = count};
    struct orl_arrays arrays = {.failed = false};
    s.label = orl_arrays_new(&arrays, count, sizeof *s.label);
    s.pixels = orl_arrays_new(&arrays, count, sizeof *s.pixels);
    s.group = orl_arrays_new(&arrays, count, sizeof *s.group);
    int code = arrays.failed ? ORL_ERR_NOMEM : label_sources(&s);
    if (code == 0)
        code = collect_sources(&s, ret_sources, ret_count);
    orl_arrays_free(&arrays);
    return code < 0 ? orl_error_set(err, code, "%s searching for glare sources",
                                    code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory")
                    : 0;
}
