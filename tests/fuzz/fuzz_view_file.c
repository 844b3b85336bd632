/* Files with one view per line. The first line of the input selects a view: a number, a name, or
 * none. */
#include <stdlib.h>
#include <string.h>

#include <oriel/job/run.h>

#include "fuzz/fuzz.h"
#include "render/film/film.h"

enum { ENTRY_MAX = 63 };

bool fuzz_view_file(const uint8_t *data, size_t size)
{
    const char *text = (const char *)data, *newline = size > 0 ? memchr(text, '\n', size) : NULL;
    char entry[ENTRY_MAX + 1] = "", *found = NULL;
    struct orl_error err = {0};
    struct orl_view view;
    if (!newline || newline - text > ENTRY_MAX || memchr(text, '\0', (size_t)(newline - text)))
        return false;
    memcpy(entry, text, (size_t)(newline - text));
    const size_t rest = size - (size_t)(newline + 1 - text);
    /* A copy of exact size lets AddressSanitizer detect reads past its end. */
    char *lines = malloc(rest ? rest : 1);
    FUZZ_PROMISE(lines != NULL);
    memcpy(lines, newline + 1, rest);
    const int code =
        orl_view_file_read("views.vf", lines, rest, *entry ? entry : NULL, &found, &err);
    free(lines);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(found == NULL);
        return false;
    }
    FUZZ_PROMISE(orl_view_parse(found, &view, &err) == 0);
    free(found);
    return true;
}
