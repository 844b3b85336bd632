/*
 * Transmission of light from a narrow cone, the sun's above all: where all of it falls into a few
 * cells of a tensor tree, what each of them sends through is put into one table beforehand, and a
 * draw is a look into it instead of a descent.
 *
 * A table is an alias table (Walker 1977, made as by Vose 1991) over the leaves that the cell
 * meets, by value times size; its probabilities are the values' own to 1e-7. Light from elsewhere
 * than the cells that have tables is drawn by orl_bsdf_sample.
 *
 * Borrows the BSDF. Immutable once made; any number of threads may draw.
 */
#ifndef ORL_BSDF_INCIDENT_H
#define ORL_BSDF_INCIDENT_H

#include <oriel/bsdf.h>

struct orl_incident;

/*
 * Directions as for orl_bsdf_sample; the cone is about the unit direction in. *ret_incident is NULL
 * when there is nothing to gain: data of another kind, coloured, or too many cells. Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_incident_new(const struct orl_bsdf *bsdf, struct orl_vec3 in, double half_angle_rad,
                     struct orl_incident **ret_incident);
void orl_incident_free(struct orl_incident *incident); /* NULL is allowed */

/* As orl_bsdf_sample with ORL_BSDF_TRANSMIT; false: nothing gets through. */
bool orl_incident_sample(const struct orl_incident *incident, struct orl_vec3 in, const double u[3],
                         struct orl_vec3 *ret_out, struct orl_rgb *ret_weight);

#endif
