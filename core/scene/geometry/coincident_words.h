/*
 * What is said of surfaces in one place: the first few pairs of every kind by name and line, the
 * others by their number.
 */
#ifndef ORL_SCENE_GEOMETRY_COINCIDENT_WORDS_H
#define ORL_SCENE_GEOMETRY_COINCIDENT_WORDS_H

#include "scene/description.h"

enum orl_coincidence {
    ORL_COINCIDENCE_SETTLED, /* the second is met, from either side */
    ORL_COINCIDENCE_OPPOSED, /* each from its front */
    ORL_COINCIDENCE_OPEN,    /* either may be met */
    ORL_COINCIDENCE_ALIKE,   /* either may be met: they are of one material */
    ORL_COINCIDENCE_PANES,   /* two panes, apart by less than can be told: light passes one alone */
    ORL_COINCIDENCES
};

/* Zeroed is ready. */
struct orl_coincidence_words {
    double tolerance; /* what lies closer is in one place */
    uint64_t told[ORL_COINCIDENCES];
    char opposed[2][200]; /* the first two */
};

/* Returns true if both are panes that rays of Radiance would pass one after the other. */
bool orl_coincidence_is_double_pane(const struct orl_description *description,
                                    const struct orl_surface *first,
                                    const struct orl_surface *second);

/* Adds a warning of two surfaces. kind is ORL_COINCIDENCE_PANES for double panes. wholly: the first
 * surface lies on the second with all of its area. */
void orl_coincidence_tell(struct orl_coincidence_words *words, struct orl_description *description,
                          enum orl_coincidence kind, const struct orl_surface *first,
                          const struct orl_surface *second, bool wholly);
/* How many more there were. */
void orl_coincidence_end(struct orl_coincidence_words *words, struct orl_description *description);

#endif
