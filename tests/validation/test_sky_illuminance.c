/*
 * Illuminance of an open sensor under every kind of sky input, compared with the request: through
 * orl_run, with the input converted to lux here by independent formulas (Perez 1990, gensky's sun)
 * and skies of scene files integrated here from their arguments.
 *
 * 65536 stratified rays: the sky's integral has an error of 1e-4 and the horizon's edge 3e-4; the
 * sun is sampled directly. Skies must be within 0.2 %.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <oriel/base/vec.h>

#include "support/references.h"
#include "support/scene_text.h"

static const double efficacy = ORL_EFFICACY_LM_PER_W;
static const double deg = ORL_DEG_TO_RAD;

/* ---- Independent model ----------------------------------------------------------------------- */

/* Perez 1990, table 4: upper clearness of each bin, then a..d of diffuse and of direct light. */
static const double bins[8][9] = {
    {1.065, 97.24, -0.46, 12.00, -8.91, 57.20, -4.55, -2.98, 117.12},
    {1.230, 107.22, 1.15, 0.59, -3.95, 98.99, -3.46, -1.21, 12.38},
    {1.500, 104.97, 2.96, -5.53, -8.77, 109.83, -4.90, -1.71, -8.81},
    {1.950, 102.39, 5.59, -13.95, -13.90, 110.34, -5.84, -1.99, -4.56},
    {2.800, 100.71, 5.94, -22.75, -23.74, 106.36, -3.97, -1.75, -6.16},
    {4.500, 106.42, 3.83, -36.15, -28.83, 107.19, -1.25, -1.51, -26.73},
    {6.200, 141.88, 1.90, -53.24, -14.03, 105.75, 0.77, -1.26, -34.44},
    {99.00, 152.23, 0.35, -45.27, -7.98, 101.18, 1.58, -1.10, -8.29}};

/* Converts direct normal and diffuse horizontal irradiance to global horizontal illuminance. */
static double perez_lux(double direct_w, double diffuse_w, double altitude_deg, int day)
{
    static const double water_cm = 2; /* gendaylit's assumption */
    const double z = (90 - altitude_deg) * deg, height = sin(altitude_deg * deg);
    const double k = 1.041 * z * z * z;
    const double clearness = ((diffuse_w + direct_w) / diffuse_w + k) / (1 + k);
    const double air_mass = 1 / (cos(z) + 0.15 * pow(93.885 - z / deg, -1.253));
    const double beyond = 1367 * (1 + 0.033412 * cos(2 * ORL_PI * (day - 3) / 365.0));
    const double brightness = diffuse_w * air_mass / beyond;
    const double *b = bins[0];
    while (clearness >= b[0])
        b += 9;
    return diffuse_w * (b[1] + b[2] * water_cm + b[3] * cos(z) + b[4] * log(brightness)) +
           direct_w * height *
               (b[5] + b[6] * water_cm + b[7] * exp(5.73 * z - 5) + b[8] * brightness);
}

/* Returns the sun's altitude by gensky's formulas; longitude and meridian in degrees east. */
static double altitude_deg(int day, double hour, double latitude, double longitude, double meridian)
{
    const double declination = 0.4093 * sin(2 * ORL_PI / 368 * (day - 81));
    const double solar = hour + 0.170 * sin(4 * ORL_PI / 373 * (day - 80)) -
                         0.129 * sin(2 * ORL_PI / 355 * (day - 8)) + (longitude - meridian) / 15;
    return asin(sin(latitude * deg) * sin(declination) -
                cos(latitude * deg) * cos(declination) * cos(ORL_PI * solar / 12)) /
           deg;
}

/* ---- Skies in the job ------------------------------------------------------------------------ */

static double read_sensor(const struct scene_run *base, struct orl_vec3 direction)
{
    const struct orl_sensor sensor = {{0, 0, 1}, direction};
    struct scene_run run = *base;
    double lx;
    run.sensors = &sensor;
    run.n_sensors = 1;
    run.samples = 65536;
    run.global = 1;
    scene_run_lx(&run, &lx);
    return lx;
}

