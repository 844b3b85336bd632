/* Scene text that must be refused: the code, the line and the primitive in the error. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"
#include "support/scene_text.h"

#define RED "void plastic red 0 0 5 .5 .2 .1 0 0\n"
#define SKY "void brightfunc sky 2 skybright perezlum.cal 0 10 1 1 1 -1 1 -1 1 0 0 1\n"
#define BSDF(strings, reals) "void BSDF b\n" strings "\n0\n" reals "\n"

struct bad {
    const char *text;
    int code, line;
    const char *primitive, *message; /* part of the message */
};

static const struct bad bad_scenes[] = {
    /* words and counts */
    {"void", ORL_ERR_SYNTAX, 1, "", "after a modifier"},
    {"void plastic", ORL_ERR_SYNTAX, 1, "", "after a type"},
    {"void plastic m\n", ORL_ERR_SYNTAX, 2, "plastic m", "count of string"},
    {"void plastic m\n0\n0\n5 .1 .1 .1 0", ORL_ERR_SYNTAX, 4, "plastic m", "ends among"},
    {"void plastic m\n0\n0\n4 .1 .1 .1 0", ORL_ERR_SYNTAX, 1, "plastic m", "5 number"},
    {"void plastic m\n1 x\n0\n5 .1 .1 .1 0 0", ORL_ERR_SYNTAX, 1, "plastic m", "0 string"},
    {"void plastic m\n0\n1 7\n5 .1 .1 .1 0 0", ORL_ERR_SYNTAX, 3, "plastic m", "must be 0"},
    {"void plastic m\n-1\n", ORL_ERR_SYNTAX, 2, "plastic m", "count of string"},
    {"void plastic m\n0 0\n# no\n5 .1 .1 .1 0 0", ORL_ERR_SYNTAX, 3, "plastic m",
     "count of number"},
    {"void plastic m\n0 0 999999999\n", ORL_ERR_LIMIT, 2, "plastic m", "too many arguments"},
    {"void plastic m\n0 0 99999999999999\n", ORL_ERR_LIMIT, 2, "plastic m", "too many arguments"},
    {"void plastic m\n0\n0\n5 .1 .x .1 0 0", ORL_ERR_SYNTAX, 4, "plastic m", "'.x'"},
    {"void plastic m\n0\n0\n5 .1 nan .1 0 0", ORL_ERR_RANGE, 4, "plastic m", "'nan'"},
    {"void plastic m\n0\n0\n5 .1\n-Inf .1 0 0", ORL_ERR_RANGE, 5, "plastic m", "'-Inf'"},
    {"void plastic m\n0\n0\n5 .1 1e400 .1 0 0", ORL_ERR_RANGE, 4, "plastic m", "'1e400'"},
    {"void plastic 'm\n0\n0\n", ORL_ERR_SYNTAX, 1, "", "never closed"},
    {"\n\nvoid pl\x01stic m", ORL_ERR_SYNTAX, 3, "", "byte 0x01"},
    {"\n5 0 0\n", ORL_ERR_SYNTAX, 2, "0 0", "not a primitive type"},
    /* types and names */
    {"\nvoid plastik m 0 0 5 0 0 0 0 0", ORL_ERR_SYNTAX, 2, "plastik m", "not a primitive type"},
    {"void mesh t 1 x.rtm 0 0", ORL_ERR_NOT_FOUND, 1, "mesh t", "x.rtm"},
    {"void mixfunc t 4 a b .5 . 0 0", ORL_ERR_NOT_FOUND, 1, "mixfunc t", "its material"},
    {"void mixtext t 4 a b helvet.fnt c.txt 0 9 0 0 0 1 0 0 0 -1 0", ORL_ERR_NOT_FOUND, 1,
     "mixtext t", "its material 'a'"},
    {"\nred polygon p 0 0 9 0 0 0 1 0 0 0 1 0", ORL_ERR_NOT_FOUND, 2, "polygon p", "'red'"},
    {"red polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n" RED, ORL_ERR_NOT_FOUND, 1, "polygon p", "'red'"},
    {RED "red sphere s 0 0 4 0 0 0 1\ns sphere t 0 0 4 0 0 0 1", ORL_ERR_NOT_FOUND, 3, "sphere t",
     "'s'"},
    {RED "red plastic m 0 0 5 0 0 0 0 0", ORL_ERR_UNSUPPORTED, 2, "plastic m", "cannot modify"},
    {"x plastic m 0 0 5 0 0 0 0 0", ORL_ERR_NOT_FOUND, 1, "plastic m", "'x'"},
    {"inherit plastic m 0 0 5 0 0 0 0 0", ORL_ERR_NOT_FOUND, 1, "plastic m", "'inherit'"},
    {"void plastic void 0 0 5 0 0 0 0 0", ORL_ERR_SYNTAX, 1, "plastic void", "reserved"},
    {"void alias a b", ORL_ERR_NOT_FOUND, 1, "alias a", "'b'"},
    {"void alias a", ORL_ERR_SYNTAX, 1, "alias a", "ends among"},
    {SKY "sky plastic m 0 0 5 0 0 0 0 0", ORL_ERR_UNSUPPORTED, 2, "plastic m", "light and glow"},
    {SKY RED "sky alias m red", ORL_ERR_UNSUPPORTED, 3, "alias m", "light and glow"},
    {SKY "sky sphere s 0 0 4 0 0 0 1", ORL_ERR_UNSUPPORTED, 2, "sphere s", "pattern"},
    /* materials out of range */
    {"void plastic m 0 0 5 1.02 .5 .5 0 0", ORL_ERR_RANGE, 1, "plastic m", "reflectance"},
    {"void plastic m 0 0 5 -.1 .5 .5 0 0", ORL_ERR_RANGE, 1, "plastic m", "reflectance"},
    {"void metal m 0 0 5 .5 1.5 .5 1 0", ORL_ERR_RANGE, 1, "metal m", "reflectance"},
    {"void plastic m 0 0 5 .5 .5 .5 1.02 0", ORL_ERR_RANGE, 1, "plastic m", "specularity"},
    {"void plastic m 0 0 5 .5 .5 .5 0 -1", ORL_ERR_RANGE, 1, "plastic m", "roughness"},
    {"void glass g 0 0 3 1.1 1 1", ORL_ERR_RANGE, 1, "glass g", "transmissivity"},
    {"void glass g 0 0 4 1 1 1 0", ORL_ERR_RANGE, 1, "glass g", "refraction"},
    {"void glass g 0 0 2 1 1", ORL_ERR_SYNTAX, 1, "glass g", "3 number"},
    {"void light l 0 0 3 1 -1 1", ORL_ERR_RANGE, 1, "light l", "negative"},
    {"void glow l 0 0 3 1 1 1", ORL_ERR_SYNTAX, 1, "glow l", "4 number"},
    {"void trans t 0 0 7 1.1 1 1 0 0 1 0", ORL_ERR_RANGE, 1, "trans t", "reflectance"},
    {"void trans t 0 0 7 1 1 1 0 0 1.5 0", ORL_ERR_RANGE, 1, "trans t", "transmission"},
    {"void trans t 0 0 7 1 1 1 0 0 1 -1", ORL_ERR_RANGE, 1, "trans t", "transmitted"},
    {"void trans t 0 0 7 1 1 1 0 2 1 0", ORL_ERR_RANGE, 1, "trans t", "roughness"},
    {"void trans t 0 0 5 1 1 1 0 0", ORL_ERR_SYNTAX, 1, "trans t", "7 number"},
    {"void plastic2 p 0 0 6 .5 .5 .5 0 .1 .2", ORL_ERR_SYNTAX, 1, "plastic2 p", "four string"},
    {"void plastic2 p 4 1 0 0 . 0 5 .5 .5 .5 0 .1", ORL_ERR_SYNTAX, 1, "plastic2 p", "6 number"},
    {"void metal2 p 4 -Dy 0 0 . 0 6 .5 .5 .5 0 .1 .2", ORL_ERR_UNSUPPORTED, 1, "metal2 p", "-Dy"},
    {"void metal2 p 4 1 0 0 f.cal 0 6 .5 .5 .5 0 .1 .2", ORL_ERR_UNSUPPORTED, 1, "metal2 p",
     "f.cal"},
    {"void metal2 p 4 0 0 0 . 0 6 .5 .5 .5 0 .1 .2", ORL_ERR_RANGE, 1, "metal2 p", "grain"},
    {"void metal2 p 4 1 0 0 . 0 6 .5 .5 .5 0 .1 0", ORL_ERR_RANGE, 1, "metal2 p", "too small"},
    {"void trans2 p 4 1 0 0 . 0 7 1 1 1 0 .1 .2 .5", ORL_ERR_SYNTAX, 1, "trans2 p", "8 number"},
    {"void dielectric d 0 0 4 1 1 1 1.5", ORL_ERR_SYNTAX, 1, "dielectric d", "5 number"},
    {"void dielectric d 0 0 5 1 1 1 .5 0", ORL_ERR_RANGE, 1, "dielectric d", "refraction"},
    {"void dielectric d 0 0 5 1 2 1 1.5 0", ORL_ERR_RANGE, 1, "dielectric d", "transmissivity"},
    {"void interface d 0 0 8 1 1 1 1.5 1 1 -1 1", ORL_ERR_RANGE, 1, "interface d",
     "transmissivity"},
    {"void interface d 0 0 8 1 1 1 1.5 1 1 1 11", ORL_ERR_RANGE, 1, "interface d", "refraction"},
    {"void mirror m 0 0 3 1.1 1 1", ORL_ERR_RANGE, 1, "mirror m", "reflectance"},
    {"void mirror m 1 x 0 3 1 1 1", ORL_ERR_NOT_FOUND, 1, "mirror m", "'x'"},
    {"void mirror m 2 x y 0 3 1 1 1", ORL_ERR_SYNTAX, 1, "mirror m", "1 string"},
    {"void illum i 1 x 0 3 1 1 1", ORL_ERR_NOT_FOUND, 1, "illum i", "'x'"},
    {SKY "void illum i 1 sky 0 3 1 1 1", ORL_ERR_NOT_FOUND, 2, "illum i", "'sky'"},
    {"void illum i 0 0 3 -1 1 1", ORL_ERR_RANGE, 1, "illum i", "negative"},
    {SKY "sky illum i 0 0 3 1 1 1", ORL_ERR_UNSUPPORTED, 2, "illum i", "light and glow"},
    {"void spotlight l 0 0 4 1 1 1 30", ORL_ERR_SYNTAX, 1, "spotlight l", "7 number"},
    {"void spotlight l 0 0 7 1 1 1 0 0 0 1", ORL_ERR_RANGE, 1, "spotlight l", "cone"},
    {"void spotlight l 0 0 7 1 1 1 361 0 0 1", ORL_ERR_RANGE, 1, "spotlight l", "cone"},
    {"void spotlight l 0 0 7 1 1 1 30 0 0 0", ORL_ERR_RANGE, 1, "spotlight l", "no length"},
    {"void spotlight l 0 0 7 1 1e31 1 30 0 0 1", ORL_ERR_RANGE, 1, "spotlight l", "too large"},
    {"void spotlight l 0 0 7 1 1 1 30 0 0 1\nl source s 0 0 4 0 0 1 1", ORL_ERR_UNSUPPORTED, 2,
     "source s", "light or glow"},
    /* surfaces */
    {RED "red polygon w\n0\n0\n8 0 0 0 1 0 0 0 1", ORL_ERR_SYNTAX, 2, "polygon w", "8 numbers"},
    {RED "red polygon w\n0\n0\n10 0 0 0 1 0 0 0 1 0 1", ORL_ERR_SYNTAX, 2, "polygon w",
     "10 numbers"},
    {RED "red polygon w 0 0 0", ORL_ERR_SYNTAX, 2, "polygon w", "0 numbers"},
    {RED "red sphere s 0 0 4 0 0 0 -1", ORL_ERR_RANGE, 2, "sphere s", "radius -1"},
    {RED "red cup c 0 0 8 0 0 0 0 0 1 2 -1", ORL_ERR_RANGE, 2, "cup c", "radius -1"},
    {RED "red ring r 0 0 8 0 0 0 0 0 1 -1 1", ORL_ERR_RANGE, 2, "ring r", "not both positive"},
    {RED "red source s 0 0 4 0 0 1 1", ORL_ERR_UNSUPPORTED, 2, "source s", "light or glow"},
    {"void source s 0 0 4 0 0 1 1", ORL_ERR_UNSUPPORTED, 1, "source s", "light or glow"},
    {"void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 0 1", ORL_ERR_RANGE, 2, "source s",
     "no length"},
    {"void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 1 0", ORL_ERR_RANGE, 2, "source s", "angle"},
    {"void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 1 361", ORL_ERR_RANGE, 2, "source s", "angle"},
    /* patterns */
    {"void brightfunc f 2 stripes stripes.cal 0 0", ORL_ERR_NOT_FOUND, 1, "brightfunc f",
     "stripes.cal"},
    {"void brightfunc f 2 stripes . 0 0", ORL_ERR_NOT_FOUND, 1, "brightfunc f", "'stripes'"},
    {"void brightfunc f 2 Px*Ts . 0 0", ORL_ERR_UNSUPPORTED, 1, "brightfunc f", "Ts"},
    {"void brightfunc f 2 A2*Px . 0 1 7", ORL_ERR_RANGE, 1, "brightfunc f", "argument 2"},
    {"void brightfunc f 2 sin(Px . 0 0", ORL_ERR_SYNTAX, 1, "brightfunc f", "')'"},
    {"void colorfunc f 3 1 1 . 0 0", ORL_ERR_SYNTAX, 1, "colorfunc f", "3 expressions"},
    {"void brightfunc f 3 Px . -q 0 0", ORL_ERR_SYNTAX, 1, "brightfunc f", "-q"},
    {"void brightfunc f 2 Px . 0 0\nf dielectric g 0 0 5 1 1 1 1.5 0", ORL_ERR_UNSUPPORTED, 2,
     "dielectric g", "not simulated on dielectrics"},
    {"void brightfunc f 2 Dx . 0 0\nf plastic g 0 0 5 1 1 1 0 0", ORL_ERR_UNSUPPORTED, 2,
     "plastic g", "only on light sources"},
    {"void brightfunc f 2 Px . 0 0\nf brightfunc g 2 skybr skybright.cal 0 3 2 1 1",
     ORL_ERR_UNSUPPORTED, 2, "brightfunc g", "a pattern cannot modify a sky"},
    {"void brightfunc f 2 skybright perezlum.cal 0 3 1 2 3", ORL_ERR_SYNTAX, 1, "brightfunc f",
     "10"},
    {"void brightfunc f 2 skybr skybright.cal 0 3 1 2 3", ORL_ERR_SYNTAX, 1, "brightfunc f", "7"},
    {"void brightfunc f 2 skybr skybright.cal 0 3 5 2 3", ORL_ERR_RANGE, 1, "brightfunc f",
     "type 5"},
    {"void brightfunc f 4 skybright perezlum.cal -rx 9 0 10 1 1 1 -1 1 -1 1 0 0 1",
     ORL_ERR_UNSUPPORTED, 1, "brightfunc f", "vertical"},
    /* BSDFs, before their file is opened */
    {BSDF("5 0 x.xml 0 0 1", "0"), ORL_ERR_SYNTAX, 1, "BSDF b", "six string"},
    {BSDF("8 1e300 x.xml 0 0 1 . -s 1e9", "0"), ORL_ERR_RANGE, 1, "BSDF b", "thickness"},
    {"void aBSDF b\n4 x.xml 0 0 1\n0\n0\n", ORL_ERR_SYNTAX, 1, "aBSDF b", "five string"},
    {"void aBSDF b\n5 x.xml 0 0 1 .\n0\n0\n", ORL_ERR_NOT_FOUND, 1, "aBSDF b", "x.xml"},
    {BSDF("6 0 x.xml 0 0 0 .", "0"), ORL_ERR_RANGE, 1, "BSDF b", "up vector"},
    {BSDF("6 0 x.xml 0 0 z .", "0"), ORL_ERR_UNSUPPORTED, 1, "BSDF b", "'z'"},
    {BSDF("6 0 x.xml 0 0 1 f.cal", "0"), ORL_ERR_UNSUPPORTED, 1, "BSDF b", "f.cal"},
    {BSDF("7 0 x.xml 0 0 1 . -q", "0"), ORL_ERR_SYNTAX, 1, "BSDF b", "'-q'"},
    {BSDF("6 0 x.xml 0 0 1 .", "4 0 0 0 0"), ORL_ERR_SYNTAX, 1, "BSDF b", "3, 6 or 9"},
    {BSDF("6 0 x.xml 0 0 1 .", "3 0 0 1"), ORL_ERR_RANGE, 1, "BSDF b", "diffuse"},
    {BSDF("6 0 x.xml 0 0 1 .", "0"), ORL_ERR_NOT_FOUND, 1, "BSDF b", "x.xml"},
    /* commands */
    {"\n!less /etc/passwd\n", ORL_ERR_UNSUPPORTED, 2, "!less /etc/passwd",
     "'less' is not supported"},
    {"\n!cat /etc/passwd\n", ORL_ERR_NOT_FOUND, 2, "!cat /etc/passwd", "no file named"},
    {"!genbox red b 1 1 1 > x\n", ORL_ERR_UNSUPPORTED, 1, "!genbox red b 1 1 1 > x", "'>'"},
    {"!genbox red b 1 1 1; rm x\n", ORL_ERR_UNSUPPORTED, 1, "!genbox red b 1 1 1; rm x", "';'"},
    {"!cat *.rad\n", ORL_ERR_UNSUPPORTED, 1, "!cat *.rad", "'*'"},
    {"!xform -rx 9 a?.rad\n", ORL_ERR_UNSUPPORTED, 1, "!xform -rx 9 a?.rad", "'?'"},
    {"!genrev red b t*2 1 4 | xform *.rad\n", ORL_ERR_UNSUPPORTED, 1,
     "!genrev red b t*2 1 4 | xform *.rad", "'*'"},
    {"!genbox red `id` 1 1 1\n", ORL_ERR_UNSUPPORTED, 1, "!genbox red `id` 1 1 1", "'`'"},
    {"!genbox red \"$(id)\" 1 1 1\n", ORL_ERR_UNSUPPORTED, 1, "!genbox red \"$(id)\" 1 1 1", "'$'"},
    {"!genbox red b 1 1 1 | tac\n", ORL_ERR_UNSUPPORTED, 1, "!genbox red b 1 1 1 | tac", "'tac'"},
    {"!\n", ORL_ERR_SYNTAX, 1, "!", "missing"},
    {"!xform a.rad |\n", ORL_ERR_SYNTAX, 1, "!xform a.rad |", "missing"},
    {"!genbox red 'b 1 1 1\n", ORL_ERR_SYNTAX, 1, "!genbox red 'b 1 1 1", "never closed"},
    {"\n!genbox red b 1 1 1\n", ORL_ERR_NOT_FOUND, 2, "polygon b.1540", "'red'"},
    {RED "!genbox red b 1 0 1\n", ORL_ERR_RANGE, 2, "!genbox red b 1 0 1", "not positive"},
    {RED "!genbox red b 1 1\n", ORL_ERR_SYNTAX, 2, "!genbox red b 1 1", "three sizes"},
    {RED "!genbox red b 1 1 1 -o\n", ORL_ERR_UNSUPPORTED, 2, "!genbox red b 1 1 1 -o", "'-o'"},
    {RED "!cat\n", ORL_ERR_SYNTAX, 2, "!cat", "needs a file"},
    {RED "!cat missing.rad\n", ORL_ERR_NOT_FOUND, 2, "!cat missing.rad", "missing.rad"},
    {RED "!cat -n a.rad\n", ORL_ERR_UNSUPPORTED, 2, "!cat -n a.rad", "'-n'"},
    {RED "!genprism red p away.txt\n", ORL_ERR_NOT_FOUND, 2, "!genprism red p away.txt",
     "away.txt"},
    {RED "!genclock 9:45\n", ORL_ERR_NOT_FOUND, 2, "brighttext clock_face_paint", "hexbit4x1.fnt"},
    {"!gensky 13 1 12\n", ORL_ERR_RANGE, 1, "!gensky 13 1 12", "month is 13"},
    {"!gensky 1 1 noon\n", ORL_ERR_SYNTAX, 1, "!gensky 1 1 noon", "time of day"},
    {"!gensky 1 1 12XYZ\n", ORL_ERR_SYNTAX, 1, "!gensky 1 1 12XYZ", "time zone"},
    {"!gensky 1 1 12 -q\n", ORL_ERR_SYNTAX, 1, "!gensky 1 1 12 -q", "'-q'"},
    {"!gendaylit 1 1 12 -C\n", ORL_ERR_UNSUPPORTED, 1, "!gendaylit 1 1 12 -C", "coloured"},
    {"!gendaylit 1 1 12 -W 5\n", ORL_ERR_SYNTAX, 1, "!gendaylit 1 1 12 -W 5", "needs a number"},
    {"!gendaylit 1 1 25 -W 5 5\n", ORL_ERR_SYNTAX, 1, "!gendaylit 1 1 25 -W 5 5", "time of day"},
    {"!xform -t 1 0\n", ORL_ERR_SYNTAX, 1, "!xform -t 1 0", "needs a number"},
    {"!xform -t 1 0 x a.rad\n", ORL_ERR_SYNTAX, 1, "!xform -t 1 0 x a.rad", "'x'"},
    {"!xform -s 0 a.rad\n", ORL_ERR_RANGE, 1, "!xform -s 0 a.rad", "must not be 0"},
    {"!xform -s 1e300 -s 1e300 a.rad\n", ORL_ERR_RANGE, 1, "!xform -s 1e300 -s 1e300 a.rad",
     "range"},
    {"!xform -t 1 0 0\n", ORL_ERR_SYNTAX, 1, "!xform -t 1 0 0", "needs a file"},
    {"!xform -q a.rad\n", ORL_ERR_SYNTAX, 1, "!xform -q a.rad", "'-q'"},
    {"!xform missing.rad\n", ORL_ERR_NOT_FOUND, 1, "!xform missing.rad", "missing.rad"},
    {"!xform -a 0 a.rad\n", ORL_ERR_SYNTAX, 1, "!xform -a 0 a.rad", "positive count"},
    {"!xform -a 1000000000 a.rad\n", ORL_ERR_LIMIT, 1, "!xform -a 1000000000 a.rad", "copies"},
    {"!genbox red b 1 1 1 | genbox red b 1 1 1\n", ORL_ERR_UNSUPPORTED, 1,
     "!genbox red b 1 1 1 | genbox red b 1 1 1", "follow"},
};

