/*
 * A tree of random triangles, cones and balls, and a scene with several copies: by instances of an
 * octree that names its file, and by xform, which copies the surfaces.
 */
#ifndef ORL_TESTS_SUPPORT_GROVE_H
#define ORL_TESTS_SUPPORT_GROVE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/files.h>

#include "scene/parsed_scene.h"

enum { GROVE_PLACES = 20, GROVE_TRIANGLES = 200, GROVE_ROUND = 12 };

struct grove_octree {
    char data[256];
    size_t size;
};

struct grove {
    char *tree; /* tree.rad */
    struct grove_octree octree,
        pair;                /* tree.oct; pair.oct: octree of pair.rad, which has two trees */
    char *shared, *expanded; /* scenes of a floor and the copies of the tree */
};

enum grove_leaves {
    GROVE_MATT,
    GROVE_BLADES, /* some triangles transmit light diffusely */
    GROVE_GLOSSY, /* smooth, waxy leaves and rough bark */
    GROVE_VARIED, /* colours and normals by functions of position and normal */
};

/* triangles: number in the tree; rounds: number of balls and cones. Freed by grove_done. */
void grove_init(struct grove *grove, size_t triangles, size_t rounds, size_t places);
void grove_init_with(struct grove *grove, size_t triangles, size_t rounds, size_t places,
                     enum grove_leaves leaves);
void grove_done(struct grove *grove);

/* Reads one of the scenes, or a text that names tree.rad, tree.oct, pair.oct, or once.rad, which
 * has an instance of tree.oct. Fails the test on error. */
struct orl_parsed_scene grove_read(const struct grove *grove, const char *scene);

/* Writes shared.rad and expanded.rad, tree.rad and tree.oct into a folder. */
void grove_write(const struct grove *grove, const char *folder);

#endif
