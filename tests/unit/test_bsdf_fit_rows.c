/* Rows of measurement files: both formats, sides and orientations, and refusals with their place.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/bsdf/bsdf_fit.h>

#include "bsdf/fit/measurements/measurements.h"

static const struct orl_fit_read_options plain = {0};

static int read_text(const char *text, const struct orl_fit_read_options *reading,
                     struct orl_fit_data *data, struct orl_error *err)
{
    return orl_fit_read("data.txt", 3, text, strlen(text), reading, data, err);
}

static void assert_direction(double x, double y, double z, double ex, double ey, double ez)
{
    if (fabs(x - ex) > 1e-5 || fabs(y - ey) > 1e-5 || fabs(z - ez) > 1e-5)
        fail_msg("(%g, %g, %g) is not (%g, %g, %g)", x, y, z, ex, ey, ez);
}

/* upphi defaults to 0: the direction at phi 0 is up. A DSF is divided by the cosine. */
static void pab_rows_are_turned_up_and_taken_by_side(void **state)
{
    struct orl_fit_data data = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(read_text("#sample_name \"film 7\"\n#format: theta phi DSF\n"
                               "#incident_angle\t30\t180\n#whatever 1 2 3\r\n"
                               "60 0 0.5\n120 90 0.25\n  45.0\t 10 1e-3 \n",
                               &plain, &data, &err),
                     0);
    assert_string_equal(data.name, "film 7");
    assert_int_equal(data.n_scans, 2);
    assert_int_equal(data.n_rows, 3);
    const struct orl_fit_scan *r = &data.scans[0], *t = &data.scans[1];
    assert_true(r->front && !r->transmitted && t->front && t->transmitted);
    assert_direction(r->in.x, r->in.y, r->in.z, 0, -0.5, sqrt(0.75));
    assert_int_equal(r->n_rows, 2);
    const struct orl_fit_row *up = &r->rows[0], *left = &t->rows[0];
    assert_direction((double)up->x, (double)up->y, (double)up->z, 0, sqrt(0.75), 0.5);
    assert_true(fabs((double)up->value - 1) < 1e-6);
    assert_direction((double)left->x, (double)left->y, (double)left->z, -sqrt(0.75), 0, 0.5);
    assert_true(fabs((double)left->value - 0.5) < 1e-6);
    assert_true(up->file == 3 && up->line == 5 && left->line == 6);
    orl_fit_data_done(&data);
}

/* The sample seen from behind is turned about its up axis, which stays. */
static void reversed_is_turned_about_what_is_up(void **state)
{
    const struct orl_fit_read_options reversed = {.reversed = true};
    struct orl_fit_data data = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(read_text("#format: theta phi BSDF\n#intheta 30\n#inphi 0\n#upphi 90\n"
                               "60 90 0.5\n",
                               &reversed, &data, &err),
                     0);
    assert_int_equal(data.n_scans, 1);
    assert_false(data.scans[0].front);
    assert_false(data.scans[0].transmitted);
    assert_direction(data.scans[0].in.x, data.scans[0].in.y, data.scans[0].in.z, -0.5, 0,
                     sqrt(0.75));
    const struct orl_fit_row *row = &data.scans[0].rows[0];
    assert_direction((double)row->x, (double)row->y, (double)row->z, 0, sqrt(0.75), 0.5);
    orl_fit_data_done(&data);
}

static void csv_has_columns_in_any_order(void **state)
{
    const struct orl_fit_read_options no_grazing = {.grazing_deg = 5};
    struct orl_fit_data data = {0};
    struct orl_error err = {0};
    (void)state;
    assert_int_equal(
        read_text("\xef\xbb\xbf# remark\n\"bsdf\"; phi_in;theta_in; theta_out;phi_out\n"
                  "0.1;180;30;20;0\n\n0.2;180;30;86;0\n0.3;180;150;160;0\n",
                  &no_grazing, &data, &err),
        0);
    assert_int_equal(data.n_rows, 3);
    assert_int_equal(data.n_scans, 2);
    assert_int_equal(data.scans[0].n_rows, 1);
    assert_false(data.scans[1].front);
    assert_false(data.scans[1].transmitted);
    assert_direction(data.scans[0].in.x, data.scans[0].in.y, data.scans[0].in.z, -0.5, 0,
                     sqrt(0.75));
    orl_fit_data_done(&data);
}

