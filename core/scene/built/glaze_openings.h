/*
 * Unglazed openings (scene/geometry/unglazed_openings.h) that let daylight in. Each gets a pane
 * that changes no light, glass of index 1, so that it is a port (scene.h) as a glazed window is.
 * Photons then start at it, and rays from inside are sampled towards it.
 */
#ifndef ORL_SCENE_BUILT_GLAZE_OPENINGS_H
#define ORL_SCENE_BUILT_GLAZE_OPENINGS_H

#include "scene/built/scene.h"

/*
 * Adds the panes to a scene whose geometry is built; the geometry is rebuilt if there are any.
 * Returns 0 or ORL_ERR_NOMEM, _LIMIT, _CANCELLED.
 *
 * An opening gets a pane if rays leave the scene from one of its sides several times as often as
 * from the other (escape.h). Rays past panes of other openings are not counted. It gets none if
 * - it stands before windows that are ports themselves (the opening of a frame or a courtyard)
 * - curved mirrors or lenses stand before it outdoors, whose light ports do not send in
 * - the scene has mist
 */
int orl_scene_glaze_openings(struct orl_scene *scene, struct orl_error *err);

#endif
