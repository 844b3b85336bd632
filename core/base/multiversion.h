/*
 * Function multiversioning: functions are compiled for the base architecture and for 256-bit
 * vectors. The form is selected when the program is loaded. The build does not contract products
 * and sums, so both forms give the same bits.
 */
#ifndef ORL_BASE_MULTIVERSION_H
#define ORL_BASE_MULTIVERSION_H

/* Sanitizers are not ready when the resolver runs. */
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_ADDRESS__) &&                  \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define ORL_FOR_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define ORL_FOR_WIDE_VECTORS
#endif

/* For functions that such a function calls in its inner loop: a call that is not inlined runs code
 * for the base architecture. */
#define ORL_ALWAYS_INLINE static inline __attribute__((always_inline))

#endif
