/* Detects the format of a file and reads it. */
#include "bsdf/fit/measurements/rows.h"

#include "base/text/number.h"

/* Returns true if the word begins with a number, including "nan" or "inf". */
static bool begins_number(struct orl_slice word)
{
    double value;
    size_t length = 0;
    while (length < word.length && word.text[length] != ',' && word.text[length] != ';')
        length++;
    return orl_number_read(word.text, length, &value) != ORL_NUMBER_INVALID;
}

/* Returns true for a CSV, which is recognised by a first line of words. */
static bool is_csv(const struct orl_scanner *scanner)
{
    struct orl_scanner ahead = *scanner;
    struct orl_slice word;
    while (orl_scanner_next_line(&ahead)) {
        if (!orl_scanner_word_of_line(&ahead, &word) || *word.text == '#')
            continue;
        const char c = *word.text;
        const bool is_word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '"';
        return is_word && !begins_number(word);
    }
    return false;
}

int orl_fit_read(const char *name, uint32_t file, const char *text, size_t size,
                 const struct orl_fit_read_options *options, struct orl_fit_data *data,
                 struct orl_error *err)
{
    struct orl_fit_lines lines = {.file = file, .options = options};
    const int code = orl_scanner_init(&lines.scanner, name, text, size, 0, err);
    if (code < 0)
        return code;
    const bool csv = is_csv(&lines.scanner);
    return csv ? orl_fit_read_csv(&lines, data, err) : orl_fit_read_pab(&lines, data, err);
}
