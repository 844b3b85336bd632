/*
 * Cached scenes: the file reads back as written, field by field, for every kind of scene. Jobs
 * that find one give the same bytes as jobs that parse the text. A cached file that is damaged, or
 * whose source files have changed, is not used.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "scene/built/scene.h"
#include "scene/cache/scene_cache_file.h"
#include "scene/parse/parse.h"
#include "support/grove.h"
#include "support/polygons.h"
#include "support/scene_text.h"
#include "support/scratch.h"

enum { FILES = 8 };

static const unsigned char content[ORL_CHECKED_FILE_CONTENT] = {1, 2, 3};

/* A scene of a.rad and the files that it names. */
struct text_files {
    const char *names[FILES];
    struct orl_file contents[FILES];
    struct orl_memory_files memory;
    struct orl_files files;
};

static void add_file(struct text_files *t, const char *name, const void *data, size_t size)
{
    const size_t n = t->memory.count++;
    assert_true(n < FILES);
    t->names[n] = name;
    t->contents[n] = (struct orl_file){data, size, NULL};
    t->memory.names = t->names;
    t->memory.contents = t->contents;
    t->files = orl_files_from_memory(&t->memory);
}

static void add_text(struct text_files *t, const char *name, const char *text)
{
    add_file(t, name, text, strlen(text));
}

/* Parses a.rad and resolves it. Returns false if it is refused. */
static bool read_text(const struct text_files *t, struct orl_parsed_scene *ret)
{
    static const char *const names[] = {"a.rad"};
    struct orl_error err = {0};
    *ret = (struct orl_parsed_scene){0};
    const bool taken = orl_scene_parse(names, 1, &t->files, ret, &err) == 0 &&
                       orl_scene_remove_coincident(ret, &err) == 0;
    if (!taken)
        print_message("refused: %s:%d %s\n", err.file, err.line, err.message);
    return taken;
}

static int open_kept(const char *path, const unsigned char *of, const struct text_files *t,
                     struct orl_parsed_scene *ret, struct orl_error *err)
{
    struct orl_sources sources;
    orl_sources_init(&sources, &t->files, NULL, orl_arena_new());
    return orl_parsed_scene_load(path, of, &sources, ret, err);
}

static unsigned char *write_cached_scene(const struct orl_parsed_scene *d, const char *path,
                                         size_t *ret_size)
{
    struct orl_error err = {0};
    uint64_t bytes;
    if (orl_parsed_scene_save(d, content, path, &bytes, &err) < 0)
        fail_msg("%s", err.message);
    unsigned char *const data = scene_read_bytes(path, ret_size);
    assert_int_equal(bytes, *ret_size);
    return data;
}

/* Writes, reads, and writes the scene again: both files are equal, and so is the scene. Returns
 * false if the text is refused. */
static bool returns(const struct text_files *t)
{
    struct orl_parsed_scene d, kept = {0};
    struct orl_error err = {0};
    const char *path;
    size_t size, size_again;
    if (!read_text(t, &d)) {
        orl_parsed_scene_done(&d);
        return false;
    }
    path = scratch_path("scene");
    unsigned char *const first = write_cached_scene(&d, path, &size);
    if (open_kept(path, content, t, &kept, &err) < 0)
        fail_msg("%s", err.message);
    assert_true(kept.coincidences_resolved);
    assert_memory_equal(kept.digest, d.digest, sizeof d.digest);
    assert_int_equal(kept.n_surfaces, d.n_surfaces);
    assert_int_equal(kept.n_materials, d.n_materials);
    assert_int_equal(kept.n_warnings, d.n_warnings);
    orl_parsed_scene_done(&d);
    path = scratch_path("again");
    unsigned char *const again = write_cached_scene(&kept, path, &size_again);
    assert_int_equal(size, size_again);
    assert_memory_equal(first, again, size);
    free(first);
    free(again);
    struct orl_scene *scene = NULL;
    (void)orl_scene_new(&kept, &scene, &err); /* the geometry may be refused */
    orl_scene_release(scene);
    return true;
}

