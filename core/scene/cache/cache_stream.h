/*
 * Shared state of this folder: one traversal of a description that either writes or reads it.
 */
#ifndef ORL_SCENE_CACHE_CACHE_STREAM_H
#define ORL_SCENE_CACHE_CACHE_STREAM_H

#include "base/io/serializer.h"
#include "scene/parse/sources.h"
#include "scene/parsed_scene.h"

struct orl_scene_cache_stream {
    struct orl_serializer serializer;
    struct orl_parsed_scene *d; /* not modified when writing */
    /* Only when reading: */
    struct orl_sources sources; /* the scene's files, in the order of the description */
    struct orl_error *err;      /* errors with more detail than the stream's code */
};

/* cache_surfaces.c: surfaces, and pairs of coincident ones that face opposite ways. */
void orl_cache_surfaces(struct orl_scene_cache_stream *k, struct orl_surface **surfaces, size_t *n);
void orl_cache_opposed(struct orl_scene_cache_stream *k, struct orl_opposed_pair **opposed,
                       size_t *n);

/* cache_patterns.c: all patterns with their functions; call it after orl_cache_grids. */
void orl_cache_patterns(struct orl_scene_cache_stream *k);
/* The pattern that a material or another pattern refers to. */
void orl_cache_pattern(struct orl_scene_cache_stream *k, struct orl_pattern **slot);

/* cache_materials.c: all materials; call it after orl_cache_patterns. */
void orl_cache_materials(struct orl_scene_cache_stream *k);

/* cache_grids.c */
void orl_cache_grids(struct orl_scene_cache_stream *k);

#endif
