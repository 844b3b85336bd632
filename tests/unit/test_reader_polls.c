/*
 * A cancel at the k-th poll of every reader of a scene and its files. The short suite covers every
 * place in the code that polls, the long suite every k. The reader returns the cancellation error
 * without a line and leaks nothing (AddressSanitizer checks).
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <execinfo.h>
#include <stdatomic.h>

#include <math.h>
#include <oriel/base/thread_pool.h>
#include <oriel/bsdf/bsdf_fit.h>
#include <oriel/job/run.h>

#include <oriel/annual/annual_report.h>

#include "fixtures/bsdf_make.h"
#include "job/job_request_json.h"
#include "support/cli.h"
#include "support/extent.h"
#include "support/scene_text.h"
#include "json/decode.h"

/* ---- Every poll ------------------------------------------------------------------------------ */

static atomic_int polls;     /* polls since the count began */
static atomic_int cancel_at; /* the poll from which on the result is true; negative: never */
/* Callers that polled, as hashes of their return addresses. Callers beyond PLACES share one entry.
 */
enum { PLACES = 4096, FRAMES = 6 };
static uintptr_t places[PLACES];

static uintptr_t place_of_caller(void)
{
    void *frames[FRAMES] = {NULL};
    uintptr_t hash = 0;
    const int count = backtrace(frames, FRAMES);
    for (int i = 1; i < count; i++) /* frame 0 is this function */
        hash = hash * 1000003 + (uintptr_t)frames[i];
    return hash;
}

/* Replaces core/base/threads/cancel.c: the core's polls call this. */
bool orl_is_cancelled(const atomic_bool *cancel)
{
    if (!cancel)
        return false;
    const int poll = atomic_fetch_add(&polls, 1), at = atomic_load(&cancel_at);
    if (at < 0 && poll < PLACES)
        places[poll] = place_of_caller();
    return atomic_load(cancel) || (at >= 0 && poll >= at);
}

/* Reads something once. Returns 0 or an error code, with details in err. */
typedef int (*reading)(const void *what, const atomic_bool *cancel, struct orl_error *err);

static int read_with(reading read, const void *what, int at, struct orl_error *err)
{
    static const atomic_bool never;
    memset(err, 0, sizeof *err);
    atomic_store(&polls, 0);
    atomic_store(&cancel_at, at);
    const int code = read(what, &never, err);
    atomic_store(&cancel_at, -1);
    return code;
}

/* The short suite tries the first poll of each place, and the last of all; the long suite every
 * poll. */
static bool is_tried(int at, int most)
{
    int before = 0;
    for (int i = 0; i < at && at < PLACES; i++)
        before += places[i] == places[at];
    return extent_is_long() || before == 0 || at == most - 1;
}

/* Returns true if the input was accepted. Refused files are cancelled too, or refused before the
 * poll. */
