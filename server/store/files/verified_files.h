/*
 * A cache of result files that are known to hold the bytes that were written. A file's digest is
 * checked when it is first served after a start, and again if it has changed since (st_ctime, which
 * every write changes). The cache holds ORL_VERIFIED_FILES files; others are checked again.
 *
 * Threads: the loop thread, except orl_verify_file, which any thread may call.
 */
#ifndef ORL_SERVER_STORE_FILES_VERIFIED_FILES_H
#define ORL_SERVER_STORE_FILES_VERIFIED_FILES_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/stat.h>
#include <time.h>

#include <oriel/base/error.h>

#include "store/files/folders.h"

enum { ORL_VERIFIED_FILES = 4096 };

struct orl_verified_files {
    struct orl_verified_file {
        dev_t device;
        ino_t inode; /* 0: none */
        off_t size;
        struct timespec changed;
    } files[ORL_VERIFIED_FILES];
};

bool orl_verified_files_has(const struct orl_verified_files *verified, const struct stat *st);
void orl_verified_files_add(struct orl_verified_files *verified, const struct stat *st);

/* Reads the file. ORL_ERR_CORRUPT if its bytes do not have that digest. */
int orl_verify_file(int fd, const char sha[ORL_SHA_HEX], struct orl_error *err);

#endif
