/*
 * Output settings of a view: its files, its tone mapping, and its false colours of luminance or
 * illuminance. Plain values; zero is the default of each.
 */
#ifndef ORIEL_JOB_PICTURE_H
#define ORIEL_JOB_PICTURE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

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
    ORL_TONE_HUMAN,  /* matches the visibility to the eye (render/picture/tonemap_ward_larson.c) */
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

/*
 * A view under several skies, for comparison: its pictures in one common exposure, side by side on
 * a contact sheet, and one after the other as an animation.
 *
 * Input is the radiances of the pictures (Radiance HDR), all of one size. Common exposure means
 * that a luminance has the same brightness in every picture, under the view's tone mapping. For
 * ORL_TONE_HUMAN, the histograms of all pictures are merged (render/picture/tonemap_ward_larson.c).
 * Black pictures, as before dawn, do not affect the exposure; they are shown black, in their place.
 * If the first picture is all black, programs without animation support show the brightest one
 * instead.
 */

/* Settings of a job; zero is the default of each. */
struct orl_sequence_request {
    bool asked;
    double frame_s;   /* seconds per picture in the animation; 0: 0.5 */
    uint32_t columns; /* columns of the sheet; 0: chosen to make it about square */
    /* Width of a picture on the sheet; 0: 240. Pictures are never enlarged, and are all reduced
     * further if the sheet would exceed the pixel limit of a picture. */
    uint32_t width_px;
};

enum { ORL_SEQUENCE_LINES = 2, ORL_SEQUENCE_TEXT = 64 };

struct orl_sequence_frame {
    const char *picture;                               /* name of the HDR for files */
    const char *shown;                                 /* path of the PNG to write */
    char lines[ORL_SEQUENCE_LINES][ORL_SEQUENCE_TEXT]; /* caption */
};

struct orl_sequence {
    const struct orl_files *files; /* borrowed, as are all pointers here */
    const struct orl_display *display;
    const struct orl_sequence_request *how;
    const struct orl_sequence_frame *frames;
    size_t n_frames;               /* 1 or more */
    const char *title;             /* heading of the sheet */
    const char *sheet, *animation; /* paths of both PNGs */
    const atomic_bool *cancel;     /* polled per picture; NULL: never */
};

/* Writes all files, each whole or absent. Returns ORL_ERR_RANGE (pictures differ in size),
 * ORL_ERR_CANCELLED, _IO, _NOMEM, or the error of reading a picture. */
int orl_sequence_write(const struct orl_sequence *sequence, struct orl_error *err);

/* Animated PNG from still PNGs of one size. */

/* Writes the animation; on errors no file is left. frame_s: seconds per frame. Returns 0,
 * ORL_ERR_RANGE (pictures differ in size), ORL_ERR_IO, _NOMEM or _SYNTAX. */
int orl_animation_write(const char *const *pictures, size_t count, double frame_s, const char *path,
                        struct orl_error *err);

#endif
