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

/* ---- Buffer views ---------------------------------------------------------------------------- */

/* Returns true if count values from the offset on fit into length. */
static bool fits(size_t length, size_t offset, size_t stride, size_t element, size_t count)
{
    return offset <= length && element <= length - offset &&
           count - 1 <= (length - offset - element) / stride;
}

/* Returns the data of the buffer view that the item names, or NULL after an error; count values
 * start at the item's offset. *stride is unchanged if the view has none; stride may be NULL. */
static const unsigned char *find_values(const struct orl_gltf_item *at, size_t element,
                                        size_t count, size_t *stride)
{
    const size_t index = orl_gltf_integer(at, "bufferView", SIZE_MAX);
    const struct orl_gltf_item view = orl_gltf_find(at, "bufferViews", index);
    const size_t offset = orl_gltf_integer(at, "byteOffset", 0);
    const size_t of = orl_gltf_integer(&view, "buffer", SIZE_MAX);
    const size_t begin = orl_gltf_integer(&view, "byteOffset", 0);
    const size_t length = orl_gltf_integer(&view, "byteLength", 0);
    const size_t step = stride ? orl_gltf_integer(&view, "byteStride", element) : element;
    const struct orl_gltf_bytes buffer = orl_gltf_buffer(&view, of);
    if (begin > buffer.size || length > buffer.size - begin)
        orl_gltf_fail(&view, ORL_ERR_SYNTAX, "it extends beyond its buffer's end");
    else if (step < element)
        orl_gltf_fail(&view, ORL_ERR_SYNTAX, "its 'byteStride' is less than the size of a value");
    else if (!fits(length, offset, step, element, count))
        orl_gltf_fail(at, ORL_ERR_SYNTAX, "it extends beyond the end of its bufferViews[%zu]",
                      index);
    if (stride)
        *stride = step;
    return at->file->code ? NULL : buffer.data + begin + offset;
}

/* ---- Sparse values --------------------------------------------------------------------------- */

/* Checks that the sparse indices rise, because they are searched by bisection. */
static void check_sparse_indices(const struct orl_gltf_accessor *a,
                                 const struct orl_gltf_item *sparse)
{
    const size_t size = size_of(a->sparse_component);
    size_t least = 0;
    for (size_t i = 0; i < a->n_sparse && !sparse->file->code; i++) {
        const size_t place = read_whole(a->sparse_component, a->sparse_indices + size * i);
        if (place < least || place >= a->count)
            orl_gltf_fail(sparse, ORL_ERR_SYNTAX,
                          "its indices do not increase, or exceed the accessor's count");
        least = place + 1;
    }
}

static void open_sparse(const struct orl_gltf_item *sparse, struct orl_gltf_accessor *a)
{
    const size_t n = orl_gltf_integer(sparse, "count", 0);
    const struct orl_gltf_item indices = orl_gltf_member(sparse, "indices");
    const struct orl_gltf_item values = orl_gltf_member(sparse, "values");
    a->n_sparse = n;
    a->sparse_component = orl_gltf_integer(&indices, "componentType", 0);
    if (n < 1 || n > a->count || most_of(a->sparse_component) == 0) {
        orl_gltf_fail(
            sparse, ORL_ERR_SYNTAX,
            "its 'count' is missing or exceeds the accessor's, or its indices are not integers");
        return;
    }
    a->sparse_indices = find_values(&indices, size_of(a->sparse_component), n, NULL);
    a->values = find_values(&values, a->n_components * size_of(a->component), n, NULL);
    orl_gltf_step(sparse, n);
    check_sparse_indices(a, sparse);
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

static void open_values(struct orl_gltf_accessor *a)
{
    const size_t element = a->n_components * size_of(a->component);
    if (element == 0 || a->count < 1 || (a->normalized && size_of(a->component) == 4)) {
        orl_gltf_fail(
            &a->item, ORL_ERR_SYNTAX,
            "its 'componentType' or 'count' is invalid, or the type cannot be 'normalized'");
        return;
    }
    a->stride = element;
    if (json_object_get(a->item.object, "bufferView"))
        a->data = find_values(&a->item, element, a->count, &a->stride);
    const struct orl_gltf_item sparse = orl_gltf_member(&a->item, "sparse");
    if (sparse.object)
        open_sparse(&sparse, a);
}

struct orl_gltf_accessor orl_gltf_accessor_open(const struct orl_gltf_item *at, size_t index,
                                                const char *type)
{
    struct orl_gltf_accessor a = {.item = orl_gltf_find(at, "accessors", index)};
    const char *const own = orl_gltf_text(&a.item, "type");
    a.n_components = strcmp(type, "SCALAR") == 0 ? 1 : (size_t)(type[3] - '0');
    if (!own || strcmp(own, type) != 0)
        orl_gltf_fail(&a.item, ORL_ERR_SYNTAX, "its 'type' is %.20s; %s uses it as %s",
                      own ? own : "none", at->name, type);
    a.normalized = json_is_true(json_object_get(a.item.object, "normalized"));
    a.component = orl_gltf_integer(&a.item, "componentType", 0);
    a.count = orl_gltf_integer(&a.item, "count", 0);
    open_values(&a);
    return a;
}

void orl_gltf_accessor_value(const struct orl_gltf_accessor *accessor, size_t i,
                             double ret_value[4])
{
    const unsigned char *const at = find_value(accessor, i);
    for (size_t k = 0; k < accessor->n_components; k++) {
        const double number =
            at ? read_number(accessor->component, at + k * size_of(accessor->component)) : 0;
        if (!isfinite(number))
            orl_gltf_fail(&accessor->item, ORL_ERR_RANGE, "its value %zu is not finite", i);
        ret_value[k] = accessor->normalized ? normalize(accessor->component, number) : number;
    }
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
