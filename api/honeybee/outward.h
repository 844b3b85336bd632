/*
 * Which way a room's faces look. Honeybee turns those of a closed room outwards when it reads a
 * model, and so do we: the second of two faces that bound each other stands inwards of it, and
 * BSDFs have a front.
 *
 * A face looks inwards when the line through it, along its normal, meets an odd number of the
 * room's other faces in front of it, and an even number behind. Where both are odd or even the room
 * has a gap there, and the face stays as it is; so do all faces of rooms with more than 256, whose
 * time would grow by faces times corners.
 */
#ifndef ORL_API_HONEYBEE_OUTWARD_H
#define ORL_API_HONEYBEE_OUTWARD_H

#include "honeybee/polygon.h"

/* *ret_inward: owned, one for each of the room's faces; NULL where none is to be turned. */
int orl_hb_inward_faces(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                        bool **ret_inward);

#endif
