/*
 * Samples whose scattering is known in closed form, and simulated goniophotometer measurements:
 * some thousands of directions, dense around peaks, with noise and gaps, in pab-opto's text format.
 *
 * Directions are in the hemisphere above the surface, on either side
 * (core/bsdf/fit/measurements/measurements.h).
 */
#ifndef ORL_TESTS_SUPPORT_SCATTERERS_H
#define ORL_TESTS_SUPPORT_SCATTERERS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <oriel/base/vec.h>

enum scatterer {
    SCATTERER_LAMBERT,
    SCATTERER_WARD,        /* isotropic Ward, roughness 0.15, on a diffuse ground */
    SCATTERER_ANISOTROPIC, /* anisotropic Ward, 0.1 in x and 0.25 in y */
    SCATTERER_SLAB, /* transmission of a dielectric slab, measured by an instrument of 0.5 degrees
                     */
    SCATTERER_CROSSING, /* two lobes of 4 degrees that cross at 30 degrees of incidence */
    SCATTERER_PEAK,     /* a specular peak of 0.3 degrees, on a diffuse ground */
    SCATTERERS
};

struct scatterer_kind {
    const char *name;
    bool transmits, isotropic;
};
extern const struct scatterer_kind scatterers[SCATTERERS];

/* Returns the BSDF value, 1/sr. */
double scatterer_value(enum scatterer which, struct orl_vec3 in, struct orl_vec3 out);
/* Returns the albedo, by quadrature to a relative error of 1e-4. */
double scatterer_albedo(enum scatterer which, struct orl_vec3 in);
/* Returns the number of peaks, at most two, and their directions, for light from `in`. */
int scatterer_peaks(enum scatterer which, struct orl_vec3 in, struct orl_vec3 ret_peaks[2]);

struct scatterer_scan {
    double theta_deg, phi_deg;
    unsigned rows;
    double noise; /* standard deviation of a value, as a share of the value, and of the diffuse
                     ground */
    bool gap;     /* true: no reflected directions within 4 degrees of the incoming light */
    uint64_t seed;
};
/* Writes a file in pab-opto's format. */
void scatterer_write(FILE *out, enum scatterer which, const struct scatterer_scan *scan);

struct orl_vec3 scatterer_direction(double theta_deg, double phi_deg);

#endif
