/*
 * Panels given as text, measured on the virtual goniophotometer in the test's process. Errors fail
 * the test.
 */
#ifndef ORL_TESTS_SUPPORT_PANELS_H
#define ORL_TESTS_SUPPORT_PANELS_H

#include <oriel/bsdf/bsdf.h>
#include <oriel/bsdf/bsdf_make.h>

struct panel {
    const char *text;
    enum orl_bsdf_basis basis;
    enum orl_bsdf_symmetry symmetry;
    bool color;
    const double *cell;  /* four numbers; NULL: the bounding box */
    uint32_t resolution; /* 0: 16 */
    double cull;         /* 0: the default */
    uint32_t paths;      /* 0: 4096 */
    double accuracy;
    uint32_t paths_most; /* 0: the default */
    uint64_t seed;       /* 0: 1 */
    uint32_t threads;    /* 0: 1 */
    bool want_errors;
};

/* Returns the result; release it with orl_bsdf_make_result_done. */
struct orl_bsdf_make_result panel_make(const struct panel *panel);
/* Measures a panel and returns the error code, without failing the test. */
int panel_try(const struct panel *panel, const atomic_bool *cancel,
              struct orl_bsdf_make_result *ret_made, struct orl_error *ret_err);
/* Reads the XML as a BSDF; release it with orl_bsdf_unref. */
struct orl_bsdf *panel_read(const struct orl_bsdf_make_result *made);

/* Fresnel reflectance of unpolarised light at one surface from index 1 to n; reflectance and
 * transmittance of a slab (or pane) of two surfaces with all inner passes, each of transmittance
 * `pass`. cosine: outside. */
double fresnel(double cosine, double n);
void slab_shares(double cosine, double n, double pass, double *ret_reflected,
                 double *ret_transmitted);

#endif
