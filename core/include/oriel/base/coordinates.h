/*
 * Checks of points and directions that users give: sensors, viewpoints, eyes, points, view
 * directions. All readers of documents, files and options use these, so that the same numbers are
 * refused everywhere.
 */
#ifndef ORIEL_BASE_COORDINATES_H
#define ORIEL_BASE_COORDINATES_H

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Checks that each coordinate is finite and at most ORL_LIMIT_DISTANCE in magnitude. what: "sensor
 * 3", for the message. Returns 0 or ORL_ERR_RANGE. */
int orl_check_point(struct orl_vec3 point, const char *what, struct orl_error *err);

/* Same as orl_check_point, and also rejects a direction whose length is zero or too small for a
 * unit vector. */
int orl_check_direction(struct orl_vec3 direction, const char *what, struct orl_error *err);

#endif
