/*
 * Samples whose scattering is known in closed form, and what a goniophotometer would measure of
 * them: some thousands of places, dense around peaks, with noise and gaps, as pab-opto's text.
 *
 * Directions are of the hemisphere above the surface, whichever side they are on (core/fit/rows.h).
 */
#ifndef ORL_TESTS_SUPPORT_SCATTERERS_H
#define ORL_TESTS_SUPPORT_SCATTERERS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <oriel/vec.h>

enum scatterer {
    SCATTERER_LAMBERT,
    SCATTERER_WARD,        /* isotropic, roughness 0.15, on a diffuse ground */
    SCATTERER_ANISOTROPIC, /* Ward's, 0.1 in x and 0.25 in y */
    SCATTERER_SLAB,        /* a dielectric slab seen by an instrument of 0.5 degrees: transmitted */
    SCATTERER_CROSSING,    /* two lobes of 4 degrees that cross at 30 degrees of incidence */
    SCATTERER_PEAK,        /* a specular peak of 0.3 degrees, on a diffuse ground */
    SCATTERERS
};

struct scatterer_kind {
    const char *name;
    bool transmits, isotropic;
};
extern const struct scatterer_kind scatterers[SCATTERERS];

/* 1/sr. */
double scatterer_value(enum scatterer which, struct orl_vec3 in, struct orl_vec3 out);
/* All of the light that is sent out, by quadrature to 1e-4 of it. */
double scatterer_albedo(enum scatterer which, struct orl_vec3 in);
/* Directions of its peaks for light from there; how many: at most two. */
int scatterer_peaks(enum scatterer which, struct orl_vec3 in, struct orl_vec3 ret_peaks[2]);

struct scatterer_scan {
    double theta_deg, phi_deg;
    unsigned rows;
    double noise; /* standard deviation of a value, as a share of it, and of the diffuse ground */
    bool gap;     /* none within 4 degrees of where light comes from, of what is reflected */
    uint64_t seed;
};
/* A file of pab-opto's. */
void scatterer_write(FILE *out, enum scatterer which, const struct scatterer_scan *scan);

struct orl_vec3 scatterer_direction(double theta_deg, double phi_deg);

#endif
