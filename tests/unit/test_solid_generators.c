/*
 * genbox, genprism, genblinds, genclock, genbranch, genrev, genworm and gensurf, read natively:
 * the words that Radiance 6.1's programs write for the same commands, without comments; and
 * refusals.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/sha256.h>

#include "scene/generate/generate.h"
#include "scene/generate/solid/solids.h"

struct expected {
    const char *command;
    size_t n_words;
    /* First 16 digits of SHA-256 over the words, each followed by a blank. */
    const char *digest;
};

static const struct expected expected[] = {
    {"genbox m n 1 2 3", 108, "5ccf18d053ab914f"},
    {"genbox oak top 1.25 0.7 0.0333333333333 -b .011", 444, "29a7b05b9680ad81"},
    {"genbox m n 2 2 1.5 -i -b .3", 444, "a9c66c6cec7c65c1"},
    {"genbox m n 4.4 2.2 1.1 -r .123456789", 344, "3c502ab5fe963bfb"},
    {"genbox m n 1 1 1 -r .2 -n 2", 344, "35d88b63368747ee"},
    {"genbox m n 1.5 2.5 0.8 -r .07 -n 4", 2892, "4a9521da51f60d08"},
    {"genbox m n 1.5 2.5 0.8 -r .4 -n 3 -i", 2532, "85143f19ceeaf5cb"},
    {"genprism m n 3 0 0 0.5 0.866 1 0", 84, "6829bb0765982a03"},
    {"genprism wall n outline.txt -l 0.3 -0.2 -1.75", 132, "4c5ac9f28f568375"},
    {"genprism m n outline.txt -c -e -l 0 0 0.333333", 72, "12c9f0af2693a7d6"},
    {"genprism m n 5 0 0 2 0 2 1 1 .5 0 1 -r .05", 295, "96f54fed2bd84268"},
    {"genprism m n outline.txt -r .125 -l .1 .2 -2", 394, "773a50cffc5fcbdd"},
    {"genprism m n 4 0 0 0 1 1.3 1 1 0 -l 0 .5 1 -r .1 -c", 313, "25f950799b111a04"},
    {"genblinds white b .05 1.2 1.5 7 22.5", 126, "d2eb541a0cbe8b75"},
    {"genblinds white b .05 1.2 1.5 3 -40 +r .11", 486, "28e0257bfa12ea35"},
    {"genblinds white b .05 1.2 1.5 3 60 -r .0375", 1512, "84b93bd4e7b81646"},
    {"genclock 10:35", 179, "3c4f31d12e3ad23e"},
    {"genclock -f face -c oak -n wall_clock 3.75", 157, "2c2000c5b385c076"},
    {"genbranch -n 3 -r 2", 1032, "4299b26463ee7427"},
    {"genbranch -bs 1 2 3 -be 1 2 9 -bt .3 -bn .5 -br .6 -bm bark -lm leaf -n 2 -r 3 -s 17 -v .45",
     2040, "feddd4a4b08bf6bc"},
    {"genrev steel torus 'sin(2*PI*t)' '2+cos(2*PI*t)' 32", 448, "7d40aa313f1bd70d"},
    {"genrev m vase 't*h' '.5+a(t)' '2*4' -e 'h=3.5;a(x)=x^2-if(x-.6,.3,0)'", 112,
     "dc17dc9d4aa1ce95"},
    {"genworm yellow banana 0 '5*sin(t)' '5*cos(t)' '.4-(.5-t)*(.5-t)' 20", 490,
     "c65edca5b1aeeb09"},
    {"genrev steel torus 'sin(2*PI*t)' '2+cos(2*PI*t)' 32 -s", 896, "9863b6d3b346a0c2"},
    {"genrev m vase 't*h' '.5+a(t)' '2*4' -e 'h=3.5;a(x)=x^2-if(x-.6,.3,0)' -s", 224,
     "2564bd16c2e41035"},
    {"gensurf m n 's' 't' 's*t' 3 2", 180, "edea3c84b4e9f0d6"},
    {"gensurf wave w 's' 't' 's*s+t*t' 2 4 -s", 328, "48661c8e6462653d"},
    {"gensurf wave w '2*s' 't+s' 's*s+.2*t*t' 2 2 -s", 164, "3d959d18f05fb2d5"},
    {"gensurf m n 's+t*t' '2*t' '1+s*s' 2 3 -s -e 'valid(s,t)=1.4-s-t'", 199, "b6f6a69af70ec51e"},
    {"gensurf m n 's' '2*t' '1+s*s' 4 4 -s -e 'valid(s,t)=1.4-s-t'", 524, "4e64f9b49149314b"},
    {"gensurf m n 's+t*t' '2*t' '1+s*s' 4 5 -o -e 'valid(s,t)=s+t-.3'", 286, "6a73c6a5e53fdf9e"},
    {"gensurf m n 's+t*t' '2*t' '1+s*s' 3 4 -s -o -i", 268, "27857efd073b1374"},
    {"gensurf land l '9*s' '7*t' outline.txt 2 5", 300, "2e8fea45408ffec1"},
    {"gensurf land l '9*s' '7*t' outline.txt 1 4 -s", 304, "75070547a2c6e409"},
    {"gensurf land l '9*s' '7*t' outline.txt 2 '5' -o", 210, "21aa0c9c61aa000d"},
    {"genworm m n 'hermite(0,1,2,-1,t)' 'bezier(0,1,2,.5,t)' t .1 7", 171, "c03a31917aa90bbd"},
};

