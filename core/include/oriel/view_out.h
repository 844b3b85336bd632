/*
 * View out by EN 17037:2018 (5.2 and annex C): how wide the view is, how far it reaches, and what
 * is in it. Recommended of at least 75 % of a used area, eyes at 1.2 m (seated) or 1.7 m:
 *
 *            horizontal sight angle   distance outside   layers in one opening
 *   minimum  14 degrees                6 m               landscape
 *   medium   28 degrees               20 m               landscape and one more
 *   high     54 degrees               50 m               sky, landscape, ground
 *
 * A place's level is the lowest of what it reaches by the three. How they are found, by rays from
 * the place, a quarter of a degree apart in azimuth and one degree in altitude:
 *
 * Openings are photon ports, as jobs have them, of glass, which the standard wants clear,
 * undistorted and neutral in colour: which panes are so can be told by name (BSDFs too, then), else
 * all of glass are. Ports in one plane with 0.3 m between them at the most are one opening: the
 * bars of a window divide no view. Holes without a pane are no openings. Shades are in their first
 * state.
 *
 * Layers. A ray that has passed an opening sees sky where it leaves the scene upwards, and ground
 * where it does so downwards; what it meets is landscape (the standard's natural or urban objects),
 * or ground: surfaces that are named so, or else those that face up within 10 degrees, and lie no
 * more than 0.5 m above the lowest of the scene. Where sky stands on ground in a column of rays,
 * there is the horizon, and that is landscape. What lies within 1 m of the pane is the window's own
 * (reveals, bars, louvres), and is no view.
 *
 * Width: of all azimuths in which a place sees out by openings that show it landscape, roof lights
 * falling out by that. Distance: in each of these azimuths to what the ray next to the horizontal
 * meets other than ground, from the pane and along its normal, level; the median of that, since the
 * standard has it of the major obstruction. INFINITY: none. Scenes are in metres.
 *
 * Edges of an opening are known to an eighth of a degree of azimuth, half a degree of altitude.
 * Results do not depend on the crew.
 */
#ifndef ORIEL_VIEW_OUT_H
#define ORIEL_VIEW_OUT_H

#include <stdbool.h>

#include <oriel/place.h>

enum { ORL_VIEW_OUT_MOST_PLACES = 20000, ORL_VIEW_OUT_MOST_NAMES = 1024 };

/* All owned; orl_view_out_wish_done frees them. */
struct orl_view_out_wish {
    struct orl_named_place *points;
    size_t n_points;
    double above_sensors; /* eyes of all sensors, so far above them; NAN: of none */
    char **openings;      /* surfaces or modifiers; NULL: all of glass */
    size_t n_openings;
    char **ground; /* likewise; NULL: as above */
    size_t n_ground;
};
void orl_view_out_wish_init(struct orl_view_out_wish *wish); /* nothing is asked for */
bool orl_view_out_is_wished(const struct orl_view_out_wish *wish);
void orl_view_out_wish_done(struct orl_view_out_wish *wish); /* NULL and zeros are fine */

enum orl_view_layer { ORL_VIEW_SKY = 1, ORL_VIEW_LANDSCAPE = 2, ORL_VIEW_GROUND = 4 };
enum orl_view_level { ORL_VIEW_NONE, ORL_VIEW_MINIMUM, ORL_VIEW_MEDIUM, ORL_VIEW_HIGH };
const char *orl_view_level_name(enum orl_view_level level); /* "none", "minimum", ... */

/* From a place. */
struct orl_view_out {
    double sight_angle_deg, distance_m;
    unsigned layers; /* of the opening that shows the most that count */
    enum orl_view_level level;
};
/* By its other members. */
enum orl_view_level orl_view_out_level(const struct orl_view_out *view);

struct orl_annual_request;
struct orl_run_env;

/* How many there are to see out from. */
size_t orl_view_out_places(const struct orl_view_out_wish *wish,
                           const struct orl_annual_request *request);
/* Reads the request's scene, or finds it on the shelf. ret_views: of the wish's points, then of
 * all sensors, where they are asked for. ORL_ERR_NOT_FOUND (a name is of nothing in the scene),
 * _LIMIT (places), _NOMEM, _CANCELLED, or what loading says. */
int orl_view_out_find(const struct orl_view_out_wish *wish,
                      const struct orl_annual_request *request, const struct orl_run_env *env,
                      struct orl_view_out *ret_views, struct orl_error *err);

#endif
