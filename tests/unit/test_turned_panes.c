/* BSDF panes whose front faces outdoors give a warning, if their orientation matters. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "fixtures/bsdf_make.h"
#include "support/scene_text.h"

#define SKY "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
#define ROOM                                                                                       \
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid BSDF F1 6 0 pane.xml 0 0 1 . 0 0\n"                   \
    "w polygon floor 0 0 12 -2 0 0 -2 4 0 2 4 0 2 0 0\n"                                           \
    "w polygon roof 0 0 12 -2 0 3 2 0 3 2 4 3 -2 4 3\n"                                            \
    "w polygon back 0 0 12 -2 4 0 -2 4 3 2 4 3 2 4 0\n"                                            \
    "w polygon left 0 0 12 -2 0 0 -2 0 3 -2 4 3 -2 4 0\n"                                          \
    "w polygon right 0 0 12 2 0 0 2 4 0 2 4 3 2 0 3\n"                                             \
    "w polygon front 0 0 30 -2 0 0 2 0 0 2 0 3 -2 0 3 -2 0 0 -1 0 1 -1 0 2 1 0 2 1 0 1 -1 0 1\n"
#define INWARDS "F1 polygon pane 0 0 12 -1 0 1 -1 0 2 1 0 2 1 0 1\n"
#define OUTWARDS "F1 polygon pane 0 0 12 -1 0 1 1 0 1 1 0 2 -1 0 2\n"

/* Trees of one level: of transmission from the back, and of both reflections. */
static const struct data {
    const char *transmission, *front, *back;
} even = {"{ 0.1 }", "{ 0.05 }", "{ 0.05 }"}, bright_inside = {"{ 0.1 }", "{ 0.15 }", "{ 0.05 }"},
  slats = {"{ {0} {0} {0} {0} {0} {0} {0} {0} {.2} {.2} {.2} {.2} {.2} {.2} {.2} {.2} }",
           "{ 0.05 }", "{ 0.05 }"};

static char *write_data(const struct data *data)
{
    struct text t;
    text_open(&t);
    make_head(t.stream, "TensorTree4");
    make_block_head(t.stream, "Visible", "Transmission Back", NULL);
    fprintf(t.stream, "%s", data->transmission);
    make_block_tail(t.stream);
    make_block_head(t.stream, "Visible", "Reflection Front", NULL);
    fprintf(t.stream, "%s", data->front);
    make_block_tail(t.stream);
    make_block_head(t.stream, "Visible", "Reflection Back", NULL);
    fprintf(t.stream, "%s", data->back);
    make_block_tail(t.stream);
    make_tail(t.stream);
    text_close(&t);
    return t.data;
}

/* Returns the number of warnings that name the pane as reversed. */
static size_t count_warnings(const char *scene, const struct data *data)
{
    static const struct orl_sensor sensor = {{0, 2, 0.8}, {0, 0, 1}};
    static const char wanted[] = "the BSDF pane 'pane' (scene.rad:11) has its front outdoors";
    char *text = write_data(data);
    size_t n = 0;
    struct orl_result result = scene_run(&(struct scene_run){.scene = scene,
                                                             .resource_name = "pane.xml",
                                                             .resource_text = text,
                                                             .sensors = &sensor,
                                                             .n_sensors = 1,
                                                             .technique = ORL_TECHNIQUE_BACKWARD,
                                                             .samples = 16});
    for (size_t i = 0; i < result.n_warnings; i++)
        n += strncmp(result.warnings[i], wanted, strlen(wanted)) == 0;
    orl_result_done(&result);
    free(text);
    return n;
}

static void test_turned(void **state)
{
    (void)state;
    assert_int_equal(count_warnings(SKY ROOM OUTWARDS, &slats), 1);
    assert_int_equal(count_warnings(SKY ROOM OUTWARDS, &bright_inside), 1);
}

static void test_not_turned(void **state)
{
    (void)state;
    assert_int_equal(count_warnings(SKY ROOM INWARDS, &slats), 0);
    assert_int_equal(count_warnings(SKY ROOM INWARDS, &bright_inside), 0);
    assert_int_equal(count_warnings(SKY ROOM OUTWARDS, &even), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_turned),
                                       cmocka_unit_test(test_not_turned)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
