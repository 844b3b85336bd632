#include "function/language/definitions.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/* Parser state for one text. */
struct parser {
    struct orl_functions *functions;
    struct orl_function_lexer lexer;
    int context;
    const char *file; /* copy owned by the set */
    /* State of the function being defined. */
    const char *parameters[ORL_FUNCTION_PARAMETERS];
    uint32_t n_parameters;
    uint64_t called;
    unsigned nesting;
    struct orl_error *err;
};

static int no_memory(const struct parser *p)
{
    return orl_error_set(p->err, ORL_ERR_NOMEM, "out of memory for definitions");
}

static bool is_sign(const struct parser *p, char sign)
{
    return p->lexer.kind == ORL_FUNCTION_TOKEN_SIGN && p->lexer.word[0] == sign;
}

static int next_word(struct parser *p)
{
    return orl_function_lexer_next(&p->lexer, p->err);
}

static int expect_sign(struct parser *p, char sign, const char *what)
{
    return is_sign(p, sign) ? next_word(p) : orl_function_lexer_expected(&p->lexer, what, p->err);
}

static struct orl_term *make_term(struct parser *p, enum orl_node_kind kind)
{
    struct orl_term *const node = orl_arena_alloc(p->functions->arena, sizeof *node);
    if (!node)
        return NULL;
    memset(node, 0, sizeof *node);
    node->kind = (uint8_t)kind;
    node->line = p->lexer.line;
    return node;
}

/* ---- Lists of nodes of unknown length -------------------------------------------------------- */

struct list {
    struct orl_term **nodes;
    char *operators; /* operator before each node */
    size_t n, room, operators_room;
};

static bool append_term(struct list *list, struct orl_term *node, char joint)
{
    if (!orl_array_reserve(&list->nodes, &list->room, list->n, sizeof(struct orl_term *)) ||
        !orl_array_reserve(&list->operators, &list->operators_room, list->n, 1))
        return false;
    list->nodes[list->n] = node;
    list->operators[list->n++] = joint;
    return true;
}

/* Moves the list into the node. */
static int store_list(struct parser *p, struct list *list, struct orl_term *node)
{
    node->n_args = (uint32_t)list->n;
    node->args = orl_arena_alloc(p->functions->arena, list->n * sizeof(struct orl_term *));
    if (!node->args)
        return no_memory(p);
    memcpy(node->args, list->nodes, list->n * sizeof(struct orl_term *));
    if (node->kind != ORL_NODE_CHAIN)
        return 0;
    node->operators = orl_arena_copy_text(p->functions->arena, list->operators, list->n);
    return node->operators ? 0 : no_memory(p);
}

static void free_list(struct list *list)
{
    free(list->nodes);
    free(list->operators);
}

/* ---- Expressions ----------------------------------------------------------------------------- */

static int read_sum(struct parser *p, struct orl_term **ret_node);

static int enter_level(struct parser *p)
{
    if (++p->nesting <= ORL_FUNCTION_NESTING)
        return 0;
    orl_error_set(p->err, ORL_ERR_LIMIT, "an expression is nested deeper than %d levels",
                  ORL_FUNCTION_NESTING);
    orl_error_at(p->err, p->file[0] ? p->file : NULL, p->lexer.line, NULL);
    orl_error_hint(p->err, "define its parts under separate names");
    return ORL_ERR_LIMIT;
}

/* Reads operands that any of two signs joins. The caller frees the list, also after an error. */
static int read_operands(struct parser *p, const char *signs,
                         int (*read)(struct parser *, struct orl_term **), struct list *list)
{
    char joint = signs[0];
    for (;;) {
        struct orl_term *one = NULL;
        int code = read(p, &one);
        if (code == 0 && !append_term(list, one, joint))
            code = no_memory(p);
        if (code < 0 || !(is_sign(p, signs[0]) || is_sign(p, signs[1])))
            return code;
        joint = p->lexer.word[0];
        code = next_word(p);
        if (code < 0)
            return code;
    }
}

/* Reads "A, B, C)", including the parenthesis. */
static int read_list(struct parser *p, struct orl_term *call)
{
    struct list list = {0};
    int code = read_operands(p, ",,", read_sum, &list);
    if (code == 0)
        code = expect_sign(p, ')', "')'");
    if (code == 0)
        code = store_list(p, &list, call);
    free_list(&list);
    return code;
}

