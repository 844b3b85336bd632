/*
 * Runs the built `oriel` as a child, as a script would: arguments in; exit code and both outputs
 * out. The program is $ORIEL_BUILD/oriel (default build/oriel).
 */
#ifndef ORL_TESTS_SUPPORT_CLI_H
#define ORL_TESTS_SUPPORT_CLI_H

#include <stddef.h>
#include <sys/types.h>

enum { CLI_OUTPUT_MAX = 65536 };

struct cli_result {
    int exit_code;                                 /* -1 if a signal ended it */
    char out[CLI_OUTPUT_MAX], err[CLI_OUTPUT_MAX]; /* truncated if longer; always end in NUL */
};

/* A running child; its outputs go to temporary files. */
struct cli_child {
    pid_t pid;
    int out_fd, err_fd;
};

/* Starts another built program, "orield". */
struct cli_child cli_start_program(const char *name, const char *const *args);
/* Reads what the child has written to standard output so far; text holds CLI_OUTPUT_MAX bytes. */
void cli_peek(const struct cli_child *child, char *ret_text);

/* Starts oriel. args ends with NULL and omits the program's name. Fails the test if it cannot
 * start. */
struct cli_child cli_start(const char *const *args);
void cli_finish(struct cli_child *child, struct cli_result *ret_result);
void cli_run(const char *const *args, struct cli_result *ret_result);
/* Runs the command with both outputs in one file (`> log 2>&1`); out and err are then equal. */
void cli_run_merged(const char *const *args, struct cli_result *ret_result);

/* Create a temporary folder; remove it. path holds at least 64 bytes. */
void cli_make_folder(char *path);
void cli_remove_folder(const char *path);
void cli_write_file(const char *folder, const char *name, const char *text);
/* Returns the file's text, NUL-terminated and owned (free()), or NULL if the file is missing. */
char *cli_read_file(const char *folder, const char *name);

/* A folder with a document and the files that it names; output goes to a subfolder. */
struct cli_desk {
    char folder[64], document[96], output[96];
    struct cli_result result; /* result of the last run */
};

struct cli_file {
    const char *name, *text;
};

/* cmocka's set-up and tear-down. The document is the first of the files; a file without a name ends
 * the list. */
int cli_desk_set_up(void **state, const struct cli_file *files);
int cli_desk_tear_down(void **state);

#endif
