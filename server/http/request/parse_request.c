#include <ctype.h>
#include <microhttpd.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "http/request/parse_request.h"
#include "process/limits.h"

const char *orl_target_split(const char *url, struct orl_target *ret_target, const char **ret_path)
{
    static const char http[] = "http://", https[] = "https://";
    struct orl_target target = {.https = strncasecmp(url, https, sizeof https - 1) == 0};
    const bool absolute = target.https || strncasecmp(url, http, sizeof http - 1) == 0;
    const char *authority = url + (target.https ? sizeof https : sizeof http) - 1;
    *ret_path = url;
    if (absolute) {
        const size_t length = strcspn(authority, "/");
        if (length == 0 || length >= sizeof target.authority)
            return "its target has an empty or too long authority";
        memcpy(target.authority, authority, length);
        if (strpbrk(target.authority, "@#\\ \t"))
            return "its target has more than host and port before the path";
        *ret_path = authority[length] ? authority + length : "/";
    }
    *ret_target = target;
    return NULL;
}

/* ---- Framing --------------------------------------------------------------------------------- */

/* Headers that give the host and the length of a request. */
struct framing {
    unsigned hosts, lengths, codings;
    bool chunked;      /* the last transfer coding is chunked */
    const char *end;   /* end of the previous version or value */
    const char *fault; /* first fault found */
};

/* Returns true for a header name: a token (RFC 9110, 5.6.2). A blank before the colon is not
 * allowed. */
static bool is_token(const char *name, size_t size)
{
    static const char others[] = "!#$%&'*+-.^_`|~";
    for (size_t i = 0; i < size; i++) {
        const char c = name[i], lower = (char)(c | 0x20);
        if (!(lower >= 'a' && lower <= 'z') && !(c >= '0' && c <= '9') &&
            (c == '\0' || !strchr(others, c)))
            return false;
    }
    return size > 0;
}

/* Returns true if there are no control characters but tabs (RFC 9110, 5.5). Some parsers end a line
 * at a lone CR. */
static bool is_value(const char *value, size_t size)
{
    for (size_t i = 0; i < size; i++)
        if (((unsigned char)value[i] < 0x20 && value[i] != '\t') || value[i] == 0x7f)
            return false;
    return true;
}

static void count_header(struct framing *framing, const char *name, const char *value)
{
    if (strcasecmp(name, MHD_HTTP_HEADER_HOST) == 0)
        framing->hosts++;
    else if (strcasecmp(name, MHD_HTTP_HEADER_CONTENT_LENGTH) == 0)
        framing->lengths++;
    else if (strcasecmp(name, MHD_HTTP_HEADER_TRANSFER_ENCODING) == 0) {
        framing->codings++;
        framing->chunked = strcasecmp(value, "chunked") == 0;
    }
}

/*
 * Returns true if this header follows directly after the previous one. libmicrohttpd 0.9 ends a
 * value at a NUL, and the headers at a line that begins with a NUL. It turns a continuation line
 * into another header. The bytes that it skipped show as a gap, since it parses in place. A line
 * must begin one or two bytes (LF or CRLF, which it has overwritten) after the end of the previous
 * line. Later versions refuse all of this themselves.
 */
static bool is_contiguous(const struct framing *framing, const char *at)
{
    return MHD_VERSION >= 0x01000000 || at == framing->end + 1 || at == framing->end + 2;
}

static const char *header_fault(const struct framing *framing, const char *name, size_t name_size,
                                const char *value, size_t value_size)
{
    if (!is_token(name, name_size))
        return "a header has an invalid name";
    if (!is_value(value, value_size))
        return "a header has control characters";
    if (!is_contiguous(framing, name))
        return "a header has no name, has a NUL, or continues on the next line";
    return NULL;
}

static enum MHD_Result check_header(void *ctx, enum MHD_ValueKind kind, const char *name,
                                    size_t name_size, const char *value, size_t value_size)
{
    struct framing *framing = ctx;
    (void)kind;
    value = value ? value : "";
    framing->fault = header_fault(framing, name, name_size, value, value_size);
    framing->end = value + value_size;
    if (!framing->fault)
        count_header(framing, name, value);
    return framing->fault ? MHD_NO : MHD_YES;
}

/* Returns true if the empty line that ends the headers follows directly after the last header. */
static bool has_contiguous_end(const struct framing *framing, struct MHD_Connection *connection,
                               const char *method)
{
    const union MHD_ConnectionInfo *info =
        MHD_get_connection_info(connection, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE);
    if (!info || MHD_VERSION >= 0x01000000)
        return true;
    const char *end = method + info->header_size;
    return is_contiguous(framing, end - 1) || is_contiguous(framing, end - 2);
}

const char *orl_framing_check(struct MHD_Connection *connection, const char *method,
                              const char *version)
{
    struct framing framing = {.end = version + strlen(version)};
    MHD_get_connection_values_n(connection, MHD_HEADER_KIND, check_header, &framing);
    if (framing.fault)
        return framing.fault;
    if (!has_contiguous_end(&framing, connection, method))
        return "a header has no name, has a NUL, or continues on the next line";
    if (framing.lengths > 1)
        return "it has more than one Content-Length";
    if (framing.codings > 0 && framing.lengths > 0)
        return "it has both Content-Length and Transfer-Encoding";
    if (framing.codings > 1 || (framing.codings == 1 && !framing.chunked))
        return "its Transfer-Encoding is not chunked";
    if (framing.hosts > 1)
        return "it has more than one Host";
    /* RFC 9112, 3.2 and 6.1: HTTP/1.0 had neither Host nor Transfer-Encoding. */
    const bool old = strcmp(version, MHD_HTTP_VERSION_1_0) == 0;
    if (framing.hosts == 0 && !old)
        return "it has no Host";
    return framing.codings > 0 && old ? "HTTP/1.0 has no Transfer-Encoding" : NULL;
}

