/* Which of the two formats a file is in. */
#include "fit/rows.h"

#include <string.h>

#include "base/number.h"

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

/* The word at the front is a number, maybe "nan" or "inf". */
static bool begins_number(const char *text, size_t size)
{
    double value;
    size_t length = 0;
    while (length < size && !is_blank(text[length]) && !strchr("\n,;", text[length]))
        length++;
    return orl_number_read(text, length, &value) != ORL_NUMBER_NOT_ONE;
}

/* A CSV is told by a first line of words. */
static bool is_csv(const char *text, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const char c = text[i];
        if (c == '#') {
            const char *end = memchr(text + i, '\n', size - i);
            if (!end)
                return false;
            i = (size_t)(end - text);
        } else if (c != '\n' && !is_blank(c)) {
            const bool is_word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"';
            return is_word && !begins_number(text + i, size - i);
        }
    }
    return false;
}

int orl_fit_read(const char *name, uint32_t file, const char *text, size_t size,
                 const struct orl_fit_reading *reading, struct orl_fit_data *data,
                 struct orl_error *err)
{
    static const char mark[] = "\xef\xbb\xbf";
    struct orl_fit_lines lines = {.name = name, .file = file, .at = text, .reading = reading};
    if (size >= 3 && memcmp(text, mark, 3) == 0) {
        lines.at += 3;
        size -= 3;
    }
    lines.end = lines.at + size;
    const bool csv = is_csv(lines.at, size);
    return csv ? orl_fit_read_csv(&lines, data, err) : orl_fit_read_pab(&lines, data, err);
}
