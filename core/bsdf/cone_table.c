#include "bsdf/loaded_bsdf.h"

#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "bsdf/bsdf_internal.h"

enum { MOST_CELLS = 16, RINGS = 4, SPOKES = 32 };

/* Slot of the alias table: a leaf, and the leaf that has the rest. All slots are equally likely. */
struct slot {
    float own; /* the leaf's share of the slot */
    uint32_t other;
    uint16_t x, y; /* the leaf's cell on the square halved `level` times */
    uint32_t level;
};

struct cell {
    size_t place; /* orl_square_cell of the direction in */
    double weight;
    struct slot *slots;
    uint32_t count; /* 0: nothing is transmitted */
};

struct orl_cone_table {
    const struct orl_bsdf *bsdf;
    const struct orl_tree *tree;
    enum orl_tree_axis given;
    bool front;
    struct orl_vec3 axis; /* axis of the cone */
    double sole_cosine;   /* least cosine to the axis that implies cells[0]; 2: none */
    size_t n_cells;
    struct cell cells[MOST_CELLS];
};

/* ---- Making ---------------------------------------------------------------------------------- */

/* Leaves found so far, and value times size of each. */
struct list {
    const struct orl_tree *tree;
    enum orl_tree_axis given;
    unsigned x, y; /* cell of the direction in, in the finest cells */
    struct slot *slots;
    double *weights;
    uint32_t count;
};

static void list_leaves(struct list *list, struct orl_tree_ref ref, unsigned level, unsigned x,
                        unsigned y)
{
    const unsigned own = list->given == ORL_AXIS_A ? 0 : 2;
    if (orl_tree_is_leaf(ref)) {
        const double value = (double)orl_tree_leaf_value(ref);
        if (value > 0) {
            list->weights[list->count] = value / (double)((size_t)1 << 2 * level);
            list->slots[list->count] =
                (struct slot){1, list->count, (uint16_t)x, (uint16_t)y, level};
            list->count++;
        }
        return;
    }
    const unsigned shift = list->tree->depth - level - 1;
    const unsigned mine = ((list->x >> shift & 1) | (list->y >> shift & 1) << 1) << own;
    for (unsigned k = 0; k < 4; k++)
        list_leaves(list, orl_tree_child(list->tree, ref, mine | k << (2 - own)), level + 1,
                    x << 1 | (k & 1), y << 1 | k >> 1);
}

/* Fills the slots of leaves below the mean from leaves above it. order: scratch for one number per
 * leaf. */
static void share_slots(struct list *list, uint32_t *order)
{
    double *weights = list->weights, sum = 0;
    uint32_t small = 0, large = list->count; /* end of the small ones; begin of the large ones */
    for (uint32_t i = 0; i < list->count; i++)
        sum += weights[i];
    for (uint32_t i = 0; i < list->count; i++) {
        weights[i] *= list->count / sum;
        order[weights[i] < 1 ? small++ : --large] = i;
    }
    for (uint32_t next = 0; next < small && large < list->count; next++) {
        const uint32_t giver = order[large];
        struct slot *slot = &list->slots[order[next]];
        slot->own = (float)weights[order[next]];
        slot->other = giver;
        weights[giver] -= 1 - (double)slot->own;
        if (weights[giver] < 1) {
            order[small++] = giver;
            large++;
        }
    }
}

static int make_cell(const struct orl_cone_table *cone_table, size_t place, struct cell *ret_cell)
{
    const struct orl_tree *tree = cone_table->tree;
    const size_t most = (size_t)1 << 2 * tree->depth, side = (size_t)1 << tree->depth;
    const double sign = cone_table->given == ORL_AXIS_A ? -1 : 1; /* A: direction of travel */
    struct list list = {.tree = tree,
                        .given = cone_table->given,
                        .x = (unsigned)(place >> tree->depth),
                        .y = (unsigned)(place & (side - 1)),
                        .slots = malloc(most * sizeof *list.slots),
                        .weights = malloc(most * sizeof *list.weights)};
    uint32_t *order = malloc(most * sizeof *order);
    int code = ORL_ERR_NOMEM;
    if (list.slots && list.weights && order) {
        struct orl_vec3 middle = orl_square_to_hemisphere(
            (struct orl_square){sign * ((2 * list.x + 1) / (double)side - 1),
                                sign * ((2 * list.y + 1) / (double)side - 1)});
        middle.z = cone_table->front ? middle.z : -middle.z;
        list_leaves(&list, tree->root, 0, 0, 0);
        share_slots(&list, order);
        *ret_cell =
            (struct cell){place, orl_bsdf_albedo(cone_table->bsdf, middle, ORL_BSDF_TRANSMIT).g,
                          list.slots, list.count};
        list.slots = NULL;
        code = 0;
    }
    free(list.slots);
    free(list.weights);
    free(order);
    return code;
}

static bool has_cell(const struct orl_cone_table *cone_table, size_t place)
{
    for (size_t i = 0; i < cone_table->n_cells; i++)
        if (cone_table->cells[i].place == place)
            return true;
    return false;
}