static int parse_memory(const char *const *names, const struct orl_file *contents, size_t count,
                        struct orl_error *err)
{
    struct orl_memory_files memory = {names, contents, count};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    const int code = orl_scene_parse(names, 1, &files, &parsed_scene, err);
    /* Outputs stay unchanged on failure. */
    if (code < 0)
        assert_null(parsed_scene.arena);
    orl_parsed_scene_done(&parsed_scene);
    return code;
}

/* Parses the text with a surface of the bad primitive's modifier: modifiers are refused when used.
 */
static int parse_used(const struct bad *bad, struct orl_error *err)
{
    char text[2048];
    const char *name = strchr(bad->primitive, ' ');
    const int n = snprintf(text, sizeof text, "%s\n%s sphere user 0 0 4 0 0 0 1\n", bad->text,
                           name ? name + 1 : "");
    assert_in_range(n, 1, sizeof text - 1);
    return scene_parse_bytes(text, (size_t)n, err);
}

static void test_bad_scenes(void **state)
{
    int wrong = 0;
    (void)state;
    for (size_t i = 0; i < sizeof bad_scenes / sizeof *bad_scenes; i++) {
        const struct bad *bad = bad_scenes + i;
        struct orl_error err = {0};
        int code = scene_parse_bytes(bad->text, strlen(bad->text), &err);
        if (code == 0)
            code = parse_used(bad, &err);
        if (code == bad->code && err.code == bad->code && err.line == bad->line &&
            strcmp(err.file, "a.rad") == 0 && strcmp(err.primitive, bad->primitive) == 0 &&
            strstr(err.message, bad->message))
            continue;
        print_error("%s\n-> %d %s:%d: %s: %s\n", bad->text, code, err.file, err.line, err.primitive,
                    err.message);
        wrong++;
    }
    assert_int_equal(wrong, 0);
}

