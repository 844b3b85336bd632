#include "scene/parse/gltf.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/scene.h>

#include "scene/parse/gltf_file.h"

enum { MAX_DEPTH = 500, CHUNK_HEAD = 8, GLB_HEAD = 12 };

struct reading {
    const char *file;
    const struct aiScene *scene;
    const struct orl_wavefront_sink *sink;
    struct orl_gltf_rest *rest;
    struct orl_wavefront_face face;
    struct orl_error *err;
};

/* Rows of a placement: x' = m[0] x + m[1] y + m[2] z + m[3]. */
struct placement {
    double row[3][4];
};

static int fail(const char *file, int code, const char *what, const char *mend,
                struct orl_error *err)
{
    orl_error_set(err, code, "%s", what);
    orl_error_hint(err, "%s", mend);
    orl_error_at(err, file, 0, NULL);
    return code;
}

/* ---- What the file asks for ------------------------------------------------------------------ */

static bool is_binary(const char *data, size_t size)
{
    return size >= GLB_HEAD && memcmp(data, "glTF", 4) == 0;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

bool orl_gltf_is(const char *data, size_t size)
{
    size_t at = 0;
    if (is_binary(data, size))
        return true;
    while (at < size && is_blank(data[at]))
        at++;
    return at < size && data[at] == '{';
}

static size_t read_u32(const char *at)
{
    const unsigned char *b = (const unsigned char *)at;
    return (size_t)b[0] | (size_t)b[1] << 8 | (size_t)b[2] << 16 | (size_t)b[3] << 24;
}

/* Of a .glb. Assimp reads on where a version is another, and makes room for what a chunk says that
 * it is, before it looks for it. */
static int heed_chunks(const char *file, const char *data, size_t size, struct orl_error *err)
{
    size_t at = GLB_HEAD;
    if (read_u32(data + 4) != 2)
        return fail(file, ORL_ERR_UNSUPPORTED, "this is glTF, but not of version 2",
                    "export it again as glTF 2.0", err);
    while (size - at >= CHUNK_HEAD) {
        const size_t length = read_u32(data + at);
        at += CHUNK_HEAD;
        if (length > size - at)
            return fail(file, ORL_ERR_SYNTAX, "a chunk of it ends behind the file's end",
                        "the file is cut short: copy or export it again", err);
        at += length;
    }
    return 0;
}

/* The JSON of either kind of file: of a .glb its first chunk. */
static void find_json(const char *data, size_t size, const char **ret_json, size_t *ret_size)
{
    const bool binary = is_binary(data, size) && size >= GLB_HEAD + CHUNK_HEAD;
    *ret_json = binary ? data + GLB_HEAD + CHUNK_HEAD : data;
    *ret_size = binary ? read_u32(data + GLB_HEAD) : size;
}

/* Colours, textures and lamps, which are passed over anyway. */
static bool is_of_looks(const char *name, size_t length)
{
    static const char *const looks[] = {"KHR_materials_", "KHR_texture_",  "KHR_lights_",
                                        "EXT_texture_",   "MSFT_texture_", "KHR_xmp"};
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++)
        if (length >= strlen(looks[i]) && memcmp(name, looks[i], strlen(looks[i])) == 0)
            return true;
    return false;
}

static int refuse_extension(const char *file, const char *name, size_t length,
                            struct orl_error *err)
{
    char what[200];
    snprintf(what, sizeof what, "the extension '%.*s' is not read",
             (int)(length < 80 ? length : 80), name);
    return fail(file, ORL_ERR_UNSUPPORTED, what,
                "export it without compression, quantization and instancing", err);
}

