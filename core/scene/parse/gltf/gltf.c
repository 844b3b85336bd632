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

static void name_material(struct reading *r, const struct orl_gltf_item *primitive)
{
    const size_t index = orl_gltf_integer(primitive, "material", SIZE_MAX);
    r->face.material[0] = '\0';
    if (index != SIZE_MAX) {
        const struct orl_gltf_item material = orl_gltf_find(primitive, "materials", index);
        copy_name(orl_gltf_text(&material, "name"), r->face.material);
    }
}

/* ---- Triangles ------------------------------------------------------------------------------- */

static size_t find_corner(const struct primitive *p, size_t i)
{
    if (p->has_indices)
        i = orl_gltf_accessor_integer(&p->indices, i);
    if (i >= p->corners.count || (p->has_indices && i == orl_gltf_accessor_max(&p->indices)))
        orl_gltf_fail(&p->item, ORL_ERR_SYNTAX,
                      "a triangle uses corner %zu, which the mesh does not have", i);
    return i;
}

static struct orl_vec3 read_vector(const struct orl_gltf_accessor *accessor, size_t i)
{
    double value[4];
    orl_gltf_accessor_value(accessor, i, value);
    return orl_v3(value[0], value[1], value[2]);
}

/* Adds the triangle of three positions in the primitive's list of corners. */
static void add_triangle(struct reading *r, const struct primitive *p, const size_t places[3],
                         const struct orl_gltf_transform *transform)
{
    struct orl_vec3 corners[3], normals[3];
    const bool turned = orl_gltf_transform_mirrors(transform);
    orl_gltf_step(&p->item, 1);
    for (int k = 0; k < 3; k++) {
        const size_t corner = find_corner(p, places[turned ? 2 - k : k]);
        if (r->file.code)
            return;
        corners[k] = orl_gltf_transform_point(transform, read_vector(&p->corners, corner));
        if (p->has_normals)
            normals[k] = orl_gltf_transform_normal(transform, read_vector(&p->normals, corner));
        if (!isfinite(corners[k].x + corners[k].y + corners[k].z))
            orl_gltf_fail(&p->item, ORL_ERR_RANGE, "a corner is not finite");
    }
    if (r->file.code)
        return;
    r->face.corners = corners;
    r->face.normals = p->has_normals ? normals : NULL;
    r->face.n_corners = 3;
    r->face.number++;
    r->face.line = (int)(r->face.number % 1000000000);
    r->file.code = r->sink->add(r->sink->ctx, &r->face, r->file.err);
}