/* ---- Scenes that are cached ------------------------------------------------------------------ */

static const char function_text[] = "half = .5 + .25*sin(Px) ; share = if(Px - 1, 1, 0);\n"
                                    "tall(z) = if(z - 3, 1, tall(z + 1)*.9);\n"
                                    "deep = tall(Pz) * noise3(Px, Py, Pz);\n"
                                    "u = Px; v = Py; wave(l) = l/1000*if(Px - 1, 1, .5); same(x) = "
                                    "x; pick = select(arg(1), .2, .7);";
static const char data_text[] = "2\n0 1 2\n0 0 3\n0 1 3\n.1 .2 .3\n.4 .5 .6\n";
static const char uneven_text[] = "1\n0 0 4\n0 1 3 9\n.1 .2 .3 .9\n";
static const char font_text[] = "65 4 0 0 255 0 255 255 0 255\n66 3 0 0 255 0 128 255\n32 0\n";
static const char obj_text[] = "v 0 0 9\nv 1 0 9\nv 0 1 9\nvn 0 0 1\nvn .1 0 1\nvn 0 .1 1\n"
                               "f 1//1 2//2 3//3\n";

/* A scene of one material on a polygon, followed by more text. */
#define FLOOR " polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n"

static const char *const scenes[] = {
    "void plastic m 0 0 5 .5 .4 .3 .1 .05\nm" FLOOR "m sphere s 0 0 4 1 1 1 .5\n"
    "m bubble b 0 0 4 1 1 1 .2\nm cone c 0 0 8 2 2 0 2 2 1 .3 0\nm ring r 0 0 8 3 3 3 0 0 1 .1 "
    ".4\n",
    "void brightfunc f 2 half f.cal 0 0\nf plastic m 0 0 5 .5 .4 .3 0 0\nm" FLOOR,
    "void brightfunc g 2 pick f.cal 0 1 2\ng brightfunc f 2 deep f.cal 0 0\n"
    "f metal m 0 0 5 .5 .4 .3 .2 .1\nm" FLOOR,
    "void colordata f 8 same same same e.dat e.dat e.dat f.cal u 0 0\n"
    "void colordata h 11 same same same d.dat d.dat d.dat f.cal u v -s 2 0 0\n"
    "h plastic m 0 0 5 .5 .4 .3 0 0\nm" FLOOR,
    "void texfunc t 6 .1*Px 0 0 . -rz 30 0 0\nt plastic m 0 0 5 .5 .4 .3 .1 0\nm" FLOOR,
    "void brighttext w 4 font.fnt . AB A 0 11 0 4 1 .5 0 0 0 -.5 0 .9 .1\n"
    "w plastic m 0 0 5 .5 .4 .3 0 0\nm" FLOOR,
    "void plastic p 0 0 5 .5 .4 .3 0 0\nvoid glass q 0 0 3 .8 .8 .8\n"
    "void mixfunc m 4 p q share f.cal 0 0\nm" FLOOR,
    "void plastic p 0 0 5 .5 .4 .3 0 0\nvoid mixfunc m 4 p void share f.cal 0 0\nm" FLOOR,
    "void specfunc s 2 wave f.cal 0 2 380 780\ns plastic m 0 0 5 .5 .5 .5 0 0\nm" FLOOR,
    "void plasfunc m 2 same(.3) f.cal 0 5 .2 .2 .2 .4 0\nm" FLOOR,
    "void prism1 m 5 .9 0 0 -1 . 0 0\nm" FLOOR,
    "void BRTDfunc m 10 0 0 0 .5*RdotP .5 .5 0 0 0 . 0 9 .1 .1 .1 .1 .1 .1 .1 .1 .1\nm" FLOOR,
    "void plastic p 0 0 5 .5 .4 .3 0 0\np" FLOOR "void antimatter a 1 p 0 0\n"
    "a sphere hole 0 0 4 1 1 0 .5\n",
    "void mist m 0 0 7 .01 .01 .01 .9 .9 .9 .5\nm sphere s 0 0 4 0 0 3 1\n"
    "void plastic p 0 0 5 .5 .4 .3 0 0\np" FLOOR,
    "void dielectric d 0 0 5 .9 .9 .9 1.5 0\nd sphere s 0 0 4 1 1 1 .5\n"
    "void mirror r 0 0 3 .9 .9 .9\nr" FLOOR "void spotlight l 0 0 7 9 9 9 60 0 0 -1\n"
    "l ring lamp 0 0 8 2 2 3 0 0 -1 0 .1\n",
    "void plastic q 0 0 5 .1 .1 .1 0 0\nvoid illum i 1 q 0 3 1 1 1\ni" FLOOR,
    "!gendaylit 6 21 12 -a 40 -o 80 -m 75 -W 700 100\nskyfunc glow sky 0 0 4 1 1 1 0\n"
    "sky source up 0 0 4 0 0 1 180\nvoid plastic p 0 0 5 .5 .4 .3 0 0\np" FLOOR,
    "void BSDF b 6 .02 panel.xml 0 1 0 . 0 3 .1 .1 .1\nb" FLOOR
    "void plastic p 0 0 5 .5 .4 .3 0 0\np polygon behind 0 0 9 0 0 -.01 1 0 -.01 0 1 -.01\n",
    "void plastic p 0 0 5 .5 .4 .3 0 0\np" FLOOR "p polygon over 0 0 9 1 1 0 1 2 0 2 1 0\n"
    "p polygon flat 0 0 9 1 1 0 1 1 0 2 1 0\n",
    "void plastic white 0 0 5 .5 .4 .3 0 0\nwhite" FLOOR "!obj2rad a.obj\n",
};

