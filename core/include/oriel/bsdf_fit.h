/*
 * A BSDF from what a goniophotometer measured: scattered values for some incident directions, each
 * at its own directions out, become values for every pair of directions, as XML.
 *
 * Files. Two formats, told apart by their first line that says anything.
 *   pab-opto: lines of a header that begin with #, then rows "theta phi value" in degrees; one
 *     incident direction a file. Of the header are read `#format: theta phi DSF` (or BSDF, BRDF,
 *     BTDF; a DSF is a BSDF times the cosine out), `#intheta`, `#inphi` or `#incident_angle theta
 *     phi`, `#upphi` (the azimuth that is up; 0), `#sample_name "..."` and `#colorimetry:` CIE-Y
 *     (one value a row) or CIE-XYZ (three, of which Y is taken).
 *   CSV: `#` lines are remarks; the first other line names the columns theta_in, phi_in, theta_out,
 *     phi_out (degrees) and bsdf or dsf, in any order, with up (degrees) where it is not 90;
 * columns by commas, semicolons or tabs. Any number of incident directions. Angles are those of
 * both formats: theta from the normal of the front, which is the inside; so theta above 90 is on
 * the back. phi is counter-clockwise seen from the front. Both directions point away from the
 * sample: theta_in = 30, theta_out = 150 is light from the front that is transmitted.
 *
 * Method. For each incident direction and side out an interpolant by Gaussian radial functions,
 * whose radii follow the density of rows (fit/knots.h); between incident directions its mass is
 * transported (Bonneel et al. 2011; Ward, Kurt and Bonneel 2014): what stands out of its
 * surroundings, what is broad, and what is the same everywhere each by itself (fit/shape.h,
 * fit/blend.h). Where nothing was measured:
 *   - towards grazing and in gaps of a scan the nearest values go on;
 *   - normal incidence is what lies between a direction and its mirror image;
 *   - beyond the last incident direction the scattering stays what it was there, turned with the
 *     straight direction, and its total is the last one's.
 * Components that no row is of are left out of the XML.
 *
 * Errors. Every incident direction that has others around it is left out once and predicted from
 * them: how far off its total and its light are is told of it, and of the whole.
 *
 * The same request gives the same bytes for any number of threads.
 */
#ifndef ORIEL_BSDF_FIT_H
#define ORIEL_BSDF_FIT_H

#include <oriel/bsdf_make.h>

enum orl_bsdf_fit_symmetry {
    ORL_BSDF_FIT_AUTO, /* by the azimuths of incident directions: one, a quarter, a half, or all */
    ORL_BSDF_FIT_ISOTROPIC,
    ORL_BSDF_FIT_QUADRILATERAL,
    ORL_BSDF_FIT_LEFT_RIGHT, /* mirrored in x: bilateral, measured from the right or left */
    ORL_BSDF_FIT_UP_DOWN,    /* mirrored in y: bilateral, measured from above or below */
    ORL_BSDF_FIT_HALF_TURN,  /* the same upside down, not mirrored */
    ORL_BSDF_FIT_ASYMMETRIC,
    ORL_BSDF_FIT_SYMMETRIES,
};

/* "auto" and so on; NULL for what is none. */
const char *orl_bsdf_fit_symmetry_name(enum orl_bsdf_fit_symmetry symmetry);

/* What files of measurements hold. */
struct orl_bsdf_measurements {
    size_t rows, directions; /* incident ones: of each side, and each side out */
    char sample[128];        /* its name as the files have it, or "" */
};

/* Whether a file's first line that says anything is of one of the formats, and of no scene. */
bool orl_bsdf_is_measured(const char *text, size_t size);

/* Reads them all: errors as of orl_bsdf_fit for files that cannot be read. */
int orl_bsdf_measurements_check(const char *const *files, size_t count,
                                const struct orl_files *provider, struct orl_bsdf_measurements *ret,
                                struct orl_error *err);

