/*
 * A configuration of frads (.cfg) as a project: {"files": [materials, windows, then scene, in their
 * order], "grids": [], "views": [{"name", "view" or "file", "width", "height"}], "states": {},
 * "skies": [], "left_out": [{"file", "why"}], "commands": [{"name", "text"}]}, as rif.h has it.
 *
 * The file is as Python's configparser writes it: [Sections] of "key = value" (or ':'), lines that
 * go on where they are indented, comments from '#' or ';' at a line's start, and ${key} or
 * ${Section:key} for another value. Of [Model] "material", "windows", "scene" and "ncps" name scene
 * files; where "window_xmls" are given, as many as windows or one for all, windows are of those
 * BSDFs, up along z, by commands. Of [RaySender] "view..." are views, sized by -x and -y. What
 * frads itself lays over surfaces ("grid_surface"), weather ("epw_file", "epw_path", "wea_path")
 * and geometry of the matrices' own ("window_cfs") are left out, and listed.
 *
 * Source: frads' documentation, "mrad". Bounds: 64 KiB a value, interpolated eight deep.
 * Errors: ORL_ERR_SYNTAX, _LIMIT, with file and line; ORL_ERR_NOMEM.
 */
#ifndef ORL_API_FRADS_H
#define ORL_API_FRADS_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/error.h>

/* *ret_project is a new reference. */
int orl_frads_read(const char *name, const char *text, size_t size, json_t **ret_project,
                   struct orl_error *err);

#endif
