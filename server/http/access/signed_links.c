#include "http/access/access.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/stat.h>

#include "http/context.h"
#include "process/limits.h"
#include "process/times.h"

/* Refuses a key file that others can read, since they could sign links with it. */
static int check_owner(int fd, const char *path, struct orl_error *err)
{
    struct stat st;
    if (fstat(fd, &st) != 0 || (st.st_mode & 077) == 0)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "other users can read %s, the key of signed links", path);
    orl_error_hint(
        err,
        "Remove it, since it may be known: a new key is made. Check who can read the data folder");
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
    orl_error_hint(err, "Remove it: a new key is made, and links signed before become invalid");
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

enum { MAC_BYTES = 32, MAC_TEXT = 44 };

static void sign_link(const unsigned char key[ORL_LINK_KEY_BYTES],
                      const struct orl_token_row *token, const char *job, const char *file,
                      int64_t until_s, char ret_signature[MAC_TEXT])
{
    unsigned char mac[MAC_BYTES];
    char text[(size_t)ORL_PARAM_MAX * 2 + sizeof token->id + sizeof token->hash + 80];
    /* Fields end with a newline, which no id or file name contains. The file still comes last. */
    const int size = snprintf(text, sizeof text, "oriel-link 2\n%s\n%s\n%s\n%lld\n%s", token->id,
                              token->hash, job, (long long)until_s, file);
    crypto_generichash(mac, sizeof mac, (const unsigned char *)text, (unsigned long long)size, key,
                       ORL_LINK_KEY_BYTES);
    sodium_bin2base64(ret_signature, MAC_TEXT, mac, sizeof mac,
                      sodium_base64_VARIANT_URLSAFE_NO_PADDING);
}

void orl_link_sign(const struct orl_request *request, const char *job, const char *file,
                   int64_t until_s, char ret_arguments[ORL_LINK_ARGUMENTS])
{
    const struct orl_token_row *token = &request->token_row;
    char signature[MAC_TEXT];
    sign_link(request->context->link_key, token, job, file, until_s, signature);
    snprintf(ret_arguments, ORL_LINK_ARGUMENTS, "by=%s&until=%lld&signature=%s", token->id,
             (long long)until_s, signature);
}

bool orl_link_is_present(const struct orl_request *request)
{
    return request->route->by_link && orl_request_query(request, "signature");
}

int orl_link_check(const struct orl_request *request, struct orl_token_row *ret_token,
                   bool *ret_good, struct orl_error *err)
{
    const struct orl_http_context *context = request->context;
    const char *by = orl_request_query(request, "by");
    const char *until = orl_request_query(request, "until");
    const char *signature = orl_request_query(request, "signature");
    char wanted[MAC_TEXT];
    bool found = false;
    *ret_good = false;
    if (!by || strlen(by) != ORL_TOKEN_ID - 1 || !until || !*until || strlen(until) > 15 ||
        until[strspn(until, "0123456789")] || strlen(signature) != MAC_TEXT - 1)
        return 0;
    const int rc =
        orl_token_row_find(context->db, context->token_statement, by, ret_token, &found, err);
    if (rc || !found)
        return rc;
    const int64_t until_s = strtoll(until, NULL, 10);
    sign_link(context->link_key, ret_token, request->params[0], request->params[1], until_s,
              wanted);
    const int64_t left_ms = 1000 * until_s - orl_time_now_ms();
    *ret_good = sodium_memcmp(wanted, signature, MAC_TEXT - 1) == 0 && left_ms > 0 &&
                left_ms <= 1000 * (int64_t)ORL_SERVER_LINK_S;
    return 0;
}
