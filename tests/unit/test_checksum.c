/* The checksum of stored files: the changes that it must detect. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "base/io/checked_file.h"
#include "base/sampling/sampling.h"

enum { SIZE = 1000 };

static void fill_data(unsigned char data[SIZE])
{
    struct orl_random random = orl_random_stream(1, ORL_PURPOSE_BENCH, 0);
    for (size_t i = 0; i < SIZE; i++)
        data[i] = (unsigned char)orl_random_bits(&random);
}

static bool same(const void *a, size_t size_a, const void *b, size_t size_b)
{
    unsigned char x[ORL_CHECKSUM_BYTES], y[ORL_CHECKSUM_BYTES];
    orl_checksum_of(a, size_a, x);
    orl_checksum_of(b, size_b, y);
    return memcmp(x, y, sizeof x) == 0;
}

static void every_bit_counts(void **state)
{
    unsigned char data[SIZE], copy[SIZE];
    (void)state;
    fill_data(data);
    memcpy(copy, data, SIZE);
    assert_true(same(data, SIZE, copy, SIZE));
    for (size_t bit = 0; bit < (size_t)8 * SIZE; bit++) {
        copy[bit / 8] ^= (unsigned char)(1U << bit % 8);
        assert_false(same(data, SIZE, copy, SIZE));
        copy[bit / 8] = data[bit / 8];
    }
}

/* Flips the same bit in two words, adjacent or far apart. */
static void two_bits_do_not_cancel(void **state)
{
    unsigned char data[SIZE], copy[SIZE];
    (void)state;
    fill_data(data);
    for (size_t bit = 0; bit < 512; bit++) {
        for (size_t apart = 8; apart <= 512; apart += 8) {
            memcpy(copy, data, SIZE);
            copy[bit / 8] ^= (unsigned char)(1U << bit % 8);
            copy[bit / 8 + apart] ^= (unsigned char)(1U << bit % 8);
            assert_false(same(data, SIZE, copy, SIZE));
        }
    }
}

/* Zeros at the end change the checksum. */
static void length_counts(void **state)
{
    const unsigned char zeros[SIZE] = {0};
    (void)state;
    for (size_t size = 0; size < 200; size++)
        for (size_t other = 0; other < size; other++)
            assert_false(same(zeros, size, zeros, other));
}

static void swapped_blocks_are_told(void **state)
{
    unsigned char data[SIZE], copy[SIZE];
    (void)state;
    fill_data(data);
    for (size_t word = 8; word <= 128; word += 8) {
        memcpy(copy, data, SIZE);
        memcpy(copy, data + word, 8);
        memcpy(copy + word, data, 8);
        assert_false(same(data, SIZE, copy, SIZE));
    }
}

static void pieces_are_the_whole(void **state)
{
    unsigned char data[SIZE], whole[ORL_CHECKSUM_BYTES], pieces[ORL_CHECKSUM_BYTES];
    struct orl_checksum sum;
    (void)state;
    fill_data(data);
    orl_checksum_of(data, SIZE, whole);
    orl_checksum_init(&sum);
    for (size_t at = 0; at < SIZE; at += 192)
        orl_checksum_add(&sum, data + at, SIZE - at < 192 ? SIZE - at : 192);
    orl_checksum_finish(&sum, pieces);
    assert_memory_equal(whole, pieces, sizeof whole);
}

/* Values are those of xxHash with seed 0, because files outlive the program that wrote them. */
static void it_stays_what_it_is(void **state)
{
    static const unsigned char wanted[ORL_CHECKSUM_BYTES] = {0x99, 0xaa, 0x06, 0xd3, 0x01, 0x47,
                                                             0x98, 0xd8, 0x60, 0x01, 0xc3, 0x24,
                                                             0x46, 0x8d, 0x49, 0x7f};
    unsigned char sum[ORL_CHECKSUM_BYTES];
    (void)state;
    orl_checksum_of("", 0, sum);
    assert_memory_equal(sum, wanted, sizeof wanted);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bit_counts),     cmocka_unit_test(two_bits_do_not_cancel),
        cmocka_unit_test(length_counts),        cmocka_unit_test(swapped_blocks_are_told),
        cmocka_unit_test(pieces_are_the_whole), cmocka_unit_test(it_stays_what_it_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
