/*
 * The files of a check, all mapped before the sandbox forbids open().
 *
 * Ownership: nothing is freed: the process ends with the check.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_MAPPED_INPUTS_H
#define ORL_SERVER_CHECKS_CHILD_MAPPED_INPUTS_H

#include <jansson.h>

#include "store/files/scene_bundle.h"

struct orl_mapped_inputs {
    struct orl_bundle bundle; /* the request's "files", in their order */
    struct orl_file *data;    /* contents of the bundle's files */
    struct orl_file single;   /* the request's "path" */
};

/* Maps the files that the request names. */
int orl_mapped_inputs_open(const json_t *request, struct orl_mapped_inputs *ret_mapped,
                           struct orl_error *err);

/* Returns a file provider that borrows opened. */
struct orl_files orl_mapped_inputs_provider(struct orl_mapped_inputs *mapped);

/* Converts a bundle to the request's "files". Returns a new reference; NULL: out of memory. */
json_t *orl_mapped_inputs_to_json(const struct orl_bundle *bundle);

#endif
