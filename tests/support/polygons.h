/*
 * Scenes of many polygons, as text: storeys of bumpy ground, a decimetre a cell, half of them
 * parallelograms and half triangles, of six materials. Neighbours share corners to the digit, as in
 * what modelling programs write; or each polygon stands apart, and shares none.
 */
#ifndef ORL_TESTS_SUPPORT_POLYGONS_H
#define ORL_TESTS_SUPPORT_POLYGONS_H

#include <stdbool.h>
#include <stddef.h>

/* The materials; to be read before any of the polygons. */
extern const char polygons_materials[];

/* The polygons from first on; free() it. */
char *polygons_text(size_t first, size_t count, bool apart, size_t *ret_size);

/* What this process has in memory now, once the allocator has let go of what is free. */
size_t polygons_resident_bytes(void);

#endif
