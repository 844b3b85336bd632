/*
 * Overrides of the materials of surfaces, for the states of shades. Instanced surfaces that are
 * affected get a copy per place.
 *
 * Overrides are applied before geometry is built, so that everything that depends on materials,
 * such as ports, is found as if the files said so.
 */
#ifndef ORL_SCENE_SWAP_H
#define ORL_SCENE_SWAP_H

#include <oriel/error.h>
#include <oriel/sha256.h>

#include "scene/description.h"

enum orl_swap_kind { ORL_SWAP_NOTHING, ORL_SWAP_FOR_BLACK, ORL_SWAP_FOR_MATERIAL };

struct orl_swap {
    const char *of;     /* window group that the swap belongs to, for messages */
    char *const *names; /* names of surfaces or of their modifiers */
    size_t n_names;
    enum orl_swap_kind kind;
    const char *material; /* name of the new material; the last definition counts */
    /* files whose surfaces also belong to it, among the files of the scene */
    size_t first_file, n_files;
};

/* orl_material.part of windows in no swap. */
#define ORL_PART_OF_NONE UINT32_MAX

/* All pointers are borrowed. */
struct orl_swaps {
    const struct orl_swap *at;
    size_t count;
    /*
     * Gives the surfaces of a swap and of its files copies of their materials, whose `part` is the
     * swap's number, from 1. Once ports are found, windows in no swap have ORL_PART_OF_NONE. This
     * separates the light by window group.
     */
    bool parted;
};

/* n_names: number of files that the scene was read from. Returns 0 or: ORL_ERR_NOT_FOUND (a name
 * that no surface or no material has); ORL_ERR_INVALID (a surface in two swaps); ORL_ERR_RANGE (a
 * BSDF that does not fit); ORL_ERR_LIMIT (too many surfaces after instances are expanded) or
 * ORL_ERR_NOMEM. */
int orl_swaps_apply(const struct orl_swaps *swaps, size_t n_names,
                    struct orl_description *description, struct orl_error *err);

/* Appends a copy of a material with that part. Returns 0 or ORL_ERR_NOMEM. */
int orl_material_part(struct orl_description *description, uint32_t material, uint32_t part,
                      uint32_t *ret_index);

/* Hashes the swaps: equal ones make equal descriptions equal. Hashes nothing if there are none. */
void orl_swaps_digest(const struct orl_swaps *swaps, struct orl_sha256 *hash);

#endif
