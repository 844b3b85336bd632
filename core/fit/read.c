/* Which of the two formats a file is in. */
#include "fit/rows.h"

#include <string.h>

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
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
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"';
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
