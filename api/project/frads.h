/*
 * Reads a frads configuration (.cfg) as a project: {"files": [materials, windows, then scene, in
 * file order], "grids": [], "views": [{"name", "view" or "file", "width", "height"}], "states":
 * {}, "skies": [], "left_out": [{"file", "why"}], "commands": [{"name", "text"}]}, as in rif.h.
 *
 * The format is that of Python's configparser: [Sections] of "key = value" (or ':'). Indented
 * lines continue a value, '#' or ';' at a line's start begins a comment, and ${key} or
 * ${Section:key} stands for another value. In [Model], "material", "windows", "scene" and "ncps"
 * name scene files. "window_xmls", one per window or one for all, gives windows these BSDFs, with
 * up along z, by commands. In [RaySender], "view..." are views, sized by -x and -y. Sensor grids
 * made from surfaces ("grid_surface"), weather ("epw_file", "epw_path", "wea_path") and geometry
 * of the matrices ("window_cfs") are left out and listed.
 *
 * Source: frads' documentation, "mrad". Bounds: 64 KiB per value, references nested at most eight
 * deep.
 * Errors: ORL_ERR_SYNTAX, _LIMIT, with file and line; ORL_ERR_NOMEM.
 */
#ifndef ORL_API_PROJECT_FRADS_H
#define ORL_API_PROJECT_FRADS_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/base/error.h>

/* Reads text as a project; *ret_project is a new reference. */
int orl_frads_read(const char *name, const char *text, size_t size, json_t **ret_project,
                   struct orl_error *err);

#endif