static void test_empty_and_binary_files(void **state)
{
    static const char png[] = "\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    static const char nul[] = "void plastic m\n0\n0\n5 .1 .1 \0 0 0\n";
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(scene_parse_bytes("", 0, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "a.rad");
    assert_non_null(strstr(err.message, "empty"));
    assert_int_equal(scene_parse_bytes(png, sizeof png, &err), ORL_ERR_SYNTAX);
    assert_int_equal(scene_parse_bytes(nul, sizeof nul, &err), ORL_ERR_SYNTAX);
    assert_int_equal(err.line, 4);
    assert_string_equal(err.primitive, "plastic m");
}

static void test_missing_main_file(void **state)
{
    static const char *const names[] = {"a.rad"};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_memory(names, NULL, 0, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, "a.rad");
}

/* A function file among the scene's files: the hint says to leave it out. */
static void test_function_file_as_scene(void **state)
{
    static const char *const names[] = {"hatch.cal"};
    static const char text[] = "{ A hatch. }\nstripe(x) = if(frac(x) - .5, 1, .5);\n";
    const struct orl_file file[] = {{text, sizeof text - 1, NULL}};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_memory(names, file, 1, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "hatch.cal");
    assert_non_null(strstr(err.hint, "function file"));
}

/* Paths with '\\', in commands and in BSDFs, as files written on Windows have them. */
static void test_windows_paths(void **state)
{
    static const char *const names[] = {"a.rad", "parts/box.rad", "bsdf/one pane.xml"};
    static const char text[] = "!xform -t 1 0 0 parts\\box.rad\n!xform \"parts\\box.rad\"\n"
                               "void BSDF pane 6 0 \"bsdf\\one pane.xml\" 0 0 1 . 0 0\n"
                               "pane ring r 0 0 8 5 5 5 0 1 0 0 1\n"
                               "!xform -t 1 1 0 parts/no\\ such.rad\n";
    char bsdf[2048];
    (void)state;
    scene_uniform_bsdf(0.1, bsdf);
    const struct orl_file file[] = {
        {text, sizeof text - 1, NULL}, {RED, sizeof RED - 1, NULL}, {bsdf, strlen(bsdf), NULL}};
    struct orl_memory_files memory = {names, file, 3};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    assert_int_equal(orl_scene_parse(names, 1, &files, &d, &err), ORL_ERR_NOT_FOUND);
    assert_int_equal(err.line, 5);
    assert_non_null(strstr(err.message, "parts/no such.rad"));
}

/* The error for a missing file names the places that were searched. */
static void test_missing_files(void **state)
{
    static const char *const texts[] = {
        "!xform -t 1 2 3 away.rad\n",
        "void BSDF b 6 0 away.xml 0 0 1 . 0 0\nb sphere s 0 0 4 0 0 "
        "0 1\n",
        "void colorpict c 7 red green blue away.hdr . Px Py 0 0\n"
        "c plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1\n"};
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct orl_error err = {0};
        assert_int_equal(scene_parse_bytes(texts[i], strlen(texts[i]), &err), ORL_ERR_NOT_FOUND);
        assert_non_null(strstr(err.message, "no file named 'away."));
        assert_non_null(strstr(err.hint, "in the folder of the file that names them"));
        assert_int_equal(err.line, 1);
    }
}

