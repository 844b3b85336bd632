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
 * has; a missing reflection is black. Where a file gives both transmissions, each serves the light
 * that arrives on its own side; Radiance's rpict, tracing backwards, uses the other one.
 *
 * An orl_bsdf is immutable once loaded, reference-counted, and safe to share between threads.
 * References: Klems 1994; Ward et al. 2011 and 2014 (tensor tree); Shirley and Chiu 1997.
 */
#ifndef ORIEL_BSDF_H
#define ORIEL_BSDF_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_bsdf;

/*
 * Parses XML held in memory, streaming; entities and DTDs are refused. name is for messages.
 * Returns 0 and an owned BSDF, or ORL_ERR_SYNTAX, _UNSUPPORTED, _RANGE, _LIMIT, _NOMEM with file
 * and line filled in.
 */
int orl_bsdf_load_xml(const char *name, const char *xml, size_t size, struct orl_bsdf **ret_bsdf,
                      struct orl_error *err);
struct orl_bsdf *orl_bsdf_ref(struct orl_bsdf *bsdf);
void orl_bsdf_unref(struct orl_bsdf *bsdf); /* NULL is allowed */

/* f(in, out) in 1/sr. Zero outside the data. Total: includes the diffuse part. */
struct orl_rgb orl_bsdf_eval(const struct orl_bsdf *bsdf, struct orl_vec3 in, struct orl_vec3 out);

/* The constant (Lambertian) part of f for in's side: reflected back, or transmitted. 1/sr. */
struct orl_rgb orl_bsdf_diffuse(const struct orl_bsdf *bsdf, bool in_front, bool transmitted);

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
 * luma of f(in,out) |cos in|. Weights and pdf as above with |cos in|. For reciprocal data it is
 * orl_bsdf_sample(out); for data that is not, it stays consistent with orl_bsdf_eval(in, out).
 */
bool orl_bsdf_sample_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                             enum orl_bsdf_side sides, const double u[3], struct orl_vec3 *ret_in,
                             struct orl_rgb *ret_weight, double *ret_pdf);

/* The pdf, per steradian, with which orl_bsdf_sample / _sample_adjoint draw a direction. */
double orl_bsdf_pdf(const struct orl_bsdf *bsdf, struct orl_vec3 in, enum orl_bsdf_side sides,
                    struct orl_vec3 out);
double orl_bsdf_pdf_adjoint(const struct orl_bsdf *bsdf, struct orl_vec3 out,
                            enum orl_bsdf_side sides, struct orl_vec3 in);

/* What a BSDF is, for upload checks and messages. */
struct orl_bsdf_info {
    char name[128];       /* of the material, from the file */
    char kind[32];        /* "TensorTree4", "Klems full", ... */
    int resolution;       /* directions per axis (trees) or per hemisphere (matrices) */
    size_t values;        /* leaf values held */
    size_t bytes;         /* memory held */
    bool has[2][2];       /* [front?][transmitted?]: in the file, rather than by reciprocity */
    double max_albedo[2]; /* largest directional R + T for light from the back, the front */
    double thickness_m;   /* 0 when not given */
    size_t clamped;       /* negative values set to zero */
};
void orl_bsdf_describe(const struct orl_bsdf *bsdf, struct orl_bsdf_info *ret_info);

#endif
