/* Files of sensors: a point and a direction a line. */
#ifndef ORL_RUN_REQUEST_SENSORS_FILE_H
#define ORL_RUN_REQUEST_SENSORS_FILE_H

#include <oriel/job/run.h>

/* Parses a file of sensors, like orl_sensors_read, into an array that the caller frees. */
int orl_sensors_parse(const char *name, const char *text, size_t size,
                      struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);
/* Reads the sensors of a file. Polls cancel, which may be NULL; returns ORL_ERR_CANCELLED then. */
int orl_sensors_load(const struct orl_files *files, const char *name, const atomic_bool *cancel,
                     struct orl_sensor **ret_sensors, size_t *ret_count, struct orl_error *err);

#endif
