/* Memory of annual glare viewpoints: limited by their number, and covered by the estimate. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "process/limits.h"
#include "runner/estimate/job_estimate.h"
#include "support/cli.h"
#include "support/room.h"

enum { FEW = 4, MANY = 40, ROWS = 3 };

/* Writes viewpoints in rows, all facing the window. */
static char *write_document(int viewpoints)
{
    char *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    assert_non_null(f);
    fputs("{\"kind\": \"annual\", \"scene\": {\"files\": [\"room.rad\"]}, \"weather\": "
          "\"y.wea\", \"samples\": 8, \"seed\": 1, \"sensors\": [[2, 2, 0.8, 0, 0, 1]], "
          "\"glare\": {\"seats\": [",
          f);
    for (int i = 0; i < viewpoints; i++)
        fprintf(f, "%s{\"at\": [%g, %g, 1.2], \"towards\": [0, -1, 0]}", i ? ", " : "",
                0.5 + 0.4 * (i % 8), 3 + 0.3 * (double)(i / 8));
    fputs("]}}", f);
    fclose(f);
    return text;
}

/* Returns the largest resident set of a run, bytes. */
static uint64_t peak_of(int viewpoints)
{
    static const char weather[] = "place m\nlatitude 38.42\nlongitude -27.14\ntime_zone -30\n"
                                  "site_elevation 0\nweather_data_file_units 1\n"
                                  "1 21 10.5 700 90\n9 3 14.5 300 250\n11 5 12.5 0 160\n";
    char *document = write_document(viewpoints), *text;
    const struct cli_file files[] = {{"job.json", document},
                                     {"room.rad", ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE},
                                     {"y.wea", weather},
                                     {NULL, NULL}};
    struct cli_desk *desk;
    struct rusage usage;
    int status = 0;
    assert_int_equal(cli_desk_set_up((void **)&desk, files), 0);
    const char *args[] = {"annual", desk->document, "-o", desk->output, NULL};
    struct cli_child child = cli_start(args);
    assert_int_equal(wait4(child.pid, &status, 0, &usage), child.pid);
    close(child.out_fd);
    close(child.err_fd);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    text = cli_read_file(desk->output, "result.json");
    assert_non_null(text);
    free(text);
    free(document);
    cli_desk_tear_down((void **)&desk);
    return (uint64_t)usage.ru_maxrss << 10;
}

static void test_bounded(void **state)
{
    if (ORL_SANITIZED)
        skip();
    const uint64_t few = peak_of(FEW), many = peak_of(MANY);
    const struct orl_job_memory needs = {
        .surfaces = 8, .triangles = 20, .sensors = 1, .year_rows = ROWS, .viewpoints = MANY};
    (void)state;
    print_message("peak %llu MiB of %d seats, %llu MiB of %d; foreseen: %llu MiB\n",
                  (unsigned long long)(few >> 20), FEW, (unsigned long long)(many >> 20), MANY,
                  (unsigned long long)(orl_job_memory_estimate(&needs) >> 20));
    assert_true(many < few + (16 << 20));
    assert_true(many < orl_job_memory_estimate(&needs));
}

/* Weather rows and viewpoints add to it; views add up to the number held in memory at once. */
static void test_estimate(void **state)
{
    struct orl_job_memory needs = {.year_rows = 8760};
    (void)state;
    assert_int_equal(orl_job_memory_viewpoints(&needs), 0);
    needs.viewpoints = 1;
    const uint64_t one = orl_job_memory_viewpoints(&needs);
    needs.viewpoints = 4;
    const uint64_t four = orl_job_memory_viewpoints(&needs);
    needs.viewpoints = 256;
    const uint64_t most = orl_job_memory_viewpoints(&needs);
    assert_true(four - one > 3 * (48ULL << 20));
    assert_true(most > four + 252ULL * 8760 * 6 / 10 * 16);
    assert_true(most < four + (32ULL << 20));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bounded),
                                       cmocka_unit_test(test_estimate)};
    return cmocka_run_group_tests_name("seat_memory", tests, NULL, NULL);
}
