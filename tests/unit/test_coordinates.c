/* All readers refuse impossible positions and directions in the same words. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <oriel/annual/annual_report.h>
#include <oriel/base/input_checks.h>

#include "annual_job/annual_members_json.h"
#include "job/job_members_json.h"
#include "render/film/film.h"
#include "run/request/job_inputs.h"

static const char *const absurd[] = {"1e300", "-1e300", "1.01e12"};
enum { ABSURD = sizeof absurd / sizeof *absurd };

static void test_limits(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 1e300, -1.01e12};
    struct orl_error err;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        for (int axis = 0; axis < 3; axis++) {
            const struct orl_vec3 v =
                orl_v3(axis == 0 ? bad[i] : 1, axis == 1 ? bad[i] : 1, axis == 2 ? bad[i] : 1);
            assert_int_equal(orl_check_point(v, "here", &err), ORL_ERR_RANGE);
            assert_ptr_equal(strstr(err.message, "here: "), err.message);
            assert_int_equal(orl_check_direction(v, "here", &err), ORL_ERR_RANGE);
        }
    assert_int_equal(orl_check_point(orl_v3(1e12, -1e12, 0), "", &err), 0);
    assert_int_equal(orl_check_direction(orl_v3(0, 0, 0), "", &err), ORL_ERR_RANGE);
    assert_int_equal(orl_check_direction(orl_v3(1e-200, 0, 0), "", &err), ORL_ERR_RANGE);
    assert_int_equal(orl_check_direction(orl_v3(1e12, 0, 0), "", &err), 0);
}

/* Returns the text with the word in place of its "%s". */
static void fill_in(const char *text, const char *word, char ret_text[256])
{
    const char *gap = strstr(text, "%s");
    assert_non_null(gap);
    snprintf(ret_text, 256, "%.*s%s%s", (int)(gap - text), text, word, gap + 2);
}

typedef int decoder(const json_t *value, const char *path, void *into, struct orl_error *err);

static int decode_job_sensors(const json_t *value, const char *path, void *into,
                              struct orl_error *err)
{
    return orl_job_sensors_from_json(value, path, into, err);
}

union request_of {
    struct orl_viewpoint_request viewpoints;
    struct orl_exposure_request exposure;
    struct orl_view_out_request view_out;
    struct orl_job job;
};

static void viewpoints_done(union request_of *request_of)
{
    orl_viewpoint_request_done(&request_of->viewpoints);
}
static void exposure_done(union request_of *request_of)
{
    orl_exposure_request_done(&request_of->exposure);
}
static void view_out_done(union request_of *request_of)
{
    orl_view_out_request_done(&request_of->view_out);
}
static void job_done(union request_of *request_of)
{
    orl_job_done(&request_of->job);
}

/* Checks that a document is refused with each invalid number in one place. */
static void refuse_document(decoder *decode, union request_of *request_of,
                            void (*done)(union request_of *request_of), const char *format,
                            const char *where)
{
    for (int i = 0; i < ABSURD; i++) {
        char text[256];
        struct orl_error err = {0};
        fill_in(format, absurd[i], text);
        json_t *doc = json_loads(text, 0, NULL);
        assert_non_null(doc);
        memset(request_of, 0, sizeof *request_of);
        assert_int_equal(decode(doc, "", request_of, &err), ORL_ERR_RANGE);
        json_decref(doc);
        done(request_of);
        assert_non_null(strstr(err.message, "at most 1e+12 in magnitude"));
        assert_string_equal(err.primitive, where);
    }
}

static void test_documents(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        union request_of request_of;
        refuse_document(orl_annual_glare_from_json, &request_of, viewpoints_done,
                        i == 0 ? "{\"seats\": [{\"at\": [0, %s, 0], \"towards\": [0, 1, 0]}]}"
                               : "{\"seats\": [{\"at\": [0, 0, 0], \"towards\": [%s, 1, 0]}]}",
                        i == 0 ? "seats[0].at" : "seats[0].towards");
        refuse_document(orl_annual_exposure_from_json, &request_of, exposure_done,
                        "{\"points\": [{\"at\": [0, 0, %s]}]}", "points[0].at");
        refuse_document(orl_annual_view_out_from_json, &request_of, view_out_done,
                        "{\"points\": [{\"at\": [0, 0, %s]}]}", "points[0].at");
        refuse_document(decode_job_sensors, &request_of, job_done,
                        i == 0 ? "[[0, 0, %s, 0, 0, 1]]" : "[[0, 0, 1, 0, 0, %s]]", "[0]");
    }
}

/* Options of a view, and lines of a sensor file. */
static void test_texts(void **state)
{
    static const char *const views[] = {"-vtv -vp 0 0 %s -vd 0 1 0 -vh 60 -vv 60",
                                        "-vtv -vp 0 0 0 -vd %s 1 0 -vh 60 -vv 60",
                                        "-vtv -vp 0 0 0 -vd 0 1 0 -vu 0 1 %s -vh 60 -vv 60"};
    static const char *const lines[] = {"0 0 %s 0 0 1\n", "0 0 0 0 %s 1\n"};
    (void)state;
    for (int i = 0; i < ABSURD; i++) {
        struct orl_error err = {0};
        char text[256];
        for (int k = 0; k < 3; k++) {
            struct orl_view view;
            fill_in(views[k], absurd[i], text);
            assert_int_equal(orl_view_parse(text, &view, &err), ORL_ERR_RANGE);
            assert_non_null(strstr(err.message, "at most 1e+12 in magnitude"));
        }
        for (int k = 0; k < 2; k++) {
            struct orl_sensor *sensors = NULL;
            size_t count = 0;
            fill_in(lines[k], absurd[i], text);
            assert_int_equal(orl_sensors_parse("a.pts", text, strlen(text), &sensors, &count, &err),
                             ORL_ERR_RANGE);
            assert_non_null(strstr(err.message, "at most 1e+12 in magnitude"));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_limits),
                                       cmocka_unit_test(test_documents),
                                       cmocka_unit_test(test_texts)};
    return cmocka_run_group_tests_name("coordinates", tests, NULL, NULL);
}
