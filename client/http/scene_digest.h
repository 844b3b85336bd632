/*
 * Computes the ids that the daemon uses: SHA-256 digests in hexadecimal. With them, uploads
 * that the daemon already has are skipped.
 */
#ifndef ORL_CLIENT_HTTP_SCENE_DIGEST_H
#define ORL_CLIENT_HTTP_SCENE_DIGEST_H

#include <stddef.h>

#include <oriel/base/error.h>

#include "distributed/file_digest.h"
#include "http/http_client.h"

/* Computes the id of a scene of these files (defined at POST /v1/scenes). */
int orl_digest_scene(const struct orl_upload_part *parts, size_t n_parts,
                     char ret_id[ORL_DIGEST_TEXT], struct orl_error *err);

#endif
