/*
 * What the files of this folder share: one walk through a description, to a file or from it.
 */
#ifndef ORL_SCENE_KEEP_KEEP_PARTS_H
#define ORL_SCENE_KEEP_KEEP_PARTS_H

#include "base/stream.h"
#include "scene/description.h"
#include "scene/parse/sources.h"

struct orl_scene_keeping {
    struct orl_stream stream;
    struct orl_description *d; /* only looked at, when it is written */
    /* When it is read: */
    struct orl_sources sources; /* the same files, in the same order */
    struct orl_error *err;      /* of what the stream does not know */
};

/* keep_surfaces.c: surfaces, and those that face each other in one place. */
void orl_keep_surfaces(struct orl_scene_keeping *k, struct orl_surface **surfaces, size_t *n);
void orl_keep_opposed(struct orl_scene_keeping *k, struct orl_opposed **opposed, size_t *n);

/* keep_patterns.c: all of them, with their functions; what they interpolate has been passed. */
void orl_keep_patterns(struct orl_scene_keeping *k);
/* One that a material or another pattern names. */
void orl_keep_pattern(struct orl_scene_keeping *k, struct orl_pattern **slot);

/* keep_materials.c: all of them; patterns have been passed. */
void orl_keep_materials(struct orl_scene_keeping *k);

/* keep_grids.c */
void orl_keep_grids(struct orl_scene_keeping *k);

#endif