/* Assimp reads past extensions, also past those without which a file is another shape. */
static int heed_extensions(const char *file, const char *data, size_t size, struct orl_error *err)
{
    static const char required[] = "\"extensionsRequired\"",
                      copies[] = "\"EXT_mesh_gpu_instancing\"";
    const char *json, *at, *end;
    find_json(data, size, &json, &size);
    end = json + size;
    if (memmem(json, size, copies, sizeof copies - 1))
        return refuse_extension(file, copies + 1, sizeof copies - 3, err);
    at = memmem(json, size, required, sizeof required - 1);
    const char *close = at ? memchr(at, ']', (size_t)(end - at)) : NULL;
    at = close ? memchr(at, '[', (size_t)(close - at)) : NULL;
    while (at && (at = memchr(at, '"', (size_t)(close - at)))) {
        const char *name = at + 1, *quote = memchr(name, '"', (size_t)(close - name));
        if (!quote)
            break;
        if (!is_of_looks(name, (size_t)(quote - name)))
            return refuse_extension(file, name, (size_t)(quote - name), err);
        at = quote + 1;
    }
    return 0;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

static struct placement within(const struct placement *outer, const struct aiMatrix4x4 *m)
{
    const double inner[4][4] = {{m->a1, m->a2, m->a3, m->a4},
                                {m->b1, m->b2, m->b3, m->b4},
                                {m->c1, m->c2, m->c3, m->c4},
                                {0, 0, 0, 1}};
    struct placement placed;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            placed.row[i][j] = 0;
            for (int k = 0; k < 4; k++)
                placed.row[i][j] += outer->row[i][k] * inner[k][j];
        }
    return placed;
}

static struct orl_vec3 row_of(const struct placement *p, int i)
{
    return orl_v3(p->row[i][0], p->row[i][1], p->row[i][2]);
}

static struct orl_vec3 place(const struct placement *p, const struct aiVector3D *v)
{
    const struct orl_vec3 at = orl_v3(v->x, v->y, v->z);
    return orl_v3(orl_dot(row_of(p, 0), at) + p->row[0][3],
                  orl_dot(row_of(p, 1), at) + p->row[1][3],
                  orl_dot(row_of(p, 2), at) + p->row[2][3]);
}

/* A mirror turns the order of corners, and not the side that is the front. */
static bool mirrors(const struct placement *p)
{
    return orl_dot(orl_cross(row_of(p, 0), row_of(p, 1)), row_of(p, 2)) < 0;
}

/* By the cofactors, which keep it at right angles; of any length. */
static struct orl_vec3 place_normal(const struct placement *p, const struct aiVector3D *v)
{
    const struct orl_vec3 n = orl_v3(v->x, v->y, v->z), a = row_of(p, 0), b = row_of(p, 1),
                          c = row_of(p, 2);
    const struct orl_vec3 placed = orl_v3(orl_dot(orl_cross(b, c), n), orl_dot(orl_cross(c, a), n),
                                          orl_dot(orl_cross(a, b), n));
    return mirrors(p) ? orl_neg(placed) : placed;
}

static void copy_name(const struct aiString *from, char ret_name[ORL_WAVEFRONT_NAME])
{
    snprintf(ret_name, ORL_WAVEFRONT_NAME, "%.*s", (int)from->length, from->data);
    for (char *c = ret_name; *c; c++)
        *c = is_blank(*c) ? '_' : *c;
}

static void name_material(struct reading *r, const struct aiMesh *mesh)
{
    struct aiString name = {0};
    r->face.material[0] = '\0';
    if (mesh->mMaterialIndex < r->scene->mNumMaterials &&
        aiGetMaterialString(r->scene->mMaterials[mesh->mMaterialIndex], AI_MATKEY_NAME, &name) ==
            aiReturn_SUCCESS)
        copy_name(&name, r->face.material);
}

static int add_triangle(struct reading *r, const struct aiMesh *mesh, const unsigned *indices,
                        const struct placement *p)
{
    struct orl_vec3 corners[3], normals[3];
    const bool turned = mirrors(p);
    for (int k = 0; k < 3; k++) {
        const unsigned i = indices[turned ? 2 - k : k];
        if (i >= mesh->mNumVertices)
            return fail(r->file, ORL_ERR_SYNTAX, "a triangle has a corner that the mesh has not",
                        "the file is damaged: export it again", r->err);
        corners[k] = place(p, &mesh->mVertices[i]);
        if (!isfinite(corners[k].x + corners[k].y + corners[k].z))
            return fail(r->file, ORL_ERR_SYNTAX, "a corner is not finite",
                        "the file is damaged: export it again", r->err);
        if (mesh->mNormals)
            normals[k] = place_normal(p, &mesh->mNormals[i]);
    }
    r->face.corners = corners;
    r->face.normals = mesh->mNormals ? normals : NULL;
    r->face.n_corners = 3;
    r->face.number++;
    r->face.line = (int)(r->face.number % 1000000000);
    return r->sink->add(r->sink->ctx, &r->face, r->err);
}

