#include "commands/bsdf_file.h"

#include <stdio.h>
#include <string.h>

#include <oriel/base/files.h>

#include "commands/local.h"
#include "http/scene_digest.h"

int orl_bsdf_file_load(const char *path, struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    struct orl_files files = orl_files_from_folder(".");
    struct orl_file file;
    int rc = files.open(files.ctx, path, &file, err);
    if (rc < 0)
        return rc;
    const struct orl_bsdf_xml xml = {
        .name = path, .data = file.data, .size = file.size, .cancel = orl_local_interrupted()};
    rc = orl_bsdf_load(&xml, ret_bsdf, err);
    files.close(files.ctx, &file);
    return rc;
}

int orl_bsdf_file_source(const char *path, char ret_source[512], struct orl_error *err)
{
    const char *slash = strrchr(path, '/');
    char sha[ORL_DIGEST_TEXT];
    const int rc = orl_digest_file(path, sha, err);
    if (rc == 0)
        snprintf(ret_source, 512, "%.300s, SHA-256 %s", slash ? slash + 1 : path, sha);
    return rc;
}
