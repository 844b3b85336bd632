#include "function/codegen/compiler.h"

#include <math.h>
#include <stdlib.h>

#include "base/memory/array.h"

/* Dependency between two bodies, by slots. */
struct use {
    uint32_t used, user;
};

struct survey {
    struct orl_compiler *c;
    struct use *uses;
    size_t n_uses, uses_room;
    uint32_t user;
};

/* Gives the body a slot, if it has none. */
static int assign_slot(struct orl_compiler *c, struct orl_formula *body)
{
    if (body->compilation == c->number)
        return 0;
    if (!orl_array_reserve(&c->bodies, &c->bodies_room, c->n_bodies, sizeof(struct orl_formula *)))
        return orl_compiler_no_memory(c);
    body->compilation = c->number;
    body->slot = (uint32_t)c->n_bodies;
    body->open = false;
    c->bodies[c->n_bodies++] = body;
    return 0;
}

static bool is_fixed(const struct orl_compiler *c, uint32_t input)
{
    return c->request->fixed && !isnan(c->request->fixed[input]);
}

/* Records the bodies that a tree uses, and marks the user as open if it reads an input. */
static int visit_term(struct survey *s, struct orl_term *node)
{
    struct orl_compiler *const c = s->c;
    int code = 0;
    if (++c->functions->work > ORL_FUNCTION_WORK)
        return orl_error_set(c->err, ORL_ERR_LIMIT,
                             "all functions together are too large to be compiled");
    if (node->kind == ORL_NODE_INPUT && !is_fixed(c, node->index))
        c->bodies[s->user]->open = true;
    else if (node->kind == ORL_NODE_INPUT)
        c->fixed_inputs |= UINT64_C(1) << node->index;
    if (node->kind == ORL_NODE_NAME || node->kind == ORL_NODE_CALL) {
        struct orl_formula *const body = orl_body_of(node);
        if (body) {
            code = assign_slot(c, body);
            if (code == 0 &&
                !orl_array_reserve(&s->uses, &s->uses_room, s->n_uses, sizeof *s->uses))
                code = orl_compiler_no_memory(c);
            if (code == 0)
                s->uses[s->n_uses++] = (struct use){body->slot, s->user};
        }
    }
    for (uint32_t i = 0; code == 0 && i < node->n_args; i++)
        code = visit_term(s, node->args[i]);
    return code;
}

static int compare_uses(const void *a, const void *b)
{
    const struct use *const left = a, *const right = b;
    if (left->used != right->used)
        return left->used < right->used ? -1 : 1;
    return left->user < right->user ? -1 : left->user > right->user;
}

/* Propagates openness: bodies that use an open body are open. */
static int propagate_open(struct survey *s)
{
    struct orl_compiler *const c = s->c;
    const size_t n = c->n_bodies;
    size_t *const first = calloc(n + 1, sizeof *first);
    uint32_t *const open = malloc((n + 1) * sizeof *open);
    size_t n_open = 0, at = 0;
    if (!first || !open) {
        free(first);
        free(open);
        return orl_compiler_no_memory(c);
    }
    if (s->n_uses)
        qsort(s->uses, s->n_uses, sizeof *s->uses, compare_uses);
    for (size_t i = 0; i <= n; i++) {
        while (at < s->n_uses && s->uses[at].used < i)
            at++;
        first[i] = at;
    }
    for (uint32_t i = 0; i < n; i++)
        if (c->bodies[i]->open)
            open[n_open++] = i;
    while (n_open > 0) {
        const uint32_t one = open[--n_open];
        for (size_t i = first[one]; i < first[one + 1]; i++) {
            struct orl_formula *const user = c->bodies[s->uses[i].user];
            if (!user->open)
                open[n_open++] = user->slot;
            user->open = true;
        }
    }
    free(first);
    free(open);
    return 0;
}

/* Sets the constant flag of each node of a tree. */
static bool mark_constants(const struct orl_compiler *c, struct orl_term *node)
{
    bool constant = true;
    for (uint32_t i = 0; i < node->n_args; i++)
        constant &= mark_constants(c, node->args[i]);
    if (node->kind == ORL_NODE_PARAMETER || node->kind == ORL_NODE_CALL_PARAMETER)
        constant = false;
    if (node->kind == ORL_NODE_INPUT)
        constant = is_fixed(c, node->index);
    if (node->kind == ORL_NODE_NAME || node->kind == ORL_NODE_CALL) {
        const struct orl_formula *const body = orl_body_of(node);
        constant = constant && !(body && body->open);
    }
    return node->constant = constant;
}

int orl_compiler_analyse(struct orl_compiler *c)
{
    struct survey s = {.c = c};
    int code = 0;
    for (; code == 0 && s.user < c->n_bodies; s.user++)
        code = visit_term(&s, c->bodies[s.user]->root);
    if (code == 0)
        code = propagate_open(&s);
    for (size_t i = 0; code == 0 && i < c->n_bodies; i++)
        mark_constants(c, c->bodies[i]->root);
    free(s.uses);
    return code;
}