static int add_mesh(struct reading *r, const struct aiMesh *mesh, const struct placement *p)
{
    int code = 0;
    name_material(r, mesh);
    r->rest->skinned += mesh->mNumBones > 0;
    for (unsigned i = 0; i < mesh->mNumFaces && code == 0; i++) {
        if (mesh->mFaces[i].mNumIndices == 3)
            code = add_triangle(r, mesh, mesh->mFaces[i].mIndices, p);
        else
            r->rest->lines++;
    }
    return code;
}

static int add_node(struct reading *r, const struct aiNode *node, const struct placement *outer,
                    int depth)
{
    const struct placement placed = within(outer, &node->mTransformation);
    int code = 0;
    if (depth > MAX_DEPTH)
        return fail(r->file, ORL_ERR_LIMIT, "nodes are within each other more than 500 deep",
                    "export it with its nodes merged", r->err);
    copy_name(&node->mName, r->face.object);
    for (unsigned i = 0; i < node->mNumMeshes && code == 0; i++)
        code = add_mesh(r, r->scene->mMeshes[node->mMeshes[i]], &placed);
    for (unsigned i = 0; i < node->mNumChildren && code == 0; i++)
        code = add_node(r, node->mChildren[i], &placed, depth + 1);
    return code;
}

/* ---- Files ----------------------------------------------------------------------------------- */

/* One at a time: Assimp keeps what went wrong last in one place. */
static const struct aiScene *import(struct orl_gltf_files *files, char ret_fault[160])
{
    static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
    struct aiFileIO io = orl_gltf_file_io(files);
    pthread_mutex_lock(&mutex);
    const struct aiScene *scene = aiImportFileEx(files->name, 0, &io);
    snprintf(ret_fault, 160, "%s", scene ? "" : aiGetErrorString());
    pthread_mutex_unlock(&mutex);
    return scene;
}

static int refuse(const struct orl_gltf_files *files, const char *file, const char *fault,
                  struct orl_error *err)
{
    char what[200];
    if (files->code) {
        *err = files->err;
        orl_error_at(err, file, 0, NULL);
        return files->code;
    }
    if (strstr(fault, "bad_alloc") || strstr(fault, "bad allocation"))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    const bool odd = strstr(fault, "No suitable reader") != NULL; /* Assimp's reader knows it not */
    snprintf(what, sizeof what, "this is no glTF 2.0 that can be read: %s",
             odd        ? "its head, its chunks or its JSON are not as they must be"
             : fault[0] ? fault
                        : "it has no scene");
    return fail(file, ORL_ERR_SYNTAX, what, "export it again as glTF 2.0, .glb for one file", err);
}

int orl_gltf_read(const char *file, const char *data, size_t size,
                  const struct orl_gltf_buffers *buffers, const struct orl_wavefront_sink *sink,
                  struct orl_gltf_rest *ret_rest, struct orl_error *err)
{
    /* Radiance's z is up, glTF's y. */
    static const struct placement upright = {{{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}}};
    struct orl_gltf_files files = {.name = is_binary(data, size) ? "scene.glb" : "scene.gltf",
                                   .file = {data, size, NULL},
                                   .buffers = buffers};
    char fault[160];
    struct reading *r = calloc(1, sizeof *r);
    *ret_rest = (struct orl_gltf_rest){0};
    if (!r)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a glTF file");
    int code = is_binary(data, size) ? heed_chunks(file, data, size, err) : 0;
    if (code == 0)
        code = heed_extensions(file, data, size, err);
    const struct aiScene *scene = code == 0 ? import(&files, fault) : NULL;
    if (code == 0 && (!scene || files.code))
        code = refuse(&files, file, fault, err);
    *r = (struct reading){.file = file, .scene = scene, .sink = sink, .rest = ret_rest, .err = err};
    if (code == 0 && scene->mRootNode)
        code = add_node(r, scene->mRootNode, &upright, 0);
    ret_rest->empty = r->face.number == 0;
    if (scene)
        aiReleaseImport(scene);
    free(r);
    return code;
}
