/*
 * Finds the faces of a room that face inwards. Honeybee turns the faces of a closed room outwards
 * when it reads a model, and so does this code. The orientation matters because the second of two
 * adjacent faces is offset inwards, and because BSDFs have a front.
 *
 * The test follows the line through a face along its normal. The face is inward if the line meets
 * an odd number of the room's other faces in front of it, and an even number behind. If both are
 * odd or both even, the room has a gap there and the face is left as it is. Rooms with more than
 * 256 faces are left as they are, because time is proportional to faces times corners.
 */
#ifndef ORL_API_HONEYBEE_FACE_ORIENTATION_H
#define ORL_API_HONEYBEE_FACE_ORIENTATION_H

#include "honeybee/polygon.h"

/* *ret_inward: owned, one flag per face of the room; NULL if no face is to be turned. */
int orl_hb_inward_faces(struct orl_hb *hb, const json_t *room, const struct orl_hb_at *at,
                        bool **ret_inward);

#endif