/* Reads the one file that commands name. */
static int read_outline(void *ctx, const char *name, char **ret_text, struct orl_error *err)
{
    (void)ctx;
    if (strcmp(name, "outline.txt") != 0)
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "'%s' is not there", name);
    *ret_text = strdup("0 0\n2.5 0.25\t3 2\n\n 1.5 1.125 0 2\n");
    return *ret_text ? 0 : ORL_ERR_NOMEM;
}

static int run_command(const char *line, struct orl_text *text, struct orl_error *err)
{
    const struct orl_generator_files files = {NULL, read_outline};
    struct orl_command command;
    int code = orl_command_split(&command, line, err);
    assert_int_equal(code, 0);
    const char *const *words = (const char *const *)command.words;
    const size_t n = command.n_words;
    if (strcmp(words[0], "genbox") == 0)
        code = orl_genbox(words, n, text, err);
    else if (strcmp(words[0], "genprism") == 0)
        code = orl_genprism(words, n, &files, text, err);
    else if (strcmp(words[0], "genblinds") == 0)
        code = orl_genblinds(words, n, text, err);
    else if (strcmp(words[0], "genclock") == 0)
        code = orl_genclock(words, n, text, err);
    else if (strcmp(words[0], "genrev") == 0)
        code = orl_genrev(words, n, &files, text, err);
    else if (strcmp(words[0], "genworm") == 0)
        code = orl_genworm(words, n, &files, text, err);
    else if (strcmp(words[0], "gensurf") == 0)
        code = orl_gensurf(words, n, &files, text, err);
    else
        code = orl_genbranch(words, n, text, err);
    orl_command_done(&command);
    return code;
}

/* Writes a number without redundant zeros, because genclock prints its own as .05 and 0.850000.
 * Rounding errors of a zero difference become 0. */
static size_t write_word(const char *word, size_t length, char ret_word[64])
{
    char plain[64], *end;
    assert_true(length < sizeof plain);
    memcpy(plain, word, length);
    plain[length] = '\0';
    const double number = strtod(plain, &end);
    return (size_t)(*end ? snprintf(ret_word, 64, "%s ", plain)
                         : snprintf(ret_word, 64, "%.12g ", fabs(number) < 1e-15 ? 0 : number));
}

