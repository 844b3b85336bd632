/* This function has its own file so that a test can link another definition in its place and
 * observe every poll (tests/unit/test_reader_polls.c). */
#include <oriel/base/thread_pool.h>

bool orl_is_cancelled(const atomic_bool *cancel)
{
    return cancel && atomic_load_explicit(cancel, memory_order_relaxed);
}