/* Returns true if the name is a parameter of the function being defined. */
static bool find_parameter(const struct parser *p, const char *name, size_t length,
                           uint32_t *ret_index)
{
    for (uint32_t i = 0; i < p->n_parameters; i++)
        if (orl_name_is(p->parameters[i], name, length)) {
            *ret_index = i;
            return true;
        }
    return false;
}

static int read_name(struct parser *p, struct orl_term **ret_node)
{
    const char *const name = p->lexer.word;
    const size_t length = p->lexer.word_length;
    struct orl_term *const node = make_term(p, ORL_NODE_NAME);
    struct orl_resolved_name resolved;
    uint32_t index = 0;
    if (!node)
        return no_memory(p);
    int code = next_word(p);
    if (code < 0)
        return code;
    const bool called = is_sign(p, '(');
    if (find_parameter(p, name, length, &index)) {
        node->kind = called ? ORL_NODE_CALL_PARAMETER : ORL_NODE_PARAMETER;
        node->index = index;
        if (called)
            p->called |= UINT64_C(1) << index;
    } else {
        code = orl_definitions_resolve(p->functions, p->context, name, length, called, &resolved,
                                       p->err);
        if (code < 0)
            return code;
        node->kind = (uint8_t)(called ? ORL_NODE_CALL : resolved.kind);
        if (resolved.kind == ORL_NODE_INPUT)
            node->index = resolved.input;
        else
            node->definition = resolved.definition;
    }
    *ret_node = node;
    if (!called)
        return 0;
    code = next_word(p);
    return code < 0 ? code : read_list(p, node);
}

static int read_number(struct parser *p, struct orl_term **ret_node)
{
    struct orl_term *const node = make_term(p, ORL_NODE_NUMBER);
    if (!node)
        return no_memory(p);
    node->number = p->lexer.number;
    *ret_node = node;
    return next_word(p);
}

static int read_atom(struct parser *p, struct orl_term **ret_node)
{
    int code;
    if (p->lexer.kind == ORL_FUNCTION_TOKEN_NUMBER)
        return read_number(p, ret_node);
    if (p->lexer.kind == ORL_FUNCTION_TOKEN_NAME)
        return read_name(p, ret_node);
    if (!is_sign(p, '('))
        return orl_function_lexer_expected(&p->lexer, "a number, a name or '('", p->err);
    code = next_word(p);
    if (code == 0)
        code = read_sum(p, ret_node);
    return code < 0 ? code : expect_sign(p, ')', "')'");
}

/* Reads an operand with an optional sign, which binds before any operator. */
static int read_signed(struct parser *p, struct orl_term **ret_node)
{
    struct orl_term *inner = NULL;
    const bool negative = is_sign(p, '-');
    int code = 0;
    if (negative || is_sign(p, '+'))
        code = next_word(p);
    if (code == 0)
        code = read_atom(p, &inner);
    if (code < 0 || !negative) {
        *ret_node = inner;
        return code;
    }
    struct orl_term *const node = make_term(p, ORL_NODE_NEGATE);
    struct list list = {&inner, NULL, 1, 0, 0};
    if (!node)
        return no_memory(p);
    *ret_node = node;
    return store_list(p, &list, node);
}

/* Reads one operand, or a chain of operands joined by the two operators. */
static int read_chain(struct parser *p, const char *operators,
                      int (*read)(struct parser *, struct orl_term **), struct orl_term **ret_node)
{
    struct list list = {0};
    struct orl_term *one = NULL;
    int code = read_operands(p, operators, read, &list);
    if (code == 0 && list.n > 1) {
        one = make_term(p, ORL_NODE_CHAIN);
        code = one ? store_list(p, &list, one) : no_memory(p);
    } else if (code == 0) {
        one = list.nodes[0];
    }
    free_list(&list);
    *ret_node = one;
    return code;
}

/* Reads a power; a^b^c is a^(b^c). */
static int read_power(struct parser *p, struct orl_term **ret_node)
{
    struct orl_term *pair[2] = {NULL, NULL};
    char operators[2] = {'+', '^'};
    int code = enter_level(p);
    if (code == 0)
        code = read_signed(p, &pair[0]);
    if (code == 0 && is_sign(p, '^')) {
        code = next_word(p);
        if (code == 0)
            code = read_power(p, &pair[1]);
        struct list list = {pair, operators, 2, 0, 0};
        *ret_node = code == 0 ? make_term(p, ORL_NODE_CHAIN) : NULL;
        if (code == 0)
            code = *ret_node ? store_list(p, &list, *ret_node) : no_memory(p);
    } else {
        *ret_node = pair[0];
    }
    p->nesting--;
    return code;
}