/* The error for a material that gains light names the numbers whose sum is too large. */
static void test_gain_of_glazing(void **state)
{
    struct orl_error err = {0};
    (void)state;
    static const char *const texts[2][2] = {
        {"void BRTDfunc g 10 .1 .1 .1 .1 .1 .1 0 0 0 . 0 9 .5 .5 .7 0 0 0 0 0 .2\n", "first three"},
        {"void BRTDfunc g 10 .1 .1 .1 .1 .1 .1 0 0 0 . 0 9 0 0 0 .5 .5 .7 0 0 .2\n",
         "second three"},
    };
    for (int i = 0; i < 2; i++) {
        char text[256];
        snprintf(text, sizeof text, "%sg sphere s 0 0 4 0 0 0 1\n", texts[i][0]);
        assert_int_equal(scene_parse_bytes(text, strlen(text), &err), ORL_ERR_RANGE);
        assert_non_null(
            strstr(err.message, "it scatters 1.1 of the incident light, which is more than 1"));
        assert_non_null(strstr(err.hint, texts[i][1]));
        assert_int_equal(err.line, 1);
    }
}

/* An empty file gives a warning; it is an error only if all are empty. */
static void test_empty_file_beside(void **state)
{
    static const char *const names[] = {"a.rad", "b.rad"};
    const struct orl_file file[] = {{"", 0, NULL}, {RED, sizeof RED - 1, NULL}};
    struct orl_memory_files memory = {names, file, 2};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene d = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(orl_scene_parse(names, 2, &files, &d, &err), 0);
    assert_int_equal(d.n_warnings, 1);
    assert_string_equal(d.warnings[0], "a.rad: the file is empty");
    orl_parsed_scene_done(&d);
}

