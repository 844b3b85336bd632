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

#include <oriel/run.h>

#include "members.h"

/* Into a struct orl_view_request of zeros. */
orl_json_decoder orl_view_from_json;

#endif
