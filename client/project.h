/*
 * Projects: a Honeybee model (.hbjson, or JSON that says it is one), a folder as Honeybee exports
 * one, or a file of rad (.rif), in place of a scene's list of files. A document says
 *
 *     "scene": {"project": PATH, "states": {"GROUP": "STATE"}, "sky": NAME, "files": [...]}
 *
 * and gets the project's files and behind them its own, and the project's grids and views where it
 * has none; a year also what moves, as its shades (project_shades.h). For a model its Radiance
 * files are written (honeybee/hbjson.h). All of it is then found in a temporary folder, beside
 * links to what the document's own folder holds.
 */
#ifndef ORL_CLIENT_PROJECT_H
#define ORL_CLIENT_PROJECT_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/error.h>

/* A folder, a model or a file of rad, rather than a document of ours. */
bool orl_project_is_one(const char *path);

/* A project laid out in a folder of its own. */
struct orl_project_place {
    char folder[4096];
    bool stays;      /* the folder; else it is temporary */
    json_t *project; /* owned: honeybee/project.h's */
};

/*
 * scene: {"project", "states", "sky", "files"}. beside: a folder whose entries are to be found
 * there too; NULL: none. The caller ends it with orl_project_done, which removes the temporary
 * folder.
 */
int orl_project_open(const json_t *scene, const char *path, const char *beside,
                     struct orl_project_place *ret_place, struct orl_error *err);
/* The same of a model, whose files go to that folder, and stay. */
int orl_project_write(const json_t *scene, const char *path, const char *into,
                      struct orl_project_place *ret_place, struct orl_error *err);
void orl_project_done(struct orl_project_place *place); /* all zero is fine */

/* The project's files, grids, views and shades into a job document. scene: as above, no longer
 * doc's. */
int orl_project_fill(const struct orl_project_place *place, const json_t *scene, json_t *doc,
                     struct orl_error *err);

/* What there is, and what was left out, in lines on stderr. */
void orl_project_tell(const json_t *project);

#endif
