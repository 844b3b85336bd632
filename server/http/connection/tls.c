#include "http/connection/connections.h"

#include <errno.h>
#include <fcntl.h>
#include <gnutls/abstract.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>

enum { PEM_MAX = 1 << 20 };

static int read_pem(const char *path, mode_t refused, char **ret_text, struct orl_error *err)
{
    struct stat st;
    char *text = NULL;
    int rc = 0;
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st) != 0) {
        rc = orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", path, orl_open_reason(errno));
    } else if (st.st_size <= 0 || st.st_size > PEM_MAX) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "%s is not a PEM file", path);
    } else if (st.st_mode & refused) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "everyone on this machine can read the key %s",
                           path);
        orl_error_hint(err, "Remove this permission with chmod o=");
    } else {
        text = calloc(1, (size_t)st.st_size + 1);
        if (!text)
            rc = orl_error_no_memory(err);
        else if (read(fd, text, (size_t)st.st_size) != st.st_size)
            rc = orl_error_set(err, ORL_ERR_IO, "cannot read all of %s", path);
    }
    if (fd >= 0)
        close(fd);
    if (rc)
        free(text);
    else
        *ret_text = text;
    return rc;
}

/* ---- Certificates --------------------------------------------------------------------------- */

enum { CHAIN_MAX = 16 };

struct orl_certificate {
    gnutls_pcert_st chain[CHAIN_MAX];
    unsigned count;
    gnutls_privkey_t key;
    struct orl_certificate *older;
    uint64_t last_user; /* once replaced: the newest connection that may have been given it */
};

static const struct orl_tls *serving;

static void certificate_free(struct orl_certificate *certificate)
{
    for (unsigned i = 0; i < certificate->count; i++)
        gnutls_pcert_deinit(&certificate->chain[i]);
    if (certificate->key)
        gnutls_privkey_deinit(certificate->key);
    free(certificate);
}

static gnutls_datum_t datum_of(char *text)
{
    return (gnutls_datum_t){(unsigned char *)text, (unsigned)strlen(text)};
}

/* Checks that the first certificate has the key's public half. Returns a GnuTLS code. */
static int check_pair(const struct orl_certificate *certificate)
{
    unsigned char of_key[64], of_cert[64];
    size_t n_key = sizeof of_key, n_cert = sizeof of_cert;
    gnutls_pubkey_t half = NULL;
    int rc = gnutls_pubkey_init(&half);
    if (rc < 0)
        return rc;
    rc = gnutls_pubkey_import_privkey(half, certificate->key, 0, 0);
    if (rc >= 0)
        rc = gnutls_pubkey_get_key_id(half, GNUTLS_KEYID_USE_SHA256, of_key, &n_key);
    if (rc >= 0)
        rc = gnutls_pubkey_get_key_id(certificate->chain[0].pubkey, GNUTLS_KEYID_USE_SHA256,
                                      of_cert, &n_cert);
    gnutls_pubkey_deinit(half);
    if (rc >= 0 && (n_key != n_cert || memcmp(of_key, of_cert, n_key) != 0))
        rc = GNUTLS_E_CERTIFICATE_KEY_MISMATCH;
    return rc;
}

/* Imports chain and key from PEM text. Returns a GnuTLS code. */
static int import_pem(struct orl_certificate *certificate, char *cert, char *key)
{
    const gnutls_datum_t cert_pem = datum_of(cert), key_pem = datum_of(key);
    unsigned count = CHAIN_MAX;
    int rc = gnutls_pcert_list_import_x509_raw(certificate->chain, &count, &cert_pem,
                                               GNUTLS_X509_FMT_PEM, 0);
    if (rc < 0)
        return rc;
    certificate->count = count;
    if (count == 0)
        return GNUTLS_E_NO_CERTIFICATE_FOUND;
    rc = gnutls_privkey_init(&certificate->key);
    if (rc >= 0)
        rc = gnutls_privkey_import_x509_raw(certificate->key, &key_pem, GNUTLS_X509_FMT_PEM, NULL,
                                            0);
    return rc < 0 ? rc : check_pair(certificate);
}

static int load_certificate(const char *cert_path, const char *key_path, char **ret_cert,
                            char **ret_key, struct orl_error *err)
{
    const int rc = read_pem(cert_path, 0, ret_cert, err);
    return rc ? rc : read_pem(key_path, S_IROTH | S_IWOTH, ret_key, err);
}

int orl_tls_load(struct orl_tls *tls, const char *cert_path, const char *key_path,
                 uint64_t newest_connection, struct orl_error *err)
{
    char *cert = NULL, *key = NULL;
    struct orl_certificate *certificate = NULL;
    int rc = load_certificate(cert_path, key_path, &cert, &key, err);
    if (cert && key) {
        certificate = calloc(1, sizeof *certificate);
        if (!certificate)
            rc = orl_error_no_memory(err);
    }
    const int code = certificate ? import_pem(certificate, cert, key) : 0;
    if (code < 0) {
        rc = orl_error_set(err, ORL_ERR_INVALID, "certificate %.150s, key %.150s: %s", cert_path,
                           key_path, gnutls_strerror(code));
        certificate_free(certificate);
    } else if (certificate) {
        certificate->older = tls->current;
        if (tls->current)
            tls->current->last_user = newest_connection;
        tls->current = certificate;
        serving = tls;
    }
    if (key)
        sodium_memzero(key, strlen(key));
    free(key);
    free(cert);
    return rc;
}

void orl_tls_free_older(struct orl_tls *tls, uint64_t oldest_handshake)
{
    struct orl_certificate **at = tls->current ? &tls->current->older : NULL;
    /* The list goes from the newest to the oldest, so last_user only falls. */
    while (at && *at && (*at)->last_user >= oldest_handshake)
        at = &(*at)->older;
    while (at && *at) {
        struct orl_certificate *certificate = *at;
        *at = certificate->older;
        certificate_free(certificate);
    }
}

void orl_tls_done(struct orl_tls *tls)
{
    while (tls->current) {
        struct orl_certificate *certificate = tls->current;
        tls->current = certificate->older;
        certificate_free(certificate);
    }
    if (serving == tls)
        serving = NULL;
}

static int retrieve_certificate(gnutls_session_t session, const gnutls_datum_t *names, int n_names,
                                const gnutls_pk_algorithm_t *kinds, int n_kinds,
                                gnutls_pcert_st **ret_chain, unsigned *ret_count,
                                gnutls_privkey_t *ret_key)
{
    (void)session, (void)names, (void)n_names, (void)kinds, (void)n_kinds;
    if (!serving || !serving->current)
        return -1;
    *ret_chain = serving->current->chain;
    *ret_count = serving->current->count;
    *ret_key = serving->current->key;
    return 0;
}

uintptr_t orl_tls_callback(void)
{
    return (uintptr_t)retrieve_certificate;
}
