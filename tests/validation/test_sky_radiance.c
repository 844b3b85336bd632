/*
 * Radiance's skies: 20 of gendaylit and gensky, in 200 directions each, compared with the values of
 * Radiance 6.1's own programs and rtrace for the same words (tests/fixtures/skies.txt). By the
 * command in a scene, and, if equivalent, as a job's sky in its compatible mode.
 *
 * The fixture has 5 digits. Scenes use the digits that the programs print, so they agree to those;
 * jobs compute in full precision, and the programs print 4 digits of a brightness: a relative error
 * of 5e-4.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "light/daylight/daylight.h"
#include "support/references.h"
#include "support/scene_text.h"

enum { DIRECTIONS = 200, SKIES = 20 };

/* Most directions cover the sky uniformly and a little below the horizon, the last fifty are close
 * to the horizon. */
static struct orl_vec3 direction(int i)
{
    const double z = i < 150 ? -0.2 + (i + 0.5) * 1.2 / 150 : -0.08 + (i - 150 + 0.5) * 0.16 / 50;
    const double phi = 2.399963229728653 * i, r = sqrt(1 - z * z);
    return orl_v3(r * cos(phi), r * sin(phi), z);
}

static const struct {
    const char *name;
    enum orl_sky_model model;
    int kind; /* enum orl_sky_input of a Perez sky, otherwise enum orl_sky_cie */
} inputs[] = {{"normal_w", ORL_SKY_BY_PEREZ, ORL_SKY_NORMAL_W},
              {"normal_lx", ORL_SKY_BY_PEREZ, ORL_SKY_NORMAL_LX},
              {"horizontal_w", ORL_SKY_BY_PEREZ, ORL_SKY_HORIZONTAL_W},
              {"indices", ORL_SKY_BY_PEREZ, ORL_SKY_INDICES},
              {"clear", ORL_SKY_BY_CIE, ORL_SKY_CLEAR},
              {"overcast", ORL_SKY_BY_CIE, ORL_SKY_OVERCAST},
              {"uniform", ORL_SKY_BY_CIE, ORL_SKY_UNIFORM},
              {"intermediate", ORL_SKY_BY_CIE, ORL_SKY_INTERMEDIATE}};

/* Returns the requested sky of a line such as "job clear 20 -50 0 0". */
static struct orl_sky sky_of_job(const char *line)
{
    struct orl_sky_request r = {.normalise = ORL_SKY_GENDAYLIT,
                                .sun_given = true,
                                .ground_reflectance = 0.2,
                                .turbidity = 2.45,
                                .direct_normal_lx = -1};
    struct orl_daylight d = {0};
    char name[32];
    size_t i = 0;
    assert_int_equal(sscanf(line, "job %31s %lf %lf %lf %lf", name, &r.sun_altitude_deg,
                            &r.sun_azimuth_deg, &r.first, &r.second),
                     5);
    while (i < sizeof inputs / sizeof *inputs && strcmp(inputs[i].name, name) != 0)
        i++;
    assert_true(i < sizeof inputs / sizeof *inputs);
    r.model = inputs[i].model;
    if (r.model == ORL_SKY_BY_PEREZ)
        r.input = (enum orl_sky_input)inputs[i].kind;
    else
        r.cie_type = (enum orl_sky_cie)inputs[i].kind;
    if (r.model == ORL_SKY_BY_CIE)
        r.input = ORL_SKY_TYPICAL;
    assert_int_equal(orl_daylight_check(&r, NULL), 0);
    assert_int_equal(orl_daylight_from_request(&r, NULL, &d, NULL), 0);
    return d.pattern;
}

static struct orl_sky sky_of_command(const char *command)
{
    char scene[300];
    snprintf(scene, sizeof scene, "!%s\n", command);
    struct orl_parsed_scene d = scene_parse_text(scene, NULL, NULL);
    assert_int_equal(d.n_skies, 1);
    const struct orl_sky sky = d.skies[0];
    orl_parsed_scene_done(&d);
    return sky;
}

/* Adds a row for the direction with the largest error. */
static void compare_sky(struct references *set, const struct orl_sky *sky, const double *radiances,
                        const char *place, double tolerance)
{
    int worst = 0;
    double most = -1;
    for (int i = 0; i < DIRECTIONS; i++) {
        const double off = fabs(orl_sky_brightness(sky, direction(i)) / radiances[i] - 1);
        if (off > most) {
            most = off;
            worst = i;
        }
    }
    reference_row_within(set, place, radiances[worst], orl_sky_brightness(sky, direction(worst)),
                         tolerance);
}

/* Reads the next line of the fixture that is no comment, without its newline; returns false at the
 * end. */
static bool next_line(FILE *file, char *line, int room)
{
    do {
        if (!fgets(line, room, file))
            return false;
        line[strcspn(line, "\n")] = '\0';
    } while (line[0] == '#');
    return true;
}

static void read_radiances(FILE *file, const char *first_line, double *ret_radiances)
{
    char line[512];
    snprintf(line, sizeof line, "%s", first_line);
    for (int i = 0; i < DIRECTIONS;) {
        char *at = line, *end;
        for (double v = strtod(at, &end); end != at && i < DIRECTIONS; v = strtod(at, &end)) {
            ret_radiances[i++] = v;
            at = end;
        }
        assert_true(i == DIRECTIONS || next_line(file, line, sizeof line));
    }
}

static void test_skies(void **state)
{
    FILE *file = fopen("tests/fixtures/skies.txt", "r");
    char command[256], job[128], line[512];
    struct references set = {.name = "sky radiance, worst of 200 directions", .tolerance = 5e-3};
    int skies = 0, jobs = 0;
    (void)state;
    assert_non_null(file);
    while (next_line(file, line, sizeof line)) {
        double radiances[DIRECTIONS];
        assert_int_equal(strncmp(line, "sky ", 4), 0);
        snprintf(command, sizeof command, "%.250s", line + 4);
        assert_true(next_line(file, line, sizeof line));
        job[0] = '\0';
        if (strncmp(line, "job ", 4) == 0) {
            snprintf(job, sizeof job, "%.120s", line);
            assert_true(next_line(file, line, sizeof line));
        }
        read_radiances(file, line, radiances);
        const struct orl_sky sky = sky_of_command(command);
        compare_sky(&set, &sky, radiances, command, 1e-4);
        skies++;
        if (job[0]) {
            const struct orl_sky same = sky_of_job(job);
            compare_sky(&set, &same, radiances, job, 6e-4);
            jobs++;
        }
    }
    fclose(file);
    references_end(&set);
    assert_int_equal(skies, SKIES);
    assert_true(jobs >= 10);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_skies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
