/*
 * Meshes and compiled scenes of other programs, read by a scene that names them. The first byte
 * chooses: an OBJ file, an OBJ file with rules (the rules come first, then 0x1c), STL, a compiled
 * mesh, an octree.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "scene/parse/parse.h"

enum { SEPARATOR = 0x1c };

#define MATERIALS "void plastic white 0 0 5 .5 .5 .5 0 0\nvoid alias a white\nvoid alias b white\n"
static const char *const scenes[] = {
    MATERIALS "!obj2rad -o o m.obj | xform -rx 90\n", MATERIALS "!obj2rad -f -m m.map m.obj\n",
    "void alias m void\nvoid plastic m 0 0 5 .5 .5 .5 0 0\n"
    "!xform -s 2 m.stl\n",
    MATERIALS "a mesh x 1 m.rtm 0 0\n", MATERIALS "void instance y 3 m.oct -t 1 0 0\n0\n0\n"};

bool fuzz_mesh(const uint8_t *data, size_t size)
{
    static const char *const main_file[] = {"s.rad"};
    static const char *const names[] = {"s.rad", "m.obj", "m.map", "m.stl", "m.rtm", "m.oct"};
    enum { KINDS = sizeof scenes / sizeof *scenes };
    const size_t kind = size > 0 ? data[0] % KINDS : 0;
    const char *const bytes = size > 0 ? (const char *)data + 1 : "";
    const size_t rest = size > 0 ? size - 1 : 0;
    const char *const cut = kind == 1 && rest > 0 ? memchr(bytes, SEPARATOR, rest) : NULL;
    const size_t rules = cut ? (size_t)(cut - bytes) : 0;
    const struct orl_file whole = {bytes, rest, NULL};
    const struct orl_file contents[] = {
        {scenes[kind], strlen(scenes[kind]), NULL},
        {cut ? cut + 1 : bytes, cut ? rest - rules - 1 : rest, NULL},
        {bytes, rules, NULL},
        whole,
        whole,
        whole};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    const int code = orl_scene_parse(main_file, 1, &files, &parsed_scene, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(err.file[0] != '\0');
        return false;
    }
    fuzz_check_surfaces(&parsed_scene);
    orl_parsed_scene_done(&parsed_scene);
    return true;
}
