/*
 * Bidirectional scattering distribution functions read from WINDOW-schema XML.
 *
 * Frame: local to the surface. +z is the Radiance surface normal (which by convention faces the
 * interior), +y is "up" projected into the surface, +x = y cross z. All directions are unit vectors
 * that point AWAY from the surface; a direction with z > 0 is on the front (inside). In the XML
 * "Front" names the exterior, which is z < 0 here; the loader converts.
 *
 * Values are in 1/sr, per channel, not cosine-weighted. Light arrives along -in (`in` points back
 * to the source) and leaves along out. Reflection: in.z and out.z have the same sign; transmission:
 * opposite signs. Reciprocity: a transmission that the file lacks is the transpose of the other
 * one, except in TensorTree3 files, where it stays black. A missing reflection is black. If a file
 * has both transmissions, each is used for light that arrives on its own side; Radiance's rpict,
 * which traces backwards, uses the other one.
 *
 * Energy: no BSDF sends out more light than it receives. If a file's R + T for light from some
 * direction is above 1 in some channel, all values for that direction are divided by it. The sum is
 * then 1, up to rounding; values for other directions stay. Reciprocal data are then no longer
 * reciprocal between such a direction and another: f(in, out) is divided, f(out, in) is not.
 *
 * Colour: if a file has CIE X and Z (matrices) or u' and v' (trees) beside Visible, values are RGB
 * by Radiance's primaries and equal-energy white, with Visible as exact luma. Samples are drawn by
 * luminance alone; their weights carry the colour.
 *
 * An orl_bsdf is immutable once loaded, reference-counted, and safe to share between threads.
 * orl_bsdf_load_xml builds all sampling tables from that file alone. Nothing depends on other
 * loaded BSDFs or on the order of loading and use. Memory is bounded by limits.h. References: Klems
 * 1994; Ward et al. 2011 and 2014 (tensor tree); Shirley and Chiu 1997.
 */
#ifndef ORIEL_BSDF_BSDF_H
#define ORIEL_BSDF_BSDF_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

struct orl_bsdf;
struct orl_thread_pool;

/*
 * Parses XML held in memory, streaming; entities and DTDs are rejected. `name` is for messages.
 * Returns 0 and an owned BSDF, or ORL_ERR_SYNTAX, _UNSUPPORTED, _RANGE, _LIMIT, _NOMEM with file
 * and line filled in.
 */
int orl_bsdf_load_xml(const char *name, const char *xml, size_t size, struct orl_bsdf **ret_bsdf,
                      struct orl_error *err);

/* XML source for orl_bsdf_load, which otherwise equals orl_bsdf_load_xml. */
struct orl_bsdf_xml {
    const char *name, *data;
    size_t size;
    /* Called while parsing, with byte ranges that are not needed again; or NULL. */
    void (*passed)(void *ctx, size_t begin, size_t end);
    void *ctx;
    const atomic_bool *cancel; /* or NULL; once it is set, parsing stops with ORL_ERR_CANCELLED */
    /* Or NULL; parses blocks in parallel, and `passed` is then called by all threads. */
    struct orl_thread_pool *pool;
};
int orl_bsdf_load(const struct orl_bsdf_xml *xml, struct orl_bsdf **ret_bsdf,
                  struct orl_error *err);

struct orl_bsdf *orl_bsdf_ref(struct orl_bsdf *bsdf);
void orl_bsdf_unref(struct orl_bsdf *bsdf); /* NULL is allowed */

/* Returns f(in, out) in 1/sr, including the diffuse part; zero outside the data. */
struct orl_rgb orl_bsdf_eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out);

/* Returns the constant (Lambertian) part of f for the given side of `in`, reflected or transmitted,
 * 1/sr. */
struct orl_rgb orl_bsdf_diffuse(const struct orl_bsdf *bsdf, bool in_front, bool transmitted);

/*
 * Returns the transmission from the back to the front as a matrix, [row][column][3]. Rows are
 * outgoing directions, columns incoming directions: cells of the file's bases, in its order. Each
 * entry is f times the projected solid angle of the incoming cell. The caller frees *ret_values.
 * Errors: ORL_ERR_UNSUPPORTED (no matrix, no transmission), ORL_ERR_NOMEM.
 */
int orl_bsdf_transmission(const struct orl_bsdf *bsdf, size_t *ret_rows, size_t *ret_columns,
                          float **ret_values, struct orl_error *err);

/* Hemispheres that a sample may go to, as flags. */
enum orl_bsdf_side { ORL_BSDF_REFLECT = 1, ORL_BSDF_TRANSMIT = 2, ORL_BSDF_BOTH = 3 };

/* Returns the directional-hemispherical reflectance, transmittance or both, by `sides`, for light
 * from `in`: 0..1 per channel. */
