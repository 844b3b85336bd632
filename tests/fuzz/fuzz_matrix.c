/* Radiance matrix files. The body is arbitrary bytes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "annual/matrices/imported_matrices.h"
#include "fuzz/fuzz.h"

bool fuzz_matrix(const uint8_t *data, size_t size)
{
    struct orl_rgb_matrix matrix = {.rows = 0};
    struct orl_error err = {0};
    /* A block of exactly the input's size lets AddressSanitizer detect reads past its end. */
    char *exact = malloc(size ? size : 1);
    FUZZ_PROMISE(exact != NULL);
    if (size > 0)
        memcpy(exact, data, size);
    const int code = orl_rgb_matrix_read("sky.smx", exact, size, &matrix, &err);
    free(exact);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(strcmp(err.file, "sky.smx") == 0);
        FUZZ_PROMISE(matrix.values == NULL);
        return false;
    }
    FUZZ_PROMISE(matrix.rows > 0 && matrix.columns > 0);
    for (size_t i = 0; i < 3 * matrix.rows * matrix.columns; i++)
        FUZZ_PROMISE(isfinite(matrix.values[i]));
    orl_rgb_matrix_done(&matrix);
    return true;
}