static bool drive(const char *name, reading read, const void *what)
{
    struct orl_error whole, err;
    const int code = read_with(read, what, -1, &whole), most = atomic_load(&polls);
    int tried = 0;
    for (int at = 0; at < most; at++) {
        if (!is_tried(at, most))
            continue;
        tried++;
        const int cut = read_with(read, what, at, &err);
        if (cut != ORL_ERR_CANCELLED || (int)err.code != cut || err.line != 0 ||
            !strstr(err.message, "cancelled"))
            fail_msg("%s, cancelled at poll %d of %d: %d, %s:%d: %s", name, at, most, cut, err.file,
                     err.line, err.message);
    }
    assert_int_equal(read_with(read, what, -1, &err), code);
    assert_int_equal(err.line, whole.line);
    assert_string_equal(err.message, whole.message);
    print_message("# %s: %d of %d polls%s\n", name, tried, most, code < 0 ? ", refused" : "");
    return code == 0;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

struct folder {
    const char *names[5];
    struct orl_file contents[5];
    size_t count;
};

static int read_scene(const void *what, const atomic_bool *cancel, struct orl_error *err)
{
    const struct folder *folder = what;
    struct orl_memory_files memory = {folder->names, folder->contents, folder->count};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_scene_summary summary = {0};
    const int code = orl_scene_check(folder->names, 1, &files, cancel, &summary, err);
    assert_true(code == 0 || (!summary.referenced && summary.surfaces == 0));
    orl_scene_summary_done(&summary);
    return code;
}

/* Every kind of surface, material and command; outlines that cross, and two coincident ones. */
static const char everything[] =
    "void plastic w 0 0 5 .5 .5 .5 0 0\nvoid metal m 0 0 5 .5 .5 .5 .9 .1\n"
    "void plastic2 w2 4 1 0 0 . 0 6 .5 .5 .5 .1 .1 .2\nvoid trans t 0 0 7 .5 .5 .5 0 0 .5 .5\n"
    "void glass g 0 0 3 .9 .9 .9\nvoid dielectric d 0 0 5 .9 .9 .9 1.5 0\n"
    "void interface i 0 0 8 .9 .9 .9 1.5 .9 .9 .9 1.3\nvoid mirror r 1 void 0 3 .9 .9 .9\n"
    "void light l 0 0 3 9 9 9\nvoid glow o 0 0 4 1 1 1 0\nvoid spotlight s 0 0 7 9 9 9 60 0 0 -1\n"
    "void illum u 1 void 0 3 1 1 1\nvoid BSDF b 6 0 tree.xml 0 0 1 . 0 0\n"
    "void aBSDF c 5 klems.xml 0 0 1 . 0 0\nvoid alias a w\nvoid alias a2 m\n"
    "l source sun 0 0 4 0 -1 1 .533\no source dome 0 0 4 0 0 1 360\n"
    "w polygon cross 0 0 15 0 0 0 4 0 0 1 3 0 2 -1 0 3 3 0\n"
    "m polygon on 0 0 12 1 .2 0 2 .2 0 2 .6 0 1 .6 0\nw2 sphere s1 0 0 4 9 9 9 1\n"
    "t bubble s2 0 0 4 9 9 9 2\nd cylinder c1 0 0 7 0 9 0 0 9 1 .3\ni tube c2 0 0 7 1 9 0 1 9 1 "
    ".3\n"
    "r cone k1 0 0 8 3 9 0 3 9 1 .3 .1\ns cup k2 0 0 8 5 9 0 5 9 1 .3 .1\n"
    "u ring r1 0 0 8 7 9 0 0 0 1 0 .5\nb polygon p1 0 0 12 20 0 0 21 0 0 21 0 1 20 0 1\n"
    "c polygon p2 0 0 12 30 0 0 31 0 0 31 0 1 30 0 1\n"
    "!genbox w box 1 2 3 -i\n!genbox w box 1 2 3 | xform -a 2 -t 40 0 0\n"
    "!gensky 3 22 12 +s -a 42 -o 71 -m 75\n!gendaylit 3 22 12 -a 42 -o 71 -m 75 -W 800 100\n"
    "!xform -n x -a 3 -t 0 20 0 -a 2 -rz 5 -i 2 -s 2 part.rad\n!xform -f copies.txt part.rad\n";

static const char part[] = "w polygon q 0 0 9 50 0 0 51 0 0 50 1 0\n";
static const char copies[] = "# two\n-t 0 0 1\nxform -t 0 0 2\n";

static void test_everything(void **state)
{
    struct text tree = make_tree_file(2);
    size_t size;
    char *klems = (char *)scene_read_bytes("tests/fixtures/bsdf_klems41.xml", &size);
    const struct folder folder = {{"main.rad", "part.rad", "tree.xml", "klems.xml", "copies.txt"},
                                  {{everything, sizeof everything - 1, NULL},
                                   {part, sizeof part - 1, NULL},
                                   {tree.data, tree.size, NULL},
                                   {klems, size, NULL},
                                   {copies, sizeof copies - 1, NULL}},
                                  5};
    (void)state;
    assert_true(drive("every primitive", read_scene, &folder));
    free(tree.data);
    free(klems);
}

/* ---- BSDFs ----------------------------------------------------------------------------------- */

struct bsdf {
    const char *data;
    size_t size;
    struct orl_thread_pool *pool;
};

static int read_bsdf(const void *what, const atomic_bool *cancel, struct orl_error *err)
{
    const struct bsdf *file = what;
    struct orl_bsdf *bsdf = NULL;
    const struct orl_bsdf_xml xml = {.name = "file.xml",
                                     .data = file->data,
                                     .size = file->size,
                                     .cancel = cancel,
                                     .pool = file->pool};
    const int code = orl_bsdf_load(&xml, &bsdf, err);
    assert_int_equal(bsdf != NULL, code == 0);
    orl_bsdf_unref(bsdf);
    return code;
}

/* Inserts blanks in the data and a long comment, so that the text is read in many slices. */
static struct text pad_with_blanks(struct text t)
{
    const int blanks = extent_is_long() ? 3 << 20 : 3 << 19; /* a slice is at most a mebibyte */
    struct text long_one;
    const char *data = strstr(t.data, "<ScatteringData>") + strlen("<ScatteringData>");
    text_open(&long_one);
    fwrite(t.data, 1, (size_t)(data - t.data), long_one.stream);
    fprintf(long_one.stream, "\n%*s<!--%*s-->%*s\n", blanks, "", blanks, "", blanks, "");
    fwrite(data, 1, t.size - (size_t)(data - t.data), long_one.stream);
    text_close(&long_one);
    free(t.data);
    return long_one;
}

static void drive_bsdf(const char *name, const char *data, size_t size)
{
    const struct bsdf file = {data, size, NULL};
    assert_true(drive(name, read_bsdf, &file));
}

static void test_bsdfs(void **state)
{
    static const char *const fixtures[] = {"tests/fixtures/bsdf_klems41.xml",
                                           "tests/fixtures/bsdf_lcp8.xml"};
    struct text made[] = {pad_with_blanks(make_tree_file(3)), pad_with_blanks(make_iso_file(3)),
                          pad_with_blanks(make_clear_file(2, .5, .1))};
    (void)state;
    for (int i = 0; i < 2; i++) {
        size_t size;
        unsigned char *xml = scene_read_bytes(fixtures[i], &size);
        drive_bsdf(fixtures[i], (char *)xml, size);
        free(xml);
    }
    for (int i = 0; i < 3; i++) {
        drive_bsdf("a tree in slices", made[i].data, made[i].size);
        free(made[i].data);
    }
}

/* Other threads read blocks beside the lead thread, so the order of polls varies: cancels until no
 * poll is left. */
static void test_blocks_side_by_side(void **state)
{
    struct text tree = pad_with_blanks(make_tree_file(3));
    struct orl_error err;
    struct bsdf file = {tree.data, tree.size, orl_thread_pool_start(3)};
    int code = ORL_ERR_CANCELLED, at = 0;
    (void)state;
    assert_non_null(file.pool);
    for (; code != 0; at++) {
        code = read_with(read_bsdf, &file, at, &err);
        assert_true(code == 0 || (code == ORL_ERR_CANCELLED && err.line == 0));
    }
    assert_in_range(at, 5, 1000);
    orl_thread_pool_stop(file.pool);
    free(tree.data);
}

/* ---- The fuzzers' corpus --------------------------------------------------------------------- */

static void drive_corpus(const char *folder, void (*drive_one)(const char *, char *, size_t))
{
    char path[512];
    DIR *entries = opendir(folder);
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries));) {
        size_t size;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        char *data = (char *)scene_read_bytes(path, &size);
        drive_one(path, data, size);
        free(data);
    }
    closedir(entries);
}