static void check_digest(const struct expected *e)
{
    struct orl_text text = {0};
    struct orl_error err = {0};
    struct orl_sha256 hash;
    unsigned char digest[ORL_SHA256_BYTES];
    char word[64], digits[17];
    size_t n = 0;
    if (run_command(e->command, &text, &err) < 0)
        fail_msg("%s: %s", e->command, err.message);
    assert_false(text.failed);
    orl_sha256_init(&hash);
    for (const char *at = text.data; *(at += strspn(at, " \n'")); at += strcspn(at, " \n'")) {
        orl_sha256_add(&hash, word, write_word(at, strcspn(at, " \n'"), word));
        n++;
    }
    orl_sha256_finish(&hash, digest);
    for (int i = 0; i < 8; i++)
        snprintf(digits + 2 * i, 3, "%02x", digest[i]);
    if (n != e->n_words || strcmp(digits, e->digest) != 0)
        fail_msg("%s: %zu words, %s, instead of %zu, %s:\n%.2000s", e->command, n, digits,
                 e->n_words, e->digest, text.data);
    orl_text_done(&text);
}

static void test_words(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        check_digest(&expected[i]);
}

/* Formulas without quotes: they match no file names, so a shell passes them on unchanged. */
static void test_formulas_need_no_quotes(void **state)
{
    static const char *const pairs[][2] = {
        {"genrev m n t*1.5 .1 3", "genrev m n 't*1.5' '.1' 3"},
        {"genworm m n t*2 t*t 0 .1+t*.2 4", "genworm m n 't*2' 't*t' 0 '.1+t*.2' 4"},
        {"gensurf m n s 2*t s*t 2 2", "gensurf m n 's' '2*t' 's*t' 2 2"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        struct orl_text bare = {0}, quoted = {0};
        struct orl_error err = {0};
        assert_int_equal(run_command(pairs[i][0], &bare, &err), 0);
        assert_int_equal(run_command(pairs[i][1], &quoted, &err), 0);
        assert_string_equal(strchr(bare.data, '\n'), strchr(quoted.data, '\n'));
        orl_text_done(&bare);
        orl_text_done(&quoted);
    }
}

/* ---- Refused --------------------------------------------------------------------------------- */

static const struct {
    const char *command;
    int code;
    const char *message; /* part of the message */
} refused[] = {
    {"genbox m n 1 2", ORL_ERR_SYNTAX, "three sizes"},
    {"genbox m n 1 2 0", ORL_ERR_RANGE, "not positive"},
    {"genbox m n 1 2 3 -r", ORL_ERR_SYNTAX, "'-r' needs a number"},
    {"genbox m n 1 2 3 -b -1", ORL_ERR_RANGE, "not positive"},
    {"genbox m n 1 2 3 -r .1 -n 1000", ORL_ERR_RANGE, "must be 1 to 256"},
    {"genbox m n 1 2 3 -o", ORL_ERR_UNSUPPORTED, "'-o'"},
    {"genbox m n 1 2 3 -r .1 -n 4 -s", ORL_ERR_UNSUPPORTED, "'-s'"},
    {"genbox m n 1 2 3 x", ORL_ERR_SYNTAX, "'x' is not an option"},
    {"genbox m \"it's\" 1 2 3", ORL_ERR_SYNTAX, "not a valid name"},
    {"genprism m n", ORL_ERR_UNSUPPORTED, "'-'"},
    {"genprism m n -", ORL_ERR_UNSUPPORTED, "'-'"},
    {"genprism m n 2 0 0 1 1", ORL_ERR_RANGE, "must be 3 to 20000"},
    {"genprism m n 3 0 0 1 1", ORL_ERR_SYNTAX, "needs a number"},
    {"genprism m n elsewhere.txt", ORL_ERR_NOT_FOUND, "elsewhere.txt"},
    {"genprism m n 3 0 0 1 0 1 1 -l 1 1 0", ORL_ERR_RANGE, "is parallel to"},
    {"genprism m n 3 0 0 1 0 1 1 -r 2", ORL_ERR_RANGE, "larger than the prism's height"},
    {"genprism m n 3 0 0 1 0 1 0 -r .1", ORL_ERR_RANGE, "corners 2 and 3 coincide"},
    {"genprism m n 3 0 0 2 0 1 0 -r .1", ORL_ERR_RANGE, "reverses at corner"},
    {"genprism m n 3 0 0 1 0 1 1 -q", ORL_ERR_SYNTAX, "'-q' is not an option"},
    {"genblinds m n .1 1 1 5", ORL_ERR_SYNTAX, "the angle"},
    {"genblinds m n .1 1 1 0 45", ORL_ERR_RANGE, "must be 1 to 20000"},
    {"genblinds m n .1 1 1 5 45 +r .01", ORL_ERR_RANGE, "cannot be bent"},
    {"genblinds m n .1 1 1 5 45 +r 1 2", ORL_ERR_SYNTAX, "is an extra argument"},
    {"genclock", ORL_ERR_SYNTAX, "time is missing"},
    {"genclock noon", ORL_ERR_SYNTAX, "'noon' is not a time"},
    {"genclock 10:75", ORL_ERR_SYNTAX, "is not a time"},
    {"genclock -q x 10:35", ORL_ERR_SYNTAX, "'-q' is not an option"},
    {"genbranch -n 50 -r 5", ORL_ERR_LIMIT, "segments"},
    {"genbranch -bs 1 2", ORL_ERR_SYNTAX, "needs a number"},
    {"genbranch 5", ORL_ERR_SYNTAX, "'5' is not an option"},
    {"genrev m n t t", ORL_ERR_SYNTAX, "needs 2 expressions"},
    {"genrev m n t t 0", ORL_ERR_RANGE, "must be 1 to 50000"},
    {"genrev m n t t t", ORL_ERR_RANGE, "must be 1 to 50000"},
    {"genrev m n t t 5 -f away.cal", ORL_ERR_NOT_FOUND, "away.cal"},
    {"genrev m n t t 5 -e", ORL_ERR_SYNTAX, "needs a word"},
    {"genworm m n t t 'no_such(t)' 1 5", ORL_ERR_NOT_FOUND, "no_such"},
    {"genworm m n t t '5*' 1 5", ORL_ERR_SYNTAX, ""},
    {"genworm m n t t t 1 5 -s", ORL_ERR_SYNTAX, "'-s' is not an option"},
    {"gensurf m n s t", ORL_ERR_SYNTAX, "three expressions and two numbers"},
    {"gensurf m n s t 's*t' 0 4", ORL_ERR_RANGE, "must be 1 to 20000"},
    {"gensurf m n s t 's*t' 4 s", ORL_ERR_RANGE, "fields along t"},
    {"gensurf m n s t 's*t' 2000 2000", ORL_ERR_LIMIT, "2000 x 2000 fields"},
    {"gensurf m n s t - 4 4", ORL_ERR_UNSUPPORTED, "'-'"},
    {"gensurf m n s t outline.txt 4 4", ORL_ERR_SYNTAX, "has 10 numbers; 4 x 4 fields need"},
    {"gensurf m n outline.txt t outline.txt 2 2", ORL_ERR_SYNTAX, "more than 9 numbers"},
    {"gensurf m n s t 's*t' 4 4 -q", ORL_ERR_SYNTAX, "'-q' is not an option"},
    {"gensurf m n s t 'none(s)' 4 4 -s", ORL_ERR_NOT_FOUND, "none"},
    {"gensurf m n s t '1e308*10*(s+1)' 4 4", ORL_ERR_RANGE, "expression 3 is not finite"},
};

static void test_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        struct orl_text text = {0};
        struct orl_error err = {0};
        const int code = run_command(refused[i].command, &text, &err);
        if (code != refused[i].code || !strstr(err.message, refused[i].message))
            fail_msg("%s: %d, %s", refused[i].command, code, err.message);
        assert_null(text.data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_words),
                                       cmocka_unit_test(test_formulas_need_no_quotes),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
