/*
 * Bidirectional scattering distribution functions read from WINDOW-schema XML.
 *
 * Frame: the surface's own. +z is the Radiance surface normal (which by custom faces the
 * interior), +y is "up" projected into the surface, +x = y cross z. All directions are unit
 * vectors that point AWAY from the surface; a direction with z > 0 lies on the front (inside).
 * In the XML "Front" names the exterior, which is z < 0 here; the loader does the turning.
 *
 * Values are 1/sr, per channel, not cosine-weighted. Light arrives along -in (that is, in points
 * back to where it came from) and leaves along out. Reflection when in.z and out.z share a sign,
 * transmission when not. Reciprocity: a transmission the file lacks is the transpose of the one it
 * has, but for TensorTree3, which stays black that way; a missing reflection is black. Where a file
 * gives both transmissions, each serves the light that arrives on its own side; Radiance's rpict,
 * tracing backwards, uses the other one.
 *
 * Energy: no BSDF sends out more light than it gets. Where a file's R + T for light from some
 * direction is above 1, in some channel, all values for light from there are divided by it, so that
 * it is 1, to the last bit or so; values for other directions stay. Data that were reciprocal are
 * then so no more between such a direction and another: f(in, out) is divided, f(out, in) is not.
 *
 * Colour: where a file has CIE X and Z (matrices) or u' and v' (trees) beside Visible, values are
 * RGB by Radiance's primaries and equal-energy white, with Visible for luma, exactly. Draws go by
 * luminance alone; their weights carry the colour.
 *
 * An orl_bsdf is immutable once loaded, reference-counted, and safe to share between threads: all
 * tables that draws need are made by orl_bsdf_load_xml from that file alone, so that nothing
 * depends on what else is loaded, in which order, or on who asks first. Memory is bounded by
 * limits.h. References: Klems 1994; Ward et al. 2011 and 2014 (tensor tree); Shirley and Chiu 1997.
 */
#ifndef ORIEL_BSDF_H
#define ORIEL_BSDF_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_bsdf;
struct orl_crew;

/*
 * Parses XML held in memory, streaming; entities and DTDs are refused. name is for messages.
 * Returns 0 and an owned BSDF, or ORL_ERR_SYNTAX, _UNSUPPORTED, _RANGE, _LIMIT, _NOMEM with file
 * and line filled in.
 */
int orl_bsdf_load_xml(const char *name, const char *xml, size_t size, struct orl_bsdf **ret_bsdf,
                      struct orl_error *err);

/* The same, for XML whose holder wants to know, while it is being read, what is not needed again.
 */
struct orl_bsdf_xml {
    const char *name, *data;
    size_t size;
    void (*passed)(void *ctx, size_t begin, size_t end); /* or NULL */
    void *ctx;
    const atomic_bool *cancel; /* or NULL; once set, it is read no further: ORL_ERR_CANCELLED */
    struct orl_crew *crew; /* or NULL; reads blocks side by side, each member tells of its own */
};
int orl_bsdf_load(const struct orl_bsdf_xml *xml, struct orl_bsdf **ret_bsdf,
                  struct orl_error *err);

struct orl_bsdf *orl_bsdf_ref(struct orl_bsdf *bsdf);
void orl_bsdf_unref(struct orl_bsdf *bsdf); /* NULL is allowed */

/* f(in, out) in 1/sr. Zero outside the data. Total: includes the diffuse part. */
struct orl_rgb orl_bsdf_eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out);

/* The constant (Lambertian) part of f for in's side: reflected back, or transmitted. 1/sr. */
struct orl_rgb orl_bsdf_diffuse(const struct orl_bsdf *bsdf, bool in_front, bool transmitted);

/*
 * Transmission from the back to the front as a matrix, [row][column][3]: rows are directions out,
 * columns directions in, cells of the file's bases in its order; f times the projected solid angle
 * of the direction in. ret_values: owned by the caller, free(). ORL_ERR_UNSUPPORTED (no matrix, no
 * transmission), ORL_ERR_NOMEM.
 */
int orl_bsdf_transmission(const struct orl_bsdf *bsdf, size_t *ret_rows, size_t *ret_columns,
                          float **ret_values, struct orl_error *err);

/* Which hemisphere a sample may go to. */
enum orl_bsdf_side { ORL_BSDF_REFLECT = 1, ORL_BSDF_TRANSMIT = 2, ORL_BSDF_BOTH = 3 };

/* Directional-hemispherical reflectance and/or transmittance for light from in: 0..1 a channel. */
struct orl_rgb orl_bsdf_albedo(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                               enum orl_bsdf_side sides);

