/*
 * A loaded BSDF in a file, as it stands in memory: mapped again it is there at once, without its
 * XML, and threads and programs that have it open share its pages.
 *
 * A sealed file (base/sealed.h): struct orl_bsdf with offsets in place of its pointers, then the
 * arrays they point to.
 *
 * Whatever changes what loading makes of a file, or how it lies in memory, is a new version.
 */
#ifndef ORL_BSDF_COMPILED_H
#define ORL_BSDF_COMPILED_H

#include <stdint.h>

#include <oriel/bsdf.h>

enum { ORL_COMPILED_VERSION = 3, ORL_COMPILED_DIGEST = 32 };

/* Writes the whole file, not synced. content: SHA-256 of the XML. ORL_ERR_IO, _NOMEM. */
int orl_bsdf_write(const struct orl_bsdf *bsdf, const unsigned char content[ORL_COMPILED_DIGEST],
                   const char *path, uint64_t *ret_bytes, struct orl_error *err);

/* Maps a file. ret_bsdf is owned; the file may go, even be replaced, while it is in use. */
int orl_bsdf_open(const char *path, const unsigned char content[ORL_COMPILED_DIGEST],
                  struct orl_bsdf **ret_bsdf, struct orl_error *err);

#endif
