/*
 * Overrides of the materials of surfaces, for the states of shades. Instanced surfaces that are
 * affected get a copy per place.
 *
 * Overrides are applied before geometry is built, so that everything that depends on materials,
 * such as ports, is found as if the files said so.
 */
#ifndef ORL_SCENE_MATERIAL_OVERRIDE_H
#define ORL_SCENE_MATERIAL_OVERRIDE_H

#include <oriel/base/error.h>
#include <oriel/base/sha256.h>

#include "scene/parsed_scene.h"

enum orl_override_kind { ORL_OVERRIDE_NONE, ORL_OVERRIDE_BLACK, ORL_OVERRIDE_MATERIAL };

struct orl_material_override {
    const char *of;     /* window group that the override belongs to, for messages */
    char *const *names; /* names of surfaces or of their modifiers */
    size_t n_names;
    enum orl_override_kind kind;
    const char *material; /* name of the new material; the last definition counts */
    /* files whose surfaces also belong to it, among the files of the scene */
    size_t first_file, n_files;
};

/* orl_material.part of windows in no override. */
#define ORL_WINDOW_GROUP_NONE UINT32_MAX

/* All pointers are borrowed. */
struct orl_material_overrides {
    const struct orl_material_override *at;
    size_t count;
    /*
     * Gives the surfaces of a override and of its files copies of their materials, whose `part` is
     * the override's number, from 1. Once ports are found, windows in no override have
     * ORL_WINDOW_GROUP_NONE. This separates the light by window group.
     */
    bool by_window_group;
};

/* n_names: number of files that the scene was read from. Returns 0 or: ORL_ERR_NOT_FOUND (a name
 * that no surface or no material has); ORL_ERR_INVALID (a surface in two overrides); ORL_ERR_RANGE
 * (a BSDF that does not fit); ORL_ERR_LIMIT (too many surfaces after instances are expanded) or
 * ORL_ERR_NOMEM. */
int orl_material_overrides_apply(const struct orl_material_overrides *material_overrides,
                                 size_t n_names, struct orl_parsed_scene *parsed_scene,
                                 struct orl_error *err);

/* Appends a copy of a material with that part. Returns 0 or ORL_ERR_NOMEM. */
int orl_material_add_group_copy(struct orl_parsed_scene *parsed_scene, uint32_t material,
                                uint32_t window_group, uint32_t *ret_index);

/* Hashes the overrides: equal ones make equal descriptions equal. Hashes nothing if there are none.
 */
void orl_material_overrides_digest(const struct orl_material_overrides *material_overrides,
                                   struct orl_sha256 *hash);

#endif
