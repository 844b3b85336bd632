/*
 * Honeybee models (HBJSON) as Radiance files, laid out as Honeybee exports a model folder:
 *
 *     model/scene/{envelope,shades,shade_meshes}.{mat,rad}, model/aperture/aperture.{mat,rad},
 *     model/aperture_group/GROUP..default..STATE.rad and states.json, the same of moving shades in
 *     model/scene_dynamic and model/scene_dynamic/indoor, model/grid/[GROUP/]GRID.pts,
 *     model/view/[GROUP/]VIEW.vf, model/bsdf/MODIFIER.xml,
 *     model/warnings.txt: a line for each thing that is not as one may think
 *
 * Rules, those of honeybee-radiance where the schema leaves a choice:
 * - A face is written with its apertures and doors cut out, one outline that runs to each hole and
 *   back. Holes of a face are cut alike.
 * - Faces of a closed room are turned outwards (outward.h), openings as their face; all else looks
 *   as its corners turn, or its plane's normal says.
 * - Of two faces that bound each other, the first has their apertures and doors; the second stands
 *   inwards from it by twice the model's tolerance, so that each side shows its own modifier.
 * - Faces of type AirBoundary are not there: light passes.
 * - A modifier is the object's, else its room's set's, else the generic one (modifier_sets.h).
 *   Void is no surface.
 *   Of several modifiers by one identifier the last in the list counts; where they differ a warning
 *   tells.
 * - A group (dynamic_group_identifier) is written once for each state: of an object with fewer
 *   states than others the last one stays; one without any stays as it is.
 * - Grids of one identifier are one grid, and of views of one identifier the last counts: of both
 *   a warning tells. A grid without sensors has
 * those of its mesh: a face's middle, along its normal.
 * - Lengths stay in the model's units. What is for energy alone, modifier_blk and modifier_direct
 *   are not read. Luminaires are what ies2rad
 *   and xform make of their IES files, in model/ies.
 *
 * Source: honeybee-schema, https://www.ladybug.tools/honeybee-schema/model.html
 *
 * Every number and name is checked; nothing is written that Radiance's syntax could take for
 * something else. Time and memory are linear in the document and what is written of it, which
 * ORL_LIMIT_FILE_BYTES bounds, with two terms more: n log n of a face's holes, and a room's faces,
 * 256 at the most, times its corners.
 * Errors: as in decode.h, with JSON paths ("rooms[2].faces[0].geometry").
 */
#ifndef ORL_API_HONEYBEE_HBJSON_H
#define ORL_API_HONEYBEE_HBJSON_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/files.h>

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

/* Whether the document says that it is a Honeybee model. */
bool orl_hbjson_is_model(const json_t *document);

int orl_hbjson_translate(const json_t *model, struct orl_text_files *ret_files,
                         struct orl_error *err);

#endif