struct orl_bsdf_fit_request {
    char **files; /* of measurements; owned */
    size_t n_files;
    char *name; /* of the material; NULL: the data's or the first file's. Owned */
    bool has_basis;
    enum orl_bsdf_basis basis; /* unless told: a tree of rank 3 if isotropic, else of rank 4 */
    enum orl_bsdf_fit_symmetry symmetry;
    uint32_t resolution; /* of trees: cells a side, a power of two from 4 to 128 */
    double cull;         /* of trees: cells within this share of their mean are one */
    bool reversed;       /* theta is counted from the outside's normal instead */
    bool keep_outliers;
    double grazing_deg; /* rows out this close to the surface, or closer, are left out; 0: none */
};

/* Trees of 64 cells a side, a cull of 0.02. */
void orl_bsdf_fit_request_init(struct orl_bsdf_fit_request *request);
void orl_bsdf_fit_request_done(struct orl_bsdf_fit_request *request);

/* What can be told of a request without its files: 0, ORL_ERR_INVALID, ORL_ERR_RANGE. */
int orl_bsdf_fit_validate(const struct orl_bsdf_fit_request *request, struct orl_error *err);

/* Where a row was left out as an outlier. */
struct orl_bsdf_outlier {
    uint32_t file; /* of the request's files */
    uint32_t line;
    double value, around; /* 1/sr: as measured, and of its neighbours' median */
};
enum { ORL_BSDF_FIT_OUTLIERS_TOLD = 32 };

/* One incident direction and one side out. Angles as in the files, +y up; theta from the normal of
 * the side that the light comes from, or leaves by. */
struct orl_bsdf_fitted_scan {
    bool front, transmitted; /* light from the front; leaves on the other side */
    double theta_deg, phi_deg;
    size_t rows, outliers, knots;
    double covered; /* share of the directions out, by their cosine, that rows lie near */
    double
        hidden_deg; /* how far the nearest row is from where straight or mirrored light goes, where
                       that is a gap in what was measured, which a peak may be lost in; else 0 */
    double noise;   /* of one row where it is dark: standard deviation, 1/sr */
    double total;   /* reflected or transmitted share of the light */
    double total_error; /* standard error of it: noise of rows, rows too far apart, and what lies
                           between the last of them and the surface */
    double peak, peak_theta_deg, peak_phi_deg; /* the largest value, 1/sr, and where it is */
    bool left_out;                             /* whether it was predicted from the others; then: */
    double predicted;                          /* the total */
    double misplaced; /* share of its light that the prediction sends more than 5 degrees astray */
};

struct orl_bsdf_fitted {
    char *xml; /* owned, ends in 0 */
    size_t xml_size;
    enum orl_bsdf_basis basis;
    enum orl_bsdf_fit_symmetry symmetry;
    size_t rows;
    size_t n_scans;
    struct orl_bsdf_fitted_scan *scans; /* owned; by component, then by direction */
    bool has[2][2];                     /* [from the front?][transmitted?], as of the next two */
    struct orl_bsdf_share diffuse[2]
                                 [2]; /* of perfectly diffuse light; its error: by leaving out,
                                         and by how the total may go on beyond the last direction */
    double misplaced[2][2];           /* the mean of those left out; negative: none could be */
    double theta_most_deg[2][2];      /* beyond it incidence is extrapolated */
    size_t n_outliers;                /* all of them, of which told are: */
    struct orl_bsdf_outlier outliers[ORL_BSDF_FIT_OUTLIERS_TOLD];
    bool color_left_out; /* CIE X and Z were there */
    char sample[128];    /* its name as the files have it, or "" */
};

/*
 * Returns 0 and what the caller frees by orl_bsdf_fitted_done; or ORL_ERR_SYNTAX, _RANGE, _LIMIT
 * with file and line, ORL_ERR_NOT_FOUND, ORL_ERR_INVALID (rows that no BSDF can be made of, or that
 * the symmetry contradicts), ORL_ERR_NOMEM, ORL_ERR_CANCELLED.
 */
int orl_bsdf_fit(const struct orl_bsdf_fit_request *request, const struct orl_bsdf_make_env *env,
                 struct orl_bsdf_fitted *ret_fitted, struct orl_error *err);
void orl_bsdf_fitted_done(struct orl_bsdf_fitted *fitted);

#endif
