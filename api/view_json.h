/*
 * A view of a job document:
 *
 *     {"name": "desk", "view": "-vtv -vp ...", "width": 400, "height": 300, "pixel_aspect": 1, ...}
 *     {"name": "desk", "file": "desk.vf", "entry": 2, "width": 400, "height": 300, ...}
 *
 * Width and height may be left out where the options of "view" have -x and -y; "entry" is a number
 * or a name. What else it may have: picture_json.h, glare_json.h.
 */
#ifndef ORL_API_VIEW_JSON_H
#define ORL_API_VIEW_JSON_H

#include <jansson.h>

#include <oriel/run.h>

/* index: of the view, for messages. What is owned is the view's also when this fails. */
int orl_view_from_json(const json_t *doc, size_t index, struct orl_view_request *view,
                       struct orl_error *err);

#endif
