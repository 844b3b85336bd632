/*
 * Scenes of many polygons, as text: storeys of bumpy ground with cells of a decimetre, half of the
 * polygons parallelograms and half triangles, of six materials. Neighbours share corners to the
 * digit, as in the output of modelling programs; or each polygon is separate, and shares none.
 */
#ifndef ORL_TESTS_SUPPORT_POLYGONS_H
#define ORL_TESTS_SUPPORT_POLYGONS_H

#include <stdbool.h>
#include <stddef.h>

/* The materials; they come before the polygons. */
extern const char polygons_materials[];

/* Returns `count` polygons from number `first` on; free() it. */
char *polygons_text(size_t first, size_t count, bool apart, size_t *ret_size);

/* Returns this process's resident memory after the allocator has released free memory. */
size_t polygons_resident_bytes(void);

#endif
