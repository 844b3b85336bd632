/*
 * MGF geometry: the scene text equals that of Radiance 6.1's mgf2rad for the same entities; arrays
 * and names; refusals and their place.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "scene/generate/mgf/mgf.h"

/* Number of realloc calls. Sanitizers replace the allocator: no calls are counted. */
static unsigned reallocations;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && !defined(__clang__)
extern void *__libc_realloc(void *memory, size_t size);

void *realloc(void *memory, size_t size)
{
    reallocations++;
    return __libc_realloc(memory, size);
}
#endif

#define CORNERS                                                                                    \
    "v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 1 2 0\nv d =\n p 0 2 0\n"                         \
    "v e =\n p .2 .2 0\nv f =\n p .2 .6 0\nv g =\n p .7 .6 0\nv up =\n n 0 0 2\n"

/* Entities, and the words of the scene text: numbers to six digits. */
static const struct {
    const char *name, *mgf, *words;
} good[] = {
    {"a face, scaled and moved",
     "c red =\n cxy .55 .35\nm matt =\n c red\n rd .2\n" CORNERS
     "xf -s .01 -t 1 2 3\no panel\nf a b c\no\nxf\n",
     "void plastic matt 0 0 5 0.550102 0.076927 0.040366 0 0 "
     "matt polygon panel.f1 0 0 9 1 2 3 1.01 2 3 1.01 2.02 3 "},
    {"a hole", CORNERS "fh a b c d - e f g\n",
     "void plastic mat 0 0 5 0 0 0 0 0 mat polygon f1 0 0 27 "
     "0 0 0 1 0 0 1 2 0 0 2 0 0.7 0.6 0 0.2 0.2 0 0.2 0.6 0 0.7 0.6 0 0 2 0 "},
    {"mirrored, it is turned", CORNERS "xf -mx\nf a b c\nxf\n",
     "void plastic mat 0 0 5 0 0 0 0 0 mat polygon f1 0 0 9 -1 2 0 -1 0 0 0 0 0 "},
    {"an array, named",
     "m solid =\n ir 1.5 0\n rs .04 0\n ts .9 0\n sides 1\n" CORNERS
     "xf -t 0 0 1 -a 2 -t 0 5 0\no item\nsph a -.4\ncyl a .1 b\no\nxf\nring up .1 .5\n",
     "void dielectric solid 0 0 5 4.22255e-06 4.22255e-06 4.22255e-06 1.5 0 "
     "solid bubble a0.item.s1 0 0 4 0 0 1 0.4 "
     "solid cylinder a0.item.cy1 0 0 7 0 0 1 1 0 1 0.1 "
     "solid bubble a1.item.s2 0 0 4 0 5 1 0.4 "
     "solid cylinder a1.item.cy2 0 0 7 0 5 1 1 5 1 0.1 "
     "solid ring r1 0 0 8 0 0 0 0 0 1 0.1 0.5 "},
    {"cones", CORNERS "cone a .1 b 0\ncone a -.1 b -.3\n",
     "void plastic mat 0 0 5 0 0 0 0 0 mat cone c1 0 0 8 0 0 0 1 0 0 0.1 0 "
     "mat cup c2 0 0 8 0 0 0 1 0 0 0.1 0.3 "},
    {"a pane", "m pane =\n ir 1.52 0\n rs .04 0\n ts .85 0\n" CORNERS "m pane\nprism a b c .25\n",
     "void glass pane 0 0 4 0.89 0.89 0.89 1.52 "
     "pane polygon f1 0 0 12 0 0 -0.25 0 0 0 1 2 0 1 2 -0.25 "
     "pane polygon f2 0 0 12 1 0 -0.25 1 0 0 0 0 0 0 0 -0.25 "
     "pane polygon f3 0 0 12 1 2 -0.25 1 2 0 1 0 0 1 0 -0.25 "
     "pane polygon f4 0 0 9 1 2 -0.25 1 0 -0.25 0 0 -0.25 "
     "pane polygon f5 0 0 9 0 0 0 1 0 0 1 2 0 "},
    {"trans", "m t =\n td .3\n rd .25\n ts .1 .05\n" CORNERS "f a b c\n",
     "void trans t 0 0 7 0.65 0.65 0.65 0 0.05 0.615385 0.25 "
     "t polygon f1 0 0 9 0 0 0 1 0 0 1 2 0 "},
    {"metal, and what is set later",
     "m t =\n rd .1\n rs .5 .2\n" CORNERS "f a b c\nf a b d\nm t\n rd .2\nf a c d\n",
     "void metal t 0 0 5 0.6 0.6 0.6 0.833333 0.2 t polygon f1 0 0 9 0 0 0 1 0 0 1 2 0 "
     "t polygon f2 0 0 9 0 0 0 1 0 0 0 2 0 "
     "void metal t 0 0 5 0.7 0.7 0.7 0.714286 0.2 t polygon f3 0 0 9 0 0 0 1 2 0 0 2 0 "},
    {"two colours",
     "c blue =\n cxy .2 .25\nc warm =\n cxy .45 .4\nm t =\n c warm\n rd .2\n c blue\n td .3\n"
     " ts .2 .1\n" CORNERS "f a b c\n",
     "void colorfunc ts_rgb* 4 0.001756 0.251401 0.479543 . 0 0 "
     "void WGMDfunc t 13 void 0 0 0 ts_rgb* 1 0.1 0.1 void 0 0 1 . 0 9 "
     "0.313941 0.16897 0.054716 0.313941 0.16897 0.054716 0.002634 0.377102 0.719314 "
     "t polygon f1 0 0 9 0 0 0 1 0 0 1 2 0 "},
    {"a torus, whose vertex stays", "v b =\n p .5 .5 .5\n n 0 0 2\ntorus b .1 .25\nring _tv2 1 2\n",
     "void plastic mat 0 0 5 0 0 0 0 0 "
     "mat cone c1 0 0 8 0.5 0.5 0.575 0.5 0.5 0.571329 0.175 0.198176 "
     "mat cone c2 0 0 8 0.5 0.5 0.571329 0.5 0.5 0.560676 0.198176 0.219084 "
     "mat cone c3 0 0 8 0.5 0.5 0.560676 0.5 0.5 0.544084 0.219084 0.235676 "
     "mat cone c4 0 0 8 0.5 0.5 0.544084 0.5 0.5 0.523176 0.235676 0.246329 "
     "mat cone c5 0 0 8 0.5 0.5 0.523176 0.5 0.5 0.5 0.246329 0.25 "
     "mat cone c6 0 0 8 0.5 0.5 0.5 0.5 0.5 0.476824 0.25 0.246329 "
     "mat cone c7 0 0 8 0.5 0.5 0.476824 0.5 0.5 0.455916 0.246329 0.235676 "
     "mat cone c8 0 0 8 0.5 0.5 0.455916 0.5 0.5 0.439324 0.235676 0.219084 "
     "mat cone c9 0 0 8 0.5 0.5 0.439324 0.5 0.5 0.428671 0.219084 0.198176 "
     "mat cone c10 0 0 8 0.5 0.5 0.428671 0.5 0.5 0.425 0.198176 0.175 "
     "mat cup c11 0 0 8 0.5 0.5 0.425 0.5 0.5 0.428671 0.175 0.151824 "
     "mat cup c12 0 0 8 0.5 0.5 0.428671 0.5 0.5 0.439324 0.151824 0.130916 "
     "mat cup c13 0 0 8 0.5 0.5 0.439324 0.5 0.5 0.455916 0.130916 0.114324 "
     "mat cup c14 0 0 8 0.5 0.5 0.455916 0.5 0.5 0.476824 0.114324 0.103671 "
     "mat cup c15 0 0 8 0.5 0.5 0.476824 0.5 0.5 0.5 0.103671 0.1 "
     "mat cup c16 0 0 8 0.5 0.5 0.5 0.5 0.5 0.523176 0.1 0.103671 "
     "mat cup c17 0 0 8 0.5 0.5 0.523176 0.5 0.5 0.544084 0.103671 0.114324 "
     "mat cup c18 0 0 8 0.5 0.5 0.544084 0.5 0.5 0.560676 0.114324 0.130916 "
     "mat cup c19 0 0 8 0.5 0.5 0.560676 0.5 0.5 0.571329 0.130916 0.151824 "
     "mat cup c20 0 0 8 0.5 0.5 0.571329 0.5 0.5 0.575 0.151824 0.175 "
     "mat ring r1 0 0 8 0.5 0.5 0.575 0 0 1 1 2 "},
    {"files within, in arrays and transforms of this one, and a vertex that stays",
     "xf -s 2\ni sub/s.mgf\nxf\ni sub/s.mgf -t 1 0 0 -a 2 -t 0 5 0\nring far .1 .2\n",
     "void plastic mat 0 0 5 0 0 0 0 0 "
     "mat sphere thing.s1 0 0 4 2 4 6 1 mat ring thing.r1 0 0 8 18 20 22 0 0 1 2 4 "
     "mat sphere a0.thing.s2 0 0 4 2 2 3 0.5 mat ring a0.thing.r2 0 0 8 10 10 11 0 0 1 1 2 "
     "mat sphere a1.thing.s3 0 0 4 2 7 3 0.5 mat ring a1.thing.r3 0 0 8 10 15 11 0 0 1 1 2 "
     "mat ring r4 0 0 8 9 10 11 0 0 1 0.1 0.2 "},
    {"a lamp", "m lamp =\n ed 3000\n" CORNERS "f a b c\n",
     "void light lamp 0 0 3 5.33481 5.33481 5.33481 lamp polygon f1 0 0 9 0 0 0 1 0 0 1 2 0 "},
};