/*
 * Draws out with pdf proportional to (luma of) f |cos out| on the allowed sides, total f, diffuse
 * part included. u: three independent uniforms in [0,1). Returns false (absorbed) when the albedo
 * of those sides is zero. ret_weight = f(in,out) |cos out| / pdf; ret_pdf per steradian.
 */
bool orl_bsdf_sample(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                     const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight,
                     double *ret_pdf);

/*
 * The adjoint: given the direction out in which light leaves, draws in with pdf proportional to
 * luma of f(in,out) |cos in|, f as in the file. Weights and pdf as above with |cos in|. For
 * reciprocal data it is orl_bsdf_sample(out); for data that is not, it stays consistent with
 * orl_bsdf_eval(in, out).
 */
bool orl_bsdf_sample_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                             enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_in,
                             struct orl_rgb *ret_weight, double *ret_pdf);

/* The pdf, per steradian, with which orl_bsdf_sample / _sample_adjoint draw a direction. */
double orl_bsdf_pdf(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                    struct orl_vec3 out);
double orl_bsdf_pdf_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                            enum orl_bsdf_side sides, struct orl_vec3 in);

/*
 * A transmission that a file holds but that is no data: all zero where the other one is not, or the
 * other one's numbers repeated although they are not their own reverse. Programs that write just
 * one transmission fill the other in like that. It is taken as absent.
 */
enum orl_bsdf_dummy { ORL_BSDF_DUMMY_NONE, ORL_BSDF_DUMMY_ZERO, ORL_BSDF_DUMMY_COPY };

/* ---- Straight through ------------------------------------------------------------------------
 *
 * What stands out of a transmission around the straight direction, found when the file is loaded:
 * the material aBSDF lets it pass undeviated and scatters the rest. How it is found is told in
 * core/bsdf/peak.h. f(in, out) = straight part + rest; orl_bsdf_straight is the integral of the
 * former, so that what goes straight and what is scattered sum to orl_bsdf_albedo.
 */

/* The share of light from in that goes straight through: 0..1 a channel. */
struct orl_rgb orl_bsdf_straight(const struct orl_bsdf *bsdf, struct orl_vec3 in);

/* How much of f(in, out) is straight: 0..1. */
double orl_bsdf_straight_part(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out);

/*
 * As orl_bsdf_sample, or given out with adjoint as orl_bsdf_sample_adjoint, but for what goes
 * straight: direction is then the opposite of the one given, pdf is 0, and the weight such that its
 * mean is orl_bsdf_straight of the direction the light comes from. The pdf of the others is of f
 * whole: the density of drawing them is that times 1 - orl_bsdf_straight_part.
 */
struct orl_bsdf_draw {
    struct orl_vec3 direction;
    struct orl_rgb weight;
    double pdf;
    bool straight;
};
bool orl_bsdf_sample_split(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                           enum orl_bsdf_side sides, const double u[3],
                           struct orl_bsdf_draw *ret_draw);

/*
 * Many draws, each as orl_bsdf_sample (or, adjoint, orl_bsdf_sample_adjoint) makes it from the same
 * numbers, never straight; ret_found: whether there is any light to go on. Trees of rank 4 are
 * larger than caches: draws asked for together wait for memory together.
 */
struct orl_bsdf_ask {
    const struct orl_bsdf *bsdf;
    struct orl_vec3 given;
    bool adjoint;
    enum orl_bsdf_side sides;
    double u[3];
};
void orl_bsdf_sample_many(const struct orl_bsdf_ask *asks, size_t n,
                          struct orl_bsdf_draw *ret_draws, bool *ret_found);

/* The integral whose inverse the pdf has: of the luminance as filed, R + T above 1 included. */
double orl_bsdf_total(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                      enum orl_bsdf_side sides);

/* A bound, at most 1, on every channel of orl_bsdf_albedo for light from that side. */
double orl_bsdf_max_albedo(const struct orl_bsdf *bsdf, bool in_front);

/* What a BSDF is, for upload checks and messages. */
struct orl_bsdf_info {
    char name[128];       /* of the material, from the file */
    char kind[32];        /* "TensorTree3", "TensorTree4", "Klems Full", ... */
    int resolution;       /* directions per axis (trees) or per hemisphere (matrices) */
    size_t values;        /* leaf values held */
    size_t bytes;         /* memory held */
    bool has[2][2];       /* [front?][transmitted?]: in the file, rather than by reciprocity */
    double max_albedo[2]; /* largest directional R + T in the file, from the back, the front */
    double thickness_m;   /* 0 when not given */
    enum orl_bsdf_dummy dummy[2]; /* the transmission of light from the back, the front */
    bool colored;                 /* some component has colour */
    bool
        color_left_out; /* some component has one channel of colour only, or of other cells: grey */
    size_t out_of_gamut;  /* values whose colour RGB cannot show: moved to its edge */
    size_t clamped;       /* negative luminances set to zero */
    size_t skipped_bytes; /* of text that stands before the XML, and was passed over */
};
void orl_bsdf_describe(const struct orl_bsdf *bsdf, struct orl_bsdf_info *ret_info);

