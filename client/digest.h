/*
 * What the daemon calls things by: SHA-256 of their bytes, in hexadecimal, so that what it has
 * already need not be sent.
 */
#ifndef ORL_CLIENT_DIGEST_H
#define ORL_CLIENT_DIGEST_H

#include <stddef.h>

#include <oriel/error.h>

#include "http.h"
#include "parts/file_digest.h"

/* The id of a scene of these files (POST /v1/scenes says how it is made). */
int orl_digest_scene(const struct orl_upload_part *parts, size_t n_parts,
                     char ret_id[ORL_DIGEST_TEXT], struct orl_error *err);

#endif
