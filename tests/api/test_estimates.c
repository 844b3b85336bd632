/* Estimates of memory and disk for jobs with matrices as results, compared with measured peaks and
 * bytes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "checks/job_manifest.h"
#include "process/limits.h"
#include "support/cli.h"
#include "support/room.h"
#include "support/year_room.h"

static const char weather[] = "place x\nlatitude 47\nlongitude -8\ntime_zone -15\n"
                              "site_elevation 0\nweather_data_file_units 1\n3 21 11.5 800 100\n";

static int set_up(void **state)
{
    static struct year_room room;
    struct reply reply;
    const struct upload_file files[] = {
        {"room.rad", year_room_scene, strlen(year_room_scene), false},
        {"one.wea", weather, sizeof weather - 1, true}};
    daemon_start(&room.daemon, (const char *const[]){"--threads", "2", NULL});
    daemon_upload(&room.daemon, files, 2, NULL, &reply);
    assert_int_equal(reply.status, 201);
    snprintf(room.scene, sizeof room.scene, "%s", reply_text(&reply, "id"));
    reply_done(&reply);
    *state = &room;
    return 0;
}

/* Returns members of an annual document with one lit hour; owned. */
static char *year_of(int sensors, const char *format)
{
    char *text = malloc((size_t)sensors * 24 + 200);
    assert_non_null(text);
    size_t at = (size_t)sprintf(text,
                                "\"weather\":\"one.wea\",\"samples\":16,\"metrics\":[\"DA300\"],"
                                "\"formats\":[\"%s\"],\"sensors\":[",
                                format);
    for (int i = 0; i < sensors; i++)
        at += (size_t)sprintf(text + at, "%s[%d.5,2,1,0,0,1]", i ? "," : "", i % 3);
    sprintf(text + at, "]");
    return text;
}

/* Estimates from the document, the room, and its one row of weather. */
static void estimate(const struct year_room *f, const char *members, double *ret_memory_mb,
                     double *ret_disk_mb)
{
    const size_t size = strlen(members) + 256;
    char *text = malloc(size);
    struct orl_job_manifest brief;
    struct orl_error err = {0};
    assert_non_null(text);
    snprintf(text, size, "{\"kind\":\"annual\",\"scene\":\"%s\",%s}", f->scene, members);
    const struct orl_file document = {text, strlen(text), NULL};
    if (orl_job_manifest_read(&document, &brief, &err))
        fail_msg("%s", err.message);
    brief.needs.surfaces = brief.needs.triangles = 7;
    brief.needs.year_rows = 1;
    *ret_memory_mb = (double)orl_job_memory_estimate(&brief.needs) / (1 << 20);
    *ret_disk_mb =
        (double)(brief.result_bytes + ORL_MATRIX_CHANNELS * orl_job_memory_windows(&brief.needs)) /
        (1 << 20);
    orl_job_manifest_done(&brief);
    free(text);
}

/* Peak memory and file sizes of one run. */
struct taken {
    double memory_mb, disk_mb;
};

static double size_of_files(const char *folder)
{
    char command[128];
    double bytes = 0;
    snprintf(command, sizeof command, "du -sb %s/out | cut -f1", folder);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    assert_int_equal(fscanf(pipe, "%lf", &bytes), 1);
    pclose(pipe);
    return bytes / (1 << 20);
}

/* Number of sensors computed together: buffers for a block are part of any job. */
enum { BLOCK = 64 };

static struct taken run_alone(const char *members)
{
    const size_t size = strlen(members) + 128;
    char folder[64], path[80], out[80], *text = malloc(size);
    const char *const args[] = {"annual", path, "-o", out, "--threads", "2", NULL};
    struct rusage usage;
    int status = -1;
    assert_non_null(text);
    cli_make_folder(folder);
    snprintf(path, sizeof path, "%s/year.json", folder);
    snprintf(out, sizeof out, "%s/out", folder);
    snprintf(text, size, "{\"kind\":\"annual\",\"scene\":{\"files\":[\"room.rad\"]},%s}", members);
    cli_write_file(folder, "year.json", text);
    cli_write_file(folder, "room.rad", year_room_scene);
    cli_write_file(folder, "one.wea", weather);
    struct cli_child child = cli_start(args);
    assert_int_equal(wait4(child.pid, &status, 0, &usage), child.pid);
    close(child.out_fd);
    close(child.err_fd);
    assert_int_equal(status, 0);
    const struct taken taken = {(double)usage.ru_maxrss / 1024, size_of_files(folder)};
    cli_remove_folder(folder);
    free(text);
    return taken;
}

