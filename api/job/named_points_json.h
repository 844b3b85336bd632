/*
 * Named places in a document:
 *
 *     [{"name": "living room" (by default "point" and its number), "at": [x, y, z]}, ...]
 */
#ifndef ORL_API_JOB_NAMED_POINTS_JSON_H
#define ORL_API_JOB_NAMED_POINTS_JSON_H

#include <jansson.h>

#include <oriel/job/named_point.h>

/* Decoders (members.h) into a struct orl_vec3: an array of three numbers, checked by
 * oriel/base/coordinates.h. */
int orl_point_from_json(const json_t *value, const char *path, void *into, struct orl_error *err);
int orl_direction_from_json(const json_t *value, const char *path, void *into,
                            struct orl_error *err);
/* Decoder for members.h's lists into a struct orl_named_point. */
int orl_named_point_from_json(const json_t *value, const char *path, void *into,
                              struct orl_error *err);

/* Names the places that have no name. Returns 0 or ORL_ERR_NOMEM. */
int orl_places_name(struct orl_named_point *places, size_t n, struct orl_error *err);

#endif
