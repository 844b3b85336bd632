/*
 * Unsupported content of a scene: counted by kind while the rest is read, and reported all at once.
 * A scene with any of it is refused in the end.
 */
#ifndef ORL_SCENE_PARSE_REFUSALS_H
#define ORL_SCENE_PARSE_REFUSALS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>

enum { ORL_REFUSALS_MAX = 24 }; /* limit of kinds; further ones are counted together */

struct orl_refusals {
    struct orl_refusal {
        char kind[48]; /* "texfunc", "!genprism" */
        uint64_t count;
        struct orl_error first;
    } kinds[ORL_REFUSALS_MAX];
    size_t n;
    uint64_t others;
};

/* Counts one refusal; err has its place, reason and hint. */
void orl_refusals_add(struct orl_refusals *refusals, const struct orl_error *err);
/* Fills err with all refusals, at the place of the first. Returns ORL_ERR_UNSUPPORTED. */
int orl_refusals_report(const struct orl_refusals *refusals, struct orl_error *err);

#endif
