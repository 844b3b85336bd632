/* Evaluates the glare of a view or a picture: names and bounds, luminance statistics, the indices
 * of one line of sight, the worst of several, and Radiance pictures. */
#include "metrics/glare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/thread_pool.h>

#include "base/statistics/numeric.h"
#include "metrics/indices.h"
#include "render/film/image_files.h"

const char *orl_glare_metric_name(enum orl_glare_metric metric)
{
    static const char *const names[ORL_GLARE_METRICS] = {"dgp",
                                                         "dgps",
                                                         "dgi",
                                                         "ugr",
                                                         "vcp",
                                                         "cgi",
                                                         "ugp",
                                                         "vertical_illuminance_lx",
                                                         "average_luminance_cd_m2",
                                                         "background_luminance_cd_m2"};
    return metric < ORL_GLARE_METRICS ? names[metric] : "unknown";
}

const char *orl_glare_class_name(enum orl_glare_class class_of)
{
    static const char *const names[] = {"imperceptible", "perceptible", "disturbing", "intolerable",
                                        "undecided"};
    return class_of <= ORL_GLARE_UNDECIDED ? names[class_of] : "unknown";
}

static enum orl_glare_class class_at(double dgp)
{
    return dgp < 0.35   ? ORL_GLARE_IMPERCEPTIBLE
           : dgp < 0.40 ? ORL_GLARE_PERCEPTIBLE
           : dgp < 0.45 ? ORL_GLARE_DISTURBING
                        : ORL_GLARE_INTOLERABLE;
}

enum orl_glare_class orl_glare_class_of(const struct orl_glare_value *dgp)
{
    if (!isfinite(dgp->interval_95[0]) || !isfinite(dgp->interval_95[1]))
        return class_at(dgp->value);
    const enum orl_glare_class low = class_at(dgp->interval_95[0]);
    return low == class_at(dgp->interval_95[1]) ? low : ORL_GLARE_UNDECIDED;
}

/* Least search radius, far smaller than the angle of any pixel. */
static const double least_radius_rad = 1e-6;

int orl_glare_settings_check(const struct orl_glare_settings *s, struct orl_error *err)
{
    const struct {
        const char *name;
        double value, least, most;
    } bounds[] = {
        {"threshold", s->threshold, 0, 1e12},
        {"radius_rad", s->radius_rad, s->radius_rad == 0 ? 0 : least_radius_rad, 3.2},
        {"peak_cd_m2", s->peak_cd_m2, 0, 1e12},
        {"band_rad", s->band_rad, 0, 3.2},
        {"age_years", s->age_years, 0, 120},
        {"vertical_illuminance_lx", s->eye_lx, 0, 1e9},
        {"task.x", s->task.x, 0, ORL_LIMIT_IMAGE_SIDE},
        {"task.y", s->task.y, 0, ORL_LIMIT_IMAGE_SIDE},
        {"task.angle_rad", s->task.angle_rad, 0, 6.3},
        {"directions.count", s->directions, 0, 360},
        {"directions.span_deg", s->directions_deg, 0, 360},
    };
    for (size_t i = 0; i < sizeof bounds / sizeof *bounds; i++)
        if (!(bounds[i].value >= bounds[i].least && bounds[i].value <= bounds[i].most))
            return orl_error_set(err, ORL_ERR_RANGE, "%s must be from %g to %g, not %g",
                                 bounds[i].name, bounds[i].least, bounds[i].most, bounds[i].value);
    return 0;
}

int orl_glare_view_check(const struct orl_view *view, const struct orl_glare_settings *settings,
                         struct orl_error *err)
{
    static const double least_deg = 90;
    int code = orl_glare_settings_check(settings, err);
    if (code < 0)
        return code;
    if (view->type == 'l')
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "glare needs a perspective or fisheye view, not a parallel one");
    if (settings->eye_lx == 0 && (view->horizontal < least_deg || view->vertical < least_deg)) {
        code = orl_error_set(err, ORL_ERR_RANGE,
                             "a view of %g by %g degrees covers too little of the light at the eye",
                             view->horizontal, view->vertical);
        orl_error_hint(err,
                       "Use -vta or -vth with 180 degrees, at least %g, or supply "
                       "glare.vertical_illuminance_lx",
                       least_deg);
    }
    return code;
}

