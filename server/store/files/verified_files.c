#include "store/files/verified_files.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/sha256.h>

static size_t place_of(const struct stat *st)
{
    return (size_t)(((uint64_t)st->st_ino * 0x9E3779B97F4A7C15U) >> 32) % ORL_VERIFIED_FILES;
}

bool orl_verified_files_has(const struct orl_verified_files *verified, const struct stat *st)
{
    const struct orl_verified_file *file = &verified->files[place_of(st)];
    return file->inode == st->st_ino && file->device == st->st_dev && file->size == st->st_size &&
           file->changed.tv_sec == st->st_ctim.tv_sec &&
           file->changed.tv_nsec == st->st_ctim.tv_nsec;
}

void orl_verified_files_add(struct orl_verified_files *verified, const struct stat *st)
{
    verified->files[place_of(st)] = (struct orl_verified_file){
        .device = st->st_dev, .inode = st->st_ino, .size = st->st_size, .changed = st->st_ctim};
}

/* Uses read, not mmap: a file truncated meanwhile then ends early instead of raising SIGBUS. */
static int digest_of(int fd, char ret_sha[ORL_SHA_HEX], struct orl_error *err)
{
    enum { CHUNK = 1 << 18 };
    unsigned char digest[ORL_SHA256_BYTES];
    struct orl_sha256 hash;
    unsigned char *chunk = malloc(CHUNK);
    off_t at = 0;
    ssize_t n = 0;
    if (!chunk)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sha256_init(&hash);
    while ((n = pread(fd, chunk, CHUNK, at)) > 0 || (n < 0 && errno == EINTR)) {
        if (n < 0)
            continue;
        orl_sha256_add(&hash, chunk, (size_t)n);
        at += n;
    }
    free(chunk);
    if (n < 0)
        return orl_error_set(err, ORL_ERR_IO, "a result file cannot be read: %s", strerror(errno));
    orl_sha256_finish(&hash, digest);
    sodium_bin2hex(ret_sha, ORL_SHA_HEX, digest, sizeof digest);
    return 0;
}

int orl_verify_file(int fd, const char sha[ORL_SHA_HEX], struct orl_error *err)
{
    char found[ORL_SHA_HEX];
    const int rc = digest_of(fd, found, err);
    if (rc || strcmp(found, sha) == 0)
        return rc;
    orl_error_set(err, ORL_ERR_CORRUPT, "the result file is damaged in the store");
    orl_error_hint(err, "The same document, submitted again, gives it anew");
    return ORL_ERR_CORRUPT;
}
