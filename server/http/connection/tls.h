/*
 * Certificate and private key of HTTPS. GnuTLS asks for them with every handshake, so they can be
 * replaced while the daemon runs. Replaced ones stay until the handshakes under way are over.
 *
 * Threads: the loop thread only. One per process: GnuTLS's callback has no closure.
 */
#ifndef ORL_SERVER_HTTP_CONNECTION_TLS_H
#define ORL_SERVER_HTTP_CONNECTION_TLS_H

#include <stdint.h>

#include <oriel/base/error.h>

struct orl_certificate;

struct orl_tls {
    struct orl_certificate *current; /* NULL: none */
};

/* Protocols of GnuTLS: TLS 1.2 and 1.3, with its default choice of strong ciphers. */
#define ORL_TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:%SERVER_PRECEDENCE"

/*
 * Reads both PEM files, and serves them from now on; invalid ones change nothing. A key that every
 * user of the machine can read is refused, and so is a key that does not match the certificate.
 * newest_connection: serial number of the last connection that may use the previous certificate.
 */
int orl_tls_load(struct orl_tls *tls, const char *cert_path, const char *key_path,
                 uint64_t newest_connection, struct orl_error *err);
/* Frees the certificates that were replaced before any connection from oldest_handshake on. */
void orl_tls_free_older(struct orl_tls *tls, uint64_t oldest_handshake);
void orl_tls_done(struct orl_tls *tls); /* wipes the keys; a zeroed struct is allowed */

/* Returns the value for MHD_OPTION_HTTPS_CERT_CALLBACK, as a number. */
uintptr_t orl_tls_callback(void);

#endif