/* Every prefix of a valid scene either parses or is refused with a place; none crashes. */
static void test_every_cut(void **state)
{
    static const char text[] =
        "# cut\nvoid plastic 'red' 0 0 5 .5 .2 .1 0 0\nvoid alias r red\n"
        "r polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n!genbox r b 1 1 1 | xform -n \"x y\" -a 2 -t 2 0 0\n"
        "!gensky -ang 40 10 +s\nskyfunc glow s 0 0 4 1 1 1 0\n!gendaylit -ang 4 10 -P 5 .2\n"
        "s source g 0 0 4 0 0 1 180\n";
    size_t refused = 0;
    (void)state;
    for (size_t size = 1; size < sizeof text; size++) {
        struct orl_error err = {0};
        const int code = scene_parse_bytes(text, size, &err);
        if (code < 0) {
            refused++;
            assert_true(err.line > 0 && err.file[0] && err.message[0]);
        }
    }
    assert_true(refused > sizeof text / 2);
}

static void test_long_words(void **state)
{
    enum { LENGTH = 6000 };
    char *text = malloc(LENGTH);
    struct orl_error err = {0};
    (void)state;
    assert_non_null(text);
    memset(text, 'x', LENGTH);
    assert_int_equal(scene_parse_bytes(text, LENGTH, &err), ORL_ERR_LIMIT);
    text[0] = '"';
    assert_int_equal(scene_parse_bytes(text, LENGTH, &err), ORL_ERR_LIMIT);
    memset(text, '9', LENGTH);
    memcpy(text, "void light l 0 0 3 ", 19);
    assert_int_equal(scene_parse_bytes(text, LENGTH - 2000, &err), ORL_ERR_RANGE);
    assert_string_equal(err.primitive, "light l");
    free(text);
}

