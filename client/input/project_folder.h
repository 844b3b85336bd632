/*
 * Projects in place of a scene's list of files: a Honeybee model (.hbjson, or JSON of that type),
 * a folder exported by Honeybee, or a file of rad (.rif) or frads (.cfg). In a document,
 *
 *     "scene": {"project": PATH, "states": {"GROUP": "STATE"}, "sky": NAME, "files": [...]}
 *
 * adds the project's files before its own, and the project's grids and views if it has none. A
 * year also gets the dynamic parts as shades (orl_project_fill_shades). A model is translated to
 * Radiance files (honeybee/hbjson.h). All files are in a temporary folder, beside links to the
 * entries of the document's own folder.
 */
#ifndef ORL_CLIENT_INPUT_PROJECT_FOLDER_H
#define ORL_CLIENT_INPUT_PROJECT_FOLDER_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/base/error.h>

/* Returns true if path is a folder, a model, or a file of rad or frads, rather than a job
 * document. */
bool orl_is_project(const char *path);

/* A project laid out in a folder. */
struct orl_project_folder {
    char folder[4096];
    bool is_permanent; /* true if the folder is permanent, not temporary */
    char units[16];    /* a model's units of length, "Meters"; empty: the project names none */
    json_t *project;   /* owned; format of project/project.h */
};

/*
 * Opens a project. scene: {"project", "states", "sky", "files"}. beside: folder whose entries
 * are linked too, or NULL. Call orl_project_done afterwards, which removes the temporary
 * folder.
 */
int orl_project_open(const json_t *scene, const char *path, const char *beside,
                     struct orl_project_folder *ret_project_folder, struct orl_error *err);
/* Opens a model likewise, but writes its files to the folder into, where they stay. */
int orl_project_write(const json_t *scene, const char *path, const char *into,
                      struct orl_project_folder *ret_project_folder, struct orl_error *err);
void orl_project_done(struct orl_project_folder *project_folder); /* all zero is fine */

/* Adds the project's files, grids, views and shades to a job document. scene: as above, no
 * longer part of doc. */
int orl_project_fill_document(const struct orl_project_folder *project_folder, const json_t *scene,
                              json_t *doc, struct orl_error *err);

/* Lists the project's contents and the files left out on stderr. */
void orl_project_list(const json_t *project);

/*
 * Adds a project's dynamic parts as shades to a year's document (annual_members_json.h).
 *
 * If a shade of the document has a group's name and no "states", it gets the project's: a state
 * per file, with its name, in the same order. Groups that no shade names are added with their
 * states. They stay in their first state, unless the document asks for sDA or LEED. In that case
 * windows are closed to their second state by LM-83's rule. Groups of one state, and those with a
 * state chosen by "scene": {"states": ...}, are unchanged.
 */

/* Adds the shades and lists them on stderr. states: a project's (project/project.h). chosen:
 * {"GROUP": "STATE"} or NULL. Errors: ORL_ERR_INVALID if shades or groups have a wrong type;
 * ORL_ERR_NOMEM. */
int orl_project_fill_shades(const json_t *states, const json_t *chosen, json_t *doc,
                            struct orl_error *err);

#endif
