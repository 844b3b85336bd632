#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text/words.h"

/* Parsed decimal number: (negative ? - : +) digits * 10^exponent, if exact. */
struct decimal {
    uint64_t digits;
    int exponent;
    bool negative, exact; /* exact: no digit was dropped and the exponent is small */
};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Reads a run of digits. Digits past the 19th do not fit and make the number inexact. */
static const char *read_digits(const char *at, const char *end, struct decimal *number, int step)
{
    for (; at < end && is_digit(*at); at++) {
        if (number->digits >= UINT64_C(1000000000000000000)) {
            number->exact = false;
            continue;
        }
        number->digits = number->digits * 10 + (uint64_t)(*at - '0');
        number->exponent += step;
    }
    return at;
}

static const char *read_exponent(const char *at, const char *end, struct decimal *number)
{
    int value = 0;
    bool negative = false;
    if (at < end && (*at == '-' || *at == '+'))
        negative = *at++ == '-';
    if (at >= end || !is_digit(*at))
        return NULL;
    for (; at < end && is_digit(*at); at++)
        value = value < 100000 ? value * 10 + (*at - '0') : value;
    number->exponent += negative ? -value : value;
    return at;
}

/* Checks the form; returns false if text is not a number. */
static bool parse_decimal(const char *text, size_t length, struct decimal *ret_number)
{
    const char *at = text, *end = text + length, *start;
    struct decimal number = {0, 0, false, true};
    if (at < end && (*at == '-' || *at == '+'))
        number.negative = *at++ == '-';
    start = at;
    at = read_digits(at, end, &number, 0);
    bool any = at > start;
    if (at < end && *at == '.') {
        start = ++at;
        at = read_digits(at, end, &number, -1);
        any = any || at > start;
    }
    if (!any)
        return false;
    if (at < end && (*at == 'e' || *at == 'E')) {
        at = read_exponent(at + 1, end, &number);
        if (!at)
            return false;
    }
    *ret_number = number;
    return at == end;
}

static bool is_nan_or_inf(const char *text, size_t length)
{
    static const char *const names[] = {"nan", "inf", "infinity"};
    if (length > 0 && (*text == '-' || *text == '+'))
        text++, length--;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strlen(names[i]) == length && strncasecmp(names[i], text, length) == 0)
            return true;
    return false;
}

/* Reads the number by strtod: slower and exact, for long mantissas and large exponents. */
static double read_by_strtod(const char *text, size_t length)
{
    char buffer[512];
    char *copy = length < sizeof buffer ? buffer : malloc(length + 1);
    double value = NAN;
    if (copy) {
        memcpy(copy, text, length);
        copy[length] = '\0';
        value = strtod(copy, NULL);
    }
    if (copy != buffer)
        free(copy);
    return value;
}

enum orl_number_fault orl_number_read(const char *text, size_t length, double *ret_value)
{
    static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    struct decimal number;
    double value;
    if (!parse_decimal(text, length, &number))
        return is_nan_or_inf(text, length) ? ORL_NUMBER_INFINITE : ORL_NUMBER_INVALID;
    /* Both factors are exact doubles, so that one operation rounds correctly (Clinger 1990). */
    if (number.exact && number.digits <= (UINT64_C(1) << 53) && abs(number.exponent) <= 22) {
        value = (double)number.digits;
        value =
            number.exponent < 0 ? value / tens[-number.exponent] : value * tens[number.exponent];
        *ret_value = number.negative ? -value : value;
        return ORL_NUMBER_OK;
    }
    value = read_by_strtod(text, length);
    if (!isfinite(value))
        return ORL_NUMBER_INFINITE;
    *ret_value = value;
    return ORL_NUMBER_OK;
}

enum orl_number_fault orl_number_read_int(const char *text, size_t length, int *ret_value)
{
    const char *at = text, *end = text + length;
    bool negative = false;
    int64_t value = 0;
    if (at < end && (*at == '-' || *at == '+'))
        negative = *at++ == '-';
    if (at >= end)
        return ORL_NUMBER_INVALID;
    for (; at < end; at++) {
        if (!is_digit(*at))
            return ORL_NUMBER_INVALID;
        value = value > 2000000000 ? value : value * 10 + (*at - '0');
    }
    if (value > 2000000000)
        return ORL_NUMBER_INFINITE;
    *ret_value = (int)(negative ? -value : value);
    return ORL_NUMBER_OK;
}

void orl_shell_words_add(struct orl_shell_words *shell_words, const char *format, ...)
{
    char *word = shell_words->text[shell_words->count];
    va_list args;
    va_start(args, format);
    vsnprintf(word, ORL_SHELL_WORD_BYTES, format, args);
    va_end(args);
    shell_words->words[shell_words->count++] = word;
}
