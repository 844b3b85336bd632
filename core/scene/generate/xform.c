#include "scene/generate/xform.h"

#include <string.h>

#include <oriel/base/limits.h>

#include "base/text/words.h"

const struct orl_xform orl_xform_identity = {.row = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                             .scale = 1.0};

struct orl_xform orl_xform_compose(const struct orl_xform *outer, const struct orl_xform *inner)
{
    struct orl_xform both = {.scale = outer->scale * inner->scale,
                             .mirrored = outer->mirrored != inner->mirrored,
                             .inverted = outer->inverted != inner->inverted};
    for (int i = 0; i < 3; i++) {
        const struct orl_vec3 o = outer->row[i];
        both.row[i] = orl_add(orl_add(orl_scale(inner->row[0], o.x), orl_scale(inner->row[1], o.y)),
                              orl_scale(inner->row[2], o.z));
    }
    both.offset = orl_xform_point(outer, inner->offset);
    return both;
}

static int fail_option(struct orl_error *err, int code, const char *option, const char *what)
{
    return orl_error_set(err, code, "xform: option '%.40s' %s", option, what);
}

/* Reads the count numbers that must follow words[0]. */
static int numbers_after(const char *const *words, size_t n_words, size_t count, double *ret_values,
                         struct orl_error *err)
{
    if (n_words < count + 1)
        return fail_option(err, ORL_ERR_SYNTAX, words[0], "needs a number after it");
    for (size_t i = 0; i < count; i++) {
        const char *word = words[i + 1];
        const enum orl_number_fault fault = orl_number_read(word, strlen(word), ret_values + i);
        if (fault != ORL_NUMBER_OK)
            return orl_error_set(err, fault == ORL_NUMBER_INFINITE ? ORL_ERR_RANGE : ORL_ERR_SYNTAX,
                                 "xform: '%.40s' after option '%.40s' is not a finite number", word,
                                 words[0]);
    }
    return 0;
}

/* Returns a right-handed rotation about axis 0, 1 or 2. */
static struct orl_xform rotation(int axis, double angle_deg)
{
    const double c = cos(angle_deg * ORL_DEG_TO_RAD), s = sin(angle_deg * ORL_DEG_TO_RAD);
    struct orl_xform t = orl_xform_identity;
    if (axis == 0) {
        t.row[1] = orl_v3(0, c, -s);
        t.row[2] = orl_v3(0, s, c);
    } else if (axis == 1) {
        t.row[0] = orl_v3(c, 0, s);
        t.row[2] = orl_v3(-s, 0, c);
    } else {
        t.row[0] = orl_v3(c, -s, 0);
        t.row[1] = orl_v3(s, c, 0);
    }
    return t;
}

static struct orl_xform scaling(double x, double y, double z)
{
    struct orl_xform t = orl_xform_identity;
    t.row[0].x = x;
    t.row[1].y = y;
    t.row[2].z = z;
    t.scale = fabs(x);
    t.mirrored = x * y * z < 0;
    return t;
}

/* Returns the axis that an option -rx, -my, ... names; -1 if none. */
static int axis_of(const char *word)
{
    return word[2] >= 'x' && word[2] <= 'z' && word[3] == '\0' ? word[2] - 'x' : -1;
}

/* Reads one transform (not -i). Returns the number of words it took, 0 if words[0] is none, or a
 * negative error. */
static int read_one(const char *const *words, size_t count, struct orl_xform *ret_one,
                    struct orl_error *err)
{
    double n[3] = {0, 0, 0};
    const char *word = words[0];
    int code = 0;
    if (strcmp(word, "-t") == 0) {
        code = numbers_after(words, count, 3, n, err);
        *ret_one = orl_xform_identity;
        if (code == 0)
            ret_one->offset = orl_v3(n[0], n[1], n[2]);
        return code < 0 ? code : 4;
    }
    if (strcmp(word, "-s") == 0) {
        code = numbers_after(words, count, 1, n, err);
        if (code == 0 && n[0] == 0.0)
            code = fail_option(err, ORL_ERR_RANGE, word, "must not be 0");
        if (code == 0)
            *ret_one = scaling(n[0], n[0], n[0]);
        return code < 0 ? code : 2;
    }
    if (strncmp(word, "-r", 2) == 0 && axis_of(word) >= 0) {
        code = numbers_after(words, count, 1, n, err);
        if (code == 0)
            *ret_one = rotation(axis_of(word), n[0]);
        return code < 0 ? code : 2;
    }
    if (strncmp(word, "-m", 2) == 0 && axis_of(word) >= 0) {
        const int axis = axis_of(word);
        *ret_one = scaling(axis == 0 ? -1 : 1, axis == 1 ? -1 : 1, axis == 2 ? -1 : 1);
        return 1;
    }
    return 0;
}

int orl_xform_repeats(const char *word, int *ret_repeats, struct orl_error *err)
{
    int repeats = 0;
    if (!word || orl_number_read_int(word, strlen(word), &repeats) != ORL_NUMBER_OK)
        return fail_option(err, ORL_ERR_SYNTAX, "-i", "needs a whole number after it");
    if (repeats > (int)ORL_LIMIT_XFORM_ARRAY)
        return fail_option(err, ORL_ERR_LIMIT, "-i", "asks for too many repeats");
    *ret_repeats = repeats;
    return 0;
}

/* Composes by repeated squaring, because an array of n copies repeats its block n^2 / 2 times in
 * total. */
void orl_xform_repeat(struct orl_xform *total, const struct orl_xform *block, int times)
{
    struct orl_xform power = *block;
    for (; times > 0; times >>= 1) {
        if (times & 1)
            *total = orl_xform_compose(&power, total);
        if (times > 1)
            power = orl_xform_compose(&power, &power);
    }
}

int orl_xform_check(const struct orl_xform *t, struct orl_error *err)
{
    const double sum = orl_dot(t->row[0], t->row[0]) + orl_dot(t->row[1], t->row[1]) +
                       orl_dot(t->row[2], t->row[2]) + orl_dot(t->offset, t->offset);
    if (isfinite(sum) && t->scale > 1e-30 && t->scale < 1e30)
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE, "xform: the transform is out of range");
}

int orl_xform_read(const char *const *words, size_t count, struct orl_xform *ret_xform,
                   size_t *ret_used, struct orl_error *err)
{
    struct orl_xform total = orl_xform_identity, block = orl_xform_identity;
    struct orl_xform one = orl_xform_identity;
    int times = 1;
    size_t i = 0;
    while (i < count) {
        if (strcmp(words[i], "-i") == 0) {
            orl_xform_repeat(&total, &block, times);
            const int code = orl_xform_repeats(i + 1 < count ? words[i + 1] : NULL, &times, err);
            if (code < 0)
                return code;
            block = orl_xform_identity;
            i += 2;
            continue;
        }
        const int used = read_one(words + i, count - i, &one, err);
        if (used < 0)
            return used;
        if (used == 0)
            break;
        block = orl_xform_compose(&one, &block);
        i += (size_t)used;
    }
    orl_xform_repeat(&total, &block, times);
    const int code = orl_xform_check(&total, err);
    if (code < 0)
        return code;
    *ret_xform = total;
    *ret_used = i;
    return 0;
}
