/*
 * Mirrors, lenses and lobes that a sun or lamp lights, and so may make caustics. A small mirror
 * that focuses the sun is easily missed by light that flies at random: so every facet of such a
 * material is looked at, from an even set of points on each of its sides, by shadow rays to all
 * suns and lamps, through panes; and from the windows along the suns, for patches of sun that are
 * small beside the facet they fall on. Suns in flat mirrors outside are looked for from the
 * windows, by their images.
 *
 * In sealed scenes what is lit outside makes no caustics inside, but for those images, and for
 * panes that are lit from outside and scatter light in.
 *
 * The answer depends on the scene alone. Rays are bounded in number; facets share them, and where
 * facets and lights are too many for that, all that is there counts as lit.
 */
#ifndef ORL_PLAN_LIT_SPECULAR_H
#define ORL_PLAN_LIT_SPECULAR_H

#include "plan/survey.h"

enum orl_lit_kind {
    ORL_LIT_FLAT,   /* flat mirrors and panes */
    ORL_LIT_CURVED, /* curved ones, and dielectrics: whatever may focus */
    ORL_LIT_LOBE,   /* BSDFs, rough metal and plastic, trans */
    ORL_LIT_KINDS
};

struct orl_lit_class {
    size_t facets;  /* of that kind */
    bool lit;       /* one at least, inside, by a sun or lamp */
    uint32_t facet; /* the first found lit */
    double share;   /* of light, that the strongest of them sends on */
};

struct orl_lit {
    struct orl_lit_class classes[ORL_LIT_KINDS];
    size_t rays; /* it took at most */
    size_t lights;
};

void orl_lit_look(const struct orl_survey *survey, struct orl_lit *ret_lit);

#endif
