#include "scene/parse/gltf/gltf_file.h"

#include <math.h>
#include <string.h>

/* ---- Numbers --------------------------------------------------------------------------------- */

/* Returns the size of a component type in bytes; 0: unknown type. */
static size_t size_of(size_t component)
{
    return component == ORL_GLTF_I8 || component == ORL_GLTF_U8     ? 1
           : component == ORL_GLTF_I16 || component == ORL_GLTF_U16 ? 2
           : component == ORL_GLTF_U32 || component == ORL_GLTF_F32 ? 4
                                                                    : 0;
}

static size_t most_of(size_t component)
{
    return component == ORL_GLTF_U8    ? UINT8_MAX
           : component == ORL_GLTF_U16 ? UINT16_MAX
           : component == ORL_GLTF_U32 ? UINT32_MAX
                                       : 0;
}

static size_t read_whole(size_t component, const unsigned char *at)
{
    size_t value = 0;
    for (size_t i = size_of(component); i-- > 0;)
        value = value << 8 | at[i];
    return value;
}

static double read_number(size_t component, const unsigned char *at)
{
    const size_t bits = read_whole(component, at);
    const uint32_t single = (uint32_t)bits;
    float value;
    if (component == ORL_GLTF_I8)
        return bits < 0x80 ? (double)bits : (double)bits - 0x100;
    if (component == ORL_GLTF_I16)
        return bits < 0x8000 ? (double)bits : (double)bits - 0x10000;
    if (component != ORL_GLTF_F32)
        return (double)bits;
    memcpy(&value, &single, sizeof value);
    return (double)value;
}

static double normalize(size_t component, double value)
{
    const double most = component == ORL_GLTF_I8    ? INT8_MAX
                        : component == ORL_GLTF_I16 ? INT16_MAX
                                                    : (double)most_of(component);
    return fmax(value / most, -1);
}

/* ---- Buffer views
 * ----------------------------------------------------------------------------- */

/* Returns true if count values from the offset on fit into length. */
static bool fits(size_t length, size_t offset, size_t stride, size_t element, size_t count)
{
    return offset <= length && element <= length - offset &&
           count - 1 <= (length - offset - element) / stride;
}

/* Finds the data of the buffer view that the item names; count values start at the item's offset.
 * *stride is unchanged if the view has none; stride may be NULL. */
static int find_values(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t element,
                       size_t count, size_t *stride, const unsigned char **ret_data,
                       struct orl_error *err)
{
    struct orl_gltf_item view;
    struct orl_gltf_bytes buffer = {NULL, 0};
    size_t index = SIZE_MAX, of = SIZE_MAX, begin = 0, length = 0, offset = 0, step = element;
    int code = orl_gltf_integer(at, "bufferView", &index, err);
    if (code == 0)
        code = orl_gltf_find(at, "bufferViews", index, &view, err);
    if (code == 0)
        code = orl_gltf_integer(at, "byteOffset", &offset, err);
    if (code == 0)
        code = orl_gltf_integer(&view, "buffer", &of, err);
    if (code == 0)
        code = orl_gltf_integer(&view, "byteOffset", &begin, err);
    if (code == 0)
        code = orl_gltf_integer(&view, "byteLength", &length, err);
    if (code == 0 && stride)
        code = orl_gltf_integer(&view, "byteStride", &step, err);
    if (code == 0)
        code = orl_gltf_file_buffer(file, &view, of, &buffer, err);
    if (code)
        return code;
    if (begin > buffer.size || length > buffer.size - begin)
        return orl_gltf_fail(&view, ORL_ERR_SYNTAX, err, "it extends beyond its buffer's end");
    if (step < element)
        return orl_gltf_fail(&view, ORL_ERR_SYNTAX, err,
                             "its 'byteStride' is less than the size of a value");
    if (!fits(length, offset, step, element, count))
        return orl_gltf_fail(at, ORL_ERR_SYNTAX, err,
                             "it extends beyond the end of its bufferViews[%zu]", index);
    if (stride)
        *stride = step;
    *ret_data = buffer.data + begin + offset;
    return 0;
}

/* ---- Sparse values
 * ---------------------------------------------------------------------------- */

/* Checks that the sparse indices rise, because they are searched by bisection. */
static int check_sparse_indices(const struct orl_gltf_accessor *a,
                                const struct orl_gltf_item *sparse, struct orl_error *err)
{
    const size_t size = size_of(a->sparse_component);
    size_t least = 0;
    for (size_t i = 0; i < a->n_sparse; i++) {
        const size_t place = read_whole(a->sparse_component, a->sparse_indices + size * i);
        if (place < least || place >= a->count)
            return orl_gltf_fail(sparse, ORL_ERR_SYNTAX, err,
                                 "its indices do not increase, or exceed the accessor's count");
        least = place + 1;
    }
    return 0;
}

