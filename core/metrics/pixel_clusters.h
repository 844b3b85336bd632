/*
 * Groups pixels by distance: any two pixels of a group are connected by steps of at most some
 * angle, and no two groups are.
 *
 * Neighbours in the picture are joined first. After that only pixels at the edges of groups can
 * connect groups. They are sorted into spatial cubes of the unit sphere, so small that all pixels
 * within one are close. Cubes within reach of each other are searched for a close pair unless they
 * already belong to one group. The cost is that of sorting the edge pixels and of testing pairs in
 * separate cubes, with a bounded number of cubes each: in practice linear.
 */
#ifndef ORL_METRICS_PIXEL_CLUSTERS_H
#define ORL_METRICS_PIXEL_CLUSTERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "metrics/view_field.h"

/*
 * Groups `count` pixels, given in ascending order. ret_group: group of each, from 0 on, in the
 * order of first pixels; ret_groups: number of groups. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_pixels_cluster(const struct orl_view_field *field, const uint32_t *pixels, size_t count,
                       double angle_rad, uint32_t *ret_group, uint32_t *ret_groups);

#endif
