/*
 * A sky asked for by a job, beside or instead of the scene's own, so that one scene serves many
 * hours. Sun, sky and ground are then far away around the scene, as gendaylit or gensky with the
 * usual "source" lines would put them.
 *
 * Conventions: degrees; latitude north, longitude EAST, time zone in hours EAST of Greenwich
 * (Radiance's programs take longitude west); azimuth of the sun from south towards west, as they
 * do. Hours are standard time, from midnight. Irradiances in W/m2 (all of the sun's spectrum),
 * illuminances in lx.
 *
 * Normalisation: FLUX takes the diffuse flux given as what the sky delivers, by fine quadrature,
 * and lights the ground by sun and sky together: its radiance is reflectance * horizontal / pi. The
 * horizon cuts the sun's disc. Where the Perez model has no answer, the sky keeps its flux and
 * does without the model's change from zenith to horizon. Models take a sun above 87 degrees as one
 * of 87, and so does the sky; the sun itself stays in its place.
 * GENDAYLIT keeps the programs' own numbers: gendaylit divides by a mean over 145 patches, which
 * loses 0.7 to 2.7 % of the flux, and both take the ground's light from a CIE sky; the sun is whole
 * or down; what the model cannot say is black.
 */
#ifndef ORIEL_SKY_H
#define ORIEL_SKY_H

#include <stdbool.h>

enum orl_sky_model {
    ORL_SKY_OF_SCENE = 0, /* none is asked for */
    ORL_SKY_BY_PEREZ,     /* Perez, Seals, Michalsky 1993, from input */
    ORL_SKY_BY_CIE,       /* CIE types, from cie_type and input */
    ORL_SKY_BY_WEATHER,   /* Perez, from a row of weather_file */
};

enum orl_sky_normalise { ORL_SKY_FLUX = 0, ORL_SKY_GENDAYLIT };

/*
 * How the sun is placed by time and site. ACCURATE: at most 0.01 degrees off, in the year of the
 * weather file's row; of no year, in 2017. RADIANCE: by the fit of IES RP-21 that gendaylit and
 * gensky use when no year is given, up to 1.1 degrees off. ORL_SKY_GENDAYLIT is always the latter.
 * A weather row whose sun is down in the middle of its interval, and up in a part of it, has it in
 * the middle of that part by ACCURATE, and none by RADIANCE.
 */
enum orl_sun_method { ORL_SUN_ACCURATE = 0, ORL_SUN_RADIANCE };
const char *orl_sun_method_name(enum orl_sun_method method); /* "accurate", "radiance" */

/* What first and second are. */
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
    enum orl_sun_method sun_method; /* where time and site place the sun */
    /* Where the sun is (Perez, CIE): said, or by time and place. Overcast needs neither, when its
     * brightness is given. Weather files know the place, and only the time is taken. */
    bool sun_given;
    double sun_altitude_deg, sun_azimuth_deg;
    bool time_given;
    int year; /* 0: none is given */
    int month, day;
    double hour;
    double interval_h; /* 0, or of a weather row: what was measured is the mean of so long */
    double latitude_deg, longitude_deg, time_zone_h;
    enum orl_sky_input input;
    double first, second;
    double ground_reflectance;
    enum orl_sky_cie cie_type;
    double turbidity;        /* CIE, clear and intermediate, ORL_SKY_TYPICAL */
    double direct_normal_lx; /* CIE, clear and intermediate: the sun's; negative: gensky's own */
    char *weather_file;      /* a name for the job's file provider; owned by the job */
    int weather_year;        /* of the rows of weather_file that count; 0: all do */
};

/* One of several skies of a job. Both are owned by the job. */
struct orl_named_sky {
    char *name; /* of its results: letters, digits, '-', '_'; unique in the job; not "result" */
    struct orl_sky_request request;
};

void orl_sky_request_init(struct orl_sky_request *request); /* defaults; of no sky */

#endif