static void text_to_file_and_back(void **state)
{
    char xml[2048];
    size_t taken = 0;
    (void)state;
    scene_uniform_bsdf(.2, xml);
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        struct text_files t = {.memory = {.count = 0}};
        add_text(&t, "a.rad", scenes[i]);
        add_text(&t, "f.cal", function_text);
        add_text(&t, "d.dat", data_text);
        add_text(&t, "e.dat", uneven_text);
        add_text(&t, "font.fnt", font_text);
        add_text(&t, "panel.xml", xml);
        add_text(&t, "a.obj", obj_text);
        const bool is_taken = returns(&t);
        taken += is_taken;
    }
    assert_int_equal(taken, sizeof scenes / sizeof *scenes);
}

/* A tree in many places, stored once, and a mesh's own normals. */
static void what_stands_in_many_places_comes_back(void **state)
{
    struct grove grove;
    struct text_files t = {.memory = {.count = 0}};
    (void)state;
    grove_init(&grove, GROVE_TRIANGLES, GROVE_ROUND, GROVE_PLACES);
    add_text(&t, "a.rad", grove.shared);
    add_text(&t, "tree.rad", grove.tree);
    add_text(&t, "once.rad", "void instance tree 1 tree.oct 0 0\n");
    add_file(&t, "tree.oct", grove.octree.data, grove.octree.size);
    assert_true(returns(&t));
    grove_done(&grove);
}

/* The scenes of the fuzz corpus. */
static void scenes_of_the_corpus_come_back(void **state)
{
    enum { SEPARATOR = 0x1c };
    static const char folder[] = "tests/fuzz/corpus/scene";
    char xml[2048], path[512];
    size_t taken = 0;
    DIR *const entries = opendir(folder);
    (void)state;
    assert_non_null(entries);
    scene_uniform_bsdf(.2, xml);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;) {
        struct text_files t = {.memory = {.count = 0}};
        size_t size;
        if (entry->d_name[0] == '.')
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        char *const text = (char *)scene_read_bytes(path, &size);
        const char *const split = memchr(text, SEPARATOR, size);
        const size_t main_size = split ? (size_t)(split - text) : size;
        add_file(&t, "a.rad", text, main_size);
        if (split)
            add_file(&t, "part.rad", split + 1, size - main_size - 1);
        add_text(&t, "panel.xml", xml);
        taken += returns(&t);
        free(text);
    }
    closedir(entries);
    print_message("%zu scenes of the corpus came back\n", taken);
    assert_true(taken >= 10);
}

