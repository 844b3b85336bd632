#include "base/checksum.h"

#include <string.h>

#include "base/random.h"

static const uint64_t odd = 0x9fb21c651e98df25ULL;

void orl_checksum_init(struct orl_checksum *sum)
{
    for (unsigned i = 0; i < ORL_CHECKSUM_LANES; i++)
        sum->lanes[i] = orl_mix64(i + 1);
    sum->size = 0;
}

static inline void add_block(uint64_t lanes[ORL_CHECKSUM_LANES], const unsigned char *block)
{
    for (size_t i = 0; i < ORL_CHECKSUM_LANES; i++) {
        uint64_t word;
        memcpy(&word, block + 8 * i, sizeof word);
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
        word = __builtin_bswap64(word);
#endif
        word ^= lanes[i];
        lanes[i] = (word << 29 | word >> 35) * odd;
    }
}

void orl_checksum_add(struct orl_checksum *sum, const void *data, size_t size)
{
    const unsigned char *at = data;
    uint64_t lanes[ORL_CHECKSUM_LANES];
    sum->size += size;
    memcpy(lanes, sum->lanes, sizeof lanes);
    for (; size >= ORL_CHECKSUM_BLOCK; size -= ORL_CHECKSUM_BLOCK, at += ORL_CHECKSUM_BLOCK)
        add_block(lanes, at);
    if (size > 0) {
        unsigned char last[ORL_CHECKSUM_BLOCK] = {0};
        memcpy(last, at, size);
        add_block(lanes, last);
    }
    memcpy(sum->lanes, lanes, sizeof lanes);
}

void orl_checksum_finish(const struct orl_checksum *sum, unsigned char ret[ORL_CHECKSUM_BYTES])
{
    uint64_t all = orl_mix64(sum->size);
    for (unsigned i = 0; i < ORL_CHECKSUM_LANES; i++)
        all = orl_mix64(all ^ sum->lanes[i]);
    for (unsigned i = 0; i < ORL_CHECKSUM_BYTES / 8; i++) {
        const uint64_t word = orl_mix64(sum->lanes[i] + all) ^ sum->lanes[i + 4];
        for (unsigned k = 0; k < 8; k++)
            ret[8 * i + k] = (unsigned char)(word >> 8 * k);
    }
}

void orl_checksum_of(const void *data, size_t size, unsigned char ret[ORL_CHECKSUM_BYTES])
{
    struct orl_checksum sum;
    orl_checksum_init(&sum);
    orl_checksum_add(&sum, data, size);
    orl_checksum_finish(&sum, ret);
}