static void test_errors_in_included_files(void **state)
{
    static const char *const names[] = {"main.rad", "sub/a.rad", "sub/b.rad"};
    static const struct orl_file contents[] = {{"# one\n!xform -t 1 0 0 sub/a.rad\n", 33, NULL},
                                               {"\n\n!xform -rz 90 b.rad\n", 23, NULL},
                                               {"\nnone sphere s 0 0 4 0 0 0 1\n", 29, NULL}};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_memory(names, contents, 3, &err), ORL_ERR_NOT_FOUND);
    assert_string_equal(err.file, "sub/b.rad");
    assert_int_equal(err.line, 2);
    assert_string_equal(err.primitive, "sphere s");
}

static void test_cycles_and_bombs(void **state)
{
    enum { LENGTH = 8 << 20 };
    static const char *const names[] = {"a.rad", "b.rad"};
    static const struct orl_file cycle[] = {{"!xform b.rad", 12, NULL},
                                            {"!xform ./a.rad", 14, NULL}};
    char *comment = malloc(LENGTH);
    const struct orl_file bomb[] = {{"!xform -a 9000 -rz 1 -a 9 b.rad", 31, NULL},
                                    {comment, LENGTH, NULL}};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_memory(names, cycle, 2, &err), ORL_ERR_LIMIT);
    assert_string_equal(err.file, "b.rad");
    assert_non_null(strstr(err.message, "includes itself"));
    assert_non_null(comment);
    memset(comment, '#', LENGTH);
    assert_int_equal(parse_memory(names, bomb, 2, &err), ORL_ERR_LIMIT);
    assert_non_null(strstr(err.message, "MiB"));
    free(comment);
}

