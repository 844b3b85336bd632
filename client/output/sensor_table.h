/* The results of a render job as tables: grids of sensors, and glare of views. */
#ifndef ORL_CLIENT_OUTPUT_SENSOR_TABLE_H
#define ORL_CLIENT_OUTPUT_SENSOR_TABLE_H

#include <jansson.h>
#include <stdio.h>

/*
 * Prints a row for each grid of a result (result_json.h), or one for all sensors of a job without
 * grids; nothing if there are no sensors. "error" is half the 95 % interval of the mean.
 *
 *     grid          sensors   mean lx    error    min lx    max lx  >= 300 lx  uniformity
 *     room_1             49      1234    1.2 %       210      4021     87.5 %        0.17
 */
void orl_print_sensor_table(FILE *to, const json_t *result);

/* Prints a line for each view with DGP: "view eye: DGP 0.312 [0.305, 0.319], imperceptible glare".
 */
void orl_print_glare_lines(FILE *to, const json_t *result);

/* Prints the paths of a result's maps and table, one per line. */
void orl_print_sensor_files(FILE *to, const json_t *result, const char *folder);

#endif
