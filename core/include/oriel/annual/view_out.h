/*
 * View out by EN 17037:2018 (5.2 and annex C): width, distance and content of the view. Recommended
 * for at least 75 % of a used area, with eyes at 1.2 m (seated) or 1.7 m:
 *
 *              horizontal sight angle   distance outside   layers in one opening
 *     minimum  14 degrees                6 m               landscape
 *     medium   28 degrees               20 m               landscape and one more
 *     high     54 degrees               50 m               sky, landscape, ground
 *
 * The level of a point is the lowest of its levels by the three criteria. They are evaluated by
 * rays from the point, a quarter of a degree apart in azimuth and one degree in altitude.
 *
 * Openings are the photon ports of jobs that consist of glass. The standard requires clear,
 * undistorted glass of neutral colour. Such panes can be listed by name (then also BSDFs);
 * otherwise all glass counts. Ports in one plane at most 0.3 m apart are one opening, so that the
 * bars of a window do not divide a view. Holes without a pane are no openings. Shades are in their
 * first state.
 *
 * Layers. A ray that has passed an opening sees sky if it leaves the scene upwards, and ground if
 * it leaves downwards. A surface that it hits is landscape (the standard's natural or urban
 * objects) or ground. Ground surfaces are listed by name; otherwise they are those that face up
 * within 10 degrees and lie at most 0.5 m above the lowest of the scene. If sky is directly above
 * ground in a column of rays, the horizon there counts as landscape. Surfaces within 1 m of the
 * pane belong to the window (reveals, bars, louvres), and are no view.
 *
 * Width: sum of all azimuths in which a point sees out by openings that show it landscape. This
 * excludes roof lights. Distance: for each of these azimuths, the horizontal distance along the
 * pane's normal from the pane to the first surface other than ground on the ray next to the
 * horizontal. The result is the median, since the standard means the major obstruction. INFINITY:
 * no obstruction. Scenes are in metres.
 *
 * Edges of an opening are known to an eighth of a degree of azimuth and half a degree of altitude.
 * Results do not depend on the number of threads.
 */
#ifndef ORIEL_ANNUAL_VIEW_OUT_H
#define ORIEL_ANNUAL_VIEW_OUT_H

#include <stdbool.h>

#include <oriel/base/input_checks.h>

enum { ORL_VIEW_OUT_MOST_POINTS = 20000, ORL_VIEW_OUT_MOST_NAMES = 1024 };

/* Request for views out. All fields are owned; orl_view_out_request_done frees them. */
struct orl_view_out_request {
    struct orl_named_point *points;
    size_t n_points;
    double above_sensors; /* height of eyes above all sensors; NAN: sensors are not used */
    char **openings;      /* names of surfaces or modifiers; NULL: all glass */
    size_t n_openings;
    char **ground; /* names of surfaces or modifiers; NULL: by the rule above */
    size_t n_ground;
};
void orl_view_out_request_init(
    struct orl_view_out_request *view_out_request); /* sets no points and no sensors */
bool orl_view_out_is_requested(const struct orl_view_out_request *view_out_request);
void orl_view_out_request_done(
    struct orl_view_out_request *view_out_request); /* NULL and zeros are fine */

enum orl_view_layer { ORL_VIEW_SKY = 1, ORL_VIEW_LANDSCAPE = 2, ORL_VIEW_GROUND = 4 };
enum orl_view_level { ORL_VIEW_NONE, ORL_VIEW_MINIMUM, ORL_VIEW_MEDIUM, ORL_VIEW_HIGH };
const char *orl_view_level_name(enum orl_view_level level); /* "none", "minimum", ... */

/* View out from a point. */
struct orl_view_out {
    double sight_angle_deg, distance_m;
    unsigned layers; /* layers of the opening that shows the most relevant ones */
    enum orl_view_level level;
};
/* Returns the level by the other fields. */
enum orl_view_level orl_view_out_level(const struct orl_view_out *view);

struct orl_annual_request;
struct orl_run_env;

/* Returns the number of points and sensors to evaluate. */
size_t orl_view_out_count(const struct orl_view_out_request *view_out_request,
                          const struct orl_annual_request *request);
/* Evaluates the views. Reads the request's scene, or finds it in the memory cache. ret_views: of
 * the request's points, then of all sensors if requested. Returns 0, ORL_ERR_NOT_FOUND (a name
 * matches nothing in the scene), _LIMIT (points), _NOMEM, _CANCELLED, or the error of loading. */
int orl_view_out_compute(const struct orl_view_out_request *view_out_request,
                         const struct orl_annual_request *request, const struct orl_run_env *env,
                         struct orl_view_out *ret_views, struct orl_error *err);

#endif
