/*
 * What is made of a view beside its radiances: which files, how bright a picture to look at is, and
 * luminance or illuminance in false colours. Plain values; zero is the default of each.
 */
#ifndef ORIEL_PICTURE_H
#define ORIEL_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

/* ---- Files ----------------------------------------------------------------------------------- */

/* The files that may come of a view, in the order in which results list them. */
enum orl_picture {
    ORL_PICTURE_HDR,       /* Radiance's: radiances, or irradiances, as they are */
    ORL_PICTURE_PNG,       /* to look at, 8 bits */
    ORL_PICTURE_PNG16,     /* the same with 16 */
    ORL_PICTURE_EXR,       /* radiances as half floats */
    ORL_PICTURE_EXR_FLOAT, /* and as floats */
    ORL_PICTURE_FALSE,     /* false colours, with a legend */
    ORL_PICTURE_LINES,     /* contour lines, and ... */
    ORL_PICTURE_BANDS,     /* ... bands, over the picture to look at */
    ORL_PICTURE_ERROR_HDR, /* standard errors of the pixels, where they are known */
    ORL_PICTURE_ERROR_PNG,
    ORL_PICTURES
};

/* Its name in results ("error_hdr"), and how its file ends ("error.hdr"). */
const char *orl_picture_name(enum orl_picture picture);
const char *orl_picture_ending(enum orl_picture picture);

/* A set of them, as bits. */
#define ORL_PICTURE_BIT(picture) (1U << (picture))

/* Those that a view may ask for by name; false: there is none of that name. */
bool orl_picture_format(const char *name, enum orl_picture *ret_picture);

/* Without any wish, as a set. */
#define ORL_PICTURES_USUAL (ORL_PICTURE_BIT(ORL_PICTURE_HDR) | ORL_PICTURE_BIT(ORL_PICTURE_PNG))

/* ---- Pictures to look at --------------------------------------------------------------------- */

enum orl_tone {
    ORL_TONE_HUMAN,    /* as much is seen of it as the eye would (render/picture/human.h) */
    ORL_TONE_LINEAR,   /* in proportion; the geometric mean of luminances becomes middle gray */
    ORL_TONE_EXPOSURE, /* in proportion, by the factor that is given */
    ORL_TONES
};

const char *orl_tone_name(enum orl_tone tone); /* "human", "linear", "exposure" */

struct orl_display {
    enum orl_tone tone;
    double exposure; /* of that tone: white is 1 / exposure, W/sr/m2 of luma */
    bool veil;       /* human: with the light that eyes scatter from bright places into dark ones */
    bool acuity;     /* human: dark places as blurred as they are seen */
    bool color_loss; /* human: colours fade where it is too dark for them */
};

/* The exposure of a camera's exposure value at ISO 100: its sensor is full at 1.2 * 2^ev cd/m2
 * (ISO 12232, saturation-based, with a lens that lets 65 % through). */
double orl_exposure_of_ev(double ev);

/* ---- False colours --------------------------------------------------------------------------- */

enum orl_palette {
    ORL_PALETTE_EVEN, /* even steps of lightness: that of error maps */
    ORL_PALETTE_DEF,  /* those of Radiance's falsecolor, by its names */
    ORL_PALETTE_SPEC,
    ORL_PALETTE_PM3D,
    ORL_PALETTE_HOT,
    ORL_PALETTE_ECO,
    ORL_PALETTES
};
const char *orl_palette_name(enum orl_palette palette); /* "even", "def", ... */
/*
 * Colours of a scale, sRGB; share: 0 at its lower end, 1 at its top; beyond is as the ends are.
 *
 * ORL_PALETTE_EVEN, in CIELAB: lightness from 14 to 91 in even steps, hue from violet by way of
 * teal to yellow so that steps differ alike, chroma as far as sRGB goes but 60 at most. The others
 * are what falsecolor shows under those names: its functions give linear values, shown with a gamma
 * of 2.2.
 */
void orl_palette_color(enum orl_palette palette, double share, unsigned char ret_srgb[3]);

enum { ORL_PICTURE_LABEL_MAX = 32, ORL_DEFAULT_DIVISIONS = 8 };

/* A place in the picture whose value is written beside it, and into the result. */
struct orl_picture_point {
    char name[ORL_PICTURE_LABEL_MAX];
    double x, y; /* pixels, from the top left */
};

struct orl_false_color {
    bool asked;
    double scale;       /* the top, in the unit; 0: found from the picture */
    double decades;     /* logarithmic over so many below the top; 0: linear from 0 */
    uint32_t divisions; /* of the scale; 0: ORL_DEFAULT_DIVISIONS */
    enum orl_palette palette;
    char label[ORL_PICTURE_LABEL_MAX]; /* the unit's name; empty: cd/m2, or lx of irradiances */
    double multiplier;                 /* from W (luma) to the unit; 0: 179 lm/W */
    bool isolines;                     /* labelled, over the colours */
    bool extrema;                      /* the darkest and the brightest pixel are marked */
    uint32_t pictures;                 /* of FALSE, LINES and BANDS, as bits; 0: FALSE */
    struct orl_picture_point *points;  /* owned by the job */
    uint32_t n_points;
};

/* ---- Sensors in planes ----------------------------------------------------------------------- */

enum { ORL_HEAT_MAPS = 16, ORL_HEAT_MAP_THRESHOLDS = 8, ORL_LENGTH_UNIT_MAX = 12 };

/* Maps of sensors that lie in planes, with tables of all of them. */
struct orl_heat_map_request {
    bool asked;
    struct orl_false_color colors; /* scale, decades, divisions and palette */
    double thresholds_lx[ORL_HEAT_MAP_THRESHOLDS];
    uint32_t n_thresholds;
    char length_unit[ORL_LENGTH_UNIT_MAX]; /* of the scene; empty: m */
};

#endif