/* Compares the excess over a year of one block of sensors without matrices: the estimate is at
 * least the measured value, and at most three times that. */
static void compare_estimate(const struct year_room *f, int sensors, const char *format)
{
    struct taken foreseen, least_foreseen;
    char *members = year_of(sensors, format), *least = year_of(BLOCK, "ill");
    estimate(f, members, &foreseen.memory_mb, &foreseen.disk_mb);
    estimate(f, least, &least_foreseen.memory_mb, &least_foreseen.disk_mb);
    const double foreseen_mb = foreseen.memory_mb - least_foreseen.memory_mb;
    const struct taken least_taken = run_alone(least);
    struct taken taken = run_alone(members);
    /* The order in which threads allocate adds up to 4 MB to a peak on a busy machine: the minimum
     * of several runs counts. */
    for (int i = 0; i < 4 && taken.memory_mb - least_taken.memory_mb >= foreseen_mb; i++) {
        const struct taken again = run_alone(members);
        taken.memory_mb = fmin(taken.memory_mb, again.memory_mb);
    }
    const double memory_mb = taken.memory_mb - least_taken.memory_mb;
    print_message("%s of %d sensors: memory %.0f MB more, %.0f foreseen; results %.0f MB, %.0f "
                  "foreseen\n",
                  format, sensors, memory_mb, foreseen_mb, taken.disk_mb, foreseen.disk_mb);
    assert_true(memory_mb < foreseen_mb && foreseen_mb < 3 * memory_mb);
    assert_true(taken.disk_mb < foreseen.disk_mb && foreseen.disk_mb < 3 * taken.disk_mb);
    free(members);
    free(least);
}

static void test_coefficients(void **state)
{
    if (ORL_SANITIZED)
        skip();
    compare_estimate(*state, 2000, "coefficients");
}

static void test_phases(void **state)
{
    if (ORL_SANITIZED)
        skip();
    compare_estimate(*state, 600, "phases");
}

/* Photons traced until they are absorbed deposit more values than the map of sunlight stores; the
 * estimate of memory covers them. */
static void test_photons(void **state)
{
    static const char members[] =
        "\"weather\":\"one.wea\",\"samples\":16,\"technique\":\"precomputed\","
        "\"photons\":1000000,\"sensors\":[[2,2,1,0,0,1]]";
    double memory_mb, disk_mb;
    if (ORL_SANITIZED)
        skip();
    estimate(*state, members, &memory_mb, &disk_mb);
    const struct taken taken = run_alone(members);
    print_message("a million photons: memory %.0f MB, %.0f foreseen\n", taken.memory_mb, memory_mb);
    assert_true(taken.memory_mb < memory_mb);
}

/* A result that can never fit is refused before anything is computed. */
static void test_beyond_the_budget(void **state)
{
    static const char *const small[] = {"--storage-budget", "60M", NULL};
    struct year_room *f = *state;
    struct reply reply;
    char *members = year_of(3000, "coefficients");
    daemon_end(&f->daemon, SIGTERM);
    daemon_restart(&f->daemon, small);
    year_room_post(f, members, &reply);
    assert_int_equal(reply.status, 507);
    reply_done(&reply);
    free(members);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_beyond_the_budget),
        cmocka_unit_test(test_coefficients),
        cmocka_unit_test(test_phases),
        cmocka_unit_test(test_photons),
    };
    return cmocka_run_group_tests(tests, set_up, year_room_tear_down);
}
