/*
 * Output settings of a view: its files, its tone mapping, and its false colours of luminance or
 * illuminance. Plain values; zero is the default of each.
 */
#ifndef ORIEL_JOB_PICTURE_H
#define ORIEL_JOB_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

/* ---- Files ----------------------------------------------------------------------------------- */

/* Files of a view, in the order in which results list them. */
enum orl_picture {
    ORL_PICTURE_HDR,       /* Radiance HDR: unmodified radiances or irradiances */
    ORL_PICTURE_PNG,       /* tone-mapped, 8 bits */
    ORL_PICTURE_PNG16,     /* tone-mapped, 16 bits */
    ORL_PICTURE_EXR,       /* radiances as half floats */
    ORL_PICTURE_EXR_FLOAT, /* radiances as floats */
    ORL_PICTURE_FALSE,     /* false colours, with a legend */
    ORL_PICTURE_LINES,     /* contour lines over the tone-mapped picture */
    ORL_PICTURE_BANDS,     /* bands over the tone-mapped picture */
    ORL_PICTURE_ERROR_HDR, /* standard errors of pixels, if known */
    ORL_PICTURE_ERROR_PNG,
    ORL_PICTURES
};

/* Returns the name in results ("error_hdr"), and the file name's ending ("error.hdr"). */
const char *orl_picture_name(enum orl_picture picture);
const char *orl_picture_ending(enum orl_picture picture);

/* Bit of a file in a set. */
#define ORL_PICTURE_BIT(picture) (1U << (picture))

/* Looks up a file that a view may request by name. Returns false for an unknown name. */
bool orl_picture_format(const char *name, enum orl_picture *ret_picture);

/* Default set of files. */
#define ORL_PICTURES_DEFAULT (ORL_PICTURE_BIT(ORL_PICTURE_HDR) | ORL_PICTURE_BIT(ORL_PICTURE_PNG))

/* ---- Tone mapping ---------------------------------------------------------------------------- */

enum orl_tone {
    ORL_TONE_HUMAN,  /* matches the visibility to the eye (render/picture/tonemap_ward_larson.h) */
    ORL_TONE_LINEAR, /* linear; the geometric mean of luminances becomes middle gray */
    ORL_TONE_EXPOSURE, /* linear, by the given factor */
    ORL_TONES
};

const char *orl_tone_name(enum orl_tone tone); /* "human", "linear", "exposure" */

struct orl_display {
    enum orl_tone tone;
    double exposure; /* for ORL_TONE_EXPOSURE: white is 1 / exposure, W/sr/m2 of luma */
    bool veil;   /* human: add the glare that the eye scatters from bright places into dark ones */
    bool acuity; /* human: blur dark places to the eye's acuity */
    bool color_loss; /* human: desaturate dark places, as the eye does */
};

/* Returns the exposure for a camera's exposure value at ISO 100: its sensor saturates at 1.2 * 2^ev
 * cd/m2 (ISO 12232, saturation-based, with a lens transmittance of 65 %). */
double orl_exposure_of_ev(double ev);

/* ---- False colours --------------------------------------------------------------------------- */

enum orl_palette {
    ORL_PALETTE_EVEN, /* even steps of lightness; used for error maps */
    ORL_PALETTE_DEF,  /* the palettes of Radiance's falsecolor, by its names */
    ORL_PALETTE_SPEC,
    ORL_PALETTE_PM3D,
    ORL_PALETTE_HOT,
    ORL_PALETTE_ECO,
    ORL_PALETTES
};
const char *orl_palette_name(enum orl_palette palette); /* "even", "def", ... */
/*
 * Returns the sRGB colour at `share` of a scale: 0 at its lower end, 1 at its top; values outside
 * are clamped.
 *
 * ORL_PALETTE_EVEN is defined in CIELAB. Lightness goes from 14 to 91 in even steps. Hue goes from
 * violet over teal to yellow in steps of equal difference. Chroma is the largest within sRGB, at
 * most 60. The other palettes reproduce falsecolor: its functions give linear values, shown with a
 * gamma of 2.2.
 */
void orl_palette_color(enum orl_palette palette, double share, unsigned char ret_srgb[3]);

enum { ORL_PICTURE_LABEL_MAX = 32, ORL_DEFAULT_DIVISIONS = 8 };

/* Labelled point: its value is written beside it in the picture, and into the result. */
struct orl_picture_point {
    char name[ORL_PICTURE_LABEL_MAX];
    double x, y; /* pixels, from the top left */
};

struct orl_false_color {
    bool asked;
    double scale;   /* top of the scale in its unit; 0: found from the picture */
    double decades; /* logarithmic scale over this many decades below the top; 0: linear from 0 */
    uint32_t divisions; /* number of divisions of the scale; 0: ORL_DEFAULT_DIVISIONS */
    enum orl_palette palette;
    char label[ORL_PICTURE_LABEL_MAX]; /* unit name; empty: cd/m2, or lx for irradiances */
    double multiplier;                 /* factor from W (luma) to the unit; 0: 179 lm/W */
    bool isolines;                     /* true: draw labelled isolines over the colours */
    bool extrema;                      /* true: mark the darkest and the brightest pixel */
    uint32_t pictures;                 /* subset of FALSE, LINES and BANDS, as bits; 0: FALSE */
    struct orl_picture_point *points;  /* owned by the job */
    uint32_t n_points;
};

/* ---- Sensors in planes ----------------------------------------------------------------------- */

enum { ORL_HEAT_MAPS = 16, ORL_HEAT_MAP_THRESHOLDS = 8, ORL_LENGTH_UNIT_MAX = 12 };

/* Heat maps of sensors that lie in planes, with tables of all sensors. */
struct orl_heat_map_request {
    bool asked;
    struct orl_false_color colors; /* only scale, decades, divisions and palette are used */
    double thresholds_lx[ORL_HEAT_MAP_THRESHOLDS];
    uint32_t n_thresholds;
    char length_unit[ORL_LENGTH_UNIT_MAX]; /* length unit of the scene; empty: m */
};

#endif
