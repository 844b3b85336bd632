/*
 * A file of Radiance's rad (.rif) as a project: {"files": [materials, illum, then scene, in their
 * order], "grids": [], "views": [{"name", "view" or "file", "width", "height", "pixel_aspect"}],
 * "states": {}, "skies": [], "left_out": [{"file", "why"}], "commands": [{"name", "text"}]}, as
 * honeybee/project.h has it. Commands in quotes are scene files to be written by those names.
 *
 * Lines are "NAME= value"; '#' begins a comment, a backslash at the end goes on. Names may be cut
 * short to three letters, in either case. Of "objects" rad itself reads nothing: the scene's files
 * name them. "view" is a name and options, or "-vf FILE"; views that rad works out from its ZONE
 * are left out. "RESOLUTION" gives the width and height that pictures are to fit, or both by one
 * number; a third, if it is not 1, is the pixels' aspect, 0 for exactly that size. Variables of
 * rad's own programs (octrees, quality, pictures) mean nothing here.
 *
 * Refused: octrees as a scene. Source: rad(1).
 * Errors: ORL_ERR_SYNTAX, _UNSUPPORTED, with file and line; ORL_ERR_NOMEM.
 */
#ifndef ORL_API_RIF_H
#define ORL_API_RIF_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/error.h>

/* *ret_project is a new reference. */
int orl_rif_read(const char *name, const char *text, size_t size, json_t **ret_project,
                 struct orl_error *err);

#endif
