/*
 * Closed forms and integrals for comparison with results, written for the tests only: nothing here
 * calls the core, except the inline arithmetic of oriel/base/vec.h.
 *
 * Conventions: directions are unit vectors toward the light; angles in radians. References: Lambert
 * 1760 (contour integral); Fresnel; ISO 15469:2004 / CIE S 011 (general sky).
 */
#ifndef ORL_TESTS_ORACLES_H
#define ORL_TESTS_ORACLES_H

#include <stdbool.h>

#include <oriel/base/vec.h>

/*
 * Returns the configuration factor: the irradiance at a point with that normal from a polygon of
 * radiance 1, over that of a full hemisphere of radiance 1 (which is pi). The polygon is in front
 * of the point's plane, or touches it. The sense of its corners does not matter.
 */
double oracle_polygon(struct orl_vec3 point, struct orl_vec3 normal, const struct orl_vec3 *corners,
                      int n);

/*
 * Returns the configuration factor of the rectangle corner, corner + a, corner + a + b, corner + b.
 */
double oracle_rectangle(struct orl_vec3 point, struct orl_vec3 normal, struct orl_vec3 corner,
                        struct orl_vec3 a, struct orl_vec3 b);

/*
 * Returns the transmittance of a plane pane in air for unpolarised light at that cosine of
 * incidence: all internal passes, each polarisation separately. pass: internal transmittance of one
 * pass at normal incidence.
 */
double oracle_pane(double cosine, double index, double pass);

/*
 * The 15 skies of ISO 15469, and as number 16 the overcast sky of 1955, (1 + 2 sin altitude) / 3.
 */
enum { ORACLE_SKIES = 16 };

struct oracle_sky {
    double a, b, c, d, e; /* gradation a, b; indicatrix c, d, e */
    struct orl_vec3 sun;
    bool traditional; /* true for number 16 */
};
struct oracle_sky oracle_sky(int number, struct orl_vec3 sun);

/* Returns the relative luminance, up to a factor; 0 below the horizon. */
double oracle_sky_luminance(const struct oracle_sky *sky, struct orl_vec3 direction);

/* Returns the horizontal irradiance for the luminance of oracle_sky_luminance. */
double oracle_sky_horizontal(const struct oracle_sky *sky);

/*
 * Writes the sky, multiplied by scale, as scene text: a brightfunc "general" of the form of
 * perezlum.cal, or of skybright.cal for number 16, with the ground value `ground`.
 */
void oracle_sky_text(const struct oracle_sky *sky, double scale, double ground, char ret_text[256]);

#endif