struct orl_rgb orl_bsdf_albedo(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                               enum orl_bsdf_side sides);

/*
 * Samples `out` with a pdf proportional to luma of f |cos out| on the allowed sides, where f
 * includes the diffuse part. u: three independent uniforms in [0,1). Returns false (absorbed) when
 * the albedo of those sides is zero. ret_weight = f(in,out) |cos out| / pdf; ret_pdf is per
 * steradian.
 */
bool orl_bsdf_sample(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                     const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight,
                     double *ret_pdf);

/*
 * Samples the adjoint: given the direction `out` in which light leaves, samples `in` with a pdf
 * proportional to luma of f(in,out) |cos in|, with f as in the file. Weight and pdf are as above,
 * with |cos in|. For reciprocal data it equals orl_bsdf_sample(out). For other data it stays
 * consistent with orl_bsdf_eval(in, out).
 */
bool orl_bsdf_sample_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                             enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_in,
                             struct orl_rgb *ret_weight, double *ret_pdf);

/* Return the pdf, per steradian, of a direction under orl_bsdf_sample and _sample_adjoint. */
double orl_bsdf_pdf(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                    struct orl_vec3 out);
double orl_bsdf_pdf_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                            enum orl_bsdf_side sides, struct orl_vec3 in);

/*
 * Kinds of placeholder transmissions: all zero where the other one is not, or a copy of the other
 * one's numbers although they are not their own transpose. Programs that compute only one
 * transmission write the other like that. The loader treats such a transmission as absent.
 */
enum orl_bsdf_placeholder {
    ORL_BSDF_NO_PLACEHOLDER,
    ORL_BSDF_PLACEHOLDER_ZERO,
    ORL_BSDF_PLACEHOLDER_COPY
};

/* ---- Straight through ------------------------------------------------------------------------
 *
 * The part of a transmission that stands out around the straight direction, found when the file is
 * loaded. The material aBSDF passes this part undeviated and scatters the rest.
 * core/bsdf/document.h describes the method. f(in, out) = straight part + rest. orl_bsdf_straight
 * is the integral of the straight part, so that straight and scattered light sum to
 * orl_bsdf_albedo.
 */

/* Returns the share of light from `in` that passes straight through: 0..1 per channel. */
struct orl_rgb orl_bsdf_straight(const struct orl_bsdf *bsdf, struct orl_vec3 in);

/* Returns the straight share of f(in, out): 0..1. */
double orl_bsdf_straight_part(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out);

/*
 * Result of a sample that separates straight light. orl_bsdf_sample_split samples as
 * orl_bsdf_sample, or, with `adjoint` and given = out, as orl_bsdf_sample_adjoint. For a straight
 * sample, direction is the opposite of the given one, pdf is 0, and the mean of the weight is
 * orl_bsdf_straight of the direction that the light comes from. For other samples pdf is that of
 * the whole f. Their actual density is pdf times (1 - orl_bsdf_straight_part).
 */
struct orl_bsdf_sample_result {
    struct orl_vec3 direction;
    struct orl_rgb weight;
    double pdf;
    bool straight;
};
bool orl_bsdf_sample_split(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                           enum orl_bsdf_side sides, const double u[3],
                           struct orl_bsdf_sample_result *ret_sample);

/*
 * Request for orl_bsdf_sample_many. Each sample equals the one that orl_bsdf_sample (or, with
 * adjoint, orl_bsdf_sample_adjoint) makes from the same numbers; it is never straight. ret_found:
 * false if the light is absorbed. Trees of rank 4 are larger than caches: a batch overlaps the
 * memory latency of its look-ups.
 */
struct orl_bsdf_sample_request {
    const struct orl_bsdf *bsdf;
    struct orl_vec3 given;
    bool adjoint;
    enum orl_bsdf_side sides;
    double u[3];
};
void orl_bsdf_sample_many(const struct orl_bsdf_sample_request *requests, size_t n,
                          struct orl_bsdf_sample_result *ret_samples, bool *ret_found);

/* Returns the normalisation integral of the pdf: of the luminance in the file, even if R + T is
 * above 1. */
double orl_bsdf_total(const struct orl_bsdf *bsdf, struct orl_vec3 given, bool adjoint,
                      enum orl_bsdf_side sides);

/* Returns a bound, at most 1, on every channel of orl_bsdf_albedo for light from that side. */
double orl_bsdf_max_albedo(const struct orl_bsdf *bsdf, bool in_front);

