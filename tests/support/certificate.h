/*
 * A self-signed test certificate for localhost, 127.0.0.1 and 0.0.0.0.
 */
#ifndef ORL_TESTS_SUPPORT_CERTIFICATE_H
#define ORL_TESTS_SUPPORT_CERTIFICATE_H

/* Writes both as PEM files; only the owner can read the key. Fails the running test on error. */
void certificate_make(const char *cert_path, const char *key_path);

#endif