static void test_deep_nesting(void **state)
{
    char names[40][24], texts[40][40];
    const char *name[40];
    struct orl_file contents[40];
    struct orl_error err = {0};
    (void)state;
    for (int i = 0; i < 40; i++) {
        snprintf(names[i], sizeof names[i], "f%d.rad", i);
        snprintf(texts[i], sizeof texts[i], i < 39 ? "!xform f%d.rad\n" : "# end %d\n", i + 1);
        name[i] = names[i];
        contents[i] = (struct orl_file){texts[i], strlen(texts[i]), NULL};
    }
    assert_int_equal(parse_memory(name, contents, 40, &err), ORL_ERR_LIMIT);
    assert_non_null(strstr(err.message, "deep"));
    contents[12] = (struct orl_file){"# end\n", 6, NULL};
    assert_int_equal(parse_memory(name, contents, 40, &err), 0);
}

static void test_bsdf_up_along_normal(void **state)
{
    static const char *const names[] = {"a.rad", "b.xml"};
    static const char scene[] = "void BSDF b 6 0 b.xml 0 0 1 . 0 0\n"
                                "b polygon roof 0 0 9 0 0 0 1 0 0 0 1 0\n";
    static const char xml[] =
        "<?xml version=\"1.0\"?><WindowElement><WindowElementType>System</WindowElementType>"
        "<Optical><Layer><Material><Name>u</Name></Material><DataDefinition>"
        "<IncidentDataStructure>TensorTree4</IncidentDataStructure></DataDefinition>"
        "<WavelengthData><LayerNumber>System</LayerNumber>"
        "<Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>"
        "<WavelengthDataDirection>Transmission Back</WavelengthDataDirection>"
        "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF</ScatteringDataType>"
        "<ScatteringData>{ 0.1 }</ScatteringData></WavelengthDataBlock></WavelengthData></Layer>"
        "</Optical></WindowElement>\n";
    const struct orl_file contents[] = {{scene, sizeof scene - 1, NULL},
                                        {xml, sizeof xml - 1, NULL}};
    const struct orl_file cut[] = {{scene, sizeof scene - 1, NULL}, {xml, sizeof xml / 2, NULL}};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(parse_memory(names, contents, 2, &err), ORL_ERR_RANGE);
    assert_string_equal(err.primitive, "polygon roof");
    assert_non_null(strstr(err.message, "up vector"));
    /* Truncated XML: the error's place is in the XML. */
    assert_int_equal(parse_memory(names, cut, 2, &err), ORL_ERR_SYNTAX);
    assert_string_equal(err.file, "b.xml");
    assert_true(err.line > 0);
}

