/* Geometry in MGF: scene text that holds no more than there was, and a place for what is refused.
 */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "scene/generate/mgf.h"

bool fuzz_mgf(const uint8_t *data, size_t size)
{
    struct orl_text text = {0};
    struct orl_error err = {0};
    char *exact = malloc(size ? size : 1);
    FUZZ_PROMISE(exact != NULL);
    if (size > 0)
        memcpy(exact, data, size);
    const struct orl_mgf mgf = {
        .file = "panel.mgf", .line = 1, .data = exact, .size = size, .unit_m = 0.01, .emission = 1};
    const int code = orl_mgf_write(&mgf, &text, &err);
    free(exact);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(err.line >= 1);
    } else {
        FUZZ_PROMISE(text.failed || !text.data || strlen(text.data) == text.size);
    }
    orl_text_done(&text);
    return code == 0;
}
