/*
 * What moves in a project, as shades of a year's document (annual_shades.h of api/).
 *
 * A shade of the document's that has a group's name and no "states" gets the project's: a state for
 * each file, by its name, the first one first. Groups that no shade names are added with their
 * states. Those stay in their first state, unless the document asks for sDA or for LEED: then
 * windows are closed to their second state by LM-83's rule. Groups of one state, and those whose
 * state "scene": {"states": ...} chooses, stay as they are.
 */
#ifndef ORL_CLIENT_PROJECT_SHADES_H
#define ORL_CLIENT_PROJECT_SHADES_H

#include <jansson.h>

#include <oriel/error.h>

/* states: a project's (honeybee/project.h); chosen: {"GROUP": "STATE"} or NULL. Tells on stderr
 * what was added. ORL_ERR_INVALID: shades or groups that are no such things; ORL_ERR_NOMEM. */
int orl_project_fill_shades(const json_t *states, const json_t *chosen, json_t *doc,
                            struct orl_error *err);

#endif
