/* The rows for function files. */
#include "support/doubled.h"

static void write_sum(FILE *f, size_t n)
{
    fputs("x = s", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "\n + %zu*s", i);
}
static void write_list(FILE *f, size_t n)
{
    fputs("x = select(s", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, ", s*%zu", i);
    fputs(");", f);
}
static void write_table(FILE *f, size_t n)
{
    fputs("x = select(s", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, ", 2*%zu", i);
    fputs(");", f);
}
/* Writes variables, each defined by the next; the last depends on s, or not. */
static void write_variables(FILE *f, size_t n)
{
    fputs("x = a0;", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "a%zu = a%zu + 1;\n", i, i + 1);
    fprintf(f, "a%zu = s;", n);
}
static void write_constants(FILE *f, size_t n)
{
    fputs("x = a0;", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "a%zu : a%zu + 1;\n", i, i + 1);
    fprintf(f, "a%zu : 2;", n);
}
static void write_calls(FILE *f, size_t n)
{
    fputs("f(a, b) = a + b; g(h, a) : h(a, 2); x = s", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, " + f(s, f(%zu, 2)) + g(f, s)", i);
}
static void write_recursion(FILE *f, size_t n)
{
    fprintf(f, "f(n) = if(n, 1 + f(n - 1), 0); x = f(s*%zu);", n);
}
/* Writes functions that appear only in branches that are never evaluated. */
static void write_unused(FILE *f, size_t n)
{
    fputs("x = if(1, s, y", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, " + f%zu(1)", i);
    fputs(");", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "f%zu(a) = f%zu(a) + nosuch;", i, (i + 1) % n);
}
static void write_redefined(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fputs("x = s; ", f);
}
static void write_comment(FILE *f, size_t n)
{
    fputs("x = s; ", f);
    for (size_t i = 0; i < n; i++)
        fputs("{ a\n", f);
    for (size_t i = 0; i < n; i++)
        fputs("} ", f);
}

#define ROW(name, n)                                                                               \
    {                                                                                              \
        "function_" #name, DOUBLED_FUNCTION, n, write_##name, 0                                    \
    }
const struct doubled doubled_functions[] = {
    ROW(sum, 1000),       ROW(list, 1000),    ROW(table, 1000),    ROW(variables, 1000),
    ROW(constants, 500),  ROW(calls, 500),    ROW(recursion, 500), ROW(unused, 500),
    ROW(redefined, 1000), ROW(comment, 5000),
};
const size_t doubled_n_functions = sizeof doubled_functions / sizeof *doubled_functions;
