/*
 * Sky of a job, for a scene without distant sources, so that one scene serves many hours. Sun, sky
 * and ground are distant sources around the scene, as gendaylit or gensky with the usual "source"
 * lines describe them.
 *
 * Conventions: degrees; latitude north, longitude EAST, time zone in hours EAST of Greenwich
 * (Radiance's programs take longitude west); azimuth of the sun from south towards west, as in
 * Radiance. Hours are standard time, from midnight. Irradiances are in W/m2 (whole solar spectrum),
 * illuminances in lx.
 *
 * Normalisation: ORL_SKY_FLUX scales the sky to the given diffuse flux, by fine quadrature. It
 * lights the ground by sun and sky together: its radiance is reflectance * horizontal / pi. The
 * horizon cuts the sun's disc. Where the Perez model is undefined, the sky keeps its flux and drops
 * the model's gradient from zenith to horizon. The models, and the sky, clamp the sun's altitude to
 * 87 degrees; the sun itself keeps its position. ORL_SKY_GENDAYLIT reproduces the programs'
 * numbers. gendaylit divides by a mean over 145 patches, which loses 0.7 to 2.7 % of the flux, and
 * both programs take the ground's light from a CIE sky. The sun's disc is either complete or below
 * the horizon. Where the model is undefined, the sky is black.
 */
#ifndef ORIEL_JOB_SKY_H
#define ORIEL_JOB_SKY_H

#include <stdbool.h>

enum orl_sky_model {
    ORL_SKY_OF_SCENE = 0, /* no sky requested */
    ORL_SKY_BY_PEREZ,     /* Perez, Seals, Michalsky 1993, from input */
    ORL_SKY_BY_CIE,       /* CIE types, from cie_type and input */
    ORL_SKY_BY_WEATHER,   /* Perez, from a row of weather_file */
};

enum orl_sky_normalise { ORL_SKY_FLUX = 0, ORL_SKY_GENDAYLIT };

/*
 * Method for the sun's position by time and site. ACCURATE: at most 0.01 degrees off, in the year
 * of the weather file's row, or in 2017 if there is no year. RADIANCE: the fit of IES RP-21 that
 * gendaylit and gensky use when no year is given, up to 1.1 degrees off. ORL_SKY_GENDAYLIT always
 * uses the latter. The sun of a weather row may be down in the middle of its interval and up in a
 * part of it. ACCURATE then places the sun in the middle of that part; RADIANCE has no sun.
 */
enum orl_sun_method { ORL_SUN_ACCURATE = 0, ORL_SUN_RADIANCE };
const char *orl_sun_method_name(enum orl_sun_method method); /* "accurate", "radiance" */

/* Meaning of `first` and `second` in orl_sky_request; "-": not used. */
enum orl_sky_input {
    ORL_SKY_NORMAL_W = 0, /* Perez: direct normal, diffuse horizontal irradiance */
    ORL_SKY_NORMAL_LX,    /* Perez: direct normal, diffuse horizontal illuminance */
    ORL_SKY_HORIZONTAL_W, /* Perez: direct horizontal, diffuse horizontal irradiance */
    ORL_SKY_GLOBAL_W,     /* Perez: global horizontal irradiance, split after Erbs 1982; - */
    ORL_SKY_INDICES,      /* Perez: clearness, brightness */
    ORL_SKY_TYPICAL,      /* CIE: -; gensky's own brightness for the sun's altitude */
    ORL_SKY_ZENITH_CD_M2, /* CIE: luminance of the zenith; - */
    ORL_SKY_DIFFUSE_LX,   /* CIE: diffuse horizontal illuminance; - */
};

enum orl_sky_cie { ORL_SKY_CLEAR = 1, ORL_SKY_OVERCAST, ORL_SKY_UNIFORM, ORL_SKY_INTERMEDIATE };

struct orl_sky_request {
    enum orl_sky_model model;
    enum orl_sky_normalise normalise;
    enum orl_sun_method sun_method; /* used if time and site determine the sun */
    /* Position of the sun (Perez, CIE): given, or computed from time and site. An overcast sky with
     * given brightness needs neither. Weather files contain the site; only the time is used. */
    bool sun_given;
    double sun_altitude_deg, sun_azimuth_deg;
    bool time_given;
    int year; /* 0: not given */
    int month, day;
    double hour;
    double interval_h; /* 0, or length of a weather row's interval, over which the measurements are
                          means */
    double latitude_deg, longitude_deg, time_zone_h;
    enum orl_sky_input input;
    double first, second;
    double ground_reflectance;
    enum orl_sky_cie cie_type;
    double turbidity;        /* CIE, clear and intermediate, ORL_SKY_TYPICAL */
    double direct_normal_lx; /* CIE, clear and intermediate: for the sun; negative: gensky's own */
    char *weather_file;      /* a name for the job's file provider; owned by the job */
    int weather_year;        /* keep only the rows of this year of weather_file; 0: all rows */
};

/* One of several skies of a job. The job owns both fields. */
struct orl_named_sky {
    char *name; /* name in results: letters, digits, '-', '_'; unique in the job; not "result" */
    struct orl_sky_request request;
};

/* Sets defaults; model ORL_SKY_OF_SCENE. */
void orl_sky_request_init(struct orl_sky_request *request);

#endif
