/* Passes libFuzzer's inputs to one target. Compiled once per target, with FUZZ_TARGET set to the
 * target's function. */
#include "fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FUZZ_TARGET(data, size);
    return 0;
}
