/*
 * Adds a project's dynamic parts as shades to a year's document (annual_shades.h of api/).
 *
 * If a shade of the document has a group's name and no "states", it gets the project's: a state
 * per file, with its name, in the same order. Groups that no shade names are added with their
 * states. They stay in their first state, unless the document asks for sDA or LEED. In that case
 * windows are closed to their second state by LM-83's rule. Groups of one state, and those with a
 * state chosen by "scene": {"states": ...}, are unchanged.
 */
#ifndef ORL_CLIENT_INPUT_PROJECT_SHADES_H
#define ORL_CLIENT_INPUT_PROJECT_SHADES_H

#include <jansson.h>

#include <oriel/base/error.h>

/* Adds the shades and lists them on stderr. states: a project's (project/project.h). chosen:
 * {"GROUP": "STATE"} or NULL. Errors: ORL_ERR_INVALID if shades or groups have a wrong type;
 * ORL_ERR_NOMEM. */
int orl_project_fill_shades(const json_t *states, const json_t *chosen, json_t *doc,
                            struct orl_error *err);

#endif
