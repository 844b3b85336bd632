/*
 * Interprets the files of a folder or zip as a project: the scene's files in reading order; sensor
 * grids, views, skies and the states of dynamic parts, by name; and the files left out, with
 * reasons.
 *
 * A project is a model folder as exported by Honeybee. It has .rad files in a folder "scene", and
 * beside it "aperture", "aperture_group", "grid", "view" or "folder.cfg", or materials (.mat) in
 * "scene". A model without faces may have only "aperture/aperture.rad" or a states.json. The scene
 * is every .mat of scene/ and aperture/, then their .rad, by name, and those of ies/, except an
 * "__NAME__.rad" that a "NAME.rad" places. Every group in a states.json adds the file of the
 * chosen or else the first state. The chosen sky of a folder sky/, or else the only one, is added
 * too. Grids are the .pts of grid/ (only those in its _info.json, if there is one), views the .vf
 * of view/.
 *
 *     {"files": ["model/aperture/aperture.mat", ...],
 *      "grids": [{"name": "room", "sensors": {"file": "model/grid/room.pts"}}],
 *      "views": [{"name": "eye", "file": "model/view/eye.vf"}],
 *      "states": {"south": {"chosen": "0_south", "of": ["0_south", "1_south"],
 *                           "files": ["model/aperture_group/south..default..0.rad", ...]}},
 *      "skies": ["noon"],
 *      "left_out": [{"file": "model/scene/envelope.blk", "why": "..."}],
 *      "warnings": ["grid 'room': ..."]}
 *
 * Warnings are the lines of the model's warnings.txt, which hbjson.h writes. The member is absent
 * if there are none.
 */
#ifndef ORL_API_PROJECT_PROJECT_H
#define ORL_API_PROJECT_PROJECT_H

#include <jansson.h>

#include <oriel/base/files.h>

/* The chosen states and sky; either may be NULL. Borrowed. */
struct orl_project_choice {
    const json_t *states; /* {"GROUP": "STATE"} */
    const char *sky;      /* name of the sky's file without folder and ending */
};

/*
 * Finds a project in a folder. names: below one folder, '/' between folders, in any order;
 * files opens them. *ret_project is a new reference, or NULL if the files are no project.
 * ORL_ERR_INVALID: a chosen group, state or sky does not exist.
 */
int orl_project_find(const char *const *names, size_t count, const struct orl_files *files,
                     const struct orl_project_choice *choice, json_t **ret_project,
                     struct orl_error *err);

#endif
