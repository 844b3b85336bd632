/*
 * Shared state of this folder: one traversal of a description that either writes or reads it.
 */
#ifndef ORL_SCENE_KEEP_KEEP_PARTS_H
#define ORL_SCENE_KEEP_KEEP_PARTS_H

#include "base/stream.h"
#include "scene/description.h"
#include "scene/parse/sources.h"

struct orl_scene_keeping {
    struct orl_stream stream;
    struct orl_description *d; /* not modified when writing */
    /* Only when reading: */
    struct orl_sources sources; /* the scene's files, in the order of the description */
    struct orl_error *err;      /* errors with more detail than the stream's code */
};

/* keep_surfaces.c: surfaces, and pairs of coincident ones that face opposite ways. */
void orl_keep_surfaces(struct orl_scene_keeping *k, struct orl_surface **surfaces, size_t *n);
void orl_keep_opposed(struct orl_scene_keeping *k, struct orl_opposed **opposed, size_t *n);

/* keep_patterns.c: all patterns with their functions; call it after orl_keep_grids. */
void orl_keep_patterns(struct orl_scene_keeping *k);
/* The pattern that a material or another pattern refers to. */
void orl_keep_pattern(struct orl_scene_keeping *k, struct orl_pattern **slot);

/* keep_materials.c: all materials; call it after orl_keep_patterns. */
void orl_keep_materials(struct orl_scene_keeping *k);

/* keep_grids.c */
void orl_keep_grids(struct orl_scene_keeping *k);

#endif
