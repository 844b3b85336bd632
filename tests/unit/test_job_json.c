/* Job documents: decoded values, and the message for each mistake. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "job/job_json.h"
#include "json/decode.h"

#define ID "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"

static int decode(const char *text, enum orl_job_origin origin, struct orl_job *job, char **id,
                  struct orl_error *err)
{
    json_t *doc = NULL;
    int rc = orl_json_parse("job.json", text, strlen(text), &doc, err);
    if (rc == 0)
        rc = orl_job_from_json(doc, origin, job, id, err);
    json_decref(doc);
    return rc;
}

static void test_full_remote_document(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    const int rc =
        decode("{\"kind\":\"render\",\"scene\":\"" ID "\",\"technique\":\"gather\",\"seed\":7,"
               "\"photons\":{\"global\":2e5,\"caustic\":0},\"gather_samples\":64,"
               "\"pixel_samples\":1048576,\"effects\":{\"glossy\":\"force\"},"
               "\"sensors\":[[1,2,3,0,0,1],[4.5,5,6,1,0,0]],"
               "\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":4,\"height\":3,"
               "\"metrics\":[\"dgp\",\"vertical_illuminance_lx\"],\"glare\":{\"threshold\":7,"
               "\"task\":{\"x\":1,\"y\":2,\"angle_rad\":0.5},\"peaks\":false,"
               "\"formula\":\"published\",\"position\":\"whole_pixels\",\"age_years\":60,"
               "\"directions\":{\"count\":5,\"span_deg\":90}}}]}",
               ORL_JOB_REMOTE, &job, &id, &err);
    assert_int_equal(rc, 0);
    assert_string_equal(id, ID);
    assert_int_equal(job.seed, 7);
    assert_int_equal(job.photons_global, 200000);
    assert_int_equal(job.photons_caustic, 0);
    assert_int_equal(job.technique, ORL_TECHNIQUE_GATHER);
    assert_int_equal(job.gather_samples, 64);
    assert_int_equal(job.pixel_samples, 1048576);
    assert_int_equal(job.overrides[ORL_EFFECT_GLOSSY], ORL_OVERRIDE_FORCE);
    assert_int_equal(job.n_sensors, 2);
    assert_true(job.sensors[1].position.x == 4.5 && job.sensors[1].direction.x == 1);
    assert_int_equal(job.n_views, 1);
    assert_string_equal(job.views[0].view, "-vtv");
    assert_int_equal(job.views[0].width, 4);
    const struct orl_glare_settings *glare = &job.views[0].glare;
    assert_int_equal(job.views[0].metrics, 1U << ORL_GLARE_DGP | 1U << ORL_GLARE_ILLUMINANCE);
    assert_true(glare->threshold == 7 && glare->task.y == 2 && glare->task.angle_rad == 0.5);
    assert_true(glare->no_peaks && !glare->smooth && glare->at_whole_pixels);
    assert_true(glare->constants == ORL_DGP_PUBLISHED && glare->age_years == 60);
    assert_true(glare->directions == 5 && glare->directions_deg == 90);
    assert_int_equal(job.n_scene_files, 0);
    orl_job_done(&job);
    free(id);
}

/* The plan may choose one map's photon count while the other is given. */
static void test_one_of_two_photon_counts(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    assert_int_equal(decode("{\"scene\":\"" ID "\",\"technique\":\"precomputed\","
                            "\"photons\":{\"caustic\":1000},\"sensors\":[[0,0,0,0,0,1]]}",
                            ORL_JOB_REMOTE, &job, &id, &err),
                     0);
    assert_int_equal(job.technique, ORL_TECHNIQUE_PRECOMPUTED);
    assert_int_equal(job.photons_caustic, 1000);
    assert_true(job.photons_global == ORL_PHOTONS_BY_PLAN);
    assert_int_equal(orl_job_validate(&job, &err), 0);
    orl_job_done(&job);
    free(id);
}

