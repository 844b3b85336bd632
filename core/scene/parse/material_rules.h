/*
 * Which modifier a face of a mesh has, by a file of rules: "wood (Group "door") (Face [1:20]);",
 * the last that holds. Reference: the obj2rad(1) manual of Radiance.
 */
#ifndef ORL_SCENE_PARSE_MATERIAL_RULES_H
#define ORL_SCENE_PARSE_MATERIAL_RULES_H

#include "scene/parse/wavefront.h"

struct orl_material_rules;

/* ORL_ERR_SYNTAX with file and line, or _NOMEM. Text is copied. */
int orl_material_rules_read(const char *file, const char *text, size_t size,
                            struct orl_material_rules **ret_rules, struct orl_error *err);
void orl_material_rules_free(struct orl_material_rules *rules);

/* NULL: the face is left out, since no rule holds or the last that does says "void". */
const char *orl_material_rules_choose(const struct orl_material_rules *rules,
                                      const struct orl_wavefront_face *face);

#endif
