/*
 * Names, files and lines of surfaces, kept for messages after geometry is built. They are packed,
 * because there may be millions: a query reads the labels of a few surfaces before it.
 */
#ifndef ORL_SCENE_SURFACE_LABELS_H
#define ORL_SCENE_SURFACE_LABELS_H

#include "scene/parsed_scene.h"

struct orl_surface_label {
    const char *name;
    const char *file; /* points into orl_parsed_scene.files */
    int line;
};

/* Copies the names. NULL: out of memory. */
struct orl_surface_labels *orl_surface_labels_new(const struct orl_surface *surfaces, size_t n);
void orl_surface_labels_free(struct orl_surface_labels *labels); /* NULL is allowed */

/* The label stays valid as long as the labels do. */
struct orl_surface_label orl_surface_label_of(const struct orl_surface_labels *labels,
                                              size_t surface);

uint64_t orl_surface_labels_bytes(const struct orl_surface_labels *labels); /* NULL: 0 */

#endif