static void what_is_wrong_is_told_with_its_line(void **state)
{
    static const struct {
        const char *text;
        int code, line;
        const char *says;
    } cases[] = {
        {"", ORL_ERR_SYNTAX, 1, "no row"},
        {"#format: theta phi DSF\n1 2 3\n", ORL_ERR_SYNTAX, 2, "incident_angle"},
        {"#intheta 3\n#inphi 3\n1 2 3\n", ORL_ERR_SYNTAX, 3, "#format"},
        {"#format: x y z\n", ORL_ERR_UNSUPPORTED, 1, "format"},
        {"#format: theta phi DSF\n#incident_angle 3\n", ORL_ERR_SYNTAX, 2, "second"},
        {"#format: theta phi DSF\n#incident_angle 3 x\n", ORL_ERR_SYNTAX, 2, "'x' is not a number"},
        {"#format: theta phi DSF\n#incident_angle 90 0\n1 2 3\n", ORL_ERR_RANGE, 3, "not 90"},
        {"#format: theta phi DSF\n#incident_angle 3 0\n1 2\n", ORL_ERR_SYNTAX, 3, "missing"},
        {"#format: theta phi DSF\n#incident_angle 3 0\n1 2 3 4\n", ORL_ERR_SYNTAX, 3,
         "a row must be"},
        {"#format: theta phi DSF\n#incident_angle 3 0\n1 2 nan\n", ORL_ERR_RANGE, 3, "finite"},
        {"#format: theta phi DSF\n#incident_angle 3 0\n181 2 1\n", ORL_ERR_RANGE, 3, "181"},
        {"#format: theta phi DSF\n#incident_angle 3 0\n1 1e9 1\n", ORL_ERR_RANGE, 3, "azimuth"},
        {"#colorimetry: RGB\n", ORL_ERR_UNSUPPORTED, 1, "CIE-XYZ"},
        {"theta_in,phi_in,theta_out,bsdf\n", ORL_ERR_SYNTAX, 1, "phi_out"},
        {"theta_in,phi_in,theta_out,phi_out\n", ORL_ERR_SYNTAX, 1, "dsf"},
        {"theta_in,theta_in\n", ORL_ERR_SYNTAX, 1, "twice"},
        {"theta_in,colour\n", ORL_ERR_SYNTAX, 1, "colour"},
        {"theta_in,phi_in,theta_out,phi_out,dsf\n1,2,3,4\n", ORL_ERR_SYNTAX, 2, "5 columns"},
        {"theta_in,phi_in,theta_out,phi_out,dsf\n1,2,3,4,5,6\n", ORL_ERR_SYNTAX, 2, "5 columns"},
        {"theta_in,phi_in,theta_out,phi_out,dsf\n1,2,3,4,\n", ORL_ERR_SYNTAX, 2, "missing"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct orl_fit_data data = {0};
        struct orl_error err = {0};
        const int code = read_text(cases[i].text, &plain, &data, &err);
        if (code != cases[i].code || err.line != cases[i].line ||
            !strstr(err.message, cases[i].says) || strcmp(err.file, "data.txt") != 0)
            fail_msg("%zu: %d, %s:%d: %s", i, code, err.file, err.line, err.message);
        orl_fit_data_done(&data);
    }
}

static enum orl_bsdf_fit_symmetry symmetry_of(const char *incidents, int *ret_code)
{
    struct orl_fit_data data = {0};
    struct orl_error err = {0};
    enum orl_bsdf_fit_symmetry symmetry = ORL_BSDF_FIT_SYMMETRIES;
    char text[4096] = "theta_in,phi_in,theta_out,phi_out,bsdf\n";
    double theta, phi;
    int used;
    for (; sscanf(incidents, "%lf/%lf %n", &theta, &phi, &used) == 2; incidents += used)
        sprintf(text + strlen(text), "%g,%g,10,0,1\n", theta, phi);
    assert_int_equal(read_text(text, &plain, &data, &err), 0);
    *ret_code = orl_fit_sort_scans(&data, ORL_BSDF_FIT_AUTO, &symmetry, &err);
    orl_fit_data_done(&data);
    return symmetry;
}

/* The symmetry is derived as in pabopto2bsdf, except for directions on axes only. */
static void azimuths_tell_the_symmetry(void **state)
{
    static const struct {
        const char *incidents;
        enum orl_bsdf_fit_symmetry symmetry;
    } cases[] = {
        {"0/0 30/180 60/180 ", ORL_BSDF_FIT_ISOTROPIC},
        {"150/0 120/0 30/180 ", ORL_BSDF_FIT_ISOTROPIC},
        {"0/0 30/0 30/45 30/90 ", ORL_BSDF_FIT_QUADRILATERAL},
        {"30/0 30/90 ", ORL_BSDF_FIT_QUADRILATERAL},
        {"30/45 30/135 ", ORL_BSDF_FIT_UP_DOWN},
        {"30/225 30/300 30/180 ", ORL_BSDF_FIT_UP_DOWN},
        {"30/100 30/200 ", ORL_BSDF_FIT_LEFT_RIGHT},
        {"30/10 30/350 ", ORL_BSDF_FIT_LEFT_RIGHT},
        {"30/45 30/135 30/225 30/315 ", ORL_BSDF_FIT_ASYMMETRIC},
    };
    int code;
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const enum orl_bsdf_fit_symmetry found = symmetry_of(cases[i].incidents, &code);
        if (code != 0 || found != cases[i].symmetry)
            fail_msg("%s: %d, %s", cases[i].incidents, code, orl_bsdf_fit_symmetry_name(found));
    }
    symmetry_of("30/45 30/225 ", &code);
    assert_int_equal(code, ORL_ERR_INVALID);
    symmetry_of("30/0 30/180 ", &code);
    assert_int_equal(code, ORL_ERR_INVALID);
}

