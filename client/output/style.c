#include "output/style.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

bool orl_terminal_can_rewrite(FILE *to)
{
    const char *term = getenv("TERM");
    return isatty(fileno(to)) && term && *term && strcmp(term, "dumb") != 0;
}

static bool has_color(FILE *to)
{
    const char *refused = getenv("NO_COLOR");
    return orl_terminal_can_rewrite(to) && !(refused && *refused);
}

const char *orl_style_begin(FILE *to, enum orl_style style)
{
    static const char *const codes[] = {"",         "\033[1m",  "\033[32m",
                                        "\033[33m", "\033[31m", "\033[2m"};
    return has_color(to) ? codes[style] : "";
}

const char *orl_style_end(FILE *to)
{
    return has_color(to) ? "\033[0m" : "";
}

int orl_terminal_columns(FILE *to)
{
    struct winsize window;
    return ioctl(fileno(to), TIOCGWINSZ, &window) == 0 && window.ws_col > 0 ? window.ws_col : 80;
}

enum orl_style orl_style_of_word(const char *word)
{
    static const struct {
        const char *word;
        enum orl_style style;
    } words[] = {{"pass", ORL_STYLE_GOOD},         {"succeeded", ORL_STYLE_GOOD},
                 {"fail", ORL_STYLE_BAD},          {"failed", ORL_STYLE_BAD},
                 {"intolerable", ORL_STYLE_BAD},   {"disturbing", ORL_STYLE_WARNING},
                 {"undecided", ORL_STYLE_WARNING}, {"cancelled", ORL_STYLE_WARNING}};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(words[i].word, word) == 0)
            return words[i].style;
    return ORL_STYLE_PLAIN;
}
