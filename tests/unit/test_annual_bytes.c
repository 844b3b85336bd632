/* The estimated disk space of an annual job is enough for the files that grow with its viewpoints.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <oriel/annual/annual_report.h>

#include "runner/estimate/job_estimate.h"
#include "support/scratch.h"

enum { VIEWPOINTS = 2, HOURS = 8784 };

/* Fills in values with the maximum number of characters. */
static void fill_hours(struct orl_viewpoint_hours *hours)
{
    for (int i = 0; i < HOURS; i++) {
        hours->dgp[i] = hours->low[i] = hours->high[i] = 0.9876F;
        hours->eye_lx[i] = 1.2346e-12F;
    }
}

static uint64_t file_bytes(const char *path)
{
    struct stat st;
    assert_int_equal(stat(path, &st), 0);
    return (uint64_t)st.st_size;
}

static void test_glare(void **state)
{
    static char name[64];
    static float values[VIEWPOINTS][4][HOURS];
    static struct orl_annual_step steps[HOURS];
    static uint32_t step_of_column[HOURS];
    struct orl_viewpoint viewpoints[VIEWPOINTS];
    struct orl_viewpoint_hours hours[VIEWPOINTS];
    (void)state;
    memset(name, '"', sizeof name - 1); /* each quote is doubled in a table */
    for (int i = 0; i < VIEWPOINTS; i++) {
        viewpoints[i] = (struct orl_viewpoint){.name = name};
        hours[i] = (struct orl_viewpoint_hours){
            .dgp = values[i][0], .low = values[i][1], .high = values[i][2], .eye_lx = values[i][3]};
        fill_hours(&hours[i]);
    }
    for (uint32_t i = 0; i < HOURS; i++) {
        steps[i] = (struct orl_annual_step){.month = 12, .day = 31, .hour = 23.4567};
        step_of_column[i] = i;
    }
    struct orl_job_request job_request = {.kind = ORL_JOB_KIND_ANNUAL};
    const struct orl_annual_report report = {.viewpoint_hours = hours, .n_viewpoints = VIEWPOINTS};
    const struct orl_annual_result result = {
        .n_steps = HOURS, .n_columns = HOURS, .steps = steps, .step_of_column = step_of_column};
    const uint64_t without = orl_job_kinds[ORL_JOB_KIND_ANNUAL].result_bytes(&job_request);
    job_request.of.annual.report_request.glare.viewpoints = viewpoints;
    job_request.of.annual.report_request.glare.n_viewpoints = VIEWPOINTS;
    const uint64_t estimate =
        orl_job_kinds[ORL_JOB_KIND_ANNUAL].result_bytes(&job_request) - without;
    const char *path = scratch_path("glare.csv");
    assert_int_equal(
        orl_annual_glare_csv(path, &job_request.of.annual.report_request, &report, &result, NULL),
        0);
    const uint64_t bytes = file_bytes(path), dates = HOURS * strlen("12,31,23.4567\n");
    print_message("# glare.csv: %llu bytes, of which %llu are dates; estimate %llu\n",
                  (unsigned long long)bytes, (unsigned long long)dates,
                  (unsigned long long)estimate);
    assert_in_range(estimate, bytes - dates, 2 * bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_glare)};
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
