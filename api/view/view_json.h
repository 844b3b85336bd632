/*
 * A view of a job document:
 *
 *     {"name": "desk", "view": "-vtv -vp ...", "width": 400, "height": 300, "pixel_aspect": 1, ...}
 *     {"name": "desk", "file": "desk.vf", "entry": 2, "width": 400, "height": 300, ...}
 *
 * Width and height may be left out if the options of "view" have -x and -y. "entry" is a number or
 * a name. picture_json.h and glare_json.h have the other members.
 */
#ifndef ORL_API_VIEW_VIEW_JSON_H
#define ORL_API_VIEW_VIEW_JSON_H

#include <oriel/job/run.h>

#include "json/members.h"

/* Decoder into a struct orl_view_request of zeros. */
orl_json_decoder orl_view_from_json;

#endif
