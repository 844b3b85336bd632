/*
 * A file of cached results in a store (oriel/job/run.h): words of 32 bits, with run lengths for
 * zeros.
 *
 * File: a header, then runs: the number of zeros, the number of words after them, these words. It
 * is only for the machine that wrote it. Reading returns ORL_ERR_VERSION for another version or
 * byte order, and ORL_ERR_CORRUPT if the file is cut, damaged (all of it is verified) or of another
 * key.
 */
#ifndef ORL_RUN_CACHE_WORD_FILE_H
#define ORL_RUN_CACHE_WORD_FILE_H

#include <oriel/job/run.h>

struct orl_word_file_info {
    char key[ORL_DIGEST_HEX + 1], family[ORL_DIGEST_HEX + 1]; /* family may be empty */
    /* Target within its family (orl_map_info). */
    uint64_t target;
    uint64_t rays;  /* number of rays traced for it */
    uint64_t bytes; /* size of the file */
};

/* Writes the whole file, not synced; size: of data, a multiple of 4. Fills file_info->bytes.
 * Returns ORL_ERR_IO, _FULL or _NOMEM and leaves no file on failure. */
int orl_word_file_write(const char *path, struct orl_word_file_info *file_info, const void *data,
                        size_t size, struct orl_error *err);

/* Reads a file. key: NULL accepts any. ret_data: receives the words, owned by the caller; NULL:
 * only verifies. */
int orl_word_file_read(const char *path, const char *key, struct orl_word_file_info *ret_file_info,
                       void **ret_data, size_t *ret_size, struct orl_error *err);

/* Reads only the header. */
int orl_word_file_describe(const char *path, struct orl_word_file_info *ret_file_info,
                           struct orl_error *err);

#endif
