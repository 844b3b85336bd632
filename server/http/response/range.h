/*
 * The Range header (RFC 9110, 14): one range of bytes. Invalid headers and those with several
 * ranges are ignored, as the standard allows.
 */
#ifndef ORL_SERVER_HTTP_RESPONSE_RANGE_H
#define ORL_SERVER_HTTP_RESPONSE_RANGE_H

#include <stdint.h>

enum orl_range_kind {
    ORL_RANGE_ALL,  /* no valid range: the whole file */
    ORL_RANGE_PART, /* the range */
    ORL_RANGE_NONE, /* a range that holds no byte of the file */
};

struct orl_range {
    uint64_t first, count;
};

/* Parses the header for a file of that size. *ret_range is set only for ORL_RANGE_PART. */
enum orl_range_kind orl_range_parse(const char *header, uint64_t size, struct orl_range *ret_range);

#endif
