/*
 * replmarks and cat: replacements of marker polygons. Expected places are those of Radiance 6.1's
 * replmarks and xform for the same files.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/files.h>

#include "scene/parse/parse.h"

#define GREY                                                                                       \
    "void plastic m 0 0 5 .5 .5 .5 0 0\nvoid plastic green 0 0 5 .1 .5 .1 0 0\n"                   \
    "void plastic mark 0 0 5 .5 .5 .5 0 0\n"

/* A tip along x, slightly off the axis, so that every rotation is visible. */
static const char tip[] = "m sphere tip 0 0 4 1 .25 .125 .1\n";
static const char marks[] = "mark polygon a 0 0 9  1 2 3  1 4 3  0 2 3\n"
                            "mark polygon b 0 0 9  0 0 1  0 0 5  2 0 1\n"
                            "other polygon c 0 0 12  1 1 0  5 2 1  5 2 1.1  1.2 2 1\n"
                            "m sphere kept 0 0 4 9 9 9 .5\n"
                            "!xform -t 10 0 0 more.rad\n";
static const char more[] = "mark polygon d 0 0 9  1 2 3  1 4 3  0 2 3\n";

static int parse(const char *line, struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err)
{
    static const char *const names[] = {"a.rad", "tip.rad", "marks.rad", "more.rad"};
    char text[1024];
    snprintf(text, sizeof text, GREY "%s\n", line);
    const struct orl_file contents[] = {{text, strlen(text), NULL},
                                        {tip, sizeof tip - 1, NULL},
                                        {marks, sizeof marks - 1, NULL},
                                        {more, sizeof more - 1, NULL}};
    struct orl_memory_files memory = {names, contents, 4};
    const struct orl_files files = orl_files_from_memory(&memory);
    return orl_scene_parse(names, 1, &files, ret_parsed_scene, err);
}

struct place {
    const char *name, *material;
    double at[3], radius;
};

static const struct {
    const char *line;
    size_t n;
    struct place places[5];
} good[] = {
    {"!replmarks -x tip.rad mark -x tip.rad other marks.rad | xform -t 0 0 0 | cat",
     5,
     {{"a.tip", "m", {0.75, 3, 3.125}, 0.1},
      {"b.tip", "m", {0.25, 0.125, 2}, 0.1},
      {"c.tip", "m", {2.20662296777, 1.91086646842, 0.761482884665}, 0.1},
      {"kept", "m", {9, 9, 9}, 0.5},
      {"d", "mark", {0, 0, 0}, 0}}},
    {"!xform -n q -rx 30 -t 1 0 0 marks.rad | replmarks -m green -x tip.rad mark -x tip.rad other",
     5,
     {{"q.a.tip", "green", {1.75, 1.03557640378, 4.20632917547}, 0.1},
      {"q.b.tip", "green", {1.25, -0.891746824527, 1.79455040378}, 0.1},
      {"q.c.tip", "m", {3.20662296654, 1.27411766573, 1.61489634995}, 0.1},
      {"q.kept", "m", {10, 3.29422863406, 12.2942286341}, 0.5},
      {"q.d.tip", "green", {11.75, 1.03557640378, 4.20632917547}, 0.1}}},
    {"!replmarks -e -s .5 -x tip.rad mark -m green -x tip.rad other marks.rad",
     5,
     {{"a.tip", "m", {0.75, 3, 3.125}, 0.1},
      {"b.tip", "m", {0.5, 0.25, 3}, 0.2},
      {"c.tip", "green", {3.11324599667, 1.83058764013, 0.546660536602}, 0.1900658},
      {"kept", "m", {9, 9, 9}, 0.5},
      {"d.tip", "m", {10.75, 3, 3.125}, 0.1}}},
    {"!replmarks -s 2 -x tip.rad mark more.rad | xform -n far -mx -s 2",
     1,
     {{"far.d.tip", "m", {0, 12, 7}, 0.8}}},
    {"!genblinds mark b 1 2 3 2 20 | cat | xform -ry 15 | replmarks -x tip.rad mark",
     2,
     {{"b.1.0.tip", "m", {0.930365857634, 1, 0.914335401575}, 0.1},
      {"b.2.0.tip", "m", {1.31859485763, 1, 2.36322440157}, 0.1}}},
    {"!cat tip.rad tip.rad | xform -n x",
     2,
     {{"x.tip", "m", {1, 0.25, 0.125}, 0.1}, {"x.tip", "m", {1, 0.25, 0.125}, 0.1}}},
};

static void test_places(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        if (parse(good[i].line, &d, &err) < 0)
            fail_msg("%s: %s", good[i].line, err.message);
        assert_int_equal(d.n_surfaces, good[i].n);
        for (size_t k = 0; k < d.n_surfaces; k++) {
            const struct place *p = &good[i].places[k];
            const struct orl_surface *s = &d.surfaces[k];
            const struct orl_vec3 at = orl_v3(p->at[0], p->at[1], p->at[2]);
            assert_string_equal(s->name, p->name);
            assert_string_equal(d.materials[s->material].name, p->material);
            /* xform prints angles with six decimals of a degree, over a length of 5. */
            if (s->kind != ORL_SURFACE_POLYGON &&
                (orl_length(orl_sub(s->quadric->center[0], at)) > 1e-7 ||
                 fabs(s->quadric->radius[0] - p->radius) > 1e-9))
                fail_msg("%s: %s at %.12g %.12g %.12g, %.12g", good[i].line, s->name,
                         s->quadric->center[0].x, s->quadric->center[0].y, s->quadric->center[0].z,
                         s->quadric->radius[0]);
        }
        orl_parsed_scene_done(&d);
    }
}

static const struct {
    const char *line;
    int code;
    const char *message;
} refused[] = {
    {"!replmarks marks.rad", ORL_ERR_SYNTAX, "needs -x"},
    {"!replmarks -x tip.rad mark", ORL_ERR_SYNTAX, "needs a file"},
    {"!replmarks -m m mark marks.rad", ORL_ERR_SYNTAX, "missing for 'mark'"},
    {"!replmarks -i tip.oct mark marks.rad", ORL_ERR_NOT_FOUND, "tip.oct"},
    {"!replmarks -q mark marks.rad", ORL_ERR_SYNTAX, "'-q'"},
    {"!replmarks -s x -x tip.rad mark marks.rad", ORL_ERR_SYNTAX, "'x'"},
    {"!replmarks -x away.rad mark marks.rad", ORL_ERR_NOT_FOUND, "away.rad"},
    {"!replmarks -x a.rad mark marks.rad", ORL_ERR_LIMIT, "includes itself"},
    {"!genbox mark b 1 1 1 | replmarks -x tip.rad mark marks.rad", ORL_ERR_SYNTAX, "no files"},
    {"!genprism mark p 7 0 0 1 0 2 1 2 2 1 3 0 2 -1 1 | replmarks -x tip.rad mark", ORL_ERR_SYNTAX,
     "not a marker"},
    {"!genbox m b 1 1 1 | cat tip.rad", ORL_ERR_SYNTAX, "no files"},
};

static void test_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        struct orl_parsed_scene d = {0};
        struct orl_error err = {0};
        const int code = parse(refused[i].line, &d, &err);
        if (code != refused[i].code || !strstr(err.message, refused[i].message))
            fail_msg("%s: %d, %s", refused[i].line, code, err.message);
        assert_true(err.file[0] != '\0' && err.line > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_places),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
