/*
 * What the files of a folder or zip are as a project: which make the scene, and in what order;
 * sensor grids, views, skies and the states of moving parts, each by its name; and which files were
 * left out, and why.
 *
 * A project is a model folder as Honeybee exports it: one that has .rad files in a folder
 * "scene", and beside it "aperture", "aperture_group", "grid", "view" or "folder.cfg", or materials
 * (.mat) there; of a model without faces, "aperture/aperture.rad" or a states.json alone. Of it are
 * the scene: every .mat of scene/ and aperture/ first, then their .rad, in the order of their
 * names, and those of ies/, but "__NAME__.rad" beside a "NAME.rad" that places it; of every group
 * in a states.json the chosen state's file, else the first state's; and the chosen sky of a folder
 * sky/, else the only one. Grids are the .pts of grid/ (those that its _info.json names, where
 * there is one), views the .vf of view/.
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
 * Warnings are the lines of the model's warnings.txt, which hbjson.h writes; left out if there are
 * none.
 */
#ifndef ORL_API_HONEYBEE_PROJECT_H
#define ORL_API_HONEYBEE_PROJECT_H

#include <jansson.h>

#include <oriel/files.h>

/* Which of what there is; either may be NULL. Borrowed. */
struct orl_project_choice {
    const json_t *states; /* {"GROUP": "STATE"} */
    const char *sky;      /* its file's name without folder and ending */
};

/*
 * names: below one folder, '/' between folders, in any order; files opens them. *ret_project is a
 * new reference; NULL when the files are no project. ORL_ERR_INVALID: a group, state or sky is
 * chosen that there is not.
 */
int orl_project_find(const char *const *names, size_t count, const struct orl_files *files,
                     const struct orl_project_choice *choice, json_t **ret_project,
                     struct orl_error *err);

#endif