/* Reads the input as fuzz_scene.c does: the included file begins after a byte 0x1c. */
static void drive_scene(const char *name, char *data, size_t size)
{
    char xml[2048];
    char *cut = size > 0 ? memchr(data, 0x1c, size) : NULL;
    const size_t head = cut ? (size_t)(cut - data) : size;
    scene_uniform_bsdf(0.1, xml);
    const struct folder folder = {{"main.rad", "part.rad", "panel.xml"},
                                  {{data, head, NULL},
                                   {cut ? cut + 1 : data, cut ? size - head - 1 : 0, NULL},
                                   {xml, strlen(xml), NULL}},
                                  3};
    drive(name, read_scene, &folder);
}

static void drive_xml(const char *name, char *data, size_t size)
{
    drive(name, read_bsdf, &(struct bsdf){data, size, NULL});
}

/* ---- Measurements ---------------------------------------------------------------------------- */

/* Reads measurements and fits the smallest tree to them. */
static int fit_measured(const void *what, const atomic_bool *cancel, struct orl_error *err)
{
    const struct folder *folder = what;
    struct orl_memory_files memory = {folder->names, folder->contents, folder->count};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_thread_pool *pool = orl_thread_pool_new(1);
    const struct orl_bsdf_make_env env = {.files = &files, .pool = pool, .cancel = cancel};
    char name[] = "data.csv", *names[] = {name};
    struct orl_bsdf_fit_request request;
    struct orl_bsdf_fit_result fitted = {0};
    assert_non_null(pool);
    orl_bsdf_fit_request_init(&request);
    request.files = names;
    request.n_files = 1;
    request.resolution = 4;
    const int code = orl_bsdf_fit(&request, &env, &fitted, err);
    assert_int_equal(fitted.xml != NULL, code == 0);
    orl_bsdf_fit_result_done(&fitted);
    orl_thread_pool_free(pool);
    return code;
}