static void test_local_document_and_defaults(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = (char *)"untouched?";
    assert_int_equal(decode("{\"scene\":{\"files\":[\"a.rad\",\"b.rad\"]},"
                            "\"sensors\":{\"file\":\"s.txt\"}}",
                            ORL_JOB_LOCAL, &job, &id, &err),
                     0);
    assert_null(id);
    assert_int_equal(job.n_scene_files, 2);
    assert_string_equal(job.scene_files[1], "b.rad");
    assert_string_equal(job.sensors_file, "s.txt");
    assert_int_equal(job.technique, ORL_TECHNIQUE_AUTO);
    assert_true(job.photons_global == ORL_PHOTONS_BY_PLAN);
    assert_true(job.photons_caustic == ORL_PHOTONS_BY_PLAN);
    assert_int_equal(job.gather_samples, 0);
    assert_int_equal(job.pixel_samples, 0);
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        assert_int_equal(job.overrides[i], ORL_OVERRIDE_AUTO);
    assert_int_equal(job.seed, 1);
    orl_job_done(&job);
}

#define SKY_JOB(sky) "{\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,1]],\"sky\":" sky "}"

static struct orl_job decode_sky(const char *text)
{
    struct orl_job job;
    struct orl_error err = {0};
    char *id = NULL;
    if (decode(text, ORL_JOB_REMOTE, &job, &id, &err) < 0 || orl_job_validate(&job, &err) < 0)
        fail_msg("%s: %s", text, err.message);
    free(id);
    return job;
}

/* Picture options of a view. */
static void test_pictures(void **state)
{
    (void)state;
    struct orl_job job = decode_sky(
        "{\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":4,"
        "\"height\":3,\"formats\":[\"png16\",\"hdr\"],\"display\":{\"ev\":10}},"
        "{\"name\":\"b\",\"view\":\"-vtv\",\"width\":4,\"height\":3,"
        "\"display\":{\"veil\":true,\"acuity\":true},"
        "\"false_color\":{\"scale\":\"auto\",\"decades\":2,\"palette\":\"eco\","
        "\"draw\":[\"lines\",\"fill\"],\"points\":[{\"name\":\"p\",\"x\":1,\"y\":2.5}]}}]}");
    const struct orl_false_color *colors = &job.views[1].false_color;
    assert_false(job.views[0].false_color.asked);
    assert_true(colors->asked && colors->scale == 0 && colors->decades == 2);
    assert_int_equal(colors->palette, ORL_PALETTE_ECO);
    assert_int_equal(colors->pictures,
                     ORL_PICTURE_BIT(ORL_PICTURE_LINES) | ORL_PICTURE_BIT(ORL_PICTURE_FALSE));
    assert_int_equal(colors->n_points, 1);
    assert_true(strcmp(colors->points[0].name, "p") == 0 && colors->points[0].y == 2.5);
    assert_int_equal(job.views[0].formats,
                     ORL_PICTURE_BIT(ORL_PICTURE_PNG16) | ORL_PICTURE_BIT(ORL_PICTURE_HDR));
    assert_int_equal(job.views[0].display.tone, ORL_TONE_EXPOSURE);
    assert_true(job.views[0].display.exposure == orl_exposure_of_ev(10));
    assert_int_equal(job.views[1].formats, 0);
    assert_int_equal(job.views[1].display.tone, ORL_TONE_HUMAN);
    assert_true(job.views[1].display.veil && job.views[1].display.acuity);
    assert_false(job.views[1].display.color_loss);
    orl_job_done(&job);
}