static void add_triangles(struct reading *r, const struct primitive *p,
                          const struct orl_gltf_transform *transform)
{
    const size_t step = p->mode == TRIANGLES ? 3 : 1;
    for (size_t i = 0; i + 2 < p->n && !r->file.code; i += step) {
        const size_t odd = p->mode == STRIP ? i % 2 : 0;
        const size_t places[3] = {p->mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        add_triangle(r, p, places, transform);
    }
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

static void open_attributes(struct primitive *p)
{
    const struct orl_gltf_item attributes = orl_gltf_member(&p->item, "attributes");
    const size_t corners = orl_gltf_integer(&attributes, "POSITION", SIZE_MAX);
    const size_t normals = orl_gltf_integer(&attributes, "NORMAL", SIZE_MAX);
    if (corners == SIZE_MAX)
        orl_gltf_fail(&attributes, ORL_ERR_SYNTAX, "it has no 'POSITION'");
    p->corners = orl_gltf_accessor_open(&attributes, corners, "VEC3");
    p->n = p->corners.count;
    p->has_normals = normals != SIZE_MAX;
    if (p->has_normals)
        p->normals = orl_gltf_accessor_open(&attributes, normals, "VEC3");
    if (p->has_normals && p->normals.count != p->corners.count)
        orl_gltf_fail(&attributes, ORL_ERR_SYNTAX, "it has %zu corners but %zu normals",
                      p->corners.count, p->normals.count);
}

static void open_indices(struct primitive *p)
{
    const size_t index = orl_gltf_integer(&p->item, "indices", SIZE_MAX);
    p->has_indices = index != SIZE_MAX;
    if (!p->has_indices)
        return;
    p->indices = orl_gltf_accessor_open(&p->item, index, "SCALAR");
    p->n = p->indices.count;
    if (orl_gltf_accessor_max(&p->indices) == 0 || p->indices.normalized)
        orl_gltf_fail(&p->indices.item, ORL_ERR_SYNTAX,
                      "it is used for indices but does not hold unsigned integers");
}

static struct primitive open_primitive(const struct orl_gltf_item *mesh, size_t i)
{
    struct primitive p = {.item = orl_gltf_element(mesh, "primitives", i)};
    p.mode = orl_gltf_integer(&p.item, "mode", TRIANGLES);
    open_attributes(&p);
    open_indices(&p);
    if (p.mode > FAN)
        orl_gltf_fail(&p.item, ORL_ERR_SYNTAX, "the 'mode' %zu is unknown", p.mode);
    if (p.mode == TRIANGLES && p.n % 3 != 0)
        orl_gltf_fail(&p.item, ORL_ERR_SYNTAX, "it has %zu corners, which is not a multiple of 3",
                      p.n);
    return p;
}

static void add_mesh(struct reading *r, const struct orl_gltf_item *mesh,
                     const struct orl_gltf_transform *transform)
{
    const size_t count = orl_gltf_length(mesh, "primitives");
    for (size_t i = 0; i < count && !r->file.code; i++) {
        orl_gltf_step(mesh, 1);
        const struct primitive p = open_primitive(mesh, i);
        name_material(r, &p.item);
        if (p.mode < TRIANGLES)
            r->ignored->lines++;
        else
            add_triangles(r, &p, transform);
    }
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

static void add_mesh_of(struct reading *r, const struct orl_gltf_item *node,
                        const struct orl_gltf_transform *combined)
{
    struct orl_gltf_instances instances;
    const size_t index = orl_gltf_integer(node, "mesh", SIZE_MAX);
    if (index == SIZE_MAX)
        return;
    const struct orl_gltf_item mesh = orl_gltf_find(node, "meshes", index);
    const char *const name = orl_gltf_text(node, "name");
    orl_gltf_instances_open(node, &instances);
    copy_name(name ? name : orl_gltf_text(&mesh, "name"), r->face.object);
    r->ignored->skinned += json_object_get(node->object, "skin") != NULL;
    r->ignored->blended += is_blended(node, &mesh);
    for (size_t i = 0; i < instances.count && !r->file.code; i++) {
        const struct orl_gltf_transform own = orl_gltf_instance_transform(&instances, i);
        const struct orl_gltf_transform transform = orl_gltf_transform_compose(combined, &own);
        add_mesh(r, &mesh, &transform);
    }
}

static void add_node(struct reading *r, const struct orl_gltf_item *by, size_t index,
                     const struct orl_gltf_transform *outer, int depth);

/* Adds the nodes that a list of the item names. */
static void add_nodes(struct reading *r, const struct orl_gltf_item *by, const char *list,
                      const struct orl_gltf_transform *outer, int depth)
{
    const size_t count = orl_gltf_length(by, list);
    for (size_t i = 0; i < count && !r->file.code; i++)
        add_node(r, by, orl_gltf_integer_in_list(by, list, i), outer, depth);
}

/* Visits a node once; a node with two parents, or inside itself, is refused. */
static void add_node(struct reading *r, const struct orl_gltf_item *by, size_t index,
                     const struct orl_gltf_transform *outer, int depth)
{
    const struct orl_gltf_item node = orl_gltf_find(by, "nodes", index);
    if (!r->file.code && r->nodes[index] != NEW)
        orl_gltf_fail(&node, ORL_ERR_SYNTAX, "%s",
                      r->nodes[index] == OPEN ? "it contains itself" : "it has two parents");
    if (depth > MAX_DEPTH)
        orl_gltf_refuse(&node, ORL_ERR_LIMIT, "export it with its nodes merged",
                        "nodes are nested more than %d deep", MAX_DEPTH);
    if (r->file.code)
        return;
    const struct orl_gltf_transform own = orl_gltf_transform_read(&node);
    const struct orl_gltf_transform combined = orl_gltf_transform_compose(outer, &own);
    r->nodes[index] = OPEN;
    add_mesh_of(r, &node, &combined);
    add_nodes(r, &node, "children", &combined, depth + 1);
    r->nodes[index] = LEFT;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static void mark_children(struct reading *r, size_t index, bool *within)
{
    const struct orl_gltf_item node = orl_gltf_find(&r->file.root, "nodes", index);
    const size_t count = orl_gltf_length(&node, "children");
    for (size_t i = 0; i < count; i++) {
        const size_t child = orl_gltf_integer_in_list(&node, "children", i);
        if (child < r->n_nodes)
            within[child] = true;
    }
}

/* A file without a scene: adds all nodes that have no parent. */
static void add_all(struct reading *r)
{
    bool *const within = calloc(r->n_nodes + 1, sizeof *within);
    if (!within) {
        orl_gltf_no_memory(&r->file);
        return;
    }
    for (size_t i = 0; i < r->n_nodes && !r->file.code; i++)
        mark_children(r, i, within);
    for (size_t i = 0; i < r->n_nodes && !r->file.code; i++)
        if (!within[i])
            add_node(r, &r->file.root, i, &orl_gltf_z_up, 0);
    free(within);
}

static void add_scene(struct reading *r)
{
    const struct orl_gltf_item *const root = &r->file.root;
    const size_t n_scenes = orl_gltf_length(root, "scenes");
    const size_t index = orl_gltf_integer(root, "scene", SIZE_MAX);
    if (n_scenes == 0 && index == SIZE_MAX) {
        add_all(r);
    } else {
        const struct orl_gltf_item scene =
            orl_gltf_find(root, "scenes", index == SIZE_MAX ? 0 : index);
        add_nodes(r, &scene, "nodes", &orl_gltf_z_up, 0);
    }
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
    orl_gltf_file_open(&r->file, file, data, size, buffers, err);
    r->n_nodes = orl_gltf_length(&r->file.root, "nodes");
    r->nodes = calloc(r->n_nodes + 1, 1);
    if (!r->nodes)
        orl_gltf_no_memory(&r->file);
    if (!r->file.code)
        add_scene(r);
    const int code = r->file.code;
    ret_ignored->empty = r->face.number == 0;
    orl_gltf_file_done(&r->file);
    free(r->nodes);
    free(r);
    return code;
}