bool orl_framing_cut_query(const char *uri)
{
    enum { EACH = 64 }; /* bytes that libmicrohttpd allocates for an argument */
    const char *query = strchr(uri, '?');
    size_t bytes = strlen(uri);
    for (const char *at = query; at; at = strchr(at + 1, '&'))
        bytes += EACH;
    if (bytes <= ORL_SERVER_URI_BYTES)
        return false;
    /* uri is libmicrohttpd's own buffer, in which it parses the arguments next. */
    if (query)
        ((char *)(uintptr_t)query)[1] = '\0';
    return true;
}

size_t orl_framing_unescape(char *text)
{
    return strstr(text, "%00") ? strlen(text) : MHD_http_unescape(text);
}

/* ---- Query arguments ------------------------------------------------------------------------- */

bool orl_query_count(const char *text, unsigned long most, unsigned long *ret_count)
{
    const size_t length = strlen(text);
    if (length == 0 || text[strspn(text, "0123456789")])
        return false;
    /* With too many digits the value is ULONG_MAX. */
    const unsigned long count = strtoul(text, NULL, 10);
    if (count < 1 || count > most)
        return false;
    *ret_count = count;
    return true;
}

bool orl_query_number(const char *text, double low, double high, double *ret_number)
{
    char *end;
    if (text[0] == '\0' || text[strspn(text, "0123456789+-.eE")])
        return false;
    const double number = strtod(text, &end);
    if (*end || !(number >= low) || !(number <= high))
        return false;
    *ret_number = number;
    return true;
}

/* ---- Content negotiation --------------------------------------------------------------------- */

/* Returns how specific a matching range is: 3 the name, 2 its type, 1 anything; 0: no match. */
static int closeness(const char *range, size_t length, const char *name)
{
    const char *slash = strchr(name, '/');
    const size_t type = slash ? (size_t)(slash - name) + 1 : 0;
    if (length == strlen(name) && strncasecmp(range, name, length) == 0)
        return 3;
    if (slash && length == type + 1 && range[type] == '*' && strncasecmp(range, name, type) == 0)
        return 2;
    if (slash)
        return length == 3 && memcmp(range, "*/*", 3) == 0;
    return length == 1 && *range == '*';
}

/* Reads a weight such as "0.8"; 0 if it is invalid. */
static double read_weight(const char *text)
{
    int thousandths = 0, place = 100;
    if (*text == '1')
        return 1;
    if (text[0] != '0' || text[1] != '.')
        return 0;
    for (text += 2; *text >= '0' && *text <= '9'; text++, place /= 10)
        thousandths += place * (*text - '0');
    return thousandths / 1000.0;
}

/* Returns the weight among the parameters up to the range's end; 1 if there is none. */
static double find_weight(const char *text, const char *end)
{
    while ((text = memchr(text, ';', (size_t)(end - text)))) {
        text++;
        text += strspn(text, " \t");
        if (text + 2 < end && strncasecmp(text, "q=", 2) == 0)
            return read_weight(text + 2);
    }
    return 1;
}

double orl_negotiate_weight(const char *header, const char *name)
{
    double weight = 0;
    int best = 0;
    for (const char *at = header; at && *at; at += *at == ',') {
        at += strspn(at, " \t");
        const char *end = at + strcspn(at, ",");
        const int close = closeness(at, strcspn(at, ",; \t"), name);
        if (close > best) {
            best = close;
            weight = find_weight(at, end);
        }
        at = end;
    }
    return weight;
}

/* ---- Range ----------------------------------------------------------------------------------- */

/* Reads a number; too large ones become UINT64_MAX. Returns false if there are no digits. */
static bool read_number(const char **at, uint64_t *ret_value)
{
    const char *start = *at;
    uint64_t value = 0;
    for (; isdigit((unsigned char)**at); ++*at) {
        const uint64_t digit = (uint64_t)(**at - '0');
        value = value > (UINT64_MAX - digit) / 10 ? UINT64_MAX : 10 * value + digit;
    }
    *ret_value = value;
    return *at != start;
}

enum orl_range_kind orl_range_parse(const char *header, uint64_t size, struct orl_range *ret_range)
{
    static const char unit[] = "bytes=";
    uint64_t first = 0, last = UINT64_MAX;
    if (strncasecmp(header, unit, sizeof unit - 1) != 0)
        return ORL_RANGE_ALL;
    const char *at = header + sizeof unit - 1;
    const bool has_first = read_number(&at, &first);
    if (*at++ != '-')
        return ORL_RANGE_ALL;
    const bool has_last = read_number(&at, &last);
    if (*at || (!has_first && !has_last) || (has_first && has_last && first > last))
        return ORL_RANGE_ALL;
    if (!has_first) { /* a suffix range: the last `last` bytes */
        if (last == 0 || size == 0)
            return ORL_RANGE_NONE;
        first = last < size ? size - last : 0;
        last = size - 1;
    }
    if (first >= size)
        return ORL_RANGE_NONE;
    if (!has_last || last > size - 1)
        last = size - 1;
    ret_range->first = first;
    ret_range->count = last - first + 1;
    return ORL_RANGE_PART;
}
