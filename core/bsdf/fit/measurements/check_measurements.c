/* Checks of measurements before a fit. */
#include <oriel/bsdf/bsdf_fit.h>
#include <stdio.h>
#include <string.h>

#include "base/text/words.h"
#include "bsdf/fit/measurements/measurements.h"

/* Returns the first line that is not a comment or empty; length 0 if there is none. */
static struct orl_slice first_line(struct orl_scanner scanner)
{
    struct orl_slice line = {"", 0};
    while (orl_scanner_line(&scanner, &line)) {
        struct orl_slice rest = line;
        const struct orl_slice word = orl_slice_take_word(&rest);
        if (word.length > 0 && word.text[0] != '#')
            return line;
    }
    return (struct orl_slice){"", 0};
}

static bool contains_name(struct orl_slice line, const char *name)
{
    const size_t length = strlen(name);
    for (size_t i = 0; i + length <= line.length; i++)
        if (strncasecmp(line.text + i, name, length) == 0)
            return true;
    return false;
}

/* Returns the number of leading characters that are in `of`. */
static size_t length_of(struct orl_slice word, const char *of)
{
    size_t n = 0;
    while (n < word.length && word.text[n] != '\0' && strchr(of, word.text[n]))
        n++;
    return n;
}

/* Returns true for a number, also if misspelt or not finite ("nan", "inf"). */
static bool is_number(struct orl_slice word)
{
    double value;
    const bool of_digits =
        length_of(word, "0123456789.+-eE") == word.length && length_of(word, ".+-eE") < word.length;
    return of_digits || orl_number_read(word.text, word.length, &value) != ORL_NUMBER_INVALID;
}

/* Returns true for two numbers and a third word, which may mark a missing value. In a scene file
 * the second word is a primitive's type, not a number. */
static bool is_row(struct orl_slice line)
{
    for (int i = 0; i < 2; i++)
        if (!is_number(orl_slice_take_word(&line)))
            return false;
    return orl_slice_take_word(&line).length > 0;
}

/* Returns true for a header of pab-opto's text, which identifies a file without rows: "#format:
 * theta phi DSF". */
static bool has_format(struct orl_scanner scanner)
{
    struct orl_slice line;
    while (orl_scanner_line(&scanner, &line)) {
        if (line.length > 0 && line.text[0] != '#')
            return false;
        if (line.length == 0)
            continue;
        line.text++;
        line.length--;
        if (orl_slice_is_nocase(orl_slice_take_word(&line), "format:") &&
            orl_slice_is_nocase(orl_slice_take_word(&line), "theta") &&
            orl_slice_is_nocase(orl_slice_take_word(&line), "phi"))
            return true;
    }
    return false;
}

bool orl_bsdf_is_measured(const char *text, size_t size)
{
    struct orl_scanner scanner;
    if (orl_scanner_init(&scanner, NULL, text, size, 0, NULL) < 0)
        return false;
    const struct orl_slice line = first_line(scanner);
    return is_row(line) || (contains_name(line, "theta_in") && contains_name(line, "theta_out")) ||
           has_format(scanner);
}

int orl_bsdf_measurements_check(const char *const *files, size_t count,
                                const struct orl_files *provider, struct orl_bsdf_measurements *ret,
                                struct orl_error *err)
{
    const struct orl_fit_read_options options = {.reversed = false};
    struct orl_fit_data data = {0};
    int code = 0;
    for (uint32_t i = 0; i < count && code == 0; i++)
        code = orl_fit_read_file(provider, files[i], i, &options, &data, err);
    *ret = (struct orl_bsdf_measurements){.rows = data.n_rows, .directions = data.n_scans};
    snprintf(ret->sample, sizeof ret->sample, "%s", data.name);
    orl_fit_data_done(&data);
    return code;
}