static int open_sparse(struct orl_gltf_file *file, const struct orl_gltf_item *sparse,
                       struct orl_gltf_accessor *a, struct orl_error *err)
{
    struct orl_gltf_item indices, values;
    int code = orl_gltf_integer(sparse, "count", &a->n_sparse, err);
    if (code == 0)
        code = orl_gltf_member(sparse, "indices", &indices, err);
    if (code == 0)
        code = orl_gltf_member(sparse, "values", &values, err);
    if (code == 0)
        code = orl_gltf_integer(&indices, "componentType", &a->sparse_component, err);
    if (code)
        return code;
    if (a->n_sparse < 1 || a->n_sparse > a->count || most_of(a->sparse_component) == 0)
        return orl_gltf_fail(
            sparse, ORL_ERR_SYNTAX, err,
            "its 'count' is missing or exceeds the accessor's, or its indices are not integers");
    code = find_values(file, &indices, size_of(a->sparse_component), a->n_sparse, NULL,
                       &a->sparse_indices, err);
    if (code == 0)
        code = find_values(file, &values, a->n_components * size_of(a->component), a->n_sparse,
                           NULL, &a->values, err);
    if (code == 0)
        code = orl_gltf_file_step(file, sparse, a->n_sparse, err);
    return code ? code : check_sparse_indices(a, sparse, err);
}

/* Returns the first component of a value; NULL: 0. */
static const unsigned char *find_value(const struct orl_gltf_accessor *a, size_t i)
{
    const size_t size = size_of(a->sparse_component);
    size_t low = 0, high = a->n_sparse;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        const size_t place = read_whole(a->sparse_component, a->sparse_indices + size * middle);
        if (place == i)
            return a->values + a->n_components * size_of(a->component) * middle;
        if (place < i)
            low = middle + 1;
        else
            high = middle;
    }
    return a->data ? a->data + a->stride * i : NULL;
}

/* ---- Accessors ------------------------------------------------------------------------------- */

static int open_values(struct orl_gltf_file *file, struct orl_gltf_accessor *a,
                       struct orl_error *err)
{
    const size_t element = a->n_components * size_of(a->component);
    struct orl_gltf_item sparse;
    int code = 0;
    if (element == 0 || a->count < 1 || (a->normalized && size_of(a->component) == 4))
        return orl_gltf_fail(
            &a->item, ORL_ERR_SYNTAX, err,
            "its 'componentType' or 'count' is invalid, or the type cannot be 'normalized'");
    a->stride = element;
    if (json_object_get(a->item.object, "bufferView"))
        code = find_values(file, &a->item, element, a->count, &a->stride, &a->data, err);
    if (code == 0)
        code = orl_gltf_member(&a->item, "sparse", &sparse, err);
    return code == 0 && sparse.object ? open_sparse(file, &sparse, a, err) : code;
}

int orl_gltf_accessor_open(struct orl_gltf_file *file, const struct orl_gltf_item *at, size_t index,
                           const char *type, struct orl_gltf_accessor *ret_accessor,
                           struct orl_error *err)
{
    struct orl_gltf_accessor a = {.n_components =
                                      strcmp(type, "SCALAR") == 0 ? 1 : (size_t)(type[3] - '0')};
    int code = orl_gltf_find(at, "accessors", index, &a.item, err);
    if (code)
        return code;
    const char *const own = orl_gltf_text(&a.item, "type");
    if (!own || strcmp(own, type) != 0)
        return orl_gltf_fail(&a.item, ORL_ERR_SYNTAX, err, "its 'type' is %.20s; %s uses it as %s",
                             own ? own : "none", at->name, type);
    a.normalized = json_is_true(json_object_get(a.item.object, "normalized"));
    code = orl_gltf_integer(&a.item, "componentType", &a.component, err);
    if (code == 0)
        code = orl_gltf_integer(&a.item, "count", &a.count, err);
    if (code == 0)
        code = open_values(file, &a, err);
    if (code == 0)
        *ret_accessor = a;
    return code;
}

int orl_gltf_accessor_value(const struct orl_gltf_accessor *accessor, size_t i, double ret_value[4],
                            struct orl_error *err)
{
    const unsigned char *const at = find_value(accessor, i);
    for (size_t k = 0; k < accessor->n_components; k++) {
        const double number =
            at ? read_number(accessor->component, at + k * size_of(accessor->component)) : 0;
        if (!isfinite(number))
            return orl_gltf_fail(&accessor->item, ORL_ERR_RANGE, err, "its value %zu is not finite",
                                 i);
        ret_value[k] = accessor->normalized ? normalize(accessor->component, number) : number;
    }
    return 0;
}

size_t orl_gltf_accessor_integer(const struct orl_gltf_accessor *accessor, size_t i)
{
    const unsigned char *const at = find_value(accessor, i);
    return at ? read_whole(accessor->component, at) : 0;
}

size_t orl_gltf_accessor_max(const struct orl_gltf_accessor *accessor)
{
    return most_of(accessor->component);
}
