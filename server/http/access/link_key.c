#include "http/access/link_key.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/open.h>

/* Refuses a key file that others can read, since they could sign links with it. */
static int check_owner(int fd, const char *path, struct orl_error *err)
{
    struct stat st;
    if (fstat(fd, &st) != 0 || (st.st_mode & 077) == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "others can read %s, the key of signed links", path);
    orl_error_hint(err, "Remove it, for it may be known: a new one is made; and look who reads "
                        "the data folder");
    return ORL_ERR_INVALID;
}

static int read_key(int fd, const char *path, unsigned char ret_key[ORL_LINK_KEY_BYTES],
                    struct orl_error *err)
{
    const int rc = check_owner(fd, path, err);
    if (rc)
        return rc;
    if (read(fd, ret_key, ORL_LINK_KEY_BYTES) == ORL_LINK_KEY_BYTES)
        return 0;
    orl_error_set(err, ORL_ERR_CORRUPT, "%s, the key of signed links, is too short", path);
    orl_error_hint(err, "Remove it: a new one is made, and links signed before are no longer good");
    return ORL_ERR_CORRUPT;
}

int orl_link_key_open(const struct orl_folders *folders, unsigned char ret_key[ORL_LINK_KEY_BYTES],
                      struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "oriel.key");
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd >= 0) {
        const int rc = read_key(fd, path, ret_key, err);
        close(fd);
        return rc;
    }
    if (errno != ENOENT)
        return orl_error_set(err, ORL_ERR_IO, "cannot open %s: %s", path, orl_open_reason(errno));
    randombytes_buf(ret_key, ORL_LINK_KEY_BYTES);
    const int rc = orl_write_file(path, ret_key, ORL_LINK_KEY_BYTES, err);
    return rc == ORL_ERR_FULL ? 0 : rc;
}