/* Writes words with a blank after each, numbers to six digits. */
static void write_words(const char *text, char *ret_words, size_t size)
{
    size_t n = 0;
    for (const char *at = text; *(at += strspn(at, " \n'")); at += strcspn(at, " \n'")) {
        char word[64], *end;
        const size_t length = strcspn(at, " \n'");
        assert_true(length < sizeof word && n + length + 2 < size);
        memcpy(word, at, length);
        word[length] = '\0';
        const double number = strtod(word, &end);
        n += (size_t)(*end ? snprintf(ret_words + n, size - n, "%s ", word)
                           : snprintf(ret_words + n, size - n, "%.6g ", number + 0.));
    }
}

/* Files that others include. */
static const struct {
    const char *folder, *name, *mgf;
} others[] = {
    {"", "sub/s.mgf", "o thing\nv a =\n p 1 2 3\nsph a .5\ni part.mgf\no\n"},
    {"sub", "part.mgf", "v far =\n p 9 10 11\n n 0 0 1\nring far 1 2\n"},
    {"", "itself.mgf", "# x\ni itself.mgf\n"},
    {"", "open.mgf", "xf -t 1 0 0\n"},
    {"", "shut.mgf", "xf\n"},
    {"", "wrong.mgf", "\n\nv a b\n"},
};

