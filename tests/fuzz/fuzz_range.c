/* The Range header: the first two bytes are the file's size, the rest is the header. */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "http/request/parse_request.h"

bool fuzz_range(const uint8_t *data, size_t size)
{
    if (size < 2)
        return false;
    const uint64_t bytes = (uint64_t)data[0] | (uint64_t)data[1] << 8;
    struct orl_range range = {0, 0};
    char *header = strndup((const char *)data + 2, size - 2);
    FUZZ_PROMISE(header != NULL);
    const enum orl_range_kind kind = orl_range_parse(header, bytes, &range);
    FUZZ_PROMISE(kind == ORL_RANGE_ALL || kind == ORL_RANGE_PART || kind == ORL_RANGE_NONE);
    if (kind == ORL_RANGE_PART) {
        FUZZ_PROMISE(range.count > 0 && range.count <= bytes);
        FUZZ_PROMISE(range.first <= bytes - range.count);
    } else {
        FUZZ_PROMISE(range.first == 0 && range.count == 0);
    }
    free(header);
    return kind == ORL_RANGE_PART;
}
