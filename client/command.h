/*
 * The commands of `oriel`: one file per command (cmd_*.c), a static table in main.c, and the small
 * option parser they share (options.c).
 *
 * Exit codes: 0 done, 1 failed (the reason is on stderr), 2 the command line makes no sense; or, of
 * verify, there is nothing to compare with.
 * Standard output carries what a script wants (an id, a table, JSON); everything else, progress
 * and errors, goes to stderr.
 * Standard output is flushed at the end of each line, so that in a log of both (`> log 2>&1`) lines
 * stand whole and in the order in which they were written.
 */
#ifndef ORL_CLIENT_COMMAND_H
#define ORL_CLIENT_COMMAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum orl_exit { ORL_EXIT_OK = 0, ORL_EXIT_FAILED = 1, ORL_EXIT_USAGE = 2 };

struct orl_subcommand {
    const char *name;
    const char *synopsis; /* what follows "oriel NAME" */
    const char *summary;  /* one line, for the list of commands */
    const char *details;  /* a paragraph for --help, or NULL */
    int (*run)(const struct orl_subcommand *self, int argc, char **argv); /* argv[0] is the name */
};

/* One option: a flag when metavar is NULL, else it takes a value. Exactly one target is set. */
struct orl_option {
    const char *name;    /* without the dashes: "output" */
    char letter;         /* 'o', or 0 */
    const char *metavar; /* "DIR" */
    const char *help;
    const char **value;
    bool *flag;
};

/* What is left of the command line when the options are taken out. Borrows from argv. */
struct orl_operands {
    char **items;
    int count;
};

/*
 * Parses argv against the options; "--" ends them. Returns true when the command should go on;
 * false when help was asked for or the line is wrong (said on stderr), with the exit code set.
 */
bool orl_options_parse(const struct orl_subcommand *self, int argc, char **argv,
                       const struct orl_option *options, size_t n_options, int min_operands,
                       int max_operands, struct orl_operands *ret_operands, int *ret_exit);

/* Says what is wrong with the command line, and where help is; returns ORL_EXIT_USAGE. */
int orl_usage_error(const struct orl_subcommand *self, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Reads a whole number in [min, max]; false when text is anything else. */
bool orl_parse_count(const char *text, uint64_t min, uint64_t max, uint64_t *ret_value);

/* The option every command that talks to a daemon has. */
#define ORL_OPTION_SERVER(target)                                                                  \
    {                                                                                              \
        .name = "server", .metavar = "URL",                                                        \
        .help = "the daemon (default: $ORIEL_URL, or http://127.0.0.1:8423)", .value = (target)    \
    }

int orl_cmd_run(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_part(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_project(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_plan(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_annual(const struct orl_subcommand *self, int argc, char **argv);
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
/* Of which argv[0] is "make". */
int orl_cmd_bsdf_fit(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_make(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_convert(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_compare(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_bsdf_plot(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_verify(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_glare(const struct orl_subcommand *self, int argc, char **argv);
int orl_cmd_version(const struct orl_subcommand *self, int argc, char **argv);

#endif
