#include "distributed/file_digest.h"

#include <stdio.h>

#include <sodium.h>

#include "distributed/atomic_files.h"

void orl_digest_end(struct orl_sha256 *hash, char ret_digest[ORL_DIGEST_TEXT])
{
    unsigned char digest[ORL_SHA256_BYTES];

    orl_sha256_finish(hash, digest);
    sodium_bin2hex(ret_digest, ORL_DIGEST_TEXT, digest, sizeof digest);
}

int orl_digest_file(const char *path, char ret_digest[ORL_DIGEST_TEXT], struct orl_error *err)
{
    struct orl_sha256 hash;
    unsigned char buffer[1 << 16];
    long long size = 0;
    FILE *file = NULL;
    size_t n;
    int rc = orl_open_for_reading(path, &file, &size, err);

    if (rc)
        return rc;
    orl_sha256_init(&hash);
    while ((n = fread(buffer, 1, sizeof buffer, file)) > 0)
        orl_sha256_add(&hash, buffer, n);
    if (ferror(file)) {
        rc = orl_error_set(err, ORL_ERR_IO, "cannot be read");
        orl_error_at(err, path, 0, NULL);
    }
    fclose(file);
    if (rc == 0)
        orl_digest_end(&hash, ret_digest);
    return rc;
}
