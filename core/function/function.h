/*
 * Functions: Radiance's language of definitions (.cal files), compiled and evaluated.
 *
 * A set of definitions (struct orl_functions) takes texts and named files; an expression over them
 * is compiled to a program (struct orl_function), flat and immutable, which is evaluated at eight
 * places at once, or at one.
 *
 * The language, as Radiance's manual has it (Ward, "The RADIANCE Synthetic Imaging System",
 * section on function files; "Radiance File Formats", function file format; rcalc(1)):
 *   NAME = EXPRESSION;  NAME(A, B) = EXPRESSION;  the same with ':' for what never changes
 *   { comments { nest } }; numbers; + - * / ^ and parentheses
 * '^' is right associative and binds first but for a sign, which belongs to what follows it:
 * -2^2 is 4, and there is one sign at most. Conditions hold where they are above zero; of if() and
 * select() only what is chosen is evaluated, and an argument only where it is used, once. Functions
 * may be recursive, and be given functions by their names. A name is looked for in the file that
 * uses it, as far as it has been read, then among the standard names; `name only in the file, name`
 * only among the standard ones. Variables, whether defined by '=' or ':', are evaluated at most
 * once at a place; what depends on no input is evaluated while compiling. Deviation: ':' does not
 * freeze what depends on the ray or on arg(): each place has its own value.
 *
 * What has no value (a logarithm of zero, a division by it, an overflow of exp or ^, select()
 * beyond its list) is 0, as rcalc has it, and the place is marked.
 *
 * No file is opened here: names go to the caller's provider, and those it does not have are looked
 * for among texts of our own of Radiance's standard names (standard.h).
 *
 * Bounds, of untrusted text: ORL_FUNCTION_* below. One that is exceeded while reading or compiling
 * is an error with file and line; while evaluating it ends the evaluation, whose values are then 0.
 *
 * Units and frames: none; they are the caller's. Ownership: an orl_function holds all that it needs
 * and outlives the set. Threads: a set serves one thread; an orl_function any number, each with
 * scratch of its own. The same inputs give the same bytes, whatever lanes they are in.
 */
#ifndef ORL_FUNCTION_FUNCTION_H
#define ORL_FUNCTION_FUNCTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>
#include <oriel/files.h>

enum {
    ORL_FUNCTION_LANES = 8,
    ORL_FUNCTION_INPUTS = 64,         /* variables that the caller gives values */
    ORL_FUNCTION_NESTING = 200,       /* of parentheses and calls in one expression */
    ORL_FUNCTION_DEPTH = 4000,        /* of calls, arguments and variables being evaluated */
    ORL_FUNCTION_STACK = 8192,        /* values under way */
    ORL_FUNCTION_PARAMETERS = 64,     /* of one function */
    ORL_FUNCTION_EXPRESSIONS = 16,    /* of one program */
    ORL_FUNCTION_OPERATIONS = 100000, /* of one evaluation, unless the caller says otherwise */
};
#define ORL_FUNCTION_TEXT (16UL << 20)        /* bytes of all texts of one set */
#define ORL_FUNCTION_FOLDING (4UL << 20)      /* operations spent on constants, of one set */
#define ORL_FUNCTION_WORK (64UL << 20)        /* terms looked at in all compilations of one set */
#define ORL_FUNCTION_INSTRUCTIONS (4UL << 20) /* of one program */

/* ---- Definitions ------------------------------------------------------------------------------
 */

struct orl_functions;

/* A file of definitions has a context of its own; what is defined in this one is seen by all. */
enum { ORL_FUNCTION_GLOBAL = 0 };

/*
 * A set that knows the standard names and these inputs, by their places in the list: "s", "t", ...
 * or orl_function_ray_names. The names are borrowed, and outlive the set. NULL: out of memory, or
 * more than ORL_FUNCTION_INPUTS.
 */
struct orl_functions *orl_functions_new(const char *const *inputs, size_t n_inputs);
void orl_functions_free(struct orl_functions *functions); /* NULL is allowed */

/*
 * Reads definitions of a context. file and line are what errors name: where the text begins (NULL
 * and 0: nowhere). A name that is defined again means the later definition from then on, also where
 * it was used before.
 */