static struct orl_sky_request by_sun(double altitude, enum orl_sky_input input, double first,
                                     double second)
{
    return (struct orl_sky_request){.model = ORL_SKY_BY_PEREZ,
                                    .sun_given = true,
                                    .sun_altitude_deg = altitude,
                                    .sun_azimuth_deg = -40,
                                    .input = input,
                                    .first = first,
                                    .second = second,
                                    .ground_reflectance = 0.2,
                                    .turbidity = 2.45,
                                    .direct_normal_lx = -1};
}

static void job_row(struct references *set, const char *what, const struct orl_sky_request *sky,
                    double lux)
{
    const struct scene_run run = {.scene = "# nothing\n", .sky = sky};
    reference_row(set, what, lux, read_sensor(&run, orl_v3(0, 0, 1)));
}

static void test_job_skies(void **state)
{
    struct references set = {.name = "sky in the job: Perez, CIE", .tolerance = 0.002};
    (void)state;
    for (int i = 0; i < 5; i++) {
        static const double altitudes[5] = {6, 20, 40, 60, 85};
        static const double direct[5] = {9000, 40000, 70000, 90000, 100000};
        static const double diffuse[5] = {4000, 10000, 30000, 12000, 45000};
        struct orl_sky_request sky = by_sun(altitudes[i], ORL_SKY_NORMAL_LX, direct[i], diffuse[i]);
        char what[64];
        snprintf(what, sizeof what, "-L %.0f %.0f, sun at %.0f deg", direct[i], diffuse[i],
                 altitudes[i]);
        job_row(&set, what, &sky, direct[i] * sin(altitudes[i] * deg) + diffuse[i]);
    }
    static const struct {
        const char *what;
        double altitude, direct, diffuse;
    } watts[4] = {{"-W 800 120, sun at 51 deg", 51, 800, 120},
                  {"-W 0 150, sun at 30 deg", 30, 0, 150},
                  {"-W 200 300, sun at 35 deg", 35, 200, 300},
                  {"-W 400 80, sun at 15 deg", 15, 400, 80}};
    for (int i = 0; i < 4; i++) {
        struct orl_sky_request sky =
            by_sun(watts[i].altitude, ORL_SKY_NORMAL_W, watts[i].direct, watts[i].diffuse);
        /* A sun given by its position has no date: gendaylit then uses day 0. */
        job_row(&set, watts[i].what, &sky,
                perez_lux(watts[i].direct, watts[i].diffuse, watts[i].altitude, 0));
    }
    static const struct {
        const char *what;
        enum orl_sky_cie type;
        double diffuse, direct;
    } cies[5] = {{"CIE clear, 12000 lx + sun 80000 lx", ORL_SKY_CLEAR, 12000, 80000},
                 {"CIE clear, 9000 lx, no sun", ORL_SKY_CLEAR, 9000, 0},
                 {"CIE intermediate, 30000 + 20000 lx", ORL_SKY_INTERMEDIATE, 30000, 20000},
                 {"CIE overcast, 15000 lx", ORL_SKY_OVERCAST, 15000, 0},
                 {"CIE uniform, 10000 lx", ORL_SKY_UNIFORM, 10000, 0}};
    for (int i = 0; i < 5; i++) {
        struct orl_sky_request sky = by_sun(50, ORL_SKY_DIFFUSE_LX, cies[i].diffuse, 0);
        sky.model = ORL_SKY_BY_CIE;
        sky.cie_type = cies[i].type;
        sky.direct_normal_lx = cies[i].direct;
        job_row(&set, cies[i].what, &sky, cies[i].diffuse + cies[i].direct * sin(50 * deg));
    }
    references_end(&set);
}

