/*
 * The files that a check is about, all of them mapped before it can open none any more.
 *
 * Ownership: nothing is given back: the process ends with the check.
 */
#ifndef ORL_SERVER_CHECKS_OPENED_H
#define ORL_SERVER_CHECKS_OPENED_H

#include <jansson.h>

#include "store/bundle.h"

struct orl_opened {
    struct orl_bundle bundle; /* of "files", in their order */
    struct orl_file *data;    /* theirs */
    struct orl_file single;   /* of "path" */
};

/* Maps what the request names. */
int orl_opened_open(const json_t *request, struct orl_opened *ret_opened, struct orl_error *err);

/* Borrows opened. */
struct orl_files orl_opened_provider(struct orl_opened *opened);

/* The other side of it: a bundle as "files". A new reference; NULL: no memory. */
json_t *orl_opened_to_json(const struct orl_bundle *bundle);

#endif
