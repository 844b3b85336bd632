/*
 * Files of other programs as parts of a scene: luminaires (luminaires.h); and meshes, Wavefront OBJ
 * files, alone or by obj2rad, glTF and STL files. A face is a polygon whose modifier is named, and
 * must be defined, as any other's is: of OBJ the name of usemtl, else of the first group, else
 * "white", or what obj2rad's rules say; of glTF the material's name, else "white"; of STL the
 * file's own name without folder and ending. A face that is
 * not planar to a thousandth of its size comes in triangles, as obj2rad cuts it; so does one whose
 * corners have normals of their own, between which light is shaded (material/texture.h), but for
 * obj2rad -f.
 */
#ifndef ORL_SCENE_PARSE_OBJECTS_H
#define ORL_SCENE_PARSE_OBJECTS_H

#include "scene/parse/parser.h"

enum orl_object_kind {
    ORL_OBJECT_NONE,
    ORL_OBJECT_OBJ,
    ORL_OBJECT_STL,
    ORL_OBJECT_GLTF,
    ORL_OBJECT_IES
};

/* By the ending of its name and by how it begins: scene text may end in .obj, too. */
enum orl_object_kind orl_object_kind_of(const char *name, const struct orl_file *file);

/* Reads a mesh of that kind, whose scope has been made. */
int orl_parser_object(struct orl_parser *parser, const struct orl_scope *scope,
                      const struct orl_file *file, enum orl_object_kind kind,
                      struct orl_error *err);

/* The command obj2rad [-f] [-m RULES] [-o NAME] FILE; without FILE when that is piped into it by a
 * command in that line, which is what messages name. */
int orl_parser_obj2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, const struct orl_file *piped,
                       int line, struct orl_error *err);

#endif
