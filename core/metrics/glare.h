/*
 * A view's luminances into what oriel/glare.h tells: the threshold, the sources, the indices.
 *
 * What pixels count, and how much, is a field's (field.h). The light at the eye is the sum of
 * luminance by solid angle and cosine over it; a view that holds less than the hemisphere lacks
 * what lies outside, which settings->eye_lx can supply, as evalglare's -i.
 *
 * Standard errors, intervals and the class are left as unknown; errors.h fills them.
 */
#ifndef ORL_METRICS_GLARE_H
#define ORL_METRICS_GLARE_H

#include "metrics/sources.h"
#include "render/film/film.h"

/* Luminances of a film, cd/m2; owned; NULL: out of memory. */
float *orl_film_luminances(const struct orl_film *film);

/* mask: luminances of a mask, as many as pixels, or NULL. ret_glare is owned. ORL_ERR_NOMEM,
 * _CANCELLED; ORL_ERR_RANGE: the task lies outside, or light is beyond measure. */
int orl_glare_evaluate(const struct orl_luminances *picture, const float *mask,
                       const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                       struct orl_error *err);

/* What can be said without pixels: settings, a view with an eye and enough of a field. */
int orl_glare_view_check(const struct orl_view *view, const struct orl_glare_settings *settings,
                         struct orl_error *err);

/* By bounds of 0.35, 0.40 and 0.45; undecided where the interval, if known, holds one. */
enum orl_glare_class orl_glare_class_of(const struct orl_glare_value *dgp);

/* Of the lines of sight that settings ask for, one's degrees from the view's. */
double orl_glare_turned_deg(const struct orl_glare_settings *settings, uint32_t direction);

#endif