static void test_measured(void **state)
{
    const int scans = (int)extent(2, 3), rows = (int)extent(30, 60);
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    (void)state;
    assert_non_null(out);
    fputs("theta_in,phi_in,theta_out,phi_out,bsdf\n", out);
    for (int k = 0; k < scans; k++)
        for (int i = 0; i < rows; i++) {
            const double theta = acos(1 - 0.95 * (i + 0.5) / rows) / ORL_DEG_TO_RAD;
            fprintf(out, "%d,180,%.3f,%.3f,%.5f\n", 30 * k, theta, fmod(137.508 * i, 360),
                    0.1 + 0.001 * theta);
        }
    assert_int_equal(fclose(out), 0);
    const struct folder folder = {{"data.csv"}, {{.data = text, .size = size}}, 1};
    assert_true(drive("measurements", fit_measured, &folder));
    free(text);
}

/* ---- Jobs ------------------------------------------------------------------------------------ */

/* Parses and decodes a job document; also checks for leaks if either is cancelled. */
static int read_job(const void *what, const atomic_bool *cancel, struct orl_error *err)
{
    const struct text *text = what;
    struct orl_job_request job_request;
    json_t *doc = NULL;
    orl_json_set_cancel(cancel);
    int code = orl_json_parse("job.json", text->data, text->size, &doc, err);
    if (code == 0)
        code = orl_job_request_from_json(doc, ORL_JOB_REMOTE, &job_request, NULL, err);
    if (code == 0)
        orl_job_request_done(&job_request);
    orl_json_set_cancel(NULL);
    json_decref(doc);
    return code;
}

static void test_documents(void **state)
{
    enum { SENSORS = 5000 };
    static const char *const kinds[] = {"render", "annual"};
    (void)state;
    for (int i = 0; i < 2; i++) {
        struct text text;
        text_open(&text);
        fprintf(text.stream, "{\"kind\": \"%s\", \"scene\": \"%064d\", %s\"sensors\": [", kinds[i],
                7, i ? "\"weather\": \"place.epw\", " : "\"seed\": 1, ");
        for (int k = 0; k < SENSORS; k++)
            fprintf(text.stream, "%s[%.2f, 2, 0.8, 0, 0, 1]", k ? "," : "", 0.01 * k);
        fputs("]}", text.stream);
        text_close(&text);
        assert_true(drive(kinds[i], read_job, &text));
        assert_true(atomic_load(&polls) > (int)(text.size >> 16) + SENSORS / 1024);
        free(text.data);
    }
}

static int read_grids(const void *what, const atomic_bool *cancel, struct orl_error *err)
{
    const struct folder *folder = what;
    struct orl_memory_files memory = {folder->names, folder->contents, folder->count};
    const struct orl_files files = orl_files_from_memory(&memory);
    char name[] = "desks.pts", *const names[] = {name, name};
    struct orl_annual_grid grids[2] = {{.name = name}, {.name = name}};
    struct orl_annual_request request = {.grids = grids, .n_grids = 2};
    const int code = orl_annual_grids_read(&request, names, &files, cancel, err);
    assert_int_equal(request.sensors != NULL, code == 0);
    free(request.sensors);
    return code;
}

static void test_grids(void **state)
{
    struct text text;
    (void)state;
    text_open(&text);
    for (int i = 0; i < 10000; i++)
        fprintf(text.stream, "%.2f 2 0.8 0 0 1\n", 0.01 * i);
    text_close(&text);
    const struct folder folder = {{"desks.pts"}, {{.data = text.data, .size = text.size}}, 1};
    assert_true(drive("grids of a year", read_grids, &folder));
    free(text.data);
}

static void test_corpus(void **state)
{
    (void)state;
    drive_corpus("tests/fuzz/corpus/scene", drive_scene);
    drive_corpus("tests/fuzz/corpus/bsdf", drive_xml);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_everything),
        cmocka_unit_test(test_bsdfs),
        cmocka_unit_test(test_blocks_side_by_side),
        cmocka_unit_test(test_measured),
        cmocka_unit_test(test_documents),
        cmocka_unit_test(test_grids),
        cmocka_unit_test(test_corpus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
