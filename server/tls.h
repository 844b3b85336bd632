/*
 * Certificate and private key of HTTPS, as libmicrohttpd's GnuTLS wants them: PEM text.
 */
#ifndef ORL_SERVER_TLS_H
#define ORL_SERVER_TLS_H

#include <oriel/error.h>

struct orl_tls {
    char *cert, *key; /* NUL-ended text; NULL: none */
};

/* What GnuTLS is to speak: TLS 1.2 and 1.3, with its own choice of strong ciphers. */
#define ORL_TLS_PRIORITIES "NORMAL:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:%SERVER_PRECEDENCE"

/* Reads both files; a key that everyone on the machine can read is refused. */
int orl_tls_load(const char *cert_path, const char *key_path, struct orl_tls *ret_tls,
                 struct orl_error *err);
void orl_tls_done(struct orl_tls *tls); /* wipes the key; a zeroed struct is fine */

#endif