/* A file may be named relative to its reader's folder or to the top, and with backslashes. Once it
 * is found, no error remains from places where it was not. */
static void what_is_found_in_the_end_is_no_error(void **state)
{
    static const char *const names[] = {"group/a.rad", "parts/b.rad"};
    static const char *const ways[] = {"!xform parts/b.rad\n", "!xform ../parts/b.rad\n",
                                       "!xform parts\\b.rad\n"};
    static const char part[] = "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 0 0 0 1\n";
    (void)state;
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        const struct orl_file contents[] = {{ways[i], strlen(ways[i]), NULL},
                                            {part, sizeof part - 1, NULL}};
        struct orl_memory_files memory = {names, contents, 2};
        const struct orl_files files = orl_files_from_memory(&memory);
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        assert_int_equal(orl_scene_parse(names, 1, &files, &d, &err), 0);
        assert_int_equal(d.n_surfaces, 1);
        assert_int_equal(err.code, 0);
        assert_string_equal(err.message, "");
        orl_parsed_scene_done(&d);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),
        cmocka_unit_test(test_empty_and_binary_files),
        cmocka_unit_test(test_function_file_as_scene),
        cmocka_unit_test(test_missing_main_file),
        cmocka_unit_test(test_gain_of_glazing),
        cmocka_unit_test(test_missing_files),
        cmocka_unit_test(test_windows_paths),
        cmocka_unit_test(test_empty_file_beside),
        cmocka_unit_test(test_every_cut),
        cmocka_unit_test(test_long_words),
        cmocka_unit_test(test_errors_in_included_files),
        cmocka_unit_test(test_cycles_and_bombs),
        cmocka_unit_test(test_deep_nesting),
        cmocka_unit_test(test_bsdf_up_along_normal),
        cmocka_unit_test(what_is_found_in_the_end_is_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
