/* SHA-256 digests of files, in hexadecimal. */
#ifndef ORL_DISTRIBUTED_FILE_DIGEST_H
#define ORL_DISTRIBUTED_FILE_DIGEST_H

#include <oriel/base/error.h>
#include <oriel/base/sha256.h>

enum { ORL_DIGEST_TEXT = 65 };

/* Ends hash and returns its digest as text. */
void orl_digest_end(struct orl_sha256 *hash, char ret_digest[ORL_DIGEST_TEXT]);

/* Computes the digest of a file's bytes. */
int orl_digest_file(const char *path, char ret_digest[ORL_DIGEST_TEXT], struct orl_error *err);

#endif
