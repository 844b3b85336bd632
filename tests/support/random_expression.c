#include "support/random_expression.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "base/sampling/sampling.h"

const char *const random_expression_definitions =
    "u : .75; v = -1.25; w : u*v - 2^u; x.y_1 = w/3;\n"
    "twice(f, x) = f(f(x)); half(x) : x/2; near(a, b) = 1 - sqrt((a-b)^2);\n"
    "sum(f, i, n) = if(i - n - .5, 0, f(i) + sum(f, i+1, n));\n"
    "power(a, n) : if(n - .5, a*power(a, n-1), 1);\n"
    "pick(i) = select(i, 3, -1, 4, u, v, 9, -2, 6);\n"
    "lazy(a, b) = if(a, a, b); ever(x) = lazy(x, ever(x+1));\n";

struct draft {
    struct orl_random random;
    char *text;
    size_t size, used;
};

static uint32_t below(struct draft *draft, uint32_t n)
{
    return (uint32_t)(orl_random_uniform(&draft->random) * n);
}

static void put_text(struct draft *draft, const char *text)
{
    const size_t length = strlen(text);
    if (draft->used + length >= draft->size)
        return;
    memcpy(draft->text + draft->used, text, length + 1);
    draft->used += length;
}

static void put_number(struct draft *draft)
{
    static const char *const some[] = {"0", "1", "2", ".5", "3.", "1e-3", "12.75", "7e1", "100"};
    char text[32];
    if (below(draft, 3) == 0) {
        put_text(draft, some[below(draft, sizeof some / sizeof *some)]);
        return;
    }
    snprintf(text, sizeof text, "%.*g", 1 + (int)below(draft, 6),
             5 * orl_random_uniform(&draft->random));
    put_text(draft, text);
}

static void put_sum(struct draft *draft, int depth);

/* Writes NAME(A, B, ...) with n arguments. */
static void put_call(struct draft *draft, const char *name, uint32_t n, int depth)
{
    put_text(draft, name);
    put_text(draft, "(");
    for (uint32_t i = 0; i < n; i++) {
        put_sum(draft, depth);
        put_text(draft, i + 1 < n ? ", " : ")");
    }
}

static void put_function(struct draft *draft, int depth)
{
    static const struct {
        const char *name;
        uint32_t n;
    } some[] = {{"sin", 1},  {"cos", 1},   {"tan", 1},   {"asin", 1},   {"acos", 1},  {"atan", 1},
                {"exp", 1},  {"log", 1},   {"log10", 1}, {"sqrt", 1},   {"floor", 1}, {"ceil", 1},
                {"rand", 1}, {"atan2", 2}, {"min", 3},   {"max", 2},    {"if", 3},    {"if", 3},
                {"half", 1}, {"near", 2},  {"pick", 1},  {"select", 4}, {"ever", 1},  {"lazy", 2}};
    static const char *const of_functions[] = {"sin", "half", "floor", "pick", "atan"};
    const uint32_t which = below(draft, 28);
    if (which < sizeof some / sizeof *some) {
        /* rand() depends on its argument's last bit; ever() recurses as deep as its argument is
         * below 0. */
        const bool is_rand = strcmp(some[which].name, "rand") == 0;
        const bool is_ever = strcmp(some[which].name, "ever") == 0;
        put_text(draft, is_rand ? "rand(floor(100*" : is_ever ? "ever(sin(" : "");
        put_call(draft, is_rand || is_ever ? "" : some[which].name, some[which].n, depth);
        put_text(draft, is_rand || is_ever ? "))" : "");
        return;
    }
    put_text(draft, which == 24 ? "power(" : which == 25 ? "sum(" : "twice(");
    put_text(draft, which == 24 ? "1.1" : of_functions[below(draft, 5)]);
    put_text(draft, which == 25 ? ", 1" : "");
    put_text(draft, ", ");
    if (which <= 25)
        put_text(draft, below(draft, 2) ? "4" : "7");
    else
        put_sum(draft, depth);
    put_text(draft, ")");
}

static void put_atom(struct draft *draft, int depth)
{
    static const char *const names[] = {"u", "v", "w", "x.y_1", "PI"};
    const uint32_t which = below(draft, depth > 0 ? 8 : 4);
    if (below(draft, 6) == 0)
        put_text(draft, below(draft, 4) ? "-" : "+");
    if (which < 3) {
        put_number(draft);
    } else if (which == 3) {
        put_text(draft, names[below(draft, 5)]);
    } else if (which == 4) {
        put_text(draft, below(draft, 8) ? "(" : "( {a {nested} comment} ");
        put_sum(draft, depth - 1);
        put_text(draft, ")");
    } else {
        put_function(draft, depth - 1);
    }
}

static void put_product(struct draft *draft, int depth)
{
    put_atom(draft, depth);
    while (below(draft, 3) == 0) {
        static const char *const joints[] = {"*", "/", "^", " * "};
        put_text(draft, joints[below(draft, 4)]);
        put_atom(draft, depth);
    }
}

static void put_sum(struct draft *draft, int depth)
{
    put_product(draft, depth);
    while (below(draft, 3) == 0) {
        put_text(draft, below(draft, 2) ? "+" : " - ");
        put_product(draft, depth);
    }
}

void random_expression_write(uint64_t seed, char *ret_text, size_t size)
{
    struct draft draft = {
        .random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0), .size = size, .text = ret_text};
    do {
        draft.used = 0;
        put_sum(&draft, 3);
    } while (draft.used > size / 2 ||
             draft.used < 12); /* nothing was cut off, and the text is not empty */
}
