/*
 * Models of skies that gensky and gendaylit use: CIE's clear and intermediate skies, and Perez's
 * all-weather sky.
 */
#ifndef ORL_SCENE_GENERATE_SKY_SKY_MODELS_H
#define ORL_SCENE_GENERATE_SKY_SKY_MODELS_H

/*
 * The CIE's clear and intermediate skies, as gensky and gendaylit use them: the formula's value at
 * the sun's distance from the zenith, and the horizontal irradiance of the sky.
 *
 * Conventions: altitude of the sun in radians. Polynomial fits are those of both programs, so that
 * the numbers agree.
 * References: CIE No. 22 (TC-4.2), 1973, for the clear sky; gensky(1) of Radiance.
 */

enum orl_cie_type { ORL_CIE_CLEAR, ORL_CIE_INTERMEDIATE };

/* Relative luminance by which the formula is divided: A4 of skybright.cal. */
double orl_cie_shape(enum orl_cie_type type, double altitude_rad);

/* Horizontal irradiance over pi times zenith radiance. */
double orl_cie_factor(enum orl_cie_type type, double altitude_rad);

/*
 * The all-weather sky of Perez, Seals and Michalsky: relative luminance from clearness epsilon and
 * brightness delta, and the luminous efficacies of diffuse and direct daylight.
 *
 * Conventions: angles in radians unless named _deg; lm/W for efficacies; W/m2 for irradiances.
 * References: Perez, Seals, Michalsky, "All-weather model for sky luminance distribution", Solar
 * Energy 50(3), 1993; Perez, Ineichen, Seals, Michalsky, Stewart, "Modeling daylight availability
 * and irradiance components from direct and global irradiance", Solar Energy 44(5), 1990.
 */

/* Range for which the model was fitted; clearness must stay below the upper bound. */
#define ORL_PEREZ_CLEARNESS_MIN 1.0
#define ORL_PEREZ_CLEARNESS_MAX 12.01
#define ORL_PEREZ_BRIGHTNESS_MIN 0.01
#define ORL_PEREZ_BRIGHTNESS_MAX 0.6

/*
 * Coefficients a..e of (1 + a exp(b / cos zenith)) (1 + c exp(d gamma) + e cos^2 gamma). The tables
 * are in single precision, as in the program whose digits are matched.
 */
struct orl_perez {
    double c[5];
};
struct orl_perez orl_perez_shape(double sun_zenith_rad, double clearness, double brightness);

/* Returns the relative luminance at an angle from the zenith and an angle from the sun. */
double orl_perez_luminance(const struct orl_perez *shape, double zenith_rad, double gamma_rad);

/*
 * Returns the horizontal integral of the relative luminance by the mean over Tregenza's 145
 * patches. It is 0.7 to 2.7 % off the true integral, but sky files are normalised by it.
 */
double orl_perez_patch_integral(const struct orl_perez *shape, double sun_zenith_rad);

/* Returns the bin (0..7) of Perez 1990 for a clearness; -1 outside the model's range. */
int orl_perez_bin(double clearness);

/* Return efficacies in a bin; water_cm is the precipitable water. */
double orl_perez_diffuse_efficacy(int bin, double brightness, double sun_zenith_rad,
                                  double water_cm);
double orl_perez_direct_efficacy(int bin, double brightness, double sun_zenith_rad,
                                 double water_cm);

#endif
