/*
 * What one job works out and others use again, in a file of a store (oriel/run.h): words of 32
 * bits, with runs of zeros told by their number.
 *
 * File: a header, then runs: the number of zeros, the number of words after them, these words. It
 * is for the machine that wrote it. Refused as ORL_ERR_VERSION when it is of another version or
 * byte order, as ORL_ERR_CORRUPT when it is cut, damaged (all of it is verified) or of another key.
 */
#ifndef ORL_RUN_KEPT_FILE_H
#define ORL_RUN_KEPT_FILE_H

#include <oriel/run.h>

struct orl_kept_about {
    char key[ORL_DIGEST_HEX + 1], family[ORL_DIGEST_HEX + 1]; /* the latter may be empty */
    uint64_t target;                                          /* of its family (orl_map_info) */
    uint64_t rays;                                            /* that it took */
    uint64_t bytes;                                           /* of the file */
};

/* Writes the whole file, not synced; size: of data, a multiple of 4. Fills about's bytes.
 * ORL_ERR_IO, _FULL, _NOMEM; no file is left then. */
int orl_kept_write(const char *path, struct orl_kept_about *about, const void *data, size_t size,
                   struct orl_error *err);

/* key: NULL takes any. ret_data: the words, owned; NULL: they are verified only. */
int orl_kept_read(const char *path, const char *key, struct orl_kept_about *ret_about,
                  void **ret_data, size_t *ret_size, struct orl_error *err);

/* By its header alone. */
int orl_kept_describe(const char *path, struct orl_kept_about *ret_about, struct orl_error *err);

#endif