/* ---- Cached scenes that are not used --------------------------------------------------------- */

static const char two_files[] = "void plastic m 0 0 5 .5 .4 .3 0 0\n!xform -t 0 0 1 sub/b.rad\n";
static const char part_text[] = "m" FLOOR "!xform c.rad\n";
static const char moved_text[] = "m polygon floor 0 0 12 0 0 0 4 0 0 4 4 0 0 3 0\n!xform c.rad\n";
static const char other_text[] = "m sphere s 0 0 4 1 1 1 .5\n";

static int open_as(const char *path, const struct text_files *t)
{
    struct orl_parsed_scene kept = {0};
    struct orl_error err = {0};
    const int code = open_kept(path, content, t, &kept, &err);
    if (code < 0)
        assert_true(err.message[0] != '\0');
    orl_parsed_scene_done(&kept);
    return code;
}

/* c.rad is searched beside b.rad first: a file that appears there takes precedence. */
static void files_that_changed_are_read_again(void **state)
{
    struct text_files t = {.memory = {.count = 0}}, changed, gone, more;
    struct orl_parsed_scene d;
    const char *path;
    size_t size;
    (void)state;
    add_text(&t, "a.rad", two_files);
    add_text(&t, "sub/b.rad", part_text);
    add_text(&t, "c.rad", other_text);
    assert_true(read_text(&t, &d));
    path = scratch_path("changed");
    free(write_cached_scene(&d, path, &size));
    orl_parsed_scene_done(&d);
    assert_int_equal(open_as(path, &t), 0);
    changed = (struct text_files){.memory = {.count = 0}};
    add_text(&changed, "a.rad", two_files);
    add_text(&changed, "sub/b.rad", moved_text);
    add_text(&changed, "c.rad", other_text);
    assert_int_equal(open_as(path, &changed), ORL_ERR_VERSION);
    gone = (struct text_files){.memory = {.count = 0}};
    add_text(&gone, "a.rad", two_files);
    add_text(&gone, "sub/b.rad", part_text);
    assert_int_equal(open_as(path, &gone), ORL_ERR_VERSION);
    more = (struct text_files){.memory = {.count = 0}};
    add_text(&more, "a.rad", two_files);
    add_text(&more, "sub/b.rad", part_text);
    add_text(&more, "c.rad", other_text);
    add_text(&more, "sub/c.rad", other_text);
    assert_int_equal(open_as(path, &more), ORL_ERR_VERSION);
}

