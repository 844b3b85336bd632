/* Names, bounds and classes of glare. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "metrics/glare.h"

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

/* Far smaller than the angle of any pixel. */
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
            return orl_error_set(err, ORL_ERR_RANGE, "%s is from %g to %g, not %g", bounds[i].name,
                                 bounds[i].least, bounds[i].most, bounds[i].value);
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
                             "a parallel view has no eye that could be dazzled");
    if (settings->eye_lx == 0 && (view->horizontal < least_deg || view->vertical < least_deg)) {
        code = orl_error_set(err, ORL_ERR_RANGE,
                             "%g by %g degrees hold too little of the light at the eye",
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