/* Measurement files are distinguished from scenes, because no scene line has numbers only. */
static void measurements_are_told_from_scenes(void **state)
{
    static const struct {
        const char *text;
        bool measured;
    } files[] = {
        {"# lab\n#incident_angle 30 180\n120 90 0.25\n", true},
        {"\xef\xbb\xbf# excel\ntheta_in;phi_in;theta_out;phi_out;bsdf\n0;0;120;0;1\n", true},
        {"Theta_In,phi_in,Theta_Out,phi_out,dsf", true},
        {"\n\n  10\t20 1e-3", true},
        {"void plastic p 0 0 5 .5 .5 .5 0 0\n", false},
        {"# a sphere\n1 sphere 2 0 0 4 0 0 0 1\n", false},
        {"!genbox p b 1 1 1\n", false},
        {"120 90 nan\n", true},
        {"NaN -inf Infinity\n", true},
        {"120 90 n/a\n", true},
        {"# lab\n#format: theta phi DSF\n", true}, /* cut off after its header */
        {"#format: ascii\nvoid plastic p 0 0 5 .5 .5 .5 0 0\n", false},
        {"nan plastic p 0 0 5 .5 .5 .5 0 0\n", false},
        {"10 20\n", false},
        {"# nothing\n", false},
        {"", false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        if (orl_bsdf_is_measured(files[i].text, strlen(files[i].text)) != files[i].measured)
            fail_msg("%s", files[i].text);
}

/* A first row that begins with a non-finite number is a row of pab-opto data, not a CSV header:
 * the error is about the number. */
static void first_rows_are_rows_of_numbers(void **state)
{
    static const char *const texts[] = {"nan 0 1\n", "-inf 90 1\n", "30 90 NaN\n"};
    static const char head[] = "#incident_angle 30 180\n#format: theta phi DSF\n";
    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct orl_fit_data data = {0};
        const struct orl_fit_read_options reading = {.reversed = false};
        struct orl_error err = {0};
        char text[128];
        snprintf(text, sizeof text, "%s%s", head, texts[i]);
        assert_int_equal(orl_fit_read("m.txt", 0, text, strlen(text), &reading, &data, &err),
                         ORL_ERR_RANGE);
        assert_int_equal(err.line, 3);
        assert_non_null(strstr(err.message, "is not a finite number"));
        orl_fit_data_done(&data);
        orl_fit_read("m.txt", 0, texts[i], strlen(texts[i]), &reading, &data, &err);
        assert_null(strstr(err.message, "column"));
        orl_fit_data_done(&data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pab_rows_are_turned_up_and_taken_by_side),
        cmocka_unit_test(reversed_is_turned_about_what_is_up),
        cmocka_unit_test(csv_has_columns_in_any_order),
        cmocka_unit_test(what_is_wrong_is_told_with_its_line),
        cmocka_unit_test(azimuths_tell_the_symmetry),
        cmocka_unit_test(measurements_are_told_from_scenes),
        cmocka_unit_test(first_rows_are_rows_of_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
