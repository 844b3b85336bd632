/*
 * Functions compiled twice, for any machine of the family and for those with vectors of 256 bits;
 * which form runs is found out when the program is loaded. The build allows no contraction of
 * products and sums, so that both forms give the same bits.
 */
#ifndef ORL_BASE_VECTORS_H
#define ORL_BASE_VECTORS_H

/* Sanitizers instrument what runs before they are ready. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) &&                  \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define ORL_FOR_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define ORL_FOR_WIDE_VECTORS
#endif

#endif