static size_t place_of(const struct orl_cone_table *cone_table, struct orl_vec3 in)
{
    return orl_square_cell(cone_table->given, orl_disk_to_square(in.x, in.y),
                           cone_table->tree->depth);
}

/*
 * Makes a table for each cell that contains one of a set of directions over the cone and slightly
 * beyond it. If these are all in one cell, so is the whole cone.
 */
static int make_cells(struct orl_cone_table *cone_table, struct orl_vec3 in, double half_angle_rad)
{
    const struct orl_frame frame = orl_frame_about(in);
    const double rim = tan(1.02 * half_angle_rad);
    bool alone = true;
    int code = 0;
    for (int i = 0; i < RINGS * SPOKES && code == 0; i++) {
        const struct orl_sincos turn = orl_sincos_turn((double)(i % SPOKES) / SPOKES);
        const int ring = i / SPOKES;
        const double radius = rim * ring / (RINGS - 1);
        const struct orl_vec3 at = orl_normalize(
            orl_to_world(&frame, orl_v3(radius * turn.cosine, radius * turn.sine, 1)));
        const size_t place = place_of(cone_table, at);
        alone = alone && (at.z > 0) == cone_table->front;
        if ((at.z > 0) != cone_table->front || has_cell(cone_table, place) ||
            cone_table->n_cells == MOST_CELLS)
            continue;
        code = make_cell(cone_table, place, &cone_table->cells[cone_table->n_cells]);
        cone_table->n_cells += code == 0;
    }
    cone_table->axis = in;
    cone_table->sole_cosine =
        alone && cone_table->n_cells == 1 && half_angle_rad < 0.1 ? cos(1.01 * half_angle_rad) : 2;
    return code;
}

int orl_cone_table_new(const struct orl_bsdf *bsdf, struct orl_vec3 in, double half_angle_rad,
                       struct orl_cone_table **ret_table)
{
    const bool front = in.z > 0;
    const struct orl_component_view *view = &bsdf->views[front][1], *other = &bsdf->views[front][0];
    *ret_table = NULL;
    if (bsdf->document.structure != ORL_STRUCTURE_TREE4 || !view->component ||
        view->component->chroma.present)
        return 0;
    /* A cell has one weight, so reflection must have no finer cells. */
    if (other->component && (other->component->chroma.present ||
                             other->component->tree.depth > view->component->tree.depth))
        return 0;
    struct orl_cone_table *cone_table = calloc(1, sizeof *cone_table);
    if (!cone_table)
        return ORL_ERR_NOMEM;
    cone_table->bsdf = bsdf;
    cone_table->tree = &view->component->tree;
    cone_table->given = orl_view_axis(view, ORL_ROLE_IN);
    cone_table->front = front;
    if (make_cells(cone_table, in, half_angle_rad) < 0) {
        orl_cone_table_free(cone_table);
        return ORL_ERR_NOMEM;
    }
    *ret_table = cone_table;
    return 0;
}

void orl_cone_table_free(struct orl_cone_table *cone_table)
{
    for (size_t i = 0; cone_table && i < cone_table->n_cells; i++)
        free(cone_table->cells[i].slots);
    free(cone_table);
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static const struct slot *draw_slot(const struct cell *cell, double u, double *ret_rest)
{
    const double at = u * cell->count;
    const uint32_t i = at < cell->count ? (uint32_t)at : cell->count - 1;
    const struct slot *slot = &cell->slots[i];
    const double own = (double)slot->own, within = at - i;
    if (within < own) {
        *ret_rest = within / own;
        return slot;
    }
    *ret_rest = own < 1 ? (within - own) / (1 - own) : 0;
    return &cell->slots[slot->other];
}

static const struct cell *cell_of(const struct orl_cone_table *cone_table, struct orl_vec3 in)
{
    if (orl_dot(in, cone_table->axis) >= cone_table->sole_cosine)
        return &cone_table->cells[0];
    const size_t place = place_of(cone_table, in);
    for (size_t i = 0; i < cone_table->n_cells && (in.z > 0) == cone_table->front; i++)
        if (cone_table->cells[i].place == place)
            return &cone_table->cells[i];
    return NULL;
}

bool orl_cone_table_sample(const struct orl_cone_table *cone_table, struct orl_vec3 in,
                           const double u[3], struct orl_vec3 *ret_out, struct orl_rgb *ret_weight)
{
    const struct cell *cell = cell_of(cone_table, in);
    double rest, pdf;
    if (!cell)
        return orl_bsdf_sample(cone_table->bsdf, in, ORL_BSDF_TRANSMIT, u, ret_out, ret_weight,
                               &pdf);
    if (cell->count == 0)
        return false;
    const struct slot *slot = draw_slot(cell, u[0], &rest);
    *ret_out = orl_square_cell_direction(cone_table->given == ORL_AXIS_A ? ORL_AXIS_B : ORL_AXIS_A,
                                         slot->x, slot->y, slot->level, rest < 1 ? rest : 0, u[1]);
    ret_out->z = cone_table->front ? -ret_out->z : ret_out->z;
    *ret_weight = orl_gray(cell->weight);
    return true;
}
