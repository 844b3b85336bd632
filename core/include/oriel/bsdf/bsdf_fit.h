/*
 * Fits a BSDF to goniophotometer measurements. Input: scattered values for some incident
 * directions, each at its own outgoing directions. Output: values for every pair of directions, as
 * XML.
 *
 * Files. There are two formats, recognised by the first line that is neither empty nor a remark.
 * - pab-opto: header lines that begin with #, then rows "theta phi value" in degrees; one incident
 *   direction per file. The header entries that are read are `#format: theta phi DSF` (or BSDF,
 *   BRDF, BTDF; a DSF is a BSDF times the cosine of the outgoing angle), `#intheta`, `#inphi` or
 *   `#incident_angle theta phi`, `#upphi` (the azimuth that is up; 0), `#sample_name "..."` and
 *   `#colorimetry:` CIE-Y (one value per row) or CIE-XYZ (three, of which Y is used).
 * - CSV: `#` lines are remarks. The first other line names the columns theta_in, phi_in, theta_out,
 *   phi_out (degrees) and bsdf or dsf, in any order, with up (degrees) where it is not 90. Columns
 *   are separated by commas, semicolons or tabs. Any number of incident directions.
 *
 * Angles are the same in both formats: theta from the normal of the front, which is the inside, so
 * that theta above 90 is on the back; phi counter-clockwise seen from the front. Both directions
 * point away from the sample: theta_in = 30, theta_out = 150 is light from the front that is
 * transmitted.
 *
 * Method. Each incident direction and outgoing side gets an interpolant by Gaussian radial basis
 * functions, whose radii follow the density of rows (bsdf/fit/scan/scan_light.h). Between incident
 * directions its mass is transported (Bonneel et al. 2011; Ward, Kurt and Bonneel 2014). Peaks,
 * broad scattering and the constant part are transported separately (bsdf/fit/scan/scan_light.h,
 * bsdf/fit/transport/transport.h). Where nothing was measured:
 * - Towards grazing angles and in gaps of a scan the nearest values continue.
 * - Normal incidence is interpolated between a direction and its mirror image.
 * - Beyond the last incident direction the scattering keeps its shape, rotated with the straight
 *   direction, and keeps the last total.
 *
 * Components without any row are left out of the XML.
 *
 * Errors. Each incident direction that has others around it is left out once and predicted from
 * them. The errors of its total and of its distribution are reported for it and for the whole.
 *
 * The same request gives the same bytes for any number of threads.
 */
#ifndef ORIEL_BSDF_BSDF_FIT_H
#define ORIEL_BSDF_BSDF_FIT_H

#include <oriel/bsdf/bsdf_make.h>

enum orl_bsdf_fit_symmetry {
    ORL_BSDF_FIT_AUTO, /* chosen by the azimuths of incident directions: one, a quarter, a half, or
                          all */
    ORL_BSDF_FIT_ISOTROPIC,
    ORL_BSDF_FIT_QUADRILATERAL,
    ORL_BSDF_FIT_LEFT_RIGHT, /* mirrored in x: bilateral, measured from the right or left */
    ORL_BSDF_FIT_UP_DOWN,    /* mirrored in y: bilateral, measured from above or below */
    ORL_BSDF_FIT_HALF_TURN,  /* symmetric under rotation by 180 degrees, not mirrored */
    ORL_BSDF_FIT_ASYMMETRIC,
    ORL_BSDF_FIT_SYMMETRIES,
};

/* Returns "auto" and so on; NULL for an invalid value. */
const char *orl_bsdf_fit_symmetry_name(enum orl_bsdf_fit_symmetry symmetry);

/* Content of measurement files. */
struct orl_bsdf_measurements {
    /* Directions: incident ones, counted for each side and each outgoing side. */
    size_t rows, directions;
    char sample[128]; /* sample name in the files, or "" */
};

/* Returns true if the first line that is neither empty nor a remark belongs to one of the formats,
 * and not to a scene. */
bool orl_bsdf_is_measured(const char *text, size_t size);

/* Reads all files. Errors are those of orl_bsdf_fit for unreadable files. */
int orl_bsdf_measurements_check(const char *const *files, size_t count,
                                const struct orl_files *provider, struct orl_bsdf_measurements *ret,
                                struct orl_error *err);

