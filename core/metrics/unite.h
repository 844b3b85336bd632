/*
 * Pixels put together where they lie close: groups such that between any two pixels of one there is
 * a way by steps of at most some angle, and none between groups.
 *
 * Neighbours in the picture are joined first; after that only pixels at the edges of what is joined
 * can bring groups together. They are sorted into cubes of the sphere's space so small that what
 * shares one is close anyway; cubes within reach of each other are searched for a pair that is
 * close, unless they are of one group already. Work is that of sorting the edges' pixels and of the
 * pairs in cubes that stay apart, a bounded number of cubes each: in practice linear.
 */
#ifndef ORL_METRICS_UNITE_H
#define ORL_METRICS_UNITE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "metrics/field.h"

/*
 * pixels: count of them, ascending. ret_group: of each, from 0 on in the order of first pixels;
 * ret_groups: how many there are. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_unite(const struct orl_field *field, const uint32_t *pixels, size_t count, double angle_rad,
              uint32_t *ret_group, uint32_t *ret_groups);

#endif
