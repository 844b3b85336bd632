/*
 * A checksum of 256 bits that is as quick as reading: it tells files that were damaged, cut or
 * swapped, not ones that were forged.
 *
 * The bytes are dealt to eight lanes by words of eight, little-endian. Each step of a lane,
 *     h = rotate(h ^ word, 29) * odd number,
 * can be undone, so that two files that differ in one word of a lane never end alike, and others do
 * by a chance of 2^-64 a lane.
 */
#ifndef ORL_BASE_CHECKSUM_H
#define ORL_BASE_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

enum { ORL_CHECKSUM_BYTES = 32, ORL_CHECKSUM_LANES = 8, ORL_CHECKSUM_BLOCK = 64 };

struct orl_checksum {
    uint64_t lanes[ORL_CHECKSUM_LANES];
    uint64_t size;
};

/* Pieces but the last are of whole blocks. */
void orl_checksum_init(struct orl_checksum *sum);
void orl_checksum_add(struct orl_checksum *sum, const void *data, size_t size);
void orl_checksum_finish(const struct orl_checksum *sum, unsigned char ret[ORL_CHECKSUM_BYTES]);

/* The whole at once. */
void orl_checksum_of(const void *data, size_t size, unsigned char ret[ORL_CHECKSUM_BYTES]);

#endif