static int open_other(void *ctx, const char *folder, const char *name, struct orl_mgf_text *ret,
                      struct orl_error *err)
{
    (void)ctx;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(others[i].folder, folder) == 0 && strcmp(others[i].name, name) == 0) {
            *ret = (struct orl_mgf_text){.file = others[i].name,
                                         .folder = strchr(name, '/') ? "sub" : "",
                                         .line = 1,
                                         .data = others[i].mgf,
                                         .size = strlen(others[i].mgf)};
            return 0;
        }
    return orl_error_set(err, ORL_ERR_NOT_FOUND, "there is no %s", name);
}

static int convert(const char *mgf, struct orl_text *text, struct orl_error *err)
{
    const struct orl_mgf document = {
        .text = {.file = "p.mgf", .folder = "", .line = 1, .data = mgf, .size = strlen(mgf)},
        .open = open_other,
        .unit_m = 1,
        .emission = 1};
    return orl_mgf_write(&document, text, err);
}

/* Checks that words are equal, and numbers to a relative 2e-5: mgf2rad prints six digits after the
 * point, and uses other colour-matching tables. */
static void check_words(const char *name, const char *words, const char *expected)
{
    const char *a = words, *b = expected;
    while (*a && *b) {
        char *end_a, *end_b;
        const double x = strtod(a, &end_a), y = strtod(b, &end_b);
        const size_t n = strcspn(a, " "), m = strcspn(b, " ");
        const bool numbers = end_a == a + n && end_b == b + m;
        const double off = x > y ? x - y : y - x;
        if (numbers ? off > 2e-6 + 2e-5 * (y > 0 ? y : -y) : n != m || memcmp(a, b, n) != 0)
            fail_msg("%s: '%.*s' instead of '%.*s' in\n%s", name, (int)n, a, (int)m, b, words);
        a += n + 1;
        b += m + 1;
    }
    if (*a || *b)
        fail_msg("%s: too long or too short:\n%s", name, words);
}

