/*
 * Reads a file of Radiance's rad (.rif) as a project: {"files": [materials, illum, then scene, in
 * file order], "grids": [], "views": [{"name", "view" or "file", "width", "height",
 * "pixel_aspect"}], "states": {}, "skies": [], "left_out": [{"file", "why"}], "commands":
 * [{"name", "text"}]}, as in project/project.h. Commands in quotes become scene files: "commands"
 * has their names and texts, for the caller to write.
 *
 * Lines are "NAME= value"; '#' begins a comment, and a backslash at the end continues the line.
 * Names may be abbreviated to three letters, in either case. "objects" is listed as left out: rad
 * does not read it either, because the scene's files name these objects. "view" is a name and
 * options, or "-vf FILE"; views that rad computes from its ZONE are left out. "RESOLUTION" gives
 * the largest width and height of pictures, or one number for both. A third number other than 1 is
 * the pixel aspect, 0 for exactly that size. Variables for rad's own programs (octrees, quality,
 * pictures) are ignored.
 *
 * An octree as a scene is refused. Source: rad(1).
 * Errors: ORL_ERR_SYNTAX, _UNSUPPORTED, with file and line; ORL_ERR_NOMEM.
 */
#ifndef ORL_API_PROJECT_RIF_H
#define ORL_API_PROJECT_RIF_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/base/error.h>

/* Reads text as a project; *ret_project is a new reference. */
int orl_rif_read(const char *name, const char *text, size_t size, json_t **ret_project,
                 struct orl_error *err);

#endif
