/*
 * Surfaces of a scene with another material than its files give them: shades in a state of theirs.
 * Where these are of what is kept once for several places, each place has its own from then on.
 *
 * Done to a description before geometry is built of it, so that whatever depends on materials,
 * ports among it, is found as if the files said so.
 */
#ifndef ORL_SCENE_SWAP_H
#define ORL_SCENE_SWAP_H

#include <oriel/error.h>
#include <oriel/sha256.h>

#include "scene/description.h"

enum orl_swap_kind { ORL_SWAP_NOTHING, ORL_SWAP_FOR_BLACK, ORL_SWAP_FOR_MATERIAL };

struct orl_swap {
    const char *of;     /* whose windows they are, for messages */
    char *const *names; /* of surfaces, or of their modifiers */
    size_t n_names;
    enum orl_swap_kind kind;
    const char *material;       /* the last of that name */
    size_t first_file, n_files; /* that belong to it, too, of those the scene is read from */
};

/* Windows that are in no swap. */
#define ORL_PART_OF_NONE UINT32_MAX

/* All borrowed. */
struct orl_swaps {
    const struct orl_swap *at;
    size_t count;
    /*
     * Surfaces of a swap and of its files get materials of their own, whose part is the swap's
     * number, from 1; once ports are found, those of no swap have ORL_PART_OF_NONE: light can be
     * told apart by the windows that it comes through.
     */
    bool parted;
};

/* n_names: of the files that the scene was read from. Returns 0, ORL_ERR_NOT_FOUND (a name that no
 * surface has, or no material), ORL_ERR_INVALID (a surface in two swaps), ORL_ERR_RANGE (a BSDF
 * that does not fit), ORL_ERR_LIMIT (too many surfaces, each place having its own) or
 * ORL_ERR_NOMEM. */
int orl_swaps_apply(const struct orl_swaps *swaps, size_t n_names,
                    struct orl_description *description, struct orl_error *err);

/* A copy of a material, of that part. Returns 0 or ORL_ERR_NOMEM. */
int orl_material_part(struct orl_description *description, uint32_t material, uint32_t part,
                      uint32_t *ret_index);

/* By equal ones equal descriptions become equal; nothing for none. */
void orl_swaps_digest(const struct orl_swaps *swaps, struct orl_sha256 *hash);

#endif