static void text_is_that_of_mgf2rad(void **state)
{
    static char words[1 << 16];
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct orl_text text = {0};
        struct orl_error err = {0};
        if (convert(good[i].mgf, &text, &err) < 0)
            fail_msg("%s: line %d: %s", good[i].name, err.line, err.message);
        write_words(text.data, words, sizeof words);
        check_words(good[i].name, words, good[i].words);
        orl_text_done(&text);
    }
}

/* ---- Warnings and refusals ------------------------------------------------------------------- */

static const struct {
    const char *mgf;
    const char *warning; /* part of the warning */
} warned[] = {
    {CORNERS "v a\n n 0 0 1\nf a b c\n", "normals"},
    {"m m =\n c\n cxy .45 .3\n rd .7\n" CORNERS "f a b c\n", "1 colours"},
    {"wobble 1 2\nwobble\n", "2 of the geometry's entities"},
};

static const struct {
    const char *mgf;
    int code, line;
    const char *message; /* part of the message */
} refused[] = {
    {"f a b c\n", ORL_ERR_SYNTAX, 1, "'a' has not been defined"},
    {CORNERS "f a b\n", ORL_ERR_SYNTAX, 17, "3 words or more"},
    {"v a =\n\n# x\n p 0 0 \\\n  x\n", ORL_ERR_SYNTAX, 5, "'x' is not a number"},
    {"v a b\n", ORL_ERR_SYNTAX, 1, "where '='"},
    {"m a = b\n", ORL_ERR_SYNTAX, 1, "material 'b'"},
    {"c\n cxy .8 .8\n", ORL_ERR_RANGE, 2, "not a chromaticity"},
    {"c\n cct 20\n", ORL_ERR_RANGE, 2, "temperature"},
    {"m\n rd 1.2\n", ORL_ERR_RANGE, 2, "out of range"},
    {"m m =\n rd .7\n rs .5 0\n" CORNERS "f a b c\n", ORL_ERR_RANGE, 20, "transmits 1.2"},
    {"xf -t 1 0\n", ORL_ERR_SYNTAX, 1, ""},
    {"xf -t 1 0 0 other.mgf\n", ORL_ERR_SYNTAX, 1, "'other.mgf' is not a transform"},
    {"xf\n", ORL_ERR_SYNTAX, 1, "no transform is open"},
    {"xf -t 1 0 0\n", ORL_ERR_SYNTAX, 1, "not closed"},
    {"o\n", ORL_ERR_SYNTAX, 1, "no object"},
    {"ies l.ies\n", ORL_ERR_UNSUPPORTED, 1, "not supported here"},
    {"\ni other.mgf\n", ORL_ERR_NOT_FOUND, 2, "there is no other.mgf"},
    {"i\n", ORL_ERR_SYNTAX, 1, "1 words"},
    {"i wrong.mgf -t 1 0\n", ORL_ERR_SYNTAX, 1, ""},
    {CORNERS "torus a .1 .2\n", ORL_ERR_RANGE, 17, "needs a normal"},
    {CORNERS "torus up .2 .1\n", ORL_ERR_RANGE, 17, "do not define a torus"},
    {CORNERS "torus up 0 0\n", ORL_ERR_RANGE, 17, "do not define a torus"},
    {CORNERS "ring a .1 .2\n", ORL_ERR_RANGE, 17, "a normal"},
    {CORNERS "cone a .1 b -.2\n", ORL_ERR_RANGE, 17, "do not define a cone"},
    {CORNERS "prism a b c 0\n", ORL_ERR_RANGE, 17, "no length"},
    {"o it's\n", ORL_ERR_SYNTAX, 1, "not allowed"},
};

