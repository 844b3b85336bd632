#include "process/runner_options.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_PARTS = 1000, MOST_THREADS = 1024, MOST_SECONDS = 1000000 };
enum { USUAL_PARTS = 64, USUAL_LEAST_S = 60 };

const char *const orl_runner_named[ORL_RUNNER_NAMED] = {"partition", "account", "qos",
                                                        "constraint"};

void orl_runner_options_init(struct orl_runner_options *options)
{
    *options = (struct orl_runner_options){
        .parts = USUAL_PARTS, .part_threads = 1, .least_s = USUAL_LEAST_S};
}

static int parse_count(const char *name, const char *value, unsigned long least, unsigned long most,
                       uint32_t *ret_number, struct orl_error *err)
{
    char *end = NULL;
    errno = 0;
    const unsigned long number = strtoul(value, &end, 10);
    if (errno || !isdigit((unsigned char)value[0]) || *end || number < least || number > most)
        return orl_error_set(err, ORL_ERR_INVALID, "%s takes a number from %lu to %lu, not '%s'",
                             name, least, most, value);
    *ret_number = (uint32_t)number;
    return 0;
}

static int parse_runner(struct orl_runner_options *options, const char *value,
                        struct orl_error *err)
{
    options->slurm = strcmp(value, "slurm") == 0;
    return options->slurm || strcmp(value, "local") == 0
               ? 0
               : orl_error_set(err, ORL_ERR_INVALID, "--runner takes local or slurm, not '%s'",
                               value);
}

/* Appends an option of sbatch, which gets an argument vector. It would take a word that is not an
 * option for its script. */
static int add_word(struct orl_runner_options *options, const char *value, struct orl_error *err)
{
    if (value[0] != '-' || options->n_words == ORL_RUNNER_WORDS)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "--slurm-option takes one option of sbatch, as --time=60, and may be "
                             "given %d times; '%s' is none",
                             ORL_RUNNER_WORDS, value);
    options->words[options->n_words++] = value;
    return 0;
}

static bool parse_named(struct orl_runner_options *options, const char *name, const char *value)
{
    static const char start[] = "--slurm-";
    for (size_t i = 0; i < ORL_RUNNER_NAMED; i++)
        if (strncmp(name, start, strlen(start)) == 0 &&
            strcmp(name + strlen(start), orl_runner_named[i]) == 0) {
            options->named[i] = value;
            return true;
        }
    return false;
}

int orl_runner_options_apply(struct orl_runner_options *options, const char *name,
                             const char *value, bool *ret_known, struct orl_error *err)
{
    int rc = 0;
    *ret_known = true;
    if (strcmp(name, "--runner") == 0)
        return parse_runner(options, value, err);
    if (strcmp(name, "--slurm-option") == 0)
        rc = add_word(options, value, err);
    else if (strcmp(name, "--shared") == 0)
        options->shared = value;
    else if (strcmp(name, "--parts") == 0)
        rc = parse_count(name, value, 1, MOST_PARTS, &options->parts, err);
    else if (strcmp(name, "--part-threads") == 0)
        rc = parse_count(name, value, 1, MOST_THREADS, &options->part_threads, err);
    else if (strcmp(name, "--least") == 0)
        rc = parse_count(name, value, 0, MOST_SECONDS, &options->least_s, err);
    else
        *ret_known = parse_named(options, name, value);
    options->any = options->any || *ret_known;
    return rc;
}

int orl_runner_options_check(const struct orl_runner_options *options, struct orl_error *err)
{
    if (options->any && !options->slurm)
        return orl_error_set(err, ORL_ERR_INVALID,
                             "--shared, --parts, --part-threads, --least and --slurm-... go with "
                             "--runner slurm");
    if (!options->slurm || options->shared)
        return 0;
    orl_error_set(err, ORL_ERR_INVALID, "--runner slurm needs --shared DIR");
    orl_error_hint(err, "DIR is a folder of this user's that all nodes see by the same path");
    return ORL_ERR_INVALID;
}
