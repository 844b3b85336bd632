/* MGF geometry: the scene text is bounded by the size of the input, and each refusal names a
 * place. */
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz.h"
#include "scene/generate/mgf/mgf.h"

/* Serves each include with the whole input again, under another name. */
static int open_again(void *ctx, const char *folder, const char *name,
                      struct orl_mgf_text *ret_text, struct orl_error *err)
{
    /* One letter each; static, because they must outlive the reader that uses them. */
    static char names[64][8];
    const struct orl_mgf_text *const whole = ctx;
    char *const own = names[name[0] & 63];
    FUZZ_PROMISE(folder != NULL);
    if (name[0] == '?')
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no such file");
    own[0] = (char)('A' + (name[0] & 63));
    *ret_text = *whole;
    ret_text->file = own;
    return 0;
}

bool fuzz_mgf(const uint8_t *data, size_t size)
{
    struct orl_text text = {0};
    struct orl_error err = {0};
    char *exact = malloc(size ? size : 1);
    FUZZ_PROMISE(exact != NULL);
    if (size > 0)
        memcpy(exact, data, size);
    struct orl_mgf_text whole = {
        .file = "panel.mgf", .folder = "", .line = 1, .data = exact, .size = size};
    const struct orl_mgf mgf = {
        .text = whole, .open = open_again, .ctx = &whole, .unit_m = 0.01, .emission = 1};
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
