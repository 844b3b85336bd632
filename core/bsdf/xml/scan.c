#include "bsdf/xml/data_text.h"

#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/scanner.h>

#include "base/text/words.h"

void orl_scan_init(struct orl_scan *scan)
{
    memset(scan, 0, sizeof *scan);
}

void orl_scan_feed(struct orl_scan *scan, const char *piece, size_t size)
{
    scan->next = piece;
    scan->end = piece + size;
}

void orl_scan_finish(struct orl_scan *scan)
{
    scan->next = scan->end = NULL;
    scan->finished = true;
}

static const bool separators[256] = {
    [' '] = true, ['\n'] = true, ['\t'] = true, ['\r'] = true, [','] = true};

static inline bool is_separator(char c)
{
    return separators[(unsigned char)c];
}

static inline bool ends_number(char c)
{
    return is_separator(c) || c == '{' || c == '}';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

int orl_number_parse(const char *text, size_t length, double *ret_value, struct orl_error *err)
{
    const size_t skip = length > 0 && (*text == '-' || *text == '+');
    const int shown = (int)(length < 40 ? length : 40);
    double value = 0;
    const enum orl_number_fault fault = orl_number_read(text, length, &value);
    if (fault == ORL_NUMBER_OK && fabs(value) <= ORL_BSDF_VALUE_MAX) {
        *ret_value = value;
        return 0;
    }
    if (length - skip >= 3 &&
        (!strncasecmp(text + skip, "nan", 3) || !strncasecmp(text + skip, "inf", 3)))
        return orl_error_set(err, ORL_ERR_RANGE, "'%.*s' is not a finite number", shown, text);
    if (fault != ORL_NUMBER_INVALID)
        return orl_error_set(err, ORL_ERR_RANGE, "'%.*s' is too large: at most %g is accepted",
                             shown, text, ORL_BSDF_VALUE_MAX);
    if (orl_slice_is_decimal_comma((struct orl_slice){text, length}))
        return orl_error_set(err, ORL_ERR_SYNTAX, "%.*s: a decimal comma; write it with a point",
                             shown, text);
    return orl_error_set(err, ORL_ERR_SYNTAX, "'%.*s' is not a number", shown, text);
}

/* ---- Fast path ------------------------------------------------------------------------------ */

enum { WORD_DIGITS = 8 };

/*
 * Returns the number of leading digits among the eight characters at p, and sets their value. The
 * digits are added in place: to pairs, then fours, then eight.
 */
static inline unsigned read_word(const char *p, uint64_t *ret_value)
{
    uint64_t x, others;
    unsigned count = WORD_DIGITS;
    memcpy(&x, p, sizeof x);
    x ^= UINT64_C(0x3030303030303030);
    others = ((x + UINT64_C(0x7676767676767676)) | x) & UINT64_C(0x8080808080808080);
    if (others)
        count = (unsigned)__builtin_ctzll(others) >> 3;
    *ret_value = 0;
    if (count == 0)
        return 0;
    x <<= 8 * (WORD_DIGITS - count); /* puts zeros in front */
    x = (x & UINT64_C(0x00ff00ff00ff00ff)) * 10 + (x >> 8 & UINT64_C(0x00ff00ff00ff00ff));
    x = (x & UINT64_C(0x0000ffff0000ffff)) * 100 + (x >> 16 & UINT64_C(0x0000ffff0000ffff));
    *ret_value = (x & UINT64_C(0xffffffff)) * 10000 + (x >> 32);
    return count;
}

/*
 * Reads a number in a common printed form: up to eight digits, a point, up to eight more, an
 * exponent of up to two digits. Returns its end and the same value as orl_number_parse. Returns
 * NULL for other forms, for numbers that one operation on exact doubles does not give, and for a
 * number that may continue after end.
 */
static inline const char *read_quickly(const char *p, const char *end, double *ret_value)
{
    enum { LONGEST = 2 * WORD_DIGITS + 8 };
    static const uint32_t tens[] = {1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};
    static const double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                    1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                    1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    uint64_t value, fraction;
    unsigned count, more = 0;
    int exponent = 0;
    if (end - p < LONGEST || __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__)
        return NULL;
    count = read_word(p, &value);
    p += count;
    if (*p == '.') {
        more = read_word(++p, &fraction);
        p += more;
        value = value * tens[more] + fraction;
        exponent = -(int)more;
    }
    if (count + more == 0)
        return NULL;
    if (*p == 'e' || *p == 'E') {
        const bool negative = *++p == '-';
        unsigned power = 0, digits = 0;
        p += negative || *p == '+';
        for (; digits < 2 && is_digit(*p); digits++)
            power = 10 * power + (unsigned)(*p++ - '0');
        if (digits == 0)
            return NULL;
        exponent += negative ? -(int)power : (int)power;
    }
    if (value > UINT64_C(1) << 53 || exponent < -22 || exponent > 22)
        return NULL;
    const double number =
        exponent < 0 ? (double)value / powers[-exponent] : (double)value * powers[exponent];
    if (!ends_number(*p) || !(number <= ORL_BSDF_VALUE_MAX))
        return NULL;
    *ret_value = number;
    return p;
}

/* ---- Tokens ---------------------------------------------------------------------------------- */

/* Appends the part of a cut number that is in the current piece. */
static int extend_partial(struct orl_scan *scan, struct orl_error *err)
{
    const char *p = scan->next;
    size_t length;
    while (p < scan->end && !ends_number(*p))
        p++;
    length = (size_t)(p - scan->next);
    if (length > sizeof scan->partial - scan->partial_length)
        return orl_error_set(err, ORL_ERR_SYNTAX, "a number is longer than %d characters",
                             ORL_SCAN_TOKEN_MAX);
    if (length > 0) /* after orl_scan_finish there is no piece to copy from */
        memcpy(scan->partial + scan->partial_length, scan->next, length);
    scan->partial_length += length;
    scan->next = p;
    return 0;
}

/* Completes a number that began in an earlier piece, if the current piece or the end of input
 * completes it. */
static int next_from_partial(struct orl_scan *scan, double *ret_value, struct orl_error *err)
{
    int code = extend_partial(scan, err);
    if (code < 0)
        return code;
    if (scan->next == scan->end && !scan->finished)
        return ORL_TOKEN_NONE;
    code = orl_number_parse(scan->partial, scan->partial_length, ret_value, err);
    scan->partial_length = 0;
    return code < 0 ? code : ORL_TOKEN_NUMBER;
}

int orl_scan_next(struct orl_scan *scan, double *ret_value, struct orl_error *err)
{
    const char *start;
    int code;
    if (scan->partial_length > 0)
        return next_from_partial(scan, ret_value, err);
    while (scan->next < scan->end && is_separator(*scan->next))
        scan->next++;
    if (scan->next == scan->end)
        return ORL_TOKEN_NONE;
    if (*scan->next == '{' || *scan->next == '}')
        return *scan->next++ == '{' ? ORL_TOKEN_OPEN : ORL_TOKEN_CLOSE;
    start = scan->next;
    const char *const quick = read_quickly(start, scan->end, ret_value);
    if (quick) {
        scan->next = quick;
        return ORL_TOKEN_NUMBER;
    }
    while (scan->next < scan->end && !ends_number(*scan->next))
        scan->next++;
    if (scan->next == scan->end) {
        scan->next = start;
        return next_from_partial(scan, ret_value, err);
    }
    code = orl_number_parse(start, (size_t)(scan->next - start), ret_value, err);
    return code < 0 ? code : ORL_TOKEN_NUMBER;
}
