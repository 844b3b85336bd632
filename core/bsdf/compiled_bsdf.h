/*
 * A file that holds a loaded BSDF in its memory layout. It is mapped without parsing XML, and its
 * pages are shared between threads and processes.
 *
 * It is a sealed file (base/io/checked_file.h): struct orl_bsdf with offsets in place of its
 * pointers, then the arrays that they point to.
 *
 * Any change of what loading makes of a file, or of its memory layout, needs a new version.
 */
#ifndef ORL_BSDF_COMPILED_BSDF_H
#define ORL_BSDF_COMPILED_BSDF_H

#include <stdint.h>

#include <oriel/bsdf/bsdf.h>

enum { ORL_COMPILED_VERSION = 3, ORL_COMPILED_DIGEST = 32 };

/* Writes the whole file; does not sync it. content: SHA-256 of the XML. Returns 0, ORL_ERR_IO or
 * ORL_ERR_NOMEM. */
int orl_bsdf_write(const struct orl_bsdf *bsdf, const unsigned char content[ORL_COMPILED_DIGEST],
                   const char *path, uint64_t *ret_bytes, struct orl_error *err);

/* Maps a file. *ret_bsdf is owned. The file may be removed or replaced while it is mapped. */
int orl_bsdf_open(const char *path, const unsigned char content[ORL_COMPILED_DIGEST],
                  struct orl_bsdf **ret_bsdf, struct orl_error *err);

#endif
