/* Certificates that are reloaded repeatedly: memory, and the lifetime of earlier ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <malloc.h>
#include <stdio.h>
#include <string.h>

#include "http/connection/connections.h"
#include "process/limits.h"
#include "support/certificate.h"
#include "support/cli.h"

struct fixture {
    char folder[64], cert[80], key[80];
    struct orl_tls tls;
};

static int set_up(void **state)
{
    static struct fixture f;
    memset(&f, 0, sizeof f);
    cli_make_folder(f.folder);
    snprintf(f.cert, sizeof f.cert, "%s/cert.pem", f.folder);
    snprintf(f.key, sizeof f.key, "%s/key.pem", f.folder);
    certificate_make(f.cert, f.key);
    *state = &f;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *f = *state;
    orl_tls_done(&f->tls);
    cli_remove_folder(f->folder);
    return 0;
}

#if ORL_SANITIZED
/* Returns the bytes in use by the sanitizer's allocator. It is declared here because gcc's packages
 * lack its header, <sanitizer/allocator_interface.h>. */
extern size_t __sanitizer_get_current_allocated_bytes(void);
#endif

/* Returns the bytes of all allocated blocks. */
static size_t memory(void)
{
#if ORL_SANITIZED
    return __sanitizer_get_current_allocated_bytes();
#else
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
#endif
}

static void load(struct fixture *f, uint64_t newest_connection)
{
    struct orl_error err;
    assert_int_equal(orl_tls_load(&f->tls, f->cert, f->key, newest_connection, &err), 0);
}

static size_t grown(size_t before)
{
    const size_t now = memory();
    return now > before ? now - before : 0;
}

/* A certificate and its key take 10 kB. Small blocks that malloc keeps for later count as used. */
enum { RELOADS = 500, LEAST_BYTES = 1000, MOST_BYTES = 10000 };

/* Without handshakes in progress memory does not grow. */
static void test_reloads(void **state)
{
    struct fixture *f = *state;
    for (int i = 0; i < 10; i++) {
        load(f, 5);
        orl_tls_free_older(&f->tls, 6);
    }
    const size_t before = memory();
    for (int i = 0; i < RELOADS; i++) {
        load(f, 5);
        orl_tls_free_older(&f->tls, 6);
    }
    print_message("# %d reloads: %zu bytes more\n", RELOADS, grown(before));
    assert_true(grown(before) < MOST_BYTES);
}

/* Loads two more certificates, and frees three in turn. Returns the bytes that remain allocated. */
static size_t replace_certificates(struct fixture *f, uint64_t n)
{
    const size_t one = memory();
    load(f, n + 3); /* connections up to n + 3 may use the first, */
    load(f, n + 7); /* up to n + 7 the second */
    const size_t three = memory();
    assert_true(three - one > 2 * LEAST_BYTES);
    orl_tls_free_older(&f->tls, n + 3);
    assert_true(memory() == three);
    orl_tls_free_older(&f->tls, n + 4);
    assert_true(three - memory() > LEAST_BYTES);
    orl_tls_free_older(&f->tls, n + 7);
    assert_true(memory() - one > LEAST_BYTES);
    orl_tls_free_older(&f->tls, n + 8);
    return grown(one);
}

/* A certificate stays while a connection from its time may still be in its handshake. The library
 * may allocate memory of its own meanwhile, for random numbers; a leaked certificate would add
 * memory each time. */
static void test_handshakes(void **state)
{
    struct fixture *f = *state;
    bool gone = false;
    load(f, 0);
    for (int i = 0; i < 3 && !gone; i++)
        gone = replace_certificates(f, 10 * (uint64_t)i) < LEAST_BYTES;
    assert_true(gone);
}

/* The oldest connection that may be in its handshake, from counts that MHD would supply. */
static void test_oldest_handshake(void **state)
{
    struct orl_connections all = {.most = 10};
    (void)state;
    assert_int_equal(orl_connections_oldest_handshake(&all), 1);
    all.started = 9;
    assert_int_equal(orl_connections_oldest_handshake(&all), 10);
    all.unwatched = 1;
    assert_int_equal(orl_connections_oldest_handshake(&all), 0);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_reloads, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_handshakes, set_up, tear_down),
        cmocka_unit_test(test_oldest_handshake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
