#include "scene/parse/gltf/gltf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/parse/gltf/gltf_file.h"

enum { MAX_DEPTH = 500 };
enum { POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, STRIP, FAN };

/* State of a node: not visited; on the current branch; done. */
enum { NEW, OPEN, LEFT };

struct reading {
    struct orl_gltf_file file;
    const struct orl_wavefront_sink *sink;
    struct orl_gltf_ignored *ignored;
    struct orl_wavefront_face face;
    unsigned char *nodes; /* NEW, OPEN or LEFT */
    size_t n_nodes;
    struct orl_error *err;
};

/* A glTF mesh primitive. */
struct primitive {
    struct orl_gltf_item item;
    struct orl_gltf_accessor corners, normals, indices;
    bool has_normals, has_indices;
    size_t mode, n; /* n: corners in total */
};

/* ---- Names ----------------------------------------------------------------------------------- */

static void copy_name(const char *from, char ret_name[ORL_WAVEFRONT_NAME])
{
    snprintf(ret_name, ORL_WAVEFRONT_NAME, "%s", from ? from : "");
    for (char *c = ret_name; *c; c++)
        *c = strchr(" \t\r\n", *c) ? '_' : *c;
}

static int name_material(struct reading *r, const struct orl_gltf_item *primitive)
{
    struct orl_gltf_item material;
    size_t index = SIZE_MAX;
    int code = orl_gltf_integer(primitive, "material", &index, r->err);
    r->face.material[0] = '\0';
    if (code || index == SIZE_MAX)
        return code;
    code = orl_gltf_find(primitive, "materials", index, &material, r->err);
    if (code == 0)
        copy_name(orl_gltf_text(&material, "name"), r->face.material);
    return code;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

static int find_corner(struct reading *r, const struct primitive *p, size_t i, size_t *ret_corner)
{
    if (p->has_indices)
        i = orl_gltf_accessor_integer(&p->indices, i);
    *ret_corner = i;
    return i < p->corners.count && !(p->has_indices && i == orl_gltf_accessor_max(&p->indices))
               ? 0
               : orl_gltf_fail(&p->item, ORL_ERR_SYNTAX, r->err,
                               "a triangle uses corner %zu, which the mesh does not have", i);
}

static int read_vector(struct reading *r, const struct orl_gltf_accessor *accessor, size_t i,
                       struct orl_vec3 *ret_vector)
{
    double value[4];
    const int code = orl_gltf_accessor_value(accessor, i, value, r->err);
    if (code == 0)
        *ret_vector = orl_v3(value[0], value[1], value[2]);
    return code;
}

/* Adds the triangle of three positions in the primitive's list of corners. */
static int add_triangle(struct reading *r, const struct primitive *p, const size_t places[3],
                        const struct orl_gltf_transform *transform)
{
    struct orl_vec3 corners[3], normals[3];
    const bool turned = orl_gltf_transform_mirrors(transform);
    int code = orl_gltf_file_step(&r->file, &p->item, 1, r->err);
    for (int k = 0; k < 3 && code == 0; k++) {
        size_t corner = 0;
        code = find_corner(r, p, places[turned ? 2 - k : k], &corner);
        if (code == 0)
            code = read_vector(r, &p->corners, corner, &corners[k]);
        if (code == 0 && p->has_normals)
            code = read_vector(r, &p->normals, corner, &normals[k]);
        if (code)
            return code;
        corners[k] = orl_gltf_transform_point(transform, corners[k]);
        if (p->has_normals)
            normals[k] = orl_gltf_transform_normal(transform, normals[k]);
        if (!isfinite(corners[k].x + corners[k].y + corners[k].z))
            return orl_gltf_fail(&p->item, ORL_ERR_RANGE, r->err, "a corner is not finite");
    }
    if (code)
        return code;
    r->face.corners = corners;
    r->face.normals = p->has_normals ? normals : NULL;
    r->face.n_corners = 3;
    r->face.number++;
    r->face.line = (int)(r->face.number % 1000000000);
    return r->sink->add(r->sink->ctx, &r->face, r->err);
}

static int add_triangles(struct reading *r, const struct primitive *p,
                         const struct orl_gltf_transform *transform)
{
    const size_t step = p->mode == TRIANGLES ? 3 : 1;
    int code = 0;
    for (size_t i = 0; i + 2 < p->n && code == 0; i += step) {
        const size_t odd = p->mode == STRIP ? i % 2 : 0;
        const size_t places[3] = {p->mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        code = add_triangle(r, p, places, transform);
    }
    return code;
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

static int open_attributes(struct reading *r, struct primitive *p)
{
    struct orl_gltf_item attributes;
    size_t corners = SIZE_MAX, normals = SIZE_MAX;
    int code = orl_gltf_member(&p->item, "attributes", &attributes, r->err);
    if (code == 0)
        code = orl_gltf_integer(&attributes, "POSITION", &corners, r->err);
    if (code == 0)
        code = orl_gltf_integer(&attributes, "NORMAL", &normals, r->err);
    if (code == 0 && corners == SIZE_MAX)
        code = orl_gltf_fail(&attributes, ORL_ERR_SYNTAX, r->err, "it has no 'POSITION'");
    if (code == 0)
        code = orl_gltf_accessor_open(&r->file, &attributes, corners, "VEC3", &p->corners, r->err);
    p->has_normals = normals != SIZE_MAX;
    if (code == 0 && p->has_normals)
        code = orl_gltf_accessor_open(&r->file, &attributes, normals, "VEC3", &p->normals, r->err);
    if (code)
        return code;
    if (p->has_normals && p->normals.count != p->corners.count)
        return orl_gltf_fail(&attributes, ORL_ERR_SYNTAX, r->err,
                             "it has %zu corners but %zu normals", p->corners.count,
                             p->normals.count);
    p->n = p->corners.count;
    return 0;
}

static int open_indices(struct reading *r, struct primitive *p)
{
    size_t index = SIZE_MAX;
    int code = orl_gltf_integer(&p->item, "indices", &index, r->err);
    p->has_indices = index != SIZE_MAX;
    if (code || !p->has_indices)
        return code;
    code = orl_gltf_accessor_open(&r->file, &p->item, index, "SCALAR", &p->indices, r->err);
    if (code)
        return code;
    if (orl_gltf_accessor_max(&p->indices) == 0 || p->indices.normalized)
        return orl_gltf_fail(&p->indices.item, ORL_ERR_SYNTAX, r->err,
                             "it is used for indices but does not hold unsigned integers");
    p->n = p->indices.count;
    return 0;
}

static int open_primitive(struct reading *r, struct primitive *p)
{
    int code = orl_gltf_integer(&p->item, "mode", &p->mode, r->err);
    if (code == 0)
        code = open_attributes(r, p);
    if (code == 0)
        code = open_indices(r, p);
    if (code)
        return code;
    if (p->mode > FAN)
        return orl_gltf_fail(&p->item, ORL_ERR_SYNTAX, r->err, "the 'mode' %zu is unknown",
                             p->mode);
    if (p->mode == TRIANGLES && p->n % 3 != 0)
        return orl_gltf_fail(&p->item, ORL_ERR_SYNTAX, r->err,
                             "it has %zu corners, which is not a multiple of 3", p->n);
    return 0;
}

static int add_mesh(struct reading *r, const struct orl_gltf_item *mesh,
                    const struct orl_gltf_transform *transform)
{
    size_t count = 0;
    int code = orl_gltf_length(mesh, "primitives", &count, r->err);
    for (size_t i = 0; i < count && code == 0; i++) {
        struct primitive p = {.mode = TRIANGLES};
        code = orl_gltf_file_step(&r->file, mesh, 1, r->err);
        if (code == 0)
            code = orl_gltf_element(mesh, "primitives", i, &p.item, r->err);
        if (code == 0)
            code = open_primitive(r, &p);
        if (code == 0)
            code = name_material(r, &p.item);
        if (code == 0 && p.mode < TRIANGLES)
            r->ignored->lines++;
        else if (code == 0)
            code = add_triangles(r, &p, transform);
    }
    return code;
}

/* ---- Nodes ----------------------------------------------------------------------------------- */

/* Returns true if the mesh has morph targets with non-zero weights. */
static bool is_blended(const struct orl_gltf_item *node, const struct orl_gltf_item *mesh)
{
    const json_t *const first = json_array_get(json_object_get(mesh->object, "primitives"), 0);
    const json_t *own = json_object_get(node->object, "weights"), *weight;
    size_t i;
    if (json_array_size(json_object_get(first, "targets")) == 0)
        return false;
    json_array_foreach(own ? own : json_object_get(mesh->object, "weights"), i,
                       weight) if (json_number_value(weight) != 0) return true;
    return false;
}

static int add_mesh_of(struct reading *r, const struct orl_gltf_item *node,
                       const struct orl_gltf_transform *combined)
{
    struct orl_gltf_item mesh;
    struct orl_gltf_instances instances;
    size_t index = SIZE_MAX;
    int code = orl_gltf_integer(node, "mesh", &index, r->err);
    if (code || index == SIZE_MAX)
        return code;
    code = orl_gltf_find(node, "meshes", index, &mesh, r->err);
    if (code == 0)
        code = orl_gltf_instances_open(&r->file, node, &instances, r->err);
    if (code)
        return code;
    const char *const name = orl_gltf_text(node, "name");
    copy_name(name ? name : orl_gltf_text(&mesh, "name"), r->face.object);
    r->ignored->skinned += json_object_get(node->object, "skin") != NULL;
    r->ignored->blended += is_blended(node, &mesh);
    for (size_t i = 0; i < instances.count && code == 0; i++) {
        struct orl_gltf_transform own;
        code = orl_gltf_instance_transform(&instances, i, &own, r->err);
        const struct orl_gltf_transform transform = orl_gltf_transform_compose(combined, &own);
        if (code == 0)
            code = add_mesh(r, &mesh, &transform);
    }
    return code;
}

/* Visits a node once; a node with two parents, or inside itself, is refused. */
static int enter_node(struct reading *r, const struct orl_gltf_item *by, size_t index, int depth,
                      struct orl_gltf_item *ret_node)
{
    const int code = orl_gltf_find(by, "nodes", index, ret_node, r->err);
    if (code)
        return code;
    if (r->nodes[index] != NEW)
        return orl_gltf_fail(ret_node, ORL_ERR_SYNTAX, r->err,
                             r->nodes[index] == OPEN ? "it contains itself" : "it has two parents");
    if (depth > MAX_DEPTH) {
        orl_gltf_fail(ret_node, ORL_ERR_LIMIT, r->err, "nodes are nested more than %d deep",
                      MAX_DEPTH);
        orl_error_hint(r->err, "export it with its nodes merged");
        return ORL_ERR_LIMIT;
    }
    r->nodes[index] = OPEN;
    return 0;
}

static int add_node(struct reading *r, const struct orl_gltf_item *by, size_t index,
                    const struct orl_gltf_transform *outer, int depth)
{
    struct orl_gltf_item node;
    struct orl_gltf_transform own;
    size_t count = 0;
    int code = enter_node(r, by, index, depth, &node);
    if (code == 0)
        code = orl_gltf_transform_read(&node, &own, r->err);
    if (code)
        return code;
    const struct orl_gltf_transform combined = orl_gltf_transform_compose(outer, &own);
    code = add_mesh_of(r, &node, &combined);
    if (code == 0)
        code = orl_gltf_length(&node, "children", &count, r->err);
    for (size_t i = 0; i < count && code == 0; i++) {
        size_t child = 0;
        code = orl_gltf_integer_in_list(&node, "children", i, &child, r->err);
        if (code == 0)
            code = add_node(r, &node, child, &combined, depth + 1);
    }
    r->nodes[index] = LEFT;
    return code;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static int mark_children(struct reading *r, size_t index, bool *within)
{
    struct orl_gltf_item node;
    size_t count = 0, child = 0;
    int code = orl_gltf_find(&r->file.root, "nodes", index, &node, r->err);
    if (code == 0)
        code = orl_gltf_length(&node, "children", &count, r->err);
    for (size_t i = 0; i < count && code == 0; i++) {
        code = orl_gltf_integer_in_list(&node, "children", i, &child, r->err);
        if (code == 0 && child < r->n_nodes)
            within[child] = true;
    }
    return code;
}

/* A file without a scene: adds all nodes that have no parent. */
static int add_all(struct reading *r)
{
    bool *const within = calloc(r->n_nodes + 1, sizeof *within);
    int code = 0;
    if (!within)
        return orl_error_set(r->err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    for (size_t i = 0; i < r->n_nodes && code == 0; i++)
        code = mark_children(r, i, within);
    for (size_t i = 0; i < r->n_nodes && code == 0; i++)
        if (!within[i])
            code = add_node(r, &r->file.root, i, &orl_gltf_z_up, 0);
    free(within);
    return code;
}

static int add_scene(struct reading *r)
{
    const struct orl_gltf_item *const root = &r->file.root;
    struct orl_gltf_item scene;
    size_t n_scenes = 0, index = SIZE_MAX, count = 0;
    int code = orl_gltf_length(root, "scenes", &n_scenes, r->err);
    if (code == 0)
        code = orl_gltf_integer(root, "scene", &index, r->err);
    if (code == 0 && n_scenes == 0 && index == SIZE_MAX)
        return add_all(r);
    if (code == 0)
        code = orl_gltf_find(root, "scenes", index == SIZE_MAX ? 0 : index, &scene, r->err);
    if (code == 0)
        code = orl_gltf_length(&scene, "nodes", &count, r->err);
    for (size_t i = 0; i < count && code == 0; i++) {
        size_t node = 0;
        code = orl_gltf_integer_in_list(&scene, "nodes", i, &node, r->err);
        if (code == 0)
            code = add_node(r, &scene, node, &orl_gltf_z_up, 0);
    }
    return code;
}

int orl_gltf_read(const char *file, const char *data, size_t size,
                  const struct orl_gltf_buffers *buffers, const struct orl_wavefront_sink *sink,
                  struct orl_gltf_ignored *ret_ignored, struct orl_error *err)
{
    struct reading *const r = calloc(1, sizeof *r);
    *ret_ignored = (struct orl_gltf_ignored){0};
    if (!r)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    r->sink = sink;
    r->ignored = ret_ignored;
    r->err = err;
    int code = orl_gltf_file_open(&r->file, file, data, size, buffers, err);
    if (code == 0)
        code = orl_gltf_length(&r->file.root, "nodes", &r->n_nodes, err);
    if (code == 0 && !(r->nodes = calloc(r->n_nodes + 1, 1)))
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    if (code == 0)
        code = add_scene(r);
    ret_ignored->empty = r->face.number == 0;
    orl_gltf_file_done(&r->file);
    free(r->nodes);
    free(r);
    return code;
}
