/*
 * Readers of mesh files without a scene: Wavefront OBJ, STL, and rules for the materials of faces
 * (glTF: gltf/gltf.h).
 */
#ifndef ORL_SCENE_PARSE_MESH_MESH_FORMATS_H
#define ORL_SCENE_PARSE_MESH_MESH_FORMATS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

/* Returns a 32-bit integer in little-endian order. */
static inline uint32_t orl_u32_at(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/*
 * Wavefront OBJ: its polygonal faces with their names. Lines, points and curved surfaces are
 * counted and ignored, as are materials of .mtl files: the name in usemtl is that of a modifier.
 * Units and axes are the file's. Reference: Wavefront, "Object Files (.obj)", appendix B1 of the
 * Advanced Visualizer's manual.
 */

enum { ORL_WAVEFRONT_NAME = 128, ORL_WAVEFRONT_GROUPS = 16 };

struct orl_wavefront_face {
    const struct orl_vec3 *corners;
    const struct orl_vec3
        *normals;     /* normals of the corners, of any length; NULL if some have none */
    size_t n_corners; /* at least three */
    uint64_t number;  /* from 1 */
    int line;         /* 1-based */
    /* Names; "" if not given. If there are too many groups, only the first are stored. */
    char material[ORL_WAVEFRONT_NAME], map[ORL_WAVEFRONT_NAME], object[ORL_WAVEFRONT_NAME];
    char groups[ORL_WAVEFRONT_GROUPS][ORL_WAVEFRONT_NAME];
    size_t n_groups;
};

struct orl_wavefront_sink {
    int (*add)(void *ctx, const struct orl_wavefront_face *face, struct orl_error *err);
    void *ctx;
};

/* Content that was ignored. */
struct orl_wavefront_ignored {
    uint64_t lines, curved; /* points and lines; curves and curved surfaces */
};

/* Returns true if the text begins like an OBJ file, and unlike a Radiance scene. */
bool orl_wavefront_detect(const char *text, size_t size);

/* Returns 0, ORL_ERR_SYNTAX with file and line, or the sink's error, which stops reading. file: for
 * messages. */
int orl_wavefront_read(const char *file, const char *text, size_t size,
                       const struct orl_wavefront_sink *sink,
                       struct orl_wavefront_ignored *ret_ignored, struct orl_error *err);

/*
 * STL: triangles, in text or binary, little-endian. Normals follow from the order of corners, and
 * the written ones are ignored; units and axes are the file's. Reference: 3D Systems,
 * "StereoLithography Interface Specification" (1988).
 */

struct orl_stl_sink {
    /* line: 1-based in text; the triangle's number in a binary file */
    int (*add)(void *ctx, const struct orl_vec3 corners[3], int line, struct orl_error *err);
    void *ctx;
};

bool orl_stl_detect(const char *data, size_t size);
/* Returns 0, ORL_ERR_SYNTAX with file and line, or the sink's error, which stops reading. file: for
 * messages. */
int orl_stl_read(const char *file, const char *data, size_t size, const struct orl_stl_sink *sink,
                 struct orl_error *err);

/*
 * Modifiers of a mesh's faces by a file of rules, such as "wood (Group "door") (Face [1:20]);". The
 * last rule that matches counts. Reference: the obj2rad(1) manual of Radiance.
 */

struct orl_material_rules;

/* Returns 0, ORL_ERR_SYNTAX with file and line, or _NOMEM. Copies the text. */
int orl_material_rules_read(const char *file, const char *text, size_t size,
                            struct orl_material_rules **ret_rules, struct orl_error *err);
void orl_material_rules_free(struct orl_material_rules *rules);

/* Returns the modifier, or NULL if the face is omitted: no rule matches, or the last match says
 * "void". */
const char *orl_material_rules_choose(const struct orl_material_rules *rules,
                                      const struct orl_wavefront_face *face);

#endif