/* Description of a BSDF, for upload checks and messages. */
struct orl_bsdf_info {
    char name[128]; /* material name in the file */
    char kind[32];  /* "TensorTree3", "TensorTree4", "Klems Full", ... */
    int resolution; /* directions per axis (trees) or per hemisphere (matrices) */
    size_t values;  /* number of stored leaf values */
    size_t bytes;   /* memory in bytes */
    bool has[2][2]; /* [front?][transmitted?]: true if in the file, not derived by reciprocity */
    double max_albedo[2]; /* largest directional R + T in the file, for light from the back, the
                             front */
    double thickness_m;   /* 0 when not given */
    enum orl_bsdf_placeholder dummy[2]; /* for the transmission of light from the back, the front */
    bool colored;                       /* true: some component has colour */
    bool color_left_out;  /* true: some component has only one colour channel, or one with other
                             cells: read as grey */
    size_t out_of_gamut;  /* values with a colour outside RGB's gamut: moved to its boundary */
    size_t clamped;       /* negative luminances, set to zero */
    size_t skipped_bytes; /* bytes of text before the XML, skipped */
};
void orl_bsdf_describe(const struct orl_bsdf *bsdf, struct orl_bsdf_info *ret_info);

/* ---- The check on upload ---------------------------------------------------------------------
 *
 * Directions are those that the light comes from: theta from the normal on its side, phi from +x
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

/* Statistics of a directional-hemispherical value over all directions that the data resolve. */
struct orl_bsdf_extremes {
    double least, mean, most;            /* mean: for perfectly diffuse light */
    double most_theta_deg, most_phi_deg; /* direction of `most` */
    /* Largest of the means over 1/32 by 1/32 of a tree's square, which Radiance's checkBSDF
     * reports. Not for totals; equal to most for matrices. */
    double most_coarse;
    double even; /* Lambertian part, which does not depend on the incident direction: pi
                    orl_bsdf_diffuse */
};

/*
 * Light that passes straight through, and the effect of the data's resolution on the sun seen in
 * it. The sun fills the data cell that it shines through: its image is `smear` times too large and
 * as much too dim. Glare sums luminance squared times solid angle, which this divides by `smear`.
 * The term 0.0918 log10(1 + s) of DGP (Wienold and Christoffersen 2006) then loses 0.0918
 * log10(smear) at the most.
 */
struct orl_bsdf_peak {
    double theta_deg, phi_deg; /* direction of the light, from the outside */
    double cell_sr;            /* solid angle of the cell that contains the straight direction */
    double smear;              /* cell_sr over the solid angle of the sun's disc; at least 1 */
    double share;              /* share of the transmission that stands out as a peak: 0..1 */
    double straight;           /* orl_bsdf_straight: share of the light that aBSDF passes; 0..1 */
    double dgp_loss;           /* upper bound of the DGP lost; 0 without a peak */
};

/* Transmission of light from 30 to 60 degrees above or below the horizontal, with +y up. */
struct orl_bsdf_redirection {
    double transmitted; /* 0..1 */
    double upward;      /* share of the transmitted light that leaves upwards */
};

enum orl_bsdf_level { ORL_BSDF_OK, ORL_BSDF_NOTE, ORL_BSDF_WARNING, ORL_BSDF_FAULT };

struct orl_bsdf_verdict {
    enum orl_bsdf_level level;
    char text[ORL_BSDF_VERDICT_TEXT]; /* one or two sentences */
};

struct orl_bsdf_check {
    struct orl_bsdf_info info;
    struct orl_bsdf_hemispherical directions[2][ORL_BSDF_CHECK_DIRECTIONS];
    struct orl_bsdf_extremes extremes[2][2]; /* [front?][transmitted?] */
    struct orl_bsdf_extremes total[2];       /* R + T */
    double total_exchanged[2]; /* largest R + T if the two reflections were exchanged */
    /*
     * Share of the scattered light that would have to move to make f(in, out) = f(out, in): 0 for
     * reciprocal data, 1 if the reverse of every path is dark. Negative: no data to compare.
     */
    double irreciprocal_reflection[2], irreciprocal_transmission;
    struct orl_bsdf_peak normal;    /* straight through at normal incidence */
    struct orl_bsdf_peak strongest; /* the check direction with the most light in its peak */
    struct orl_bsdf_redirection redirection[2][2]; /* [front?][light from above?] */
    size_t n_verdicts;
    struct orl_bsdf_verdict verdicts[ORL_BSDF_VERDICTS_MAX]; /* messages for users */
    enum orl_bsdf_level worst;
};

/*
 * Checks a BSDF. Takes milliseconds for a matrix, up to a second for the largest trees. Values are
 * finite, because orl_bsdf_load_xml rejects others, with their line.
 */
void orl_bsdf_examine(const struct orl_bsdf *bsdf, struct orl_bsdf_check *ret_check);

/* "ok", "note", "warning", "fault". */
const char *orl_bsdf_level_name(enum orl_bsdf_level level);

#endif
