/*
 * Unglazed openings (scene/geometry/unglazed.h) that let daylight in: each gets a pane that changes
 * no light, glass of index 1, so that it is a port (scene.h) as a glazed window is. Photons then
 * start at it, and rays from inside are aimed at it.
 */
#ifndef ORL_LIGHT_GLAZE_H
#define ORL_LIGHT_GLAZE_H

#include "light/scene.h"

/*
 * Adds the panes to a scene whose geometry is built, which is built anew if there are any. An
 * opening gets one where rays leave the scene from one side of it several times as often as from
 * the other, past panes of other openings, and no window is behind nearly all of it. Nothing is
 * added where there is mist. Returns 0 or ORL_ERR_NOMEM, _LIMIT, _CANCELLED.
 */
int orl_scene_glaze_openings(struct orl_scene *scene, struct orl_error *err);

#endif