/* Errors in included files. */
static const struct {
    const char *mgf;
    int code, line;
    const char *message, *file;
} refused_within[] = {
    {"i itself.mgf\n", ORL_ERR_LIMIT, 2, "includes itself", "itself.mgf"},
    {"i open.mgf\nxf\n", ORL_ERR_SYNTAX, 1, "not closed", "open.mgf"},
    {"xf -t 1 0 0\ni shut.mgf\n", ORL_ERR_SYNTAX, 1, "is open", "shut.mgf"},
    {"i shut.mgf -t 1 0 0\n", ORL_ERR_SYNTAX, 1, "is open", "shut.mgf"},
    {"i wrong.mgf -t 1 0 0\n", ORL_ERR_SYNTAX, 3, "where '='", "wrong.mgf"},
};

static void what_may_mislead_is_said(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof warned / sizeof *warned; i++) {
        struct orl_text text = {0};
        struct orl_error err = {0};
        assert_int_equal(convert(warned[i].mgf, &text, &err), 0);
        if (!strstr(text.warnings, warned[i].warning))
            fail_msg("%s: '%s'", warned[i].mgf, text.warnings);
        orl_text_done(&text);
    }
}

static void expect_refused(const char *mgf, int code, const char *file, int line,
                           const char *message)
{
    struct orl_text text = {0};
    struct orl_error err = {0};
    const int found = convert(mgf, &text, &err);
    if (found != code || err.line != line || !strstr(err.message, message))
        fail_msg("%s: %d, line %d: %s", mgf, found, err.line, err.message);
    assert_string_equal(err.file, file);
    orl_text_done(&text);
}

static void what_is_refused_has_its_line(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        expect_refused(refused[i].mgf, refused[i].code, "p.mgf", refused[i].line,
                       refused[i].message);
    for (size_t i = 0; i < sizeof refused_within / sizeof *refused_within; i++)
        expect_refused(refused_within[i].mgf, refused_within[i].code, refused_within[i].file,
                       refused_within[i].line, refused_within[i].message);
}

/* Copies of an array, 176 bytes each, are reallocated only when the capacity doubles. */
static void copies_are_seldom_moved(void **state)
{
    struct orl_text text = {0};
    struct orl_error err = {0};
    (void)state;
    reallocations = 0;
    assert_int_equal(convert("v a =\n p 0 0 0\nxf -a 4096 -t 1 0 0\nsph a 1\nxf\n", &text, &err),
                     0);
    print_message("%u reallocations\n", reallocations);
    assert_true(reallocations < 64);
    orl_text_done(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_is_that_of_mgf2rad),
        cmocka_unit_test(what_may_mislead_is_said),
        cmocka_unit_test(what_is_refused_has_its_line),
        cmocka_unit_test(copies_are_seldom_moved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
