/*
 * Translates Honeybee models (HBJSON) into Radiance files, in the layout of Honeybee's model
 * folder:
 *
 *     model/scene/{envelope,shades,shade_meshes}.{mat,rad}, model/aperture/aperture.{mat,rad},
 *     model/aperture_group/GROUP..default..STATE.rad and states.json, likewise for dynamic
 *     shades in model/scene_dynamic and model/scene_dynamic/indoor, model/grid/[GROUP/]GRID.pts,
 *     model/view/[GROUP/]VIEW.vf, model/bsdf/MODIFIER.xml,
 *     model/warnings.txt: one warning per line
 *
 * Rules (those of honeybee-radiance where the schema leaves a choice):
 * - Apertures and doors are cut out of their face: its outline runs to each hole and back. A face's
 *   own holes are cut likewise.
 * - Faces of a closed room are turned outwards (face_orientation.c), and openings with their face.
 * All other objects are oriented by their plane's normal, or else by the order of their corners.
 * - If two faces bound each other, their common apertures and doors are written with the first. The
 *   second face is offset inwards by twice the model's tolerance, so that each side shows its own
 *   modifier.
 * - Faces of type AirBoundary are not written: light passes.
 * - A modifier is the object's, else its room's set's, else the generic one (modifiers.h).
 *   Void is no surface. If several modifiers have one identifier, the last in the list counts; a
 *   warning is given if they differ.
 * - A group (dynamic_group_identifier) is written once for each state. An object with fewer states
 *   than others keeps its last one; an object without states is unchanged.
 * - Grids with one identifier form one grid; of views with one identifier the last counts. Both
 *   give a warning. A grid without sensors gets those of its mesh: a face's middle, along its
 *   normal.
 * - Lengths keep the model's units. Energy properties, modifier_blk and modifier_direct are not
 *   read. Luminaires are made by ies2rad and xform from their IES files, in model/ies.
 *
 * Source: honeybee-schema, https://www.ladybug.tools/honeybee-schema/model.html
 *
 * Every number and name is checked, so that Radiance parses the output as intended. Time and
 * memory are linear in the sizes of document and output, which ORL_LIMIT_FILE_BYTES bounds. Two
 * more terms are n log n for a face's n holes, and faces (at most 256) times corners for a room.
 * Errors: as in decode.h, with JSON paths ("rooms[2].faces[0].geometry").
 */
#ifndef ORL_API_HONEYBEE_HBJSON_H
#define ORL_API_HONEYBEE_HBJSON_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/base/files.h>

/* A file in memory; owned. */
struct orl_text_file {
    char *name, *text;
    size_t size;
};

struct orl_text_files {
    struct orl_text_file *items;
    size_t count, room;
};
void orl_text_files_done(struct orl_text_files *files);

/* Returns true if the document says that it is a Honeybee model. */
bool orl_hbjson_is_model(const json_t *document);

int orl_hbjson_translate(const json_t *model, struct orl_text_files *ret_files,
                         struct orl_error *err);

#endif
