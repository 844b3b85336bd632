/*
 * A material met by light, and the proofs that go for all kinds of it.
 *
 * A draw's weight is f |cos| / pdf, so that the mean weight of draws that fall into a part of the
 * sphere is the integral of f |cos| over that part, whatever the pdf; and the share of draws that
 * fall there is the integral of the pdf. Both are compared, bin by bin, with quadratures; the sum
 * of squared deviations over their variances is chi-square. Bounds are at 99.99 % (Wilson and
 * Hilferty, z = 3.72). Everything here fails the running test where it does not hold.
 */
#ifndef ORL_TESTS_SUBJECT_H
#define ORL_TESTS_SUBJECT_H

#include "scene/material/scatter.h"

/* The number of draws of each check: 50 000, or 200 000 in the long suite. Bounds follow from it.
 */
int subject_draws(void);

/* A material met from its front, in a tilted frame: nothing may depend on axes. */
struct subject {
    struct orl_description description;
    const struct orl_material *material; /* m */
    struct orl_hit hit;
    struct orl_frame frame;
};

/* text defines the material m; resource is a file it mentions, or NULL. */
struct subject subject_of(const char *text, const char *resource, const char *resource_text);
void subject_done(struct subject *s);

/* From the normal, in the subject's frame; beyond 90 degrees it is behind. */
struct orl_vec3 subject_direction(const struct subject *s, double theta_deg, double phi_deg);

/* Mean weights of draws by what became of them. */
struct tally {
    struct orl_rgb straight, mirror, diffuse, glossy, refracted;
    double squares; /* of the luma of weights */
    double most;    /* channel of a weight */
};
struct tally subject_draw(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, enum orl_lobes lobes, uint64_t seed);

/*
 * Draws of lobes against orl_scatter_eval_lobes, in weight and in sum. The midpoint rule may be off
 * by `slack` of a bin where the lobe is sharp or has steps; that is added to the deviation allowed.
 * Returns the quadrature's sum: the albedo.
 */
double subject_check_lobe(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, double slack, uint64_t seed);

/* How draws fall against orl_scatter_pdf; lobes and slack as above, two-sided where it is 0. */
void subject_check_pdf(const struct subject *s, struct orl_vec3 from, enum orl_transport transport,
                       enum orl_lobes lobes, double slack, uint64_t seed);

/* f(a, b) = f(b, a) for directions all around, finite and not negative. */
void subject_check_reciprocity(const struct subject *s, uint64_t seed);

#endif
