#include "metrics/glare.h"

#include <stdlib.h>

#include <oriel/base/thread_pool.h>

#include "base/statistics/sum.h"
#include "metrics/dgp.h"
#include "metrics/indices.h"
#include "metrics/luminance_stats.h"

static const double usual_threshold = 2000, usual_factor = 5, most_factor = 100;
static const double usual_radius_rad = 0.2, usual_peak = 50000;

float *orl_film_luminances(const struct orl_film *film)
{
    const size_t count = (size_t)film->width * film->height;
    float *cd_m2 = malloc(count * sizeof *cd_m2);
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

/* Returns DGP's correction for age: 1 / (1.1 - 0.5 age / 100), 1 for 20 years (evalglare 1.08 to
 * 1.16). */
static double age_factor(double years)
{
    return years > 0 ? 1 / (1.1 - 0.5 * years / 100) : 1;
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

static int compute_metrics(const struct orl_glare_settings *settings,
                           const struct orl_glare_light *light, struct orl_glare *glare,
                           struct orl_error *err)
{
    const struct orl_dgp_options options = {settings->constants, settings->low_light};
    const double eye_lx = settings->eye_lx > 0 ? settings->eye_lx : light->eye_lx;
    double values[ORL_GLARE_METRICS];
    orl_glare_indices(light, glare->sources, glare->n_sources, values);
    values[ORL_GLARE_DGPS] = fmin(6.22e-5 * eye_lx + 0.184, 1);
    const int code =
        orl_dgp(eye_lx, glare->sources, glare->n_sources, &options, &values[ORL_GLARE_DGP], err);
    values[ORL_GLARE_DGP] = fmin(values[ORL_GLARE_DGP] * age_factor(settings->age_years), 1);
    for (int i = 0; i < ORL_GLARE_METRICS; i++)
        glare->values[i] = (struct orl_glare_value){values[i], NAN, {NAN, NAN}};
    glare->class_of = orl_glare_class_of(&glare->values[ORL_GLARE_DGP]);
    return code;
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

double orl_glare_rotation_deg(const struct orl_glare_settings *settings, uint32_t direction)
{
    if (settings->directions < 2)
        return 0;
    const double step = settings->directions_deg / (settings->directions - 1);
    return direction * step - settings->directions_deg / 2;
}