void orl_glare_done(struct orl_glare *glare)
{
    if (!glare)
        return;
    free(glare->sources);
    glare->sources = NULL;
    glare->n_sources = 0;
}

/* ---- Luminance statistics -------------------------------------------------------------------- */

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

/* Computes the luminance statistics of the pixels where a mask is brighter than 0.1 (evalglare's
 * -A). Median and percentiles are over pixels, independent of their solid angle. The mean is
 * weighted by solid angle; the deviation is about the unweighted mean. All values are zero if no
 * pixel counts. Returns 0 or ORL_ERR_NOMEM. */
static int orl_glare_masked_stats(const struct orl_luminances *picture, const float *mask,
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

/* Computes the statistics of pixels within an angle above and below the picture's middle row,
 * column by column, as evalglare's -B. For an even number of rows the middle is the lower one of
 * the two. */
static int orl_glare_band_stats(const struct orl_luminances *picture, double angle_rad,
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

/* ---- One line of sight ----------------------------------------------------------------------- */

static const double usual_threshold = 2000, usual_factor = 5, most_factor = 100;
static const double usual_radius_rad = 0.2, usual_peak = 50000;

float *orl_film_luminances(const struct orl_film *film)
{
    const size_t count = (size_t)film->width * film->height;
    float *cd_m2 = malloc((count + 1) * sizeof *cd_m2);
    for (size_t i = 0; cd_m2 && i < count; i++) {
        const float *p = film->pixels[i];
        const struct orl_rgb color = {(double)p[0], (double)p[1], (double)p[2]};
        cd_m2[i] = (float)(ORL_EFFICACY_LM_PER_W * orl_luma(color));
    }
    return cd_m2;
}

/* Totals over all pixels that count. */
struct totals {
    double eye_lx, average_cd_m2, most_cd_m2;
};

static struct totals sum_field(const struct orl_luminances *picture)
{
    const struct orl_view_field *field = picture->field;
    struct orl_sum eye = {0}, all = {0};
    double most = 0;
    for (size_t i = 0; i < (size_t)field->width * field->height; i++) {
        const double sr = (double)field->solid_angle[i], cd_m2 = (double)picture->cd_m2[i];
        if (sr == 0)
            continue;
        orl_sum_add(&eye, sr * cd_m2 * (double)field->direction[i][2]);
        orl_sum_add(&all, sr * cd_m2);
        most = fmax(most, cd_m2);
    }
    return (struct totals){orl_sum_value(&eye),
                           field->all_sr > 0 ? orl_sum_value(&all) / field->all_sr : 0, most};
}

/* Returns the mean luminance of the task, or of the view if there is no task or none of it
 * counts. */
static double task_luminance(const struct orl_luminances *picture,
                             const struct orl_glare_area *task, double average)
{
    const struct orl_view_field *field = picture->field;
    if (task->angle_rad == 0)
        return average;
    const struct orl_vec3 middle =
        orl_view_field_direction_at(field, task->x, field->height - task->y);
    const double least = cos(fmin(task->angle_rad / 2, ORL_PI));
    struct orl_sum light = {0}, sr = {0};
    for (size_t i = 0; i < (size_t)field->width * field->height; i++) {
        const double here = (double)field->solid_angle[i];
        if (here > 0 && orl_dot(orl_view_field_direction(field, i), middle) >= least) {
            orl_sum_add(&light, here * (double)picture->cd_m2[i]);
            orl_sum_add(&sr, here);
        }
    }
    return orl_sum_value(&sr) > 0 ? orl_sum_value(&light) / orl_sum_value(&sr) : average;
}

static struct orl_glare_source_rule rule_of(const struct orl_glare_settings *s, double task)
{
    const double usual = s->task.angle_rad > 0 ? usual_factor : usual_threshold;
    const double asked = s->threshold > 0 ? s->threshold : usual;
    return (struct orl_glare_source_rule){
        .threshold_cd_m2 = asked > most_factor ? asked : asked * task,
        .radius_rad = s->radius_rad > 0 ? s->radius_rad : usual_radius_rad,
        .smooth = s->smooth,
        .at_whole_pixels = s->at_whole_pixels,
        .peak_cd_m2 = s->no_peaks         ? INFINITY
                      : s->peak_cd_m2 > 0 ? s->peak_cd_m2
                                          : usual_peak};
}

/* Returns the illuminance by the sources. Rounding of the sums could exceed the illuminance at the
 * eye. */
static double direct_illuminance(const struct orl_glare *glare, double eye_lx)
{
    double direct = 0;
    for (size_t i = 0; i < glare->n_sources; i++)
        direct += glare->sources[i].illuminance_lx;
    return fmin(direct, eye_lx);
}

static int check_task(const struct orl_glare_area *task, const struct orl_view_field *field,
                      struct orl_error *err)
{
    if (task->angle_rad == 0 || (task->x <= field->width && task->y <= field->height))
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE,
                         "the task at (%g, %g) lies outside of a picture of %u x %u pixels",
                         task->x, task->y, field->width, field->height);
}

static int rate_dgp(const struct orl_glare_settings *settings, double eye_lx,
                    const struct orl_glare_source *sources, size_t n_sources, double *ret_dgp,
                    struct orl_error *err)
{
    const struct orl_dgp_options options = {settings->constants, settings->low_light};
    /* DGP's correction for age is 1 for 20 years (evalglare 1.08 to 1.16). */
    const double years = settings->age_years, age = years > 0 ? 1 / (1.1 - 0.5 * years / 100) : 1;
    const int code = orl_dgp(eye_lx, sources, n_sources, &options, ret_dgp, err);
    *ret_dgp = fmin(*ret_dgp * age, 1);
    return code;
}

/* Sources that pixels may blur are brighter than these (cd/m2): where they show a known disc, and
 * elsewhere; and they have few pixels: their edge is most of it. */
static const double least_disc_cd_m2 = 5e4, least_blurred_cd_m2 = 1e6, least_evenness = 0.8;
enum { MOST_BLURRED_PIXELS = 64 };

/* Returns the solid angle that a source has without the blur of its pixels: that of the disc it
 * shows, or the one at which it is as bright as its brightest pixel. */
static double sharp_angle(const struct orl_glare_source *source, const struct orl_glare_disc *discs,
                          size_t n_discs)
{
    const double reach = sqrt(source->solid_angle_sr / ORL_PI), sr = source->solid_angle_sr;
    if (source->pixels > MOST_BLURRED_PIXELS)
        return sr;
    for (size_t i = 0; i < n_discs && source->most_cd_m2 >= least_disc_cd_m2; i++)
        if (orl_dot(discs[i].direction, source->direction) >= cos(fmin(reach, ORL_PI)))
            return fmin(discs[i].solid_angle_sr, sr);
    return source->most_cd_m2 >= least_blurred_cd_m2
               ? sr * source->luminance_cd_m2 / source->most_cd_m2
               : sr;
}

int orl_glare_sharpen(const struct orl_glare_settings *settings, const struct orl_glare_disc *discs,
                      size_t n_discs, struct orl_glare *glare, struct orl_error *err)
{
    const double eye_lx =
        settings->eye_lx > 0 ? settings->eye_lx : glare->values[ORL_GLARE_ILLUMINANCE].value;
    struct orl_glare_source *sources = calloc(glare->n_sources + 1, sizeof *sources);
    if (!sources)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for glare sources");
    glare->blurred_pixels = 0;
    for (size_t i = 0; i < glare->n_sources; i++) {
        struct orl_glare_source *source = &sources[i];
        *source = glare->sources[i];
        const double sharp = sharp_angle(source, discs, n_discs);
        if (!(sharp < least_evenness * source->solid_angle_sr))
            continue;
        if (glare->blurred_pixels == 0)
            glare->blurred_pixels = source->pixels;
        source->luminance_cd_m2 *= source->solid_angle_sr / sharp;
        source->solid_angle_sr = sharp;
    }
    const int code =
        rate_dgp(settings, eye_lx, sources, glare->n_sources, &glare->sharper_dgp, err);
    free(sources);
    return code;
}

static int compute_metrics(const struct orl_glare_settings *settings,
                           const struct orl_glare_light *light, struct orl_glare *glare,
                           struct orl_error *err)
{
    const double eye_lx = settings->eye_lx > 0 ? settings->eye_lx : light->eye_lx;
    double values[ORL_GLARE_METRICS];
    orl_glare_indices(light, glare->sources, glare->n_sources, values);
    values[ORL_GLARE_DGPS] = fmin(6.22e-5 * eye_lx + 0.184, 1);
    int code =
        rate_dgp(settings, eye_lx, glare->sources, glare->n_sources, &values[ORL_GLARE_DGP], err);
    for (int i = 0; i < ORL_GLARE_METRICS; i++)
        glare->values[i] = (struct orl_glare_value){values[i], NAN, {NAN, NAN}};
    if (code == 0)
        code = orl_glare_sharpen(settings, NULL, 0, glare, err);
    glare->class_of = orl_glare_class_of(&glare->values[ORL_GLARE_DGP]);
    return code;
}

bool orl_glare_is_blurred(const struct orl_glare *glare, uint32_t width, uint32_t *ret_width)
{
    enum { SHARP_PIXELS = 100 };
    static const double least_difference = 0.01;
    if (glare->blurred_pixels == 0 ||
        !(glare->sharper_dgp - glare->values[ORL_GLARE_DGP].value >= least_difference))
        return false;
    const double wider = sqrt((double)SHARP_PIXELS / (double)glare->blurred_pixels);
    *ret_width = (uint32_t)(100 * ceil(fmax(wider, 1.25) * width / 100));
    return true;
}

int orl_glare_evaluate(const struct orl_luminances *picture, const float *mask,
                       const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                       struct orl_error *err)
{
    const int outside = check_task(&settings->task, picture->field, err);
    if (outside < 0)
        return outside;
    if (orl_is_cancelled(picture->cancel))
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while rating glare");
    const struct totals totals = sum_field(picture);
    const double task = task_luminance(picture, &settings->task, totals.average_cd_m2);
    const struct orl_glare_source_rule rule = rule_of(settings, task);
    struct orl_glare glare = {.threshold_cd_m2 = rule.threshold_cd_m2,
                              .task_cd_m2 = task,
                              .most_cd_m2 = totals.most_cd_m2,
                              .field_sr = picture->field->all_sr};
    int code = orl_glare_sources_find(picture, &rule, &glare.sources, &glare.n_sources, err);
    if (code == 0) {
        glare.direct_lx = direct_illuminance(&glare, totals.eye_lx);
        const struct orl_glare_light light = {totals.eye_lx, glare.direct_lx, totals.average_cd_m2,
                                              (totals.eye_lx - glare.direct_lx) / ORL_PI};
        code = compute_metrics(settings, &light, &glare, err);
    }
    if (code == 0 && mask)
        code = orl_glare_masked_stats(picture, mask, &glare.masked, err);
    if (code == 0 && settings->band_rad > 0)
        code = orl_glare_band_stats(picture, settings->band_rad, &glare.band, err);
    if (code < 0)
        orl_glare_done(&glare);
    else
        *ret_glare = glare;
    return code;
}

/* ---- Several lines of sight ------------------------------------------------------------------ */

/* Share of the view's field that a line of sight must cover. */
static const double enough = 0.98;

/* Evaluates one line of sight; *ret_covered is true if the picture covers enough of the field of
 * view there. */
static int evaluate_direction(const struct orl_glare_picture *p,
                              const struct orl_glare_settings *settings, double turned_deg,
                              double least_sr, struct orl_glare *ret_glare, bool *ret_covered,
                              struct orl_error *err)
{
    struct orl_view_field field;
    int code = orl_view_field_init(&field, p->view, p->width, p->height, turned_deg, err);
    const struct orl_luminances luminances = {&field, p->cd_m2, p->cancel};
    *ret_covered = field.all_sr >= least_sr;
    if (code == 0 && *ret_covered)
        code = orl_glare_evaluate(&luminances, p->mask, settings, ret_glare, err);
    ret_glare->turned_deg = turned_deg;
    orl_view_field_done(&field);
    return code;
}

int orl_glare_worst_direction(const struct orl_glare_picture *glare_picture,
                              const struct orl_glare_settings *settings,
                              struct orl_glare *ret_glare, struct orl_error *err)
{
    struct orl_glare worst = {0};
    bool covered;
    int code = evaluate_direction(glare_picture, settings, 0, 0, &worst, &covered, err);
    const double least_sr = enough * worst.field_sr;
    for (uint32_t i = 0; i < settings->directions && code == 0; i++) {
        const double span = settings->directions_deg;
        const double turned =
            settings->directions < 2 ? 0 : i * (span / (settings->directions - 1)) - span / 2;
        struct orl_glare glare = {0};
        code = evaluate_direction(glare_picture, settings, turned, least_sr, &glare, &covered, err);
        if (code == 0 && covered &&
            glare.values[ORL_GLARE_DGP].value > worst.values[ORL_GLARE_DGP].value) {
            orl_glare_done(&worst);
            worst = glare;
        } else {
            orl_glare_done(&glare);
        }
    }
    if (code == 0)
        *ret_glare = worst;
    else
        orl_glare_done(&worst);
    return code;
}

/* ---- Radiance pictures ----------------------------------------------------------------------- */

int orl_glare_read_mask(const struct orl_picture_bytes *bytes, uint32_t width, uint32_t height,
                        float **ret_mask, struct orl_error *err)
{
    struct orl_hdr_picture mask = {0};
    int code = orl_hdr_read(bytes->name, bytes->data, bytes->size, &mask, err);
    if (code == 0 && (mask.film.width != width || mask.film.height != height)) {
        code = orl_error_set(err, ORL_ERR_RANGE, "the mask has %u x %u pixels, the picture %u x %u",
                             mask.film.width, mask.film.height, width, height);
        orl_error_at(err, bytes->name, 0, NULL);
    }
    if (code == 0) {
        *ret_mask = orl_film_luminances(&mask.film);
        if (!*ret_mask)
            code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a mask");
    }
    orl_hdr_done(&mask);
    return code;
}

static int evaluate_picture(const struct orl_hdr_picture *picture,
                            const struct orl_picture_bytes *mask,
                            const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                            struct orl_error *err)
{
    float *cd_m2 = orl_film_luminances(&picture->film), *masked = NULL;
    int code = cd_m2 ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for luminances");
    if (code == 0 && mask)
        code = orl_glare_read_mask(mask, picture->film.width, picture->film.height, &masked, err);
    const struct orl_glare_picture glare_picture = {
        &picture->view, picture->film.width, picture->film.height, cd_m2, masked, NULL};
    if (code == 0)
        code = orl_glare_worst_direction(&glare_picture, settings, ret_glare, err);
    free(cd_m2);
    free(masked);
    return code;
}

int orl_glare_of_picture(const struct orl_picture_bytes *picture, const char *view,
                         const struct orl_picture_bytes *mask,
                         const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                         struct orl_error *err)
{
    struct orl_hdr_picture hdr = {0};
    int code = orl_glare_settings_check(settings, err);
    if (code == 0)
        code = orl_hdr_read(picture->name, picture->data, picture->size, &hdr, err);
    if (code < 0)
        return code;
    if (view)
        code = orl_view_parse(view, &hdr.view, err);
    else if (!hdr.has_view) {
        code = orl_error_set(err, ORL_ERR_SYNTAX, "the picture has no VIEW line");
        orl_error_at(err, picture->name, 0, NULL);
        orl_error_hint(err, "Give its view, such as -vta -vh 180 -vv 180");
    }
    if (code == 0)
        code = evaluate_picture(&hdr, mask, settings, ret_glare, err);
    orl_hdr_done(&hdr);
    return code;
}
