/*
 * Modifiers of a mesh's faces by a file of rules, such as "wood (Group "door") (Face [1:20]);". The
 * last rule that matches counts. Reference: the obj2rad(1) manual of Radiance.
 */
#ifndef ORL_SCENE_PARSE_MESH_MATERIAL_RULES_H
#define ORL_SCENE_PARSE_MESH_MATERIAL_RULES_H

#include "scene/parse/mesh/wavefront.h"

struct orl_material_rules;

/* Returns 0, ORL_ERR_SYNTAX with file and line, or _NOMEM. Copies the text. */
int orl_material_rules_read(const char *file, const char *text, size_t size,
                            struct orl_material_rules **ret_rules, struct orl_error *err);
void orl_material_rules_free(struct orl_material_rules *rules);

/* Returns the modifier, or NULL if the face is omitted: no rule matches, or the last match says
 * "void". */
const char *orl_material_rules_choose(const struct orl_material_rules *rules,
                                      const struct orl_wavefront_face *face);

#endif
