/* orield: reads its settings, prepares the process, and serves until a signal stops it. */
#include <archive.h>
#include <gnutls/gnutls.h>
#include <malloc.h>
#include <microhttpd.h>
#include <signal.h>
#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <uv.h>

#include "checks/child/child_checks.h"
#include "commit.h"
#include "handlers/handlers.h"
#include "maintenance/scrub.h"
#include "process/config.h"
#include "process/limits.h"
#include "process/signals.h"
#include "result/version_report.h"
#include "server.h"

static void announce(const char *url)
{
    printf("listening on %s\n", url);
}

/*
 * Makes free return large blocks to the system: they are always mappings of their own. By default,
 * glibc allocates blocks of up to 32 MiB on the heap once one such block has been freed. The gaps
 * between them then stay allocated: hundreds of MiB after a few dozen jobs.
 */
static void give_memory_back(void)
{
    enum { LARGE = 256 << 10 };
    mallopt(M_MMAP_THRESHOLD, LARGE);
}

/* Raises the limit of descriptors to the maximum, since every client takes one. */
static void raise_file_limit(void)
{
    struct rlimit files;
    if (getrlimit(RLIMIT_NOFILE, &files) == 0) {
        files.rlim_cur = files.rlim_max;
        setrlimit(RLIMIT_NOFILE, &files);
    }
}

static int print_error(const struct orl_error *err, int status)
{
    char text[3 * ORL_ERROR_TEXT_MAX];
    orl_error_format(err, text, sizeof text);
    fprintf(stderr, "orield: %s\n", text);
    return status;
}

/* Prints the version, and as JSON if that is the next argument. */
static int print_version(const char *next)
{
    enum { LIBRARIES = 5 };
    struct orl_library_version libraries[LIBRARIES];
    struct orl_error err;
    const int archive = archive_version_number(); /* 3006002 is 3.6.2 */
    const char *const known[LIBRARIES][2] = {{"SQLite", sqlite3_libversion()},
                                             {"libmicrohttpd", MHD_get_version()},
                                             {"libuv", uv_version_string()},
                                             {"GnuTLS", gnutls_check_version(NULL)},
                                             {"libarchive", ""}};
    for (int i = 0; i < LIBRARIES; i++) {
        libraries[i].name = known[i][0];
        snprintf(libraries[i].version, sizeof libraries[i].version, "%s", known[i][1]);
    }
    snprintf(libraries[LIBRARIES - 1].version, sizeof libraries[0].version, "%d.%d.%d",
             archive / 1000000, archive / 1000 % 1000, archive % 1000);
    const struct orl_version_report report = {.program = "orield",
                                              .commit = ORL_COMMIT,
                                              .libraries = libraries,
                                              .n_libraries = LIBRARIES};
    const bool as_json = next && strcmp(next, "--json") == 0;
    return orl_version_report_print(stdout, &report, as_json, &err) ? print_error(&err, 1) : 0;
}

int main(int argc, char **argv)
{
    struct orl_config config;
    struct orl_error err;
    enum orl_config_action action;
    char pool[16];
    setvbuf(stdout, NULL, _IOLBF, 0); /* keeps lines in order if stdout and stderr go to one log */
    umask(077);                       /* stored data is private to the daemon's user */
    if (sodium_init() < 0) {
        fprintf(stderr, "orield: no source of random numbers\n");
        return 1;
    }
    if (argc == 3 && strcmp(argv[1], ORL_FORK_SERVER_MODE) == 0)
        return orl_fork_server_main(argv[2]);
    if (argc > 1 && (strcmp(argv[1], "scrub") == 0 || strcmp(argv[1], "backup") == 0))
        return orl_store_command(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "token") == 0)
        return orl_token_command(argc - 1, argv + 1);
    if (orl_config_parse(argc, argv, &config, &action, &err))
        return print_error(&err, 2);
    if (action == ORL_CONFIG_HELP) {
        orl_config_help(stdout);
        return 0;
    }
    if (action == ORL_CONFIG_VERSION)
        return print_version(argv[argc - 1]);
    /* libuv reads this before its first work and never again. */
    snprintf(pool, sizeof pool, "%u", config.threads + ORL_SERVER_IO_THREADS);
    setenv("UV_THREADPOOL_SIZE", pool, 1);
    raise_file_limit();
    give_memory_back();
    signal(SIGPIPE, SIG_IGN); /* a write to a client that has disconnected then returns an error */
    orl_signal_ignore(SIGHUP);
    signal(SIGXFSZ, SIG_IGN); /* so does a write that grows a file beyond ulimit -f */
    if (orl_server_run(&config, &orl_routes, announce, &err))
        return print_error(&err, 1);
    return 0;
}
