/*
 * Glare: how people are dazzled by what they look at, from a view's luminances.
 *
 * A view that asks for metrics is evaluated as rendered, before its pixels are rounded to a file; a
 * Radiance HDR picture with a VIEW line is evaluated by orl_glare_of_picture. What is found are
 * glare sources: pixels that stand out by a threshold, put together where they lie close, bright
 * peaks apart (metrics/sources.h); then the indices (metrics/indices.h).
 *
 * Units: luminance cd/m2, illuminance lx, solid angles sr. Places in a picture are in pixels from
 * its left and its lower edge, 0.5 in the middle of the first.
 *
 * Errors stated are of what was sampled: ORL_GLARE_NO_ERROR where nothing is known of that.
 */
#ifndef ORIEL_GLARE_H
#define ORIEL_GLARE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/vec.h>

/* What a view can be asked for; a set of them is a sum of 1 << metric. */
enum orl_glare_metric {
    ORL_GLARE_DGP,         /* daylight glare probability */
    ORL_GLARE_DGPS,        /* the same simplified, from the light at the eye alone */
    ORL_GLARE_DGI,         /* daylight glare index */
    ORL_GLARE_UGR,         /* unified glare rating */
    ORL_GLARE_VCP,         /* visual comfort probability, per cent */
    ORL_GLARE_CGI,         /* CIE glare index */
    ORL_GLARE_UGP,         /* unified glare probability */
    ORL_GLARE_ILLUMINANCE, /* lx at the eye, upright to the line of sight */
    ORL_GLARE_AVERAGE,     /* luminance of all that is seen, cd/m2 */
    ORL_GLARE_BACKGROUND,  /* luminance beside the sources: (Ev - Ev of the sources) / pi, cd/m2 */
    ORL_GLARE_METRICS
};
/* "dgp", "dgps", "dgi", ..., "vertical_illuminance_lx", ... */
const char *orl_glare_metric_name(enum orl_glare_metric metric);

enum orl_dgp_constants { ORL_DGP_EVALGLARE, ORL_DGP_PUBLISHED };

/* A part of the view, about a place in it. */
struct orl_glare_area {
    double x, y;      /* pixels, from the left and from below */
    double angle_rad; /* across; 0: there is no such part */
};

enum { ORL_GLARE_MASK_MAX = 256 };

struct orl_glare_settings {
    double threshold; /* up to 100: as a multiple of the task's mean luminance, or, without a task,
                         of the whole view's; above: cd/m2. 0: 5 with a task, else 2000 */
    struct orl_glare_area task;
    double radius_rad; /* pixels no farther apart than half of it are one source; 0: 0.2 */
    bool smooth;       /* pixels surrounded by a source are part of it */
    bool no_peaks;     /* nothing is taken apart from a source */
    double peak_cd_m2; /* what is: 0: 50 000 */
    enum orl_dgp_constants constants;
    bool low_light;        /* DGP with its correction below 1000 lx */
    double age_years;      /* DGP for people of that age; 0: for everybody */
    double eye_lx;         /* measured elsewhere, in place of the view's; 0: the view's */
    bool at_whole_pixels;  /* indices as evalglare takes them: metrics/evalglare.md */
    uint32_t directions;   /* so many lines of sight, turned about up; 0 or 1: the view's */
    double directions_deg; /* from the first to the last, the view's in the middle */
    double band_rad;       /* luminances are told of a band that reaches so far above and below the
                              picture's middle row; 0: of none */
    char mask[ORL_GLARE_MASK_MAX]; /* of a job: a picture of the view's size among the scene's
                                      files; luminances are told of where it is above 0.1 */
};
/* ORL_ERR_RANGE with the name of the setting. */
int orl_glare_settings_check(const struct orl_glare_settings *settings, struct orl_error *err);

struct orl_glare_source {
    double luminance_cd_m2, solid_angle_sr, position_index;
    size_t pixels;
    double x, y;               /* its middle, by luminance */
    struct orl_vec3 direction; /* to there, in the scene's axes */
    double angle_deg;          /* from the line of sight */
    double illuminance_lx;     /* that it gives at the eye */
    double most_cd_m2;         /* its brightest pixel */
};

/* A number that was sampled. */
struct orl_glare_value {
    double value, standard_error; /* NaN: not known */
    double interval_95[2];        /* NaN likewise */
};

/* Luminances of a part of the view. */
struct orl_glare_part {
    size_t pixels;
    double solid_angle_sr, illuminance_lx;
    double mean, median, deviation, percentile_75, percentile_95, least, most; /* cd/m2 */
};

/* DGP's, after Wienold 2009. */
enum orl_glare_class {
    ORL_GLARE_IMPERCEPTIBLE, /* below 0.35 */
    ORL_GLARE_PERCEPTIBLE,   /* below 0.40 */
    ORL_GLARE_DISTURBING,    /* below 0.45 */
    ORL_GLARE_INTOLERABLE,
    ORL_GLARE_UNDECIDED /* its interval holds a bound */
};
const char *orl_glare_class_name(enum orl_glare_class class_of);

struct orl_glare {
    struct orl_glare_value values[ORL_GLARE_METRICS];
    enum orl_glare_class class_of;
    double direct_lx;       /* of the light at the eye, the sources' */
    double threshold_cd_m2; /* that pixels had to be above */
    double task_cd_m2;      /* mean luminance of the task, or of the view */
    double most_cd_m2;      /* the brightest pixel */
    double field_sr;        /* that the view holds of the hemisphere before the eye */
    double turned_deg; /* the line of sight from the view's, to the left: the worst of several */
    struct orl_glare_part masked;     /* where there is a mask */
    struct orl_glare_part band;       /* where one is asked for */
    struct orl_glare_source *sources; /* owned; by what they add to DGP, the most first */
    size_t n_sources;
};
void orl_glare_done(struct orl_glare *glare); /* NULL is fine */

/*
 * Evaluates a Radiance HDR picture. view: options in place of its VIEW line, or NULL; mask: bytes
 * of another picture of the same size, or NULL. ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, _LIMIT,
 * _NOMEM; ret_glare is the caller's to release.
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
