#include "output/wrap.h"

#include <string.h>

static const char space[] = " \t\r\n";

/* Returns the number of bytes of the character at text, 1 or more; a character takes one column. */
static size_t character_bytes(const char *text)
{
    size_t length = 1;

    while (((unsigned char)text[length] & 0xc0) == 0x80)
        length++;
    return length;
}

static int count_columns(const char *text, size_t length)
{
    int count = 0;

    for (size_t at = 0; at < length; at += character_bytes(text + at))
        count++;
    return count;
}

static void start_line(FILE *to, int indent)
{
    fprintf(to, "\n%*s", indent, "");
}

/* Prints one word from column on, cut at the line's end. Returns the column after it. */
static int print_word(FILE *to, int column, int indent, const char *word, size_t length)
{
    for (size_t at = 0; at < length;) {
        const size_t step = character_bytes(word + at);
        const unsigned char first = (unsigned char)word[at];

        if (column >= ORL_WRAP_COLUMNS && indent < ORL_WRAP_COLUMNS) {
            start_line(to, indent);
            column = indent;
        }
        if (first < 32 || first == 127)
            fputc('?', to);
        else
            fwrite(word + at, 1, step, to);
        at += step;
        column++;
    }
    return column;
}

void orl_print_wrapped(FILE *to, int column, int indent, const char *text)
{
    for (int number = 0;; number++) {
        text += strspn(text, space);
        const size_t length = strcspn(text, space);

        if (length == 0)
            break;
        if (number > 0 && column + 1 + count_columns(text, length) > ORL_WRAP_COLUMNS) {
            start_line(to, indent);
            column = indent;
        } else if (number > 0) {
            fputc(' ', to);
            column++;
        }
        column = print_word(to, column, indent, text, length);
        text += length;
    }
    fputc('\n', to);
}
