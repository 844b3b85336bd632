/* A project's contents as tables (project/project.h). */
#ifndef ORL_CLIENT_OUTPUT_PROJECT_TABLE_H
#define ORL_CLIENT_OUTPUT_PROJECT_TABLE_H

#include <jansson.h>
#include <stdio.h>

#include "input/project_folder.h"

/* Prints units, scene, grids with their sensors, views with their types, skies, window groups with
 * their states, files left out, and missing files. missing: an array of names. */
void orl_print_project(FILE *to, const char *path, const struct orl_project_folder *project_folder,
                       const json_t *missing);

#endif
