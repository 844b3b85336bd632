/*
 * Closed forms and integrals that tests compare results with, written for the tests alone: nothing
 * here calls the core, but for the inline arithmetic of oriel/vec.h.
 *
 * Conventions: directions are unit vectors towards where light comes from; angles in radians.
 * References: Lambert 1760 (contour integral); Fresnel; ISO 15469:2004 / CIE S 011 (general sky).
 */
#ifndef ORL_TESTS_ORACLES_H
#define ORL_TESTS_ORACLES_H

#include <stdbool.h>

#include <oriel/vec.h>

/*
 * Configuration factor: share of the irradiance under a full hemisphere of radiance 1 (that is, of
 * pi) that a polygon of radiance 1 gives at a point with that normal. The polygon lies in front of
 * the point's plane, or touches it. The sign of its turn does not matter.
 */
double oracle_polygon(struct orl_vec3 point, struct orl_vec3 normal, const struct orl_vec3 *corners,
                      int n);

/* The same for the rectangle corner, corner + a, corner + a + b, corner + b. */
double oracle_rectangle(struct orl_vec3 point, struct orl_vec3 normal, struct orl_vec3 corner,
                        struct orl_vec3 a, struct orl_vec3 b);

/*
 * Transmittance of a plane pane in air for unpolarised light at that cosine of incidence: all
 * internal passes, each polarisation by itself. pass: what one pass straight through lets by.
 */
double oracle_pane(double cosine, double index, double pass);

/* The 15 skies of ISO 15469, and as 16 the overcast sky of 1955, (1 + 2 sin altitude) / 3. */
enum { ORACLE_SKIES = 16 };

struct oracle_sky {
    double a, b, c, d, e; /* gradation a, b; indicatrix c, d, e */
    struct orl_vec3 sun;
    bool traditional; /* number 16 */
};
struct oracle_sky oracle_sky(int number, struct orl_vec3 sun);

/* Relative luminance, up to a factor; 0 below the horizon. */
double oracle_sky_luminance(const struct oracle_sky *sky, struct orl_vec3 direction);

/* Horizontal irradiance of luminance as oracle_sky_luminance has it. */
double oracle_sky_horizontal(const struct oracle_sky *sky);

/*
 * The sky as scene text, times scale: a brightfunc "general" of perezlum.cal's form, or of
 * skybright.cal's for number 16, whose ground value is ground.
 */
void oracle_sky_text(const struct oracle_sky *sky, double scale, double ground, char ret_text[256]);

#endif
