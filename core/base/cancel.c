/* The one question in a file of its own: a test that links a function of this name instead sees
 * every poll there is (tests/unit/test_reader_polls.c). */
#include <oriel/crew.h>

bool orl_is_cancelled(const atomic_bool *cancel)
{
    return cancel && atomic_load_explicit(cancel, memory_order_relaxed);
}
