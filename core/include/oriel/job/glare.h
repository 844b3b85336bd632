/*
 * Glare metrics from the luminances of a view.
 *
 * A view with metrics is evaluated as rendered, before its pixels are rounded to a file. A Radiance
 * HDR picture with a VIEW line is evaluated by orl_glare_of_picture. First, glare sources are
 * found: pixels above a threshold, merged where they lie close, with bright peaks kept separate
 * (metrics/glare_sources.h). Then the indices are computed (metrics/indices.h).
 *
 * Units: luminance cd/m2, illuminance lx, solid angles sr. Positions in a picture are in pixels
 * from its left and its lower edge, 0.5 in the middle of the first.
 *
 * Stated errors are sampling errors; NaN where they are not known.
 */
#ifndef ORIEL_JOB_GLARE_H
#define ORIEL_JOB_GLARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Metrics of a view; a set is a sum of 1 << metric. */
enum orl_glare_metric {
    ORL_GLARE_DGP,         /* daylight glare probability */
    ORL_GLARE_DGPS,        /* simplified DGP, from the illuminance at the eye alone */
    ORL_GLARE_DGI,         /* daylight glare index */
    ORL_GLARE_UGR,         /* unified glare rating */
    ORL_GLARE_VCP,         /* visual comfort probability, per cent */
    ORL_GLARE_CGI,         /* CIE glare index */
    ORL_GLARE_UGP,         /* unified glare probability */
    ORL_GLARE_ILLUMINANCE, /* illuminance at the eye, perpendicular to the line of sight, lx */
    ORL_GLARE_AVERAGE,     /* mean luminance of the whole view, cd/m2 */
    ORL_GLARE_BACKGROUND,  /* luminance outside the sources: (Ev - Ev of the sources) / pi, cd/m2 */
    ORL_GLARE_METRICS
};
/* "dgp", "dgps", "dgi", ..., "vertical_illuminance_lx", ... */
const char *orl_glare_metric_name(enum orl_glare_metric metric);

enum orl_dgp_constants { ORL_DGP_EVALGLARE, ORL_DGP_PUBLISHED };

/* Circular part of the view. */
struct orl_glare_area {
    double x, y;      /* pixels, from the left and from below */
    double angle_rad; /* full angle; 0: no such part */
};

enum { ORL_GLARE_MASK_MAX = 256 };

struct orl_glare_settings {
    double threshold; /* up to 100: multiple of the mean luminance of the task, or of the whole view
                         without a task; above 100: cd/m2. 0: 5 with a task, else 2000 */
    struct orl_glare_area task;
    double radius_rad; /* pixels no further apart than half of it belong to one source; 0: 0.2 */
    bool smooth;       /* true: pixels surrounded by a source are part of it */
    bool no_peaks;     /* true: peaks are not split from their source */
    double peak_cd_m2; /* luminance of peaks; 0: 50 000 */
    enum orl_dgp_constants constants;
    bool low_light;        /* true: apply DGP's correction below 1000 lx */
    double age_years;      /* DGP for people of that age; 0: no age correction */
    double eye_lx;         /* measured illuminance that replaces the view's; 0: the view's */
    bool at_whole_pixels;  /* position indices as evalglare takes them: metrics/evalglare.md */
    uint32_t directions;   /* number of lines of sight, rotated about up; 0 or 1: the view's only */
    double directions_deg; /* angle from the first to the last, centred on the view's */
    double band_rad;       /* half height of a horizontal band about the picture's middle row for
                              luminance statistics; 0: none */
    char mask[ORL_GLARE_MASK_MAX]; /* jobs only: mask picture of the view's size among the scene's
                                      files; luminance statistics cover the pixels above 0.1 */
};
/* Checks the settings. Returns 0, or ORL_ERR_RANGE with the name of the setting. */
int orl_glare_settings_check(const struct orl_glare_settings *settings, struct orl_error *err);

struct orl_glare_source {
    double luminance_cd_m2, solid_angle_sr, position_index;
    size_t pixels;
    double x, y;               /* luminance-weighted centre */
    struct orl_vec3 direction; /* direction to that centre, in scene axes */
    double angle_deg;          /* angle from the line of sight */
    double illuminance_lx;     /* contribution to the illuminance at the eye */
    double most_cd_m2;         /* luminance of its brightest pixel */
};

/* Sampled value with its error. */
struct orl_glare_value {
    double value, standard_error; /* NaN: not known */
    double interval_95[2];        /* NaN: not known */
};

/* Luminance statistics of a part of the view. */
struct orl_glare_part {
    size_t pixels;
    double solid_angle_sr, illuminance_lx;
    double mean, median, deviation, percentile_75, percentile_95, least, most; /* cd/m2 */
};

/* Classes of DGP after Wienold 2009. */
enum orl_glare_class {
    ORL_GLARE_IMPERCEPTIBLE, /* below 0.35 */
    ORL_GLARE_PERCEPTIBLE,   /* below 0.40 */
    ORL_GLARE_DISTURBING,    /* below 0.45 */
    ORL_GLARE_INTOLERABLE,
    ORL_GLARE_UNDECIDED /* the interval contains a class bound */
};
const char *orl_glare_class_name(enum orl_glare_class class_of);

struct orl_glare {
    struct orl_glare_value values[ORL_GLARE_METRICS];
    enum orl_glare_class class_of;
    double direct_lx;       /* illuminance at the eye by the sources */
    double threshold_cd_m2; /* threshold of source pixels */
    double task_cd_m2;      /* mean luminance of the task, or of the view */
    double most_cd_m2;      /* luminance of the brightest pixel */
    double field_sr;        /* solid angle of the view within the hemisphere before the eye */
    double turned_deg; /* line of sight relative to the view's, positive to the left: the worst of
                          several */
    /*
     * Wide pixels spread a small bright source, such as the sun's disc, over a larger solid angle
     * at a lower luminance, and DGP grows with the square of the luminance. sharper_dgp is DGP with
     * such sources at their own solid angle where it is known, otherwise as bright as their
     * brightest pixel, a lower bound. It is DGP itself where no source is blurred. blurred_pixels:
     * size of the most important such source, in pixels; 0: none.
     */
    double sharper_dgp;
    size_t blurred_pixels;
    struct orl_glare_part masked;     /* set if there is a mask */
    struct orl_glare_part band;       /* set if band_rad is above 0 */
    struct orl_glare_source *sources; /* owned; sorted by contribution to DGP, largest first */
    size_t n_sources;
};
void orl_glare_done(struct orl_glare *glare); /* NULL is fine */

/* Returns true if DGP is at least 0.01 too low because pixels blur a source. *ret_width: a width
 * of the view, in pixels, at which they hardly do; width: its width. */
bool orl_glare_is_blurred(const struct orl_glare *glare, uint32_t width, uint32_t *ret_width);

/*
 * Picture file in memory, for orl_glare_of_picture. That function evaluates a Radiance HDR picture.
 * `view`: options that replace its VIEW line, or NULL. `mask`: another picture of the same size, or
 * NULL. Returns 0, ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, _LIMIT or _NOMEM. The caller releases
 * ret_glare.
 */
struct orl_picture_bytes {
    const char *name; /* for messages */
    const void *data;
    size_t size;
};
int orl_glare_of_picture(const struct orl_picture_bytes *picture, const char *view,
                         const struct orl_picture_bytes *mask,
                         const struct orl_glare_settings *settings, struct orl_glare *ret_glare,
                         struct orl_error *err);

#endif
