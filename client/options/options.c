/* The option parser: each command has a table of options, from which the help is made too. */
#include "options/command.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/suggest.h>

#include "output/style.h"
#include "output/terminal.h"

int orl_usage_error(const struct orl_subcommand *self, const char *format, ...)
{
    va_list args;
    fprintf(stderr, "oriel %s: ", self->name);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fprintf(stderr, "\nTry `oriel %s --help`.\n", self->name);
    return ORL_EXIT_USAGE;
}

/* Prints an option's row, wrapped to the width of help texts. */
static void print_option(const struct orl_option *option)
{
    enum { HELP_COLUMN = 25 };
    char left[128]; /* a value may be all words of an enumeration */
    const int length =
        snprintf(left, sizeof left, "  %s%c%s--%s%s%s", option->letter ? "-" : "",
                 option->letter ? option->letter : ' ', option->letter ? ", " : "   ", option->name,
                 option->metavar ? " " : "", option->metavar ? option->metavar : "");
    if (length < HELP_COLUMN)
        printf("%-*s", HELP_COLUMN, left);
    else
        printf("%s\n%*s", left, HELP_COLUMN, "");
    orl_print_wrapped(stdout, ORL_HELP_COLUMNS, HELP_COLUMN, HELP_COLUMN, option->help);
}

static void print_help(const struct orl_subcommand *self, const struct orl_option *options,
                       size_t n)
{
    static const struct orl_option help = {
        .name = "help", .letter = 'h', .help = "print this text"};
    printf("usage: oriel %s %s\n\n%s.\n", self->name, self->synopsis, self->summary);
    if (self->details) {
        putchar('\n');
        orl_print_wrapped(stdout, ORL_HELP_COLUMNS, 0, 0, self->details);
    }
    printf("\n%soptions%s\n", orl_style_begin(stdout, ORL_STYLE_HEADING), orl_style_end(stdout));
    for (size_t i = 0; i < n; i++)
        print_option(&options[i]);
    print_option(&help);
    if (self->example)
        printf("\n%sexample%s\n  %s\n", orl_style_begin(stdout, ORL_STYLE_HEADING),
               orl_style_end(stdout), self->example);
    printf("\n" ORL_GUIDE_LINE "\n");
}

/* Finds the option that an argument names. *ret_value points after '=' or the letter, or is
 * NULL. */
static const struct orl_option *find_option(const char *arg, const struct orl_option *options,
                                            size_t n, const char **ret_value)
{
    const bool is_long = arg[1] == '-';
    const char *name = arg + 2, *equals = is_long ? strchr(name, '=') : NULL;
    const size_t length = equals ? (size_t)(equals - name) : strlen(name);
    for (size_t i = 0; i < n; i++) {
        if (is_long && strlen(options[i].name) == length &&
            strncmp(options[i].name, name, length) == 0) {
            *ret_value = equals ? equals + 1 : NULL;
            return &options[i];
        }
        if (!is_long && options[i].letter && arg[1] == options[i].letter) {
            *ret_value = arg[2] ? arg + 2 : NULL;
            return &options[i];
        }
    }
    return NULL;
}

/* Reports an unknown option, and suggests one. */
static int refuse_option(const struct orl_subcommand *self, const char *arg,
                         const struct orl_option *options, size_t n)
{
    char name[ORL_SUGGEST_LETTERS + 1];
    struct orl_suggestion suggestion = {.word = name};
    const size_t dashes = strspn(arg, "-");
    snprintf(name, sizeof name, "%.*s", (int)strcspn(arg + dashes, "="), arg + dashes);
    for (size_t i = 0; i < n; i++)
        orl_suggestion_add(&suggestion, options[i].name);
    orl_suggestion_add(&suggestion, "help");
    if (!suggestion.best)
        return orl_usage_error(self, "unknown option \"%s\"", arg);
    return orl_usage_error(self, "unknown option \"%s\"; did you mean \"--%s\"?", arg,
                           suggestion.best);
}

/* Reads one option at argv[*at] with its value. Returns 0 or an exit code. */
static int take_option(const struct orl_subcommand *self, int argc, char **argv, int *at,
                       const struct orl_option *options, size_t n)
{
    const char *value = NULL;
    const struct orl_option *option = find_option(argv[*at], options, n, &value);
    if (!option)
        return refuse_option(self, argv[*at], options, n);
    if (!option->metavar) {
        if (value)
            return orl_usage_error(self, "--%s takes no value", option->name);
        *option->flag = true;
        return 0;
    }
    if (!value && *at + 1 < argc)
        value = argv[++*at];
    if (!value)
        return orl_usage_error(self, "--%s needs a value: %s", option->name, option->metavar);
    *option->value = value;
    return 0;
}

bool orl_options_parse(const struct orl_subcommand *self, int argc, char **argv,
                       const struct orl_option *options, size_t n_options, int min_operands,
                       int max_operands, struct orl_operands *ret_operands, int *ret_exit)
{
    int count = 0;
    bool only_operands = false;
    for (int i = 1; i < argc; i++) {
        if (only_operands || argv[i][0] != '-' || argv[i][1] == '\0') {
            argv[1 + count++] = argv[i]; /* overwrites only arguments that were already read */
        } else if (strcmp(argv[i], "--") == 0) {
            only_operands = true;
        } else if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            print_help(self, options, n_options);
            *ret_exit = ORL_EXIT_OK;
            return false;
        } else {
            *ret_exit = take_option(self, argc, argv, &i, options, n_options);
            if (*ret_exit)
                return false;
        }
    }
    if (count < min_operands || count > max_operands) {
        *ret_exit = orl_usage_error(self, "%s operands; usage: oriel %s %s",
                                    count < min_operands ? "missing" : "too many", self->name,
                                    self->synopsis);
        return false;
    }
    *ret_operands = (struct orl_operands){argv + 1, count};
    return true;
}

bool orl_parse_count(const char *text, uint64_t min, uint64_t max, uint64_t *ret_value)
{
    char *end;
    unsigned long long value;
    if (text[0] < '0' || text[0] > '9')
        return false;
    errno = 0;
    value = strtoull(text, &end, 10);
    if (errno || *end || value < min || value > max)
        return false;
    *ret_value = value;
    return true;
}