int orl_functions_define(struct orl_functions *functions, int context, const char *file, int line,
                         const char *text, size_t length, struct orl_error *err);

/*
 * The context of a file of that name, which is read when it is asked for first: from the provider
 * (NULL: there is none), or, where that has none, from our own texts. Defines in the global context
 * instead if global is true, as option -f of generators does.
 */
int orl_functions_load(struct orl_functions *functions, const struct orl_files *files,
                       const char *name, bool global, int *ret_context, struct orl_error *err);

/* True when the context (or the global one) defines a function, not a variable, of that name. */
bool orl_functions_has(const struct orl_functions *functions, int context, const char *name);
/* How many arguments it takes, of the library's the fewest; 0: there is none. */
uint32_t orl_functions_arity(const struct orl_functions *functions, int context, const char *name);

/* ---- Programs ---------------------------------------------------------------------------------
 */

struct orl_function;

struct orl_function_request {
    int context;
    const char *const *expressions; /* "noise3(Px,Py,Pz)", or a variable's name */
    size_t n_expressions;
    const double *arguments; /* arg(1), arg(2), ...: constants of the program; arg(0): how many */
    size_t n_arguments;
    /* Inputs whose value is known: by place, NAN where it is not. NULL: none is. */
    const double *fixed;
    uint32_t operations; /* the bound of one evaluation; 0: ORL_FUNCTION_OPERATIONS */
    const char *file;    /* what errors in the expressions name; NULL and 0: nothing */
    int line;
};

/* Compiles all expressions to one program, which evaluates a variable that several use once. */
int orl_function_compile(struct orl_functions *functions,
                         const struct orl_function_request *request,
                         struct orl_function **ret_function, struct orl_error *err);
void orl_function_free(struct orl_function *function); /* NULL is allowed */

/* The inputs that it reads, a bit each, by their places. */
uint64_t orl_function_inputs(const struct orl_function *function);
/* Those that it asks for and that the request fixed; known while it is compiled, not once kept. */
uint64_t orl_function_fixed_inputs(const struct orl_function *function);
/* True, and its value, when an expression's value is the same everywhere. */
bool orl_function_is_constant(const struct orl_function *function, size_t expression,
                              double *ret_value);

/*
 * Writes a program to a stream, or reads one (base/stream.h); NULL is one, too. What is read is
 * owned by whoever has the slot, also when it is cut short.
 */
struct orl_stream;
void orl_function_pass(struct orl_function **function, struct orl_stream *stream);

/* ---- Values -----------------------------------------------------------------------------------
 */

/* One quantity at eight places. */
struct orl_function_lanes {
    double at[ORL_FUNCTION_LANES];
};

struct orl_function_scratch;
struct orl_function_scratch *orl_function_scratch_new(void); /* NULL: out of memory */
void orl_function_scratch_free(struct orl_function_scratch *scratch);
/* The calling thread's own, which is not to be freed. */
struct orl_function_scratch *orl_function_scratch_of_thread(void);

struct orl_function_outcome {
    unsigned undefined; /* lanes in which something had no value, and counted as 0 */
    bool exceeded;      /* a bound was: all values are 0 */
};

/*
 * Evaluates at the places of lanes (a bit each, the first 8). inputs[i].at[l] is input i's value at
 * place l; those that the program does not read need not be there, and inputs may be NULL when it
 * reads none. ret_values has a row for each expression; lanes that were not asked for are
 * untouched. Values may be infinite or NaN: what they mean is the caller's to judge.
 */
struct orl_function_outcome orl_function_evaluate(const struct orl_function *function,
                                                  struct orl_function_scratch *scratch,
                                                  const struct orl_function_lanes *inputs,
                                                  unsigned lanes,
                                                  struct orl_function_lanes *ret_values);

/* At one place: inputs[i] is input i's value, ret_values has one for each expression. */
struct orl_function_outcome orl_function_at(const struct orl_function *function,
                                            struct orl_function_scratch *scratch,
                                            const double *inputs, double *ret_values);

#endif