struct orl_bsdf_fit_request {
    char **files; /* measurement files; owned */
    size_t n_files;
    char *name; /* material name; NULL: that of the data or of the first file. Owned */
    bool has_basis;
    /* Used if has_basis; default: a tree of rank 3 if isotropic, else of rank 4. */
    enum orl_bsdf_basis basis;
    enum orl_bsdf_fit_symmetry symmetry;
    uint32_t resolution; /* trees only: cells per side, a power of two from 4 to 128 */
    double cull;         /* trees only: cells within this share of their mean are merged */
    bool reversed;       /* true: theta is measured from the outside normal */
    bool keep_outliers;
    double grazing_deg; /* rows whose outgoing direction is within this angle of the surface are
                           left out; 0: none */
};

/* Sets defaults: trees of 64 cells per side, a cull of 0.02. */
void orl_bsdf_fit_request_init(struct orl_bsdf_fit_request *request);
void orl_bsdf_fit_request_done(struct orl_bsdf_fit_request *request);

/* Checks a request without its files. Returns 0, ORL_ERR_INVALID or ORL_ERR_RANGE. */
int orl_bsdf_fit_validate(const struct orl_bsdf_fit_request *request, struct orl_error *err);

/* Row that was left out as an outlier. */
struct orl_bsdf_outlier {
    uint32_t file; /* index in the request's files */
    uint32_t line;
    double value, around; /* 1/sr: the measured value, and the median of its neighbours */
};
enum { ORL_BSDF_FIT_MAX_OUTLIERS = 32 };

/* Scan: one incident direction and one outgoing side. Angles are as in the files, with +y up; theta
 * from the normal of the side that the light comes from, or leaves by. */
struct orl_bsdf_fit_scan {
    bool front, transmitted; /* light from the front; light leaves on the other side */
    double theta_deg, phi_deg;
    size_t rows, outliers, centers;
    double covered; /* share of the outgoing directions, weighted by their cosine, that have rows
                       nearby */
    /* Distance from the straight or mirror direction to the nearest row, if that is a gap in which
     * a peak may be hidden; else 0. */
    double hidden_deg;
    double noise;       /* standard deviation of a row in the dark part, 1/sr */
    double total;       /* reflected or transmitted share of the light */
    double total_error; /* standard error of total, due to noise of rows, to sparse rows, and to the
                           unmeasured range between the last rows and the surface */
    double peak, peak_theta_deg, peak_phi_deg; /* largest value, 1/sr, and its direction */
    bool left_out;    /* true: it was also predicted from the others; sets the next two */
    double predicted; /* predicted total */
    double misplaced; /* share of its light that the prediction sends more than 5 degrees off */
};

struct orl_bsdf_fit_result {
    char *xml; /* owned, NUL-terminated */
    size_t xml_size;
    enum orl_bsdf_basis basis;
    enum orl_bsdf_fit_symmetry symmetry;
    size_t rows;
    size_t n_scans;
    struct orl_bsdf_fit_scan *scans; /* owned; by component, then by direction */
    bool has[2][2];                  /* [from the front?][transmitted?], as for the next two */
    /* For perfectly diffuse light. The error combines leave-one-out errors and the unknown total
     * beyond the last direction. */
    struct orl_bsdf_share diffuse[2][2];
    double misplaced[2][2]; /* mean over the scans left out; negative: none could be left out */
    double theta_most_deg[2][2]; /* largest measured theta; incidence beyond it is extrapolated */
    size_t n_outliers;           /* number of all outliers; `outliers` lists the first ones */
    struct orl_bsdf_outlier outliers[ORL_BSDF_FIT_MAX_OUTLIERS];
    bool color_left_out; /* true: CIE X and Z were present, but are not used */
    char sample[128];    /* sample name in the files, or "" */
};

/*
 * Fits. Returns 0 and a result that the caller frees by orl_bsdf_fit_result_done. Otherwise returns
 * ORL_ERR_SYNTAX, _RANGE, _LIMIT with file and line, ORL_ERR_NOT_FOUND, ORL_ERR_INVALID (rows that
 * do not define a BSDF, or that contradict the symmetry), ORL_ERR_NOMEM, ORL_ERR_CANCELLED.
 */
int orl_bsdf_fit(const struct orl_bsdf_fit_request *request, const struct orl_bsdf_make_env *env,
                 struct orl_bsdf_fit_result *ret_result, struct orl_error *err);
void orl_bsdf_fit_result_done(struct orl_bsdf_fit_result *result);

#endif
