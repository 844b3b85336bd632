/*
 * A material hit by light, and the checks that apply to all kinds of materials.
 *
 * A sample's weight is f |cos| / pdf. The mean weight of samples in a part of the sphere is
 * therefore the integral of f |cos| over that part, whatever the pdf; and the share of samples in
 * it is the integral of the pdf. Both are compared, bin by bin, with quadratures; the sum of
 * squared deviations over their variances is chi-square. Bounds are at 99.99 % (Wilson and
 * Hilferty, z = 3.72). Everything here fails the running test on violation.
 */
#ifndef ORL_TESTS_SUBJECT_H
#define ORL_TESTS_SUBJECT_H

#include "scene/material/scatter.h"

/* Returns the number of samples of each check: 50 000, or 200 000 in the long suite. Bounds follow
 * from it. */
int subject_draws(void);

/* A material hit from its front, in a tilted frame, so that nothing depends on axes. */
struct subject {
    struct orl_parsed_scene parsed_scene;
    const struct orl_material *material; /* m */
    struct orl_hit hit;
    struct orl_frame frame;
};

/* text defines the material m; resource is a file that it mentions, or NULL. */
struct subject subject_of(const char *text, const char *resource, const char *resource_text);
void subject_done(struct subject *s);

/* Returns a direction by angles from the normal, in the subject's frame; beyond 90 degrees it is
 * behind. */
struct orl_vec3 subject_direction(const struct subject *s, double theta_deg, double phi_deg);

/* Mean weights of samples by event. */
struct tally {
    struct orl_rgb straight, mirror, diffuse, glossy, refracted;
    double squares; /* mean square of the luma of weights */
    double most;    /* largest channel of a weight */
};
struct tally subject_draw(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, enum orl_lobes lobes, uint64_t seed);

/*
 * Compares samples of lobes with orl_material_eval_lobes, in weight and in sum. The midpoint rule
 * may be off by `slack` of a bin where the lobe is sharp or has steps; that is added to the allowed
 * deviation. Returns the quadrature's sum: the albedo.
 */
double subject_check_lobe(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, double slack, uint64_t seed);

/* Compares the distribution of samples with orl_material_pdf; lobes and slack as above. The check
 * is two-sided if slack is 0. */
void subject_check_pdf(const struct subject *s, struct orl_vec3 from, enum orl_transport transport,
                       enum orl_lobes lobes, double slack, uint64_t seed);

/* Checks f(a, b) = f(b, a) for directions all around, finite and not negative. */
void subject_check_reciprocity(const struct subject *s, uint64_t seed);

#endif
