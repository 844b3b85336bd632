/*
 * A certificate of a test's own, signed by itself, for localhost, 127.0.0.1 and 0.0.0.0.
 */
#ifndef ORL_TESTS_SUPPORT_CERTIFICATE_H
#define ORL_TESTS_SUPPORT_CERTIFICATE_H

/* Writes both as PEM files, the key readable by the owner alone. Fails the running test. */
void certificate_make(const char *cert_path, const char *key_path);

#endif