/* Rows of 22 March and 21 December in the made-up weather of tests/fixtures. */
static void test_weather_files(void **state)
{
    static const struct {
        const char *what;
        int month, day, day_of_year;
        double hour, direct, diffuse;
    } rows[4] = {{"22 March 11:30, 812 + 119 W/m2", 3, 22, 81, 11.5, 812, 119},
                 {"22 March 16:30, 558 + 61 W/m2", 3, 22, 81, 16.5, 558, 61},
                 {"21 December 10:30, 121 W/m2", 12, 21, 355, 10.5, 0, 121},
                 {"21 December 14:30, 90 W/m2", 12, 21, 355, 14.5, 0, 90}};
    static char names[2][16] = {"weather.epw", "weather.wea"};
    (void)state;
    for (int file = 0; file < 2; file++) {
        char path[64];
        size_t size;
        struct references set = {.name = file == 0 ? "sky from an EPW file" : "sky from a WEA file",
                                 .tolerance = 0.002};
        snprintf(path, sizeof path, "tests/fixtures/%s", names[file]);
        unsigned char *bytes = scene_read_bytes(path, &size);
        char *text = calloc(size + 1, 1);
        assert_non_null(text);
        memcpy(text, bytes, size);
        free(bytes);
        for (int i = 0; i < 4; i++) {
            const struct orl_sky_request sky = {.model = ORL_SKY_BY_WEATHER,
                                                .time_given = true,
                                                .month = rows[i].month,
                                                .day = rows[i].day,
                                                .hour = rows[i].hour,
                                                .sun_method = ORL_SUN_RADIANCE,
                                                .ground_reflectance = 0.2,
                                                .weather_file = names[file]};
            const struct scene_run run = {.scene = "# nothing\n",
                                          .resource_name = names[file],
                                          .resource_text = text,
                                          .sky = &sky};
            const double altitude =
                altitude_deg(rows[i].day_of_year, rows[i].hour, 38.42, 27.14, 30);
            reference_row(&set, rows[i].what,
                          perez_lux(rows[i].direct, rows[i].diffuse, altitude, rows[i].day_of_year),
                          read_sensor(&run, orl_v3(0, 0, 1)));
        }
        free(text);
        references_end(&set);
    }
}

/* ---- Skies in the scene ---------------------------------------------------------------------- */

/* Sky and ground blend about the horizon, in perezlum.cal as in skybright.cal. */
static double blended(double z, double sky, double ground)
{
    const double up = pow(z + 1.01, 10), down = 1 / up;
    return fmax(0, (up * sky + down * ground) / (up + down));
}

static double angle_between(const double *sun, struct orl_vec3 d)
{
    return acos(fmin(fmax(sun[0] * d.x + sun[1] * d.y + sun[2] * d.z, -1), 1));
}

/* skybright with the arguments A1.. (a[0]..), written from the programs' manual pages. */
static double skybright(const struct orl_sky *sky, struct orl_vec3 d)
{
    const double *a = sky->a;
    if (sky->kind == ORL_SKY_PEREZ) {
        const double g = angle_between(a + 7, d);
        return blended(d.z,
                       a[0] * (1 + a[2] * exp(a[3] / fmax(d.z, 0.01))) *
                           (1 + a[4] * exp(a[5] * g) + a[6] * cos(g) * cos(g)),
                       a[1]);
    }
    if (a[0] == 2)
        return blended(d.z, a[1] * (1 + 2 * d.z) / 3, a[2]);
    if (a[0] == 3)
        return blended(d.z, a[1], a[2]);
    const double g = angle_between(a + 4, d);
    if (a[0] == 1)
        return blended(d.z,
                       a[1] * (0.91 + 10 * exp(-3 * g) + 0.45 * cos(g) * cos(g)) *
                           (1 - exp(-0.32 / fmax(d.z, 0.01))) / a[3],
                       a[2]);
    const double eta = acos(d.z), sun = acos(a[6]);
    const double gradation = (1.35 * sin(5.631 - 3.59 * eta) + 3.12) * sin(4.396 - 2.6 * sun);
    return blended(d.z,
                   a[1] * (gradation + 6.37 - eta) / 2.326 *
                       exp(-0.563 * g * ((2.629 - eta) * (1.562 - sun) + 0.812)) / a[3],
                   a[2]);
}

/*
 * Returns the irradiance from the sky above the horizon, on a plane of that normal; by midpoints.
 */
