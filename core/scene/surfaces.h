/*
 * Surfaces of a parsed scene before geometry is built: expansion of instances, overrides of
 * materials, labels for messages.
 */
#ifndef ORL_SCENE_SURFACES_H
#define ORL_SCENE_SURFACES_H

#include <oriel/base/error.h>
#include <oriel/base/sha256.h>

#include "scene/parsed_scene.h"

/*
 * Surfaces that a parsed scene stores once and instances in several places (orl_prototype): their
 * count, and their expansion to one surface per place, as the files would have them.
 */

/* Returns the number of surfaces with every instance counted. */
uint64_t orl_parsed_scene_count_surfaces(const struct orl_parsed_scene *parsed_scene);

/* Returns true if a prototype's surface, stored under the name `stored`, is called `name` in that
 * placement. */
bool orl_placement_has_name(const struct orl_parsed_scene *parsed_scene,
                            const struct orl_placement *placement, const char *stored,
                            const char *name);

/* Returns the inverse transform. orl_xform_direction by it keeps unit directions unit. */
struct orl_xform orl_xform_inverse(const struct orl_xform *xform);
/* Returns the transformed unit vector of a unit direction or normal. */
struct orl_vec3 orl_xform_direction(const struct orl_xform *xform, struct orl_vec3 direction);
/* Returns the transformed normal of a surface's front; an inverted surface has its front on the
 * other side. */
struct orl_vec3 orl_xform_normal(const struct orl_xform *xform, struct orl_vec3 normal);
struct orl_quadric orl_xform_quadric(const struct orl_xform *xform,
                                     const struct orl_quadric *quadric);
enum orl_surface_kind orl_xform_kind(const struct orl_xform *xform, enum orl_surface_kind kind);

/* Returns true if something in the scene depends on where surfaces lie: it cuts them, hides them,
 * or treats them separately. Then instances must be expanded. */
bool orl_parsed_scene_must_split(const struct orl_parsed_scene *parsed_scene);

/*
 * Expands the prototypes that have fewer placements than fewer_than and have no patterns
 * (orl_prototype.has_patterns): each place gets surfaces of its own, in the order of the files.
 * ORL_ALL_PLACEMENTS expands every prototype. Returns 0, ORL_ERR_LIMIT (more surfaces than are
 * allowed) or ORL_ERR_NOMEM.
 */
#define ORL_ALL_PLACEMENTS SIZE_MAX
int orl_placements_expand(struct orl_parsed_scene *parsed_scene, size_t fewer_than,
                          struct orl_error *err);

/*
 * Overrides of the materials of surfaces, for the states of shades. Instanced surfaces that are
 * affected get a copy per place.
 *
 * Overrides are applied before geometry is built, so that everything that depends on materials,
 * such as ports, is found as if the files said so.
 */

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

/* Value of orl_material.window_group for windows in no override. */
#define ORL_WINDOW_GROUP_NONE UINT32_MAX

/* All pointers are borrowed. */
struct orl_material_overrides {
    const struct orl_material_override *at;
    size_t count;
    /*
     * Gives the surfaces of an override and of its files copies of their materials, whose
     * window_group is the override's number, from 1. Once ports are found, windows in no override
     * have ORL_WINDOW_GROUP_NONE. This separates the light by window group.
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

/* Appends a copy of a material with that window group. Returns 0 or ORL_ERR_NOMEM. */
int orl_material_add_group_copy(struct orl_parsed_scene *parsed_scene, uint32_t material,
                                uint32_t window_group, uint32_t *ret_index);

/* Hashes the overrides: equal ones make equal parsed scenes equal. Hashes nothing if there are
 * none. */
void orl_material_overrides_digest(const struct orl_material_overrides *material_overrides,
                                   struct orl_sha256 *hash);

/*
 * Names, files and lines of surfaces, for messages after geometry is built. They are packed,
 * because there may be millions: a query reads the labels of a few surfaces before it.
 */

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
