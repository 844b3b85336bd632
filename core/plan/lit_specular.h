/*
 * Finds mirrors, lenses and lobes that a sun or lamp lights, and that may therefore make caustics.
 * A small mirror that focuses the sun is easily missed by random light. So every facet of such a
 * material is tested from an even set of points on each of its sides, by shadow rays to all suns
 * and lamps, through panes. Rays from the windows along the suns find sun patches that are small
 * relative to the facet. Suns in flat outdoor mirrors are searched from the windows, by their
 * virtual images.
 *
 * In sealed scenes surfaces lit outdoors make no caustics indoors, except for those images, and for
 * panes that are lit from outside and scatter light in.
 *
 * The result depends on the scene alone. The number of rays is bounded and shared among the facets.
 * If facets and lights are too many, all such surfaces count as lit.
 */
#ifndef ORL_PLAN_LIT_SPECULAR_H
#define ORL_PLAN_LIT_SPECULAR_H

#include "plan/survey.h"

enum orl_lit_specular_kind {
    ORL_LIT_FLAT,   /* flat mirrors and panes */
    ORL_LIT_CURVED, /* curved mirrors, and dielectrics: surfaces that may focus */
    ORL_LIT_LOBE,   /* BSDFs, rough metal and plastic, trans */
    ORL_LIT_KINDS
};

struct orl_lit_specular_class {
    size_t facets;  /* number of facets of that kind */
    bool lit;       /* true: at least one is lit, inside, by a sun or lamp */
    uint32_t facet; /* first facet found lit */
    double share;   /* share of light that the strongest of them sends on */
};

struct orl_lit_specular {
    struct orl_lit_specular_class classes[ORL_LIT_KINDS];
    size_t rays; /* upper bound on the rays cast */
    size_t lights;
};

void orl_lit_specular_find(const struct orl_plan_survey *survey, struct orl_lit_specular *ret_lit);

#endif