static void test_skies(void **state)
{
    (void)state;
    struct orl_job job = decode_sky(SKY_JOB(
        "{\"perez\":{\"month\":3,\"day\":22,\"hour\":12,\"latitude\":38.42,\"longitude\":27.14,"
        "\"time_zone\":2,\"direct_normal_w_m2\":800,\"diffuse_horizontal_w_m2\":120}}"));
    assert_int_equal(job.sky.model, ORL_SKY_BY_PEREZ);
    assert_int_equal(job.sky.normalise, ORL_SKY_FLUX);
    assert_int_equal(job.sky.sun_method, ORL_SUN_ACCURATE);
    assert_int_equal(job.sky.input, ORL_SKY_NORMAL_W);
    assert_true(job.sky.time_given && !job.sky.sun_given);
    assert_true(job.sky.longitude_deg == 27.14 && job.sky.time_zone_h == 2);
    assert_true(job.sky.first == 800 && job.sky.second == 120);
    assert_true(job.sky.ground_reflectance == 0.2);
    orl_job_done(&job);
    job = decode_sky(SKY_JOB("{\"perez\":{\"sun_altitude\":30,\"sun_azimuth\":-20,"
                             "\"direct_horizontal_w_m2\":80,\"diffuse_horizontal_w_m2\":120},"
                             "\"normalise\":\"gendaylit\"}"));
    assert_int_equal(job.sky.input, ORL_SKY_HORIZONTAL_W);
    assert_int_equal(job.sky.normalise, ORL_SKY_GENDAYLIT);
    assert_true(job.sky.sun_given && job.sky.sun_azimuth_deg == -20 && job.sky.first == 80);
    orl_job_done(&job);
    job = decode_sky(SKY_JOB("{\"cie\":{\"type\":\"overcast\",\"zenith_cd_m2\":5000}}"));
    assert_int_equal(job.sky.model, ORL_SKY_BY_CIE);
    assert_int_equal(job.sky.cie_type, ORL_SKY_OVERCAST);
    assert_int_equal(job.sky.input, ORL_SKY_ZENITH_CD_M2);
    orl_job_done(&job);
    job = decode_sky(SKY_JOB("{\"weather\":{\"file\":\"x.epw\",\"month\":3,\"day\":22,"
                             "\"hour\":11.5,\"ground_reflectance\":0.3},\"sun\":\"radiance\"}"));
    assert_int_equal(job.sky.sun_method, ORL_SUN_RADIANCE);
    assert_int_equal(job.sky.model, ORL_SKY_BY_WEATHER);
    assert_string_equal(job.sky.weather_file, "x.epw");
    assert_true(job.sky.hour == 11.5 && job.sky.ground_reflectance == 0.3);
    orl_job_done(&job);
}

/* Each mistake: the document (without braces), the code, and the JSON path that the error must
 * name. */
#define VIEW_A "\"name\":\"a\",\"view\":\"-vtv\",\"width\":4,\"height\":3"

