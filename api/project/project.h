/*
 * Reads a folder, a zip, or a configuration of rad or frads as a project: the scene's files in
 * reading order; sensor grids, views, skies and the states of dynamic parts, by name; and the files
 * left out, with reasons.
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
#include <stddef.h>

#include <oriel/base/error.h>
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

/*
 * Reads a file of Radiance's rad (.rif) as a project: {"files": [materials, illum, then scene, in
 * file order], "grids": [], "views": [{"name", "view" or "file", "width", "height",
 * "pixel_aspect"}], "states": {}, "skies": [], "left_out": [{"file", "why"}], "commands":
 * [{"name", "text"}]}, as above. Commands in quotes become scene files: "commands"
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

/* Reads text as a project; *ret_project is a new reference. */
int orl_rif_read(const char *name, const char *text, size_t size, json_t **ret_project,
                 struct orl_error *err);

/*
 * Reads a frads configuration (.cfg) as a project: {"files": [materials, windows, then scene, in
 * file order], "grids": [], "views": [{"name", "view" or "file", "width", "height"}], "states":
 * {}, "skies": [], "left_out": [{"file", "why"}], "commands": [{"name", "text"}]}, as above.
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

/* Reads text as a project; *ret_project is a new reference. */
int orl_frads_read(const char *name, const char *text, size_t size, json_t **ret_project,
                   struct orl_error *err);

#endif