/* ---- The check on upload ---------------------------------------------------------------------
 *
 * Directions are those the light comes from: theta from the normal on its side, phi from +x
 * towards +y. Index 1 is light from the front, 0 from the back (outside), as in has[][].
 */

enum {
    ORL_BSDF_CHECK_DIRECTIONS = 21, /* 0, and 15 to 75 degrees at four azimuths */
    ORL_BSDF_VERDICTS_MAX = 21,
    ORL_BSDF_VERDICT_TEXT = 256,
};

struct orl_bsdf_hemispherical {
    double theta_deg, phi_deg;
    double reflected, transmitted; /* 0..1 */
};

/* Of a directional-hemispherical value over all directions that the data tell apart. */
struct orl_bsdf_extremes {
    double least, mean, most;            /* mean: of perfectly diffuse light */
    double most_theta_deg, most_phi_deg; /* where most is */
    /* The most of means over 1/32 by 1/32 of a tree's square: what Radiance's checkBSDF reports.
     * Not for totals; equal to most for matrices. */
    double most_coarse;
    double even; /* what is sent evenly to all sides whatever it comes from: pi orl_bsdf_diffuse */
};

/*
 * The light that goes straight through, and what the data's resolution does to the sun in it. The
 * sun fills the cell of the data that it shines through: its image is smear times too large and as
 * much too dim. Glare counts luminance squared times solid angle, which that divides by smear;
 * 0.0918 log10(1 + s) of DGP (Wienold and Christoffersen 2006) then loses 0.0918 log10(smear) at
 * the most.
 */
struct orl_bsdf_peak {
    double theta_deg, phi_deg; /* of the light, from the outside */
    double cell_sr;            /* solid angle of the cell that the straight direction falls into */
    double smear;              /* over that of the sun's disc; at least 1 */
    double share;              /* of the transmission that stands out as a peak there: 0..1 */
    double straight;           /* orl_bsdf_straight: of the light, what aBSDF lets pass; 0..1 */
    double dgp_loss;           /* bound on the DGP lost; 0 where there is no peak */
};

/* What light from 30 to 60 degrees above or below the horizontal does, +y being up. */
struct orl_bsdf_redirection {
    double transmitted; /* 0..1 */
    double upward;      /* share of that which leaves rising */
};

enum orl_bsdf_level { ORL_BSDF_OK, ORL_BSDF_NOTE, ORL_BSDF_WARNING, ORL_BSDF_FAULT };

struct orl_bsdf_verdict {
    enum orl_bsdf_level level;
    char text[ORL_BSDF_VERDICT_TEXT]; /* one sentence or two */
};

struct orl_bsdf_check {
    struct orl_bsdf_info info;
    struct orl_bsdf_hemispherical directions[2][ORL_BSDF_CHECK_DIRECTIONS];
    struct orl_bsdf_extremes extremes[2][2]; /* [front?][transmitted?] */
    struct orl_bsdf_extremes total[2];       /* R + T */
    double total_exchanged[2];               /* most R + T if the two reflections changed places */
    /*
     * The share of the scattered light that would have to move for f(in, out) = f(out, in): 0 for
     * reciprocal data, 1 where the reverse of every path is dark. Negative: nothing to compare.
     */
    double irreciprocal_reflection[2], irreciprocal_transmission;
    struct orl_bsdf_peak normal; /* straight through at normal incidence */
    struct orl_bsdf_peak
        strongest; /* of the directions above, the one with most light in the peak */
    struct orl_bsdf_redirection redirection[2][2]; /* [front?][light from above?] */
    size_t n_verdicts;
    struct orl_bsdf_verdict verdicts[ORL_BSDF_VERDICTS_MAX]; /* in plain words */
    enum orl_bsdf_level worst;
};

/*
 * Looks a BSDF over: milliseconds for a matrix, up to a second for the largest trees. Values that
 * are not finite never get here: orl_bsdf_load_xml refuses them, with their line.
 */
void orl_bsdf_examine(const struct orl_bsdf *bsdf, struct orl_bsdf_check *ret_check);

/* "ok", "note", "warning", "fault". */
const char *orl_bsdf_level_name(enum orl_bsdf_level level);

#endif