static const struct {
    const char *text;
    int code;
    const char *path;
} mistakes[] = {
    {"", ORL_ERR_INVALID, "scene"},
    {"\"scene\":7", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"0123\"", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"0123456789ABCDEF0123456789abcdef0123456789abcdef0123456789abcdef\"",
     ORL_ERR_INVALID, "scene"},
    {"\"scene\":{\"files\":[\"a.rad\"]}", ORL_ERR_INVALID, "scene"},
    {"\"scene\":\"" ID "\"", ORL_ERR_INVALID, "document"},
    {"\"scene\":\"" ID "\",\"sensors\":[],\"views\":[]", ORL_ERR_INVALID, "document"},
    {"\"scene\":\"" ID "\",\"sensor\":[]", ORL_ERR_INVALID, "sensor"},
    {"\"scene\":\"" ID "\",\"kind\":\"annual\"", ORL_ERR_INVALID, "kind"},
    {"\"scene\":\"" ID "\",\"technique\":1", ORL_ERR_INVALID, "technique"},
    {"\"scene\":\"" ID "\",\"technique\":\"gathr\"", ORL_ERR_INVALID, "technique"},
    {"\"scene\":\"" ID "\",\"effects\":{\"caustic\":\"skip\"}", ORL_ERR_INVALID, "effects.caustic"},
    {"\"scene\":\"" ID "\",\"photons\":{\"globl\":1}", ORL_ERR_INVALID, "photons.globl"},
    {"\"scene\":\"" ID "\",\"photons\":[]", ORL_ERR_INVALID, "photons"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":0}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":-5}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"global\":1.5}", ORL_ERR_RANGE, "photons.global"},
    {"\"scene\":\"" ID "\",\"photons\":{\"caustic\":1e300}", ORL_ERR_RANGE, "photons.caustic"},
    {"\"scene\":\"" ID "\",\"photons\":{\"caustic\":\"many\"}", ORL_ERR_INVALID, "photons.caustic"},
    {"\"scene\":\"" ID "\",\"seed\":-1", ORL_ERR_RANGE, "seed"},
    {"\"scene\":\"" ID "\",\"gather_samples\":null", ORL_ERR_INVALID, "gather_samples"},
    {"\"scene\":\"" ID "\",\"pixel_samples\":-1", ORL_ERR_RANGE, "pixel_samples"},
    {"\"scene\":\"" ID "\",\"pixel_samples\":1048577", ORL_ERR_RANGE, "pixel_samples"},
    {"\"scene\":\"" ID "\",\"pixel_samples\":\"64\"", ORL_ERR_INVALID, "pixel_samples"},
    {"\"scene\":\"" ID "\",\"sensors\":7", ORL_ERR_INVALID, "sensors"},
    {"\"scene\":\"" ID "\",\"sensors\":{\"file\":\"\"}", ORL_ERR_INVALID, "sensors.file"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,1],[1,2,3]]", ORL_ERR_INVALID, "sensors[1]"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,true]]", ORL_ERR_INVALID, "sensors[0][5]"},
    {"\"scene\":\"" ID "\",\"sensors\":[[0,0,0,0,0,0]]", ORL_ERR_RANGE, "sensors[0]"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":1}]",
     ORL_ERR_INVALID, "views[0].height"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":99999,"
     "\"height\":1}]",
     ORL_ERR_RANGE, "views[0].width"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"\",\"view\":\"-vtv\",\"width\":1,"
     "\"height\":1}]",
     ORL_ERR_INVALID, "views[0].name"},
    {"\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"\",\"width\":1,\"height\":1},7]",
     ORL_ERR_INVALID, "views[0].view"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"formats\":[]}]", ORL_ERR_INVALID,
     "views[0].formats"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"formats\":[\"gif\"]}]", ORL_ERR_INVALID,
     "views[0].formats"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"display\":{\"tone\":\"dark\"}}]",
     ORL_ERR_INVALID, "views[0].display.tone"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"display\":{\"ev\":1,\"exposure\":1}}]",
     ORL_ERR_INVALID, "views[0].display"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"display\":{\"ev\":99}}]", ORL_ERR_RANGE,
     "views[0].display.ev"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"display\":{\"exposure\":0}}]", ORL_ERR_RANGE,
     "views[0].display.exposure"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A
     ",\"display\":{\"tone\":\"linear\",\"veil\":true}}]",
     ORL_ERR_INVALID, "views[0].display.veil"},
