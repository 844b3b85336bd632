/*
 * Files of other programs as parts of a scene: luminaires (luminaires.h); and meshes in Wavefront
 * OBJ (directly or by obj2rad), glTF and STL. A face becomes a polygon, whose modifier must be
 * defined like any other's. Its name is: for OBJ that of usemtl, else the first group's, else
 * "white", or what obj2rad's rules give; for glTF the material's name, else "white"; for STL the
 * file's name without folder and extension.
 *
 * A face that is not planar to a thousandth of its size is split into triangles, as by obj2rad; so
 * is one whose corners have different normals, between which shading is interpolated
 * (material/patterns/texture.h), except with obj2rad -f.
 */
#ifndef ORL_SCENE_PARSE_MESH_MESH_IMPORT_H
#define ORL_SCENE_PARSE_MESH_MESH_IMPORT_H

#include "scene/parse/parser.h"

enum orl_import_kind {
    ORL_IMPORT_NONE,
    ORL_IMPORT_OBJ,
    ORL_IMPORT_STL,
    ORL_IMPORT_GLTF,
    ORL_IMPORT_IES
};

/* Decides by the name's extension and by the first bytes: scene text may end in .obj, too. */
enum orl_import_kind orl_import_kind_of(const char *name, const struct orl_file *file);

/* Reads a mesh of that kind, in the scope made for it. */
int orl_parser_import_mesh(struct orl_parser *parser, const struct orl_scope *scope,
                           const struct orl_file *file, enum orl_import_kind kind,
                           struct orl_error *err);

/* The command obj2rad [-f] [-m RULES] [-o NAME] FILE. Without FILE it reads the output piped into
 * it by a command in that line, which messages name. */
int orl_parser_obj2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, const struct orl_file *piped,
                       int line, struct orl_error *err);

#endif
