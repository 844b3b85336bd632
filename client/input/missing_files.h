/*
 * Finds the files that a project refers to and that do not exist: files of its scene, of its states
 * and grids and views, and all files that these refer to (BSDFs, IES files, function files, ...).
 */
#ifndef ORL_CLIENT_INPUT_MISSING_FILES_H
#define ORL_CLIENT_INPUT_MISSING_FILES_H

#include <jansson.h>

#include <oriel/base/error.h>

#include "input/project_folder.h"

/*
 * Finds the names of missing files, as the project spells them. *ret_missing: an array of strings,
 * owned by the caller. Files of the library (RAYPATH) exist.
 *
 * The core's own parser reads the scene. A missing file of Radiance text is taken as empty, and a
 * missing BSDF as a plain one, so that one pass after the other finds all of them. Other kinds of
 * files, such as pictures, end the search. ret_unreadable: the error of a scene that cannot be read
 * for another reason, without missing files; else its code is 0.
 */
int orl_find_missing_files(const struct orl_project_folder *project_folder, json_t **ret_missing,
                           struct orl_error *ret_unreadable, struct orl_error *err);

#endif
