/*
 * glTF files read by a scene that places them: .glb or .gltf by the first bytes. The buffer "b" of
 * a .gltf is the input itself. Input that begins as neither is read as scene text, as in
 * fuzz_scene.c.
 */
#include <string.h>

#include "fuzz/fuzz.h"
#include "scene/parse/gltf/gltf.h"
#include "scene/parse/parse.h"

#define MATERIALS "void plastic white 0 0 5 .5 .5 .5 0 0\n"

bool fuzz_gltf(const uint8_t *data, size_t size)
{
    static const char *const main_file[] = {"s.rad"};
    static const char *const names[] = {"s.rad", "m.glb", "m.gltf", "b"};
    const bool binary = size > 4 && memcmp(data, "glTF", 4) == 0;
    const char *const scene =
        binary ? MATERIALS "!xform -m white -s 2 m.glb\n" : MATERIALS "!xform -m white m.gltf\n";
    const struct orl_file whole = {(const char *)data, size, NULL};
    const struct orl_file contents[] = {{scene, strlen(scene), NULL}, whole, whole, whole};
    struct orl_memory_files memory = {names, contents, sizeof names / sizeof *names};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_parsed_scene parsed_scene = {0};
    struct orl_error err = {0};
    if (!orl_gltf_detect((const char *)data, size))
        return false;
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
