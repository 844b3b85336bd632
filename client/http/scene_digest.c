#include "http/scene_digest.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/sha256.h>

#include "distributed/file_digest.h"

static int by_name(const void *a, const void *b)
{
    const struct orl_upload_part *x = a, *y = b;

    return strcmp(x->name, y->name);
}

/* Hashes a line "main <digest> <name>\n", or with "resource". */
static int add_line(struct orl_sha256 *hash, const struct orl_upload_part *part,
                    struct orl_error *err)
{
    const char *role = part->resource ? "resource " : "main ";
    char digest[ORL_DIGEST_TEXT];
    const int rc = orl_digest_file(part->path, digest, err);

    if (rc)
        return rc;
    orl_sha256_add(hash, role, strlen(role));
    orl_sha256_add(hash, digest, strlen(digest));
    orl_sha256_add(hash, " ", 1);
    orl_sha256_add(hash, part->name, strlen(part->name));
    orl_sha256_add(hash, "\n", 1);
    return 0;
}

int orl_digest_scene(const struct orl_upload_part *parts, size_t n_parts,
                     char ret_id[ORL_DIGEST_TEXT], struct orl_error *err)
{
    static const char first[] = "oriel-scene 1\n";
    struct orl_upload_part *resources =
        calloc(n_parts + 1, sizeof *resources); /* strings are borrowed */
    struct orl_sha256 hash;
    size_t n_resources = 0;
    int rc = 0;

    if (!resources)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, first, strlen(first));
    for (size_t i = 0; i < n_parts && rc == 0; i++) {
        if (parts[i].resource)
            resources[n_resources++] = parts[i];
        else
            rc = add_line(&hash, &parts[i], err);
    }
    qsort(resources, n_resources, sizeof *resources, by_name);
    for (size_t i = 0; i < n_resources && rc == 0; i++)
        rc = add_line(&hash, &resources[i], err);
    free(resources);
    if (rc == 0)
        orl_digest_end(&hash, ret_id);
    return rc;
}
