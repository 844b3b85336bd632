/*
 * The commands of `oriel`: one file per command (cmd_*.c), a static table in main.c, and the small
 * option parser they share (options.c).
 *
 * Exit codes: 0 done, 1 failed (the reason is on stderr), 2 the command line is invalid. For
 * verify, 2 also means that there is nothing to compare with.
 *
 * Standard output has results for scripts (an id, a table, JSON); progress and errors go to stderr.
 * Standard output is flushed at the end of each line. So a log of both (`> log 2>&1`) has whole
 * lines in the order in which they were written.
 */
#ifndef ORL_CLIENT_OPTIONS_COMMAND_H
#define ORL_CLIENT_OPTIONS_COMMAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum orl_exit { ORL_EXIT_OK = 0, ORL_EXIT_FAILED = 1, ORL_EXIT_USAGE = 2 };

struct orl_subcommand {
    const char *name;
    const char *synopsis; /* arguments after "oriel NAME" */
    const char *summary;  /* one line, for the list of commands */
    const char *details;  /* a paragraph for --help, or NULL */
    int (*run)(const struct orl_subcommand *self, int argc, char **argv); /* argv[0] is the name */
    const char *example; /* a command line, or NULL */
};

/* Last line of every --help. */
#define ORL_GUIDE_LINE "Guide: /guide of a running daemon, such as http://127.0.0.1:8423/guide"

/* One option: a flag when metavar is NULL, else it takes a value. Exactly one target is set. */
struct orl_option {
    const char *name; /* without the dashes: "output" */
    char letter;      /* 'o', or 0 */
    /* "DIR"; words that are given as they are: "text|json". Completion is made from it (client/
     * packaging). */
    const char *metavar;
    const char *help;
    const char **value;
    bool *flag;
};

/* Operands: the arguments that are left when options are removed. Borrows from argv. */
struct orl_operands {
    char **items;
    int count;
};

/*
 * Parses argv against the options; "--" ends them. Returns true if the command should continue.
 * Returns false with *ret_exit set if help was printed or the line is invalid (reported on
 * stderr).
 */
bool orl_options_parse(const struct orl_subcommand *self, int argc, char **argv,
                       const struct orl_option *options, size_t n_options, int min_operands,
                       int max_operands, struct orl_operands *ret_operands, int *ret_exit);

/* Reports an error of the command line, with a hint to --help; returns ORL_EXIT_USAGE. */
int orl_usage_error(const struct orl_subcommand *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reads a whole number in [min, max]; returns false for any other text. */
bool orl_parse_count(const char *text, uint64_t min, uint64_t max, uint64_t *ret_value);

/* The --server option of every command that talks to a daemon. */
#define ORL_OPTION_SERVER(target)                                                                  \
    {                                                                                              \
        .name = "server", .metavar = "SERVER",                                                     \
        .help = "daemon: a URL, or a name in ~/.config/oriel.toml (default: $ORIEL_URL, or that "  \
                "file's server, or http://127.0.0.1:8423)",                                        \
        .value = (target)                                                                          \
    }

int orl_cmd_run(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_part(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_project(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_plan(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_annual(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_recipe(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_study(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_submit(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_status(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_wait(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_fetch(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_cancel(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_watch(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_list(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_link(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_remove(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_maps(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_upload(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf(const struct orl_subcommand *self, int argc, char **argv);
/* Verbs of bsdf; argv[0] is the verb, such as "make". */
int orl_cmd_bsdf_fit(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_make(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_convert(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_compare(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_plot(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_verify(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_glare(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_health(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv);

#endif
