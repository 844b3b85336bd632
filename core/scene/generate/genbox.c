#include "scene/generate/generate.h"

#include <string.h>

/*
 * A box from the origin to size. Corner k has bit 0 set for the far x, bit 1 for y, bit 2 for z;
 * a face is called after its corners. Inverted, near and far change places, which turns every face
 * inside out and keeps the names.
 */
static void add_face(struct orl_text *text, const char *material, const char *name,
                     const double size[3], bool inverted, const char corners[5])
{
    orl_text_add(text, "'%s' polygon '%s.%s'\n0\n0\n12\n", material, name, corners);
    for (int i = 0; i < 4; i++) {
        const int k = corners[i] - '0';
        for (int axis = 0; axis < 3; axis++) {
            const bool far = ((k >> axis & 1) != 0) != inverted;
            orl_text_add(text, " %.17g", far ? size[axis] : 0.0);
        }
        orl_text_add(text, "\n");
    }
}

static int read_options(struct orl_words *words, bool *inverted, struct orl_error *err)
{
    while (words->left > 0) {
        const char *option = *words->at++;
        words->left--;
        if (strcmp(option, "-i") == 0) {
            *inverted = true;
        } else if (strlen(option) == 2 && option[0] == '-' && strchr("brnso", option[1])) {
            orl_error_set(err, ORL_ERR_UNSUPPORTED, "genbox: option '%s' is not supported", option);
            orl_error_hint(err, "include the output of genbox instead of the command");
            return ORL_ERR_UNSUPPORTED;
        } else {
            return orl_error_set(err, ORL_ERR_SYNTAX, "genbox: '%.40s' is no option", option);
        }
    }
    return 0;
}

int orl_genbox(const char *const *words, size_t count, struct orl_text *text, struct orl_error *err)
{
    static const char faces[6][5] = {"1540", "4620", "2310", "3267", "5137", "6457"};
    struct orl_words rest = {"genbox", NULL, 0};
    double size[3] = {0, 0, 0};
    bool inverted = false;
    int code = 0;
    if (count < 6)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "genbox needs a material, a name and three sizes");
    rest.at = words + 3;
    rest.left = count - 3;
    if (strchr(words[1], '\'') || strchr(words[2], '\''))
        return orl_error_set(err, ORL_ERR_SYNTAX, "genbox: quotes in names are not allowed");
    for (int axis = 0; axis < 3 && code == 0; axis++) {
        code = orl_words_number(&rest, "a size", size + axis, err);
        if (code == 0 && size[axis] <= 0)
            code = orl_error_set(err, ORL_ERR_RANGE, "genbox: size %g is not positive", size[axis]);
    }
    if (code == 0)
        code = read_options(&rest, &inverted, err);
    for (int face = 0; face < 6 && code == 0; face++)
        add_face(text, words[1], words[2], size, inverted, faces[face]);
    return code;
}