#define VIEW_WITH(more)                                                                            \
    "\"scene\":\"" ID "\",\"views\":[{\"name\":\"a\",\"view\":\"-vtv\",\"width\":1,"               \
    "\"height\":1," more "}]"
    {VIEW_WITH("\"metrics\":\"dgp\""), ORL_ERR_INVALID, "views[0].metrics"},
    {VIEW_WITH("\"metrics\":[\"dgp\",\"dpg\"]"), ORL_ERR_INVALID, "views[0].metrics[1]"},
    {VIEW_WITH("\"glare\":[]"), ORL_ERR_INVALID, "views[0].glare"},
    {VIEW_WITH("\"glare\":{\"treshold\":5}"), ORL_ERR_INVALID, "views[0].glare.treshold"},
    {VIEW_WITH("\"glare\":{\"threshold\":-5}"), ORL_ERR_RANGE, "views[0].glare.threshold"},
    {VIEW_WITH("\"glare\":{\"smooth\":1}"), ORL_ERR_INVALID, "views[0].glare.smooth"},
    {VIEW_WITH("\"glare\":{\"formula\":\"x\"}"), ORL_ERR_INVALID, "views[0].glare.formula"},
    {VIEW_WITH("\"glare\":{\"task\":{\"x\":1}}"), ORL_ERR_INVALID, "views[0].glare.task.angle_rad"},
    {VIEW_WITH("\"glare\":{\"directions\":{\"count\":1}}"), ORL_ERR_RANGE,
     "views[0].glare.directions.count"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":7}]", ORL_ERR_INVALID,
     "views[0].false_color"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"scale\":-1}}]", ORL_ERR_RANGE,
     "views[0].false_color.scale"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"scale\":\"big\"}}]",
     ORL_ERR_INVALID, "views[0].false_color.scale"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"divisions\":1000}}]",
     ORL_ERR_RANGE, "views[0].false_color.divisions"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"palette\":\"gray\"}}]",
     ORL_ERR_INVALID, "views[0].false_color.palette"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"label\":\"\\u00b5\"}}]",
     ORL_ERR_INVALID, "views[0].false_color.label"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A ",\"false_color\":{\"draw\":[\"dots\"]}}]",
     ORL_ERR_INVALID, "views[0].false_color.draw"},
    {"\"scene\":\"" ID "\",\"views\":[{" VIEW_A
     ",\"false_color\":{\"points\":[{\"name\":\"p\",\"x\":9,\"y\":0}]}}]",
     ORL_ERR_RANGE, "views[0].false_color.points[0].x"},
    {"\"scene\":\"" ID "\",\"sky\":7", ORL_ERR_INVALID, "sky"},
    {"\"scene\":\"" ID "\",\"sky\":{}", ORL_ERR_INVALID, "sky"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{},\"cie\":{}}", ORL_ERR_INVALID, "sky"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"lat\":1}}", ORL_ERR_INVALID, "sky.perez.lat"},
    {"\"scene\":\"" ID "\",\"sky\":{\"moon\":{}}", ORL_ERR_INVALID, "sky.moon"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"sun_altitude\":1,\"sun_azimuth\":1}}",
     ORL_ERR_INVALID, "sky.perez"},
    {"\"scene\":\"" ID
     "\",\"sky\":{\"perez\":{\"direct_normal_lx\":1,\"diffuse_horizontal_w_m2\":1}}",
     ORL_ERR_INVALID, "sky.perez"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"direct_normal_lx\":1,\"clearness\":1}}",
     ORL_ERR_INVALID, "sky.perez"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"direct_normal_w_m2\":1}}", ORL_ERR_INVALID,
     "sky.perez.diffuse_horizontal_w_m2"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"month\":3}}", ORL_ERR_INVALID, "sky.perez.day"},
    {"\"scene\":\"" ID "\",\"sky\":{\"perez\":{\"month\":13}}", ORL_ERR_RANGE, "sky.perez.month"},
    {"\"scene\":\"" ID "\",\"sky\":{\"cie\":{}}", ORL_ERR_INVALID, "sky.cie.type"},
    {"\"scene\":\"" ID "\",\"sky\":{\"cie\":{\"type\":\"blue\"}}", ORL_ERR_INVALID, "sky.cie.type"},
    {"\"scene\":\"" ID "\",\"sky\":{\"cie\":{\"type\":\"clear\",\"direct_normal_lx\":-1}}",
     ORL_ERR_RANGE, "sky.cie.direct_normal_lx"},
    {"\"scene\":\"" ID "\",\"sky\":{\"weather\":{\"month\":1,\"day\":1,\"hour\":1}}",
     ORL_ERR_INVALID, "sky.weather.file"},
    {"\"scene\":\"" ID "\",\"sky\":{\"weather\":{\"file\":\"x\",\"month\":1,\"day\":1}}",
     ORL_ERR_INVALID, "sky.weather.hour"},
    {"\"scene\":\"" ID "\",\"sky\":{\"cie\":{\"type\":\"clear\"},\"sun\":\"best\"}",
     ORL_ERR_INVALID, "sky.sun"},
    {"\"scene\":\"" ID "\",\"sky\":{\"cie\":{\"type\":\"clear\"},\"normalise\":\"yes\"}",
     ORL_ERR_INVALID, "sky.normalise"},
};

static void test_mistakes_name_their_path(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
        char text[1024];
        struct orl_job job;
        struct orl_error err;
        char *id = NULL;
        snprintf(text, sizeof text, "{%s}", mistakes[i].text);
        const int rc = decode(text, ORL_JOB_REMOTE, &job, &id, &err);
        if (rc != mistakes[i].code || strcmp(err.primitive, mistakes[i].path) != 0)
            fail_msg("%s: code %d at '%s', expected %d at '%s'", text, rc, err.primitive,
                     mistakes[i].code, mistakes[i].path);
        assert_non_null(strstr(err.message, mistakes[i].path));
        assert_null(id);
    }
}