static int read_product(struct parser *p, struct orl_term **ret_node)
{
    return read_chain(p, "*/", read_power, ret_node);
}

static int read_sum(struct parser *p, struct orl_term **ret_node)
{
    return read_chain(p, "+-", read_product, ret_node);
}

/* ---- Definitions ----------------------------------------------------------------------------- */

/* Reads "(A, B)" after the name; a variable has none. */
static int read_parameters(struct parser *p)
{
    int code;
    p->n_parameters = 0;
    p->called = 0;
    if (!is_sign(p, '('))
        return 0;
    do {
        code = next_word(p);
        if (code < 0)
            return code;
        if (p->lexer.kind != ORL_FUNCTION_TOKEN_NAME)
            return orl_function_lexer_expected(&p->lexer, "a parameter's name", p->err);
        if (p->n_parameters == ORL_FUNCTION_PARAMETERS) {
            orl_error_set(p->err, ORL_ERR_LIMIT, "a function has more than %d parameters",
                          ORL_FUNCTION_PARAMETERS);
            orl_error_at(p->err, p->file[0] ? p->file : NULL, p->lexer.line, NULL);
            return ORL_ERR_LIMIT;
        }
        const char *const name =
            orl_arena_copy_text(p->functions->arena, p->lexer.word, p->lexer.word_length);
        if (!name)
            return no_memory(p);
        p->parameters[p->n_parameters++] = name;
        code = next_word(p);
    } while (code == 0 && is_sign(p, ','));
    return code < 0 ? code : expect_sign(p, ')', "')'");
}

static int read_definition(struct parser *p)
{
    const char *name = p->lexer.word;
    size_t length = p->lexer.word_length;
    struct orl_term *root = NULL;
    int code, line = p->lexer.line;
    if (p->lexer.kind != ORL_FUNCTION_TOKEN_NAME)
        return orl_function_lexer_expected(&p->lexer, "a name to be defined", p->err);
    if (length > 1 && name[0] == '`') {
        name++;
        length--;
    }
    code = next_word(p);
    if (code == 0)
        code = read_parameters(p);
    if (code == 0 && !is_sign(p, '=') && !is_sign(p, ':'))
        return orl_function_lexer_expected(&p->lexer, "'=' or ':'", p->err);
    if (code == 0)
        code = next_word(p);
    if (code == 0)
        code = read_sum(p, &root);
    if (code == 0 && !is_sign(p, ';') && p->lexer.kind != ORL_FUNCTION_TOKEN_END)
        return orl_function_lexer_expected(&p->lexer, "';'", p->err);
    if (code < 0)
        return code;
    struct orl_definition *const definition =
        orl_definitions_at(p->functions, p->context, name, length);
    if (!definition)
        return no_memory(p);
    struct orl_formula *const body =
        p->n_parameters ? &definition->function : &definition->variable;
    body->root = root;
    body->file = p->file;
    body->line = line;
    body->n_parameters = p->n_parameters;
    body->called = p->called;
    return 0;
}

static int begin_text(struct parser *p, const char *file, int line, const char *text, size_t length)
{
    p->file = file ? orl_arena_copy_text(p->functions->arena, file, strlen(file)) : "";
    if (!p->file)
        return no_memory(p);
    return orl_function_lexer_begin(&p->lexer, p->file, line, text, length, p->err);
}

int orl_syntax_define(struct orl_functions *functions, int context, const char *file, int line,
                      const char *text, size_t length, struct orl_error *err)
{
    struct parser p = {.functions = functions, .context = context, .err = err};
    int code = begin_text(&p, file, line, text, length);
    while (code == 0 && p.lexer.kind != ORL_FUNCTION_TOKEN_END)
        code = is_sign(&p, ';') ? next_word(&p) : read_definition(&p);
    return code;
}

int orl_syntax_expression(struct orl_functions *functions, int context, const char *file, int line,
                          const char *text, size_t length, struct orl_term **ret_root,
                          struct orl_error *err)
{
    struct parser p = {.functions = functions, .context = context, .err = err};
    struct orl_term *root = NULL;
    int code = begin_text(&p, file, line, text, length);
    if (code == 0)
        code = read_sum(&p, &root);
    if (code == 0 && p.lexer.kind != ORL_FUNCTION_TOKEN_END && !is_sign(&p, ';'))
        return orl_function_lexer_expected(&p.lexer, "an operator", err);
    if (code == 0)
        *ret_root = root;
    return code;
}