static double irradiance(const struct orl_sky *sky, struct orl_vec3 normal)
{
    enum { ROWS = 900, COLUMNS = 720 };
    double sum = 0;
    for (int i = 0; i < ROWS; i++)
        for (int k = 0; k < COLUMNS; k++) {
            const double z = (i + 0.5) / ROWS, s = sqrt(1 - z * z);
            const double phi = 2 * ORL_PI * (k + 0.5) / COLUMNS;
            const struct orl_vec3 d = orl_v3(s * cos(phi), s * sin(phi), z);
            sum += fmax(0, orl_dot(d, normal)) * skybright(sky, d);
        }
    return sum * 2 * ORL_PI / ((double)ROWS * COLUMNS);
}

#define SOURCE "skyfunc glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 180\n"

/* Commands in a scene keep Radiance's own numbers, defined by their arguments. */
static void test_scene_skies(void **state)
{
    static const char *const commands[] = {"gendaylit 3 22 12 -a 38.42 -o -27.14 -m -30 -W 800 120",
                                           "gendaylit 6 21 14.5 -a 48.2 -o -16.4 -m -15 -W 0 250",
                                           "gendaylit 12 21 10 -a 42 -o 71 -m 75 -G 150 90",
                                           "gendaylit -ang 35 30 -L 35000 12000",
                                           "gendaylit -ang 25 -60 -P 1.35 .25",
                                           "gensky 6 21 12 +s -a 40 -o 105 -m 105",
                                           "gensky -ang 30 20 +i",
                                           "gensky -ang 50 0 -s -B 60",
                                           "gensky -ang 15 -45 -c -b 20",
                                           "gensky 9 21 15.5 -u -a 52 -o -13 -m -15"};
    struct references set = {.name = "sky in the scene", .tolerance = 0.002};
    (void)state;
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        char text[512];
        snprintf(text, sizeof text, "!%s\n" SOURCE, commands[i]);
        struct orl_parsed_scene d = scene_parse_text(text, NULL, NULL);
        double lux = efficacy * irradiance(&d.skies[0], orl_v3(0, 0, 1));
        for (size_t s = 0; s < d.n_distant_sources; s++) {
            const struct orl_material *m = &d.materials[d.distant_sources[s].material];
            const double quarter = sin(0.25 * d.distant_sources[s].angle_deg * deg);
            if (m->kind == ORL_MATERIAL_LIGHT)
                lux += efficacy * m->color.g * 4 * ORL_PI * quarter * quarter *
                       d.distant_sources[s].direction.z;
        }
        orl_parsed_scene_done(&d);
        reference_row(&set, commands[i], lux,
                      read_sensor(&(struct scene_run){.scene = text}, orl_v3(0, 0, 1)));
    }
    references_end(&set);
}

/*
 * The overcast sky: 7 pi Lz / 9, and 0.396177 of it on a wall, where the pattern's ground continues
 * the horizon's value. The blending pulls values near the horizon toward it: it takes 0.05 %, and
 * 0.3 % on a wall, which the integral includes and the closed forms do not.
 */
static void test_overcast(void **state)
{
    static const char scene[] =
        "void brightfunc skyfunc 2 skybr skybright.cal 0 3 2 1 .33333333\n" SOURCE;
    struct references set = {.name = "CIE overcast sky", .tolerance = 0.002};
    const struct orl_sky sky = {.kind = ORL_SKY_CIE, .a = {2, 1, 1.0 / 3}, .n_args = 3};
    const struct scene_run run = {.scene = scene};
    const double up = read_sensor(&run, orl_v3(0, 0, 1));
    (void)state;
    reference_row(&set, "E_h, integral", efficacy * irradiance(&sky, orl_v3(0, 0, 1)), up);
    reference_row(&set, "E_h = 7 pi L_z / 9", efficacy * 7 * ORL_PI / 9, up);
    for (int i = 0; i < 3; i++) {
        const struct orl_vec3 n = orl_v3(cos(1.1 * i), sin(1.1 * i), 0);
        const double wall = read_sensor(&run, n);
        reference_row(&set, "E_v, integral", efficacy * irradiance(&sky, n), wall);
        reference_row_within(&set, "E_v / E_h", 0.396177, wall / up, 0.01);
    }
    references_end(&set);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_job_skies),
        cmocka_unit_test(test_weather_files),
        cmocka_unit_test(test_scene_skies),
        cmocka_unit_test(test_overcast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
