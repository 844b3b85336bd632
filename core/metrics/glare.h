/*
 * Evaluates the luminances of a view to the results of oriel/job/glare.h: threshold, sources,
 * indices.
 *
 * view_field.h defines the pixels that count and their weights. The illuminance at the eye is the
 * sum of luminance times solid angle and cosine over the field. A view smaller than the hemisphere
 * lacks the light from outside; settings->eye_lx can supply it, as evalglare's -i.
 *
 * Standard errors and intervals are left as unknown, and the class is that of the value;
 * view_batches.h computes them.
 */
#ifndef ORL_METRICS_GLARE_H
#define ORL_METRICS_GLARE_H

#include "metrics/glare_sources.h"
#include "render/film/film.h"

/* Returns the luminances of a film, cd/m2; owned. NULL: out of memory. */
float *orl_film_luminances(const struct orl_film *film);

/* Evaluates a picture. mask: luminances of a mask, one per pixel, or NULL. ret_glare is owned.
 * Returns 0, ORL_ERR_NOMEM, _CANCELLED, or ORL_ERR_RANGE (the task lies outside, or luminances are
 * out of range). */
int orl_glare_evaluate(const struct orl_luminances *picture, const float *mask,
                       const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                       struct orl_error *err);

/* Checks everything that needs no pixels: settings, a view with an eye and enough of a field. */
int orl_glare_view_check(const struct orl_view *view, const struct orl_glare_settings *settings,
                         struct orl_error *err);

/* Returns the class by the bounds 0.35, 0.40 and 0.45; undecided if the interval is known and
 * contains a bound. */
enum orl_glare_class orl_glare_class_of(const struct orl_glare_value *dgp);

/* Returns the rotation of a line of sight of the settings from the view's, degrees. */
double orl_glare_rotation_deg(const struct orl_glare_settings *settings, uint32_t direction);

#endif