/* No view writes a file that another view writes. */
static void test_names_of_views(void **state)
{
    static const struct {
        const char *one, *other;
        bool sound;
    } cases[] = {
        {"a", "a", false},       {"a", "a.error", false},     {"a.error", "a", false},
        {"a", "a.false", false}, {"a.b", "a.b.lines", false}, {"a", "a.err", true},
        {"a", "a.errors", true}, {"a", "ab", true},           {"ab.error", "a", true},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512], *id = NULL;
        struct orl_job job;
        struct orl_error err = {0};
        snprintf(text, sizeof text,
                 "{\"scene\":\"" ID "\",\"views\":[{\"name\":\"%s\",\"view\":\"-vtv\",\"width\":4,"
                 "\"height\":3},{\"name\":\"%s\",\"view\":\"-vtv\",\"width\":4,\"height\":3}]}",
                 cases[i].one, cases[i].other);
        assert_int_equal(decode(text, ORL_JOB_REMOTE, &job, &id, &err), 0);
        const int rc = orl_job_validate(&job, &err);
        if (rc != (cases[i].sound ? 0 : ORL_ERR_INVALID))
            fail_msg("%s, %s: %d %s", cases[i].one, cases[i].other, rc, err.message);
        orl_job_done(&job);
        free(id);
    }
}

static void test_unknown_member_lists_the_known(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    decode("{\"scene\":\"" ID "\",\"photons\":{\"globl\":1}}", ORL_JOB_REMOTE, &job, &id, &err);
    assert_string_equal(err.hint, "did you mean \"global\"? Known here: global, caustic, exact");
}

/* Text that is not JSON, or not a valid document, gives an error with its line. */
static void test_syntax_has_a_line(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        int line;
    } bad[] = {
        {"", 1},
        {"{\n\"scene\":}", 2},
        {"{\"seed\":NaN}", 1},
        {"{\"seed\":1,\n\"seed\":2}", 2},
        {"{\"seed\":1e999}", 1},
        {"[1,2", 1},
        {"{\"scene\":\"\xff\"}", 1},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct orl_error err;
        json_t *doc = NULL;
        assert_int_equal(orl_json_parse("job.json", bad[i].text, strlen(bad[i].text), &doc, &err),
                         ORL_ERR_SYNTAX);
        assert_null(doc);
        assert_int_equal(err.line, bad[i].line);
        assert_string_equal(err.file, "job.json");
    }
}

/* An array or a bare word is refused in place of the document. */
static void test_document_must_be_an_object(void **state)
{
    (void)state;
    struct orl_job job;
    struct orl_error err;
    char *id = NULL;
    assert_int_equal(decode("[]", ORL_JOB_REMOTE, &job, &id, &err), ORL_ERR_INVALID);
    assert_string_equal(err.primitive, "document");
}

static void test_a_byte_order_mark_is_passed_over(void **state)
{
    static const char text[] = "\xef\xbb\xbf{\"kind\": \"render\"}", alone[] = "\xef\xbb\xbf";
    struct orl_error err = {0};
    json_t *doc = NULL;
    (void)state;
    assert_int_equal(orl_json_parse("job.json", text, sizeof text - 1, &doc, &err), 0);
    assert_string_equal(json_string_value(json_object_get(doc, "kind")), "render");
    json_decref(doc);
    assert_int_equal(orl_json_parse("job.json", alone, 3, &doc, &err), ORL_ERR_SYNTAX);
    assert_int_equal(orl_json_parse("job.json", alone, 2, &doc, &err), ORL_ERR_SYNTAX);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_byte_order_mark_is_passed_over),
        cmocka_unit_test(test_full_remote_document),
        cmocka_unit_test(test_one_of_two_photon_counts),
        cmocka_unit_test(test_local_document_and_defaults),
        cmocka_unit_test(test_pictures),
        cmocka_unit_test(test_skies),
        cmocka_unit_test(test_mistakes_name_their_path),
        cmocka_unit_test(test_names_of_views),
        cmocka_unit_test(test_unknown_member_lists_the_known),
        cmocka_unit_test(test_syntax_has_a_line),
        cmocka_unit_test(test_document_must_be_an_object),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