static void write_bytes(const char *path, const unsigned char *data, size_t size)
{
    FILE *const file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void damaged_files_are_refused(void **state)
{
    struct text_files t = {.memory = {.count = 0}};
    static const unsigned char other[ORL_CHECKED_FILE_CONTENT] = {3};
    struct orl_parsed_scene d, kept = {0};
    const char *path;
    size_t size;
    (void)state;
    add_text(&t, "a.rad", scenes[0]);
    assert_true(read_text(&t, &d));
    path = scratch_path("damaged");
    unsigned char *const data = write_cached_scene(&d, path, &size);
    orl_parsed_scene_done(&d);
    assert_int_equal(open_kept(path, other, &t, &kept, NULL), ORL_ERR_CORRUPT);
    for (size_t at = 0; at < size; at += 1 + size / 97) {
        data[at] ^= 4;
        write_bytes(path, data, size);
        const int code = open_as(path, &t);
        assert_true(code == ORL_ERR_CORRUPT || code == ORL_ERR_VERSION);
        data[at] ^= 4;
    }
    for (size_t cut = 0; cut < size; cut += 1 + size / 13) {
        write_bytes(path, data, cut);
        assert_int_equal(open_as(path, &t), ORL_ERR_CORRUPT);
    }
    write_bytes(path, data, size);
    assert_int_equal(open_as(path, &t), 0);
    free(data);
}

/* ---- In jobs --------------------------------------------------------------------------------- */

enum { POLYGONS = 12000, SENSORS = 2 };

/* Returns a field of polygons, patterned, under a sky. */
static char *field(void)
{
    static const char head[] = "void brightfunc f 2 .5+.3*sin(Px) . 0 0\n"
                               "f plastic patterned 0 0 5 .5 .4 .3 0 0\n"
                               "patterned polygon ground 0 0 12 -9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1\n"
                               "!gensky -ang 60 20 -c -B 50\nskyfunc glow sky 0 0 4 1 1 1 0\n"
                               "sky source up 0 0 4 0 0 1 180\n";
    size_t size;
    char *const polygons = polygons_text(0, POLYGONS, true, &size);
    const size_t all = sizeof head + strlen(polygons_materials) + size;
    char *const text = malloc(all);
    assert_non_null(text);
    snprintf(text, all, "%s%s%s", head, polygons_materials, polygons);
    free(polygons);
    return text;
}

static struct orl_result run_job(const char *text, const char *folder)
{
    static const struct orl_sensor sensors[SENSORS] = {{{3, 3, 4}, {0, 0, 1}},
                                                       {{1, 2, 4}, {0, 0, -1}}};
    const struct scene_run run = {.scene = text,
                                  .sensors = sensors,
                                  .n_sensors = SENSORS,
                                  .technique = ORL_TECHNIQUE_BACKWARD,
                                  .samples = 64,
                                  .folder = folder};
    return scene_run(&run);
}

/* Returns the path of the one scene in the folder's cache; false: there is none. */
static bool kept_in(const char *folder, char ret_path[1024])
{
    DIR *const entries = opendir(folder);
    bool found = false;
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;)
        if (strncmp(entry->d_name, "scene-", 6) == 0) {
            assert_false(found);
            found = true;
            snprintf(ret_path, 1024, "%s/%s", folder, entry->d_name);
        }
    closedir(entries);
    return found;
}

static void damage(const char *path)
{
    size_t size;
    unsigned char *const data = scene_read_bytes(path, &size);
    data[size / 2] ^= 1;
    write_bytes(path, data, size);
    free(data);
}

/* A scene is parsed, found in the cache, found damaged and parsed again: the results have the same
 * bytes. */
static void jobs_find_scenes(void **state)
{
    char *const text = field();
    char folder[512], path[1024];
    struct orl_result results[3];
    (void)state;
    snprintf(folder, sizeof folder, "%s", scratch_path("job"));
    assert_int_equal(mkdir(folder, 0777), 0);
    for (int i = 0; i < 3; i++) {
        results[i] = run_job(text, folder);
        assert_true(kept_in(folder, path));
        if (i == 1)
            damage(path);
        assert_int_equal(results[i].n_warnings, results[0].n_warnings + (i == 2));
        assert_memory_equal(results[i].illuminance_lx, results[0].illuminance_lx,
                            SENSORS * sizeof(double));
        assert_int_equal(results[i].health.surfaces, results[0].health.surfaces);
    }
    assert_true(results[0].health.surfaces > POLYGONS);
    for (int i = 0; i < 3; i++)
        orl_result_done(&results[i]);
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(text_to_file_and_back),
        cmocka_unit_test(what_stands_in_many_places_comes_back),
        cmocka_unit_test(scenes_of_the_corpus_come_back),
        cmocka_unit_test(files_that_changed_are_read_again),
        cmocka_unit_test(damaged_files_are_refused),
        cmocka_unit_test(jobs_find_scenes),
    };
    return cmocka_run_group_tests(tests, scratch_set_up, scratch_tear_down);
}
