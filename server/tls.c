#include "tls.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PEM_MAX = 1 << 20 };

static int read_pem(const char *path, mode_t refused, char **ret_text, struct orl_error *err)
{
    struct stat st;
    char *text = NULL;
    int rc = 0;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 || fstat(fd, &st) != 0) {
        rc = orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", path, strerror(errno));
    } else if (!S_ISREG(st.st_mode) || st.st_size <= 0 || st.st_size > PEM_MAX) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "%s is no PEM file", path);
    } else if (st.st_mode & refused) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "everyone on this machine can read the key %s",
                           path);
        orl_error_hint(err, "chmod o= takes that away");
    } else {
        text = calloc(1, (size_t)st.st_size + 1);
        if (!text)
            rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
        else if (read(fd, text, (size_t)st.st_size) != st.st_size)
            rc = orl_error_set(err, ORL_ERR_IO, "cannot read %s whole", path);
    }
    if (fd >= 0)
        close(fd);
    if (rc)
        free(text);
    else
        *ret_text = text;
    return rc;
}

int orl_tls_load(const char *cert_path, const char *key_path, struct orl_tls *ret_tls,
                 struct orl_error *err)
{
    struct orl_tls tls = {NULL, NULL};
    int rc = read_pem(cert_path, 0, &tls.cert, err);
    if (rc == 0)
        rc = read_pem(key_path, S_IROTH | S_IWOTH, &tls.key, err);
    if (rc)
        orl_tls_done(&tls);
    else
        *ret_tls = tls;
    return rc;
}

void orl_tls_done(struct orl_tls *tls)
{
    if (tls->key)
        sodium_memzero(tls->key, strlen(tls->key));
    free(tls->key);
    free(tls->cert);
    *tls = (struct orl_tls){NULL, NULL};
}
