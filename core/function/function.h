/*
 * Functions: Radiance's language of definitions (.cal files), compiled and evaluated.
 *
 * A set of definitions (struct orl_functions) is read from texts and named files. An expression
 * over them is compiled to a flat, immutable program (struct orl_function), which is evaluated at
 * eight points at once, or at one.
 *
 * The language, as in Radiance's manual (Ward, "The RADIANCE Synthetic Imaging System", section on
 * function files; "Radiance File Formats", function file format; rcalc(1)):
 *     NAME = EXPRESSION;  NAME(A, B) = EXPRESSION;  the same with ':' for constants
 *     { comments { nest } }; numbers; + - * / ^ and parentheses
 * '^' is right associative and binds first, except for a sign, which belongs to the operand after
 * it: -2^2 is 4. At most one sign is allowed. A condition is true if it is above zero. if() and
 * select() evaluate only the chosen operand. An argument is evaluated only when it is used, at most
 * once. Functions may be recursive, and may take functions by name as arguments. A name is searched
 * in the file that uses it, as far as it has been read, then among the standard names. `name
 * searches only the file, name` only the standard names. Variables, defined by '=' or ':', are
 * evaluated at most once per point. Expressions that depend on no input are evaluated while
 * compiling. Deviation from Radiance: ':' does not freeze a value that depends on the ray or on
 * arg(); each point has its own value.
 *
 * An undefined value (a logarithm of zero, a division by zero, an overflow of exp or ^, select()
 * outside its list) is 0, as in rcalc, and the point is marked.
 *
 * No file is opened here: names go to the caller's provider. Names that it does not have are
 * searched among Oriel's own versions of Radiance's standard files (below).
 *
 * Limits for untrusted text: ORL_FUNCTION_* below. If a limit is exceeded while reading or
 * compiling, the error has file and line. If one is exceeded while evaluating, the evaluation ends
 * and its values are 0.
 *
 * Units and frames: none; they are the caller's. Ownership: an orl_function holds all that it needs
 * and may outlive the set. Threads: a set is used by one thread, an orl_function by any number,
 * each with separate scratch. The same inputs give the same bytes in any lane.
 */
#ifndef ORL_FUNCTION_FUNCTION_H
#define ORL_FUNCTION_FUNCTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/error.h>
#include <oriel/base/files.h>

enum {
    ORL_FUNCTION_LANES = 8,
    ORL_FUNCTION_INPUTS = 64,         /* variables that the caller sets */
    ORL_FUNCTION_NESTING = 200,       /* parentheses and calls in one expression */
    ORL_FUNCTION_DEPTH = 4000,        /* calls, arguments and variables being evaluated */
    ORL_FUNCTION_STACK = 8192,        /* values on the stack */
    ORL_FUNCTION_PARAMETERS = 64,     /* parameters of one function */
    ORL_FUNCTION_EXPRESSIONS = 16,    /* expressions in one program */
    ORL_FUNCTION_OPERATIONS = 100000, /* operations of one evaluation, by default */
};
#define ORL_FUNCTION_TEXT (16UL << 20)        /* bytes of all texts of one set */
#define ORL_FUNCTION_FOLDING (4UL << 20)      /* operations spent on constants in one set */
#define ORL_FUNCTION_WORK (64UL << 20)        /* terms visited by all compilations of one set */
#define ORL_FUNCTION_INSTRUCTIONS (4UL << 20) /* instructions of one program */

/* ---- Definitions ----------------------------------------------------------------------------- */

struct orl_functions;

/* Context that is visible to all; each file of definitions has a separate context. */
enum { ORL_FUNCTION_GLOBAL = 0 };

/*
 * Creates a set that knows the standard names and these inputs, by their index in the list: "s",
 * "t", ... or orl_function_ray_names. The names are borrowed, and must outlive the set. NULL: out
 * of memory, or more than ORL_FUNCTION_INPUTS.
 */
struct orl_functions *orl_functions_new(const char *const *inputs, size_t n_inputs);
void orl_functions_free(struct orl_functions *functions); /* NULL is allowed */

/*
 * Reads definitions of a context. file and line are the place of the text in error messages (NULL
 * and 0: none). A later definition of a name replaces the earlier one, also for earlier uses.
 */
int orl_functions_define(struct orl_functions *functions, int context, const char *file, int line,
                         const char *text, size_t length, struct orl_error *err);

/*
 * Returns the context of a file. The file is read on first use: from the provider (may be NULL),
 * or, if that lacks it, from the built-in texts. If global is true, it defines into the global
 * context instead, as option -f of generators does.
 */
int orl_functions_load(struct orl_functions *functions, const struct orl_files *files,
                       const char *name, bool global, int *ret_context, struct orl_error *err);

/* Returns true if the context (or the global one) defines a function, not a variable, of that
 * name. */
bool orl_functions_has(const struct orl_functions *functions, int context, const char *name);
/* Returns the number of arguments of a function, the smallest for built-in ones; 0: no such
 * function. */
uint32_t orl_functions_arity(const struct orl_functions *functions, int context, const char *name);

/* ---- Programs -------------------------------------------------------------------------------- */

struct orl_function;

struct orl_function_request {
    int context;
    const char *const *expressions; /* "noise3(Px,Py,Pz)", or a variable's name */
    size_t n_expressions;
    /* arg(1), arg(2), ...: constants of the program; arg(0) is their number. */
    const double *arguments;
    size_t n_arguments;
    /* Known values of inputs, by index; NAN: not known. NULL: none is known. */
    const double *fixed;
    uint32_t operations; /* limit of one evaluation; 0: ORL_FUNCTION_OPERATIONS */
    const char *file;    /* file and line of the expressions in error messages; NULL and 0: none */
    int line;
};

/* Compiles all expressions to one program. A variable that several of them use is evaluated
 * once. */
int orl_function_compile(struct orl_functions *functions,
                         const struct orl_function_request *request,
                         struct orl_function **ret_function, struct orl_error *err);
void orl_function_free(struct orl_function *function); /* NULL is allowed */

/* Returns the inputs that the program reads, as bits by index. */
uint64_t orl_function_inputs(const struct orl_function *function);
/* Returns the fixed inputs that the program uses, as bits; known after compilation, but not after
 * reading from a stream. */
uint64_t orl_function_fixed_inputs(const struct orl_function *function);
/* Returns true, and the value, if an expression is constant. */
bool orl_function_is_constant(const struct orl_function *function, size_t expression,
                              double *ret_value);

/*
 * Writes a program to a stream, or reads one (base/io/checked_file.h); NULL is valid, too. The
 * owner of the slot owns what is read, also after an error.
 */
struct orl_serializer;
void orl_function_serialize(struct orl_function **function, struct orl_serializer *serializer);

/* ---- Values ---------------------------------------------------------------------------------- */

/* One quantity at eight points. */
struct orl_function_lanes {
    double at[ORL_FUNCTION_LANES];
};

struct orl_function_scratch;
struct orl_function_scratch *orl_function_scratch_new(void); /* NULL: out of memory */
void orl_function_scratch_free(struct orl_function_scratch *scratch);
/* Returns the calling thread's scratch, which must not be freed. */
struct orl_function_scratch *orl_function_scratch_of_thread(void);

struct orl_function_outcome {
    unsigned undefined; /* lanes with an undefined value, which counted as 0 */
    bool exceeded;      /* true: a limit was exceeded; all values are 0 */
};

/*
 * Evaluates the program at the points given by `lanes` (one bit each, the first 8). inputs[i].at[l]
 * is the value of input i at point l. Inputs that the program does not read may be missing; inputs
 * may be NULL if it reads none. ret_values has one entry per expression; other lanes are untouched.
 * Values may be infinite or NaN; the caller must check.
 */
struct orl_function_outcome orl_function_evaluate(const struct orl_function *function,
                                                  struct orl_function_scratch *scratch,
                                                  const struct orl_function_lanes *inputs,
                                                  unsigned lanes,
                                                  struct orl_function_lanes *ret_values);

/* Evaluates at one point: inputs[i] is the value of input i, ret_values has one value per
 * expression. */
struct orl_function_outcome orl_function_at(const struct orl_function *function,
                                            struct orl_function_scratch *scratch,
                                            const double *inputs, double *ret_values);

/*
 * Ray properties that functions of patterns and materials may use: the inputs of their programs,
 * with Radiance's names (reference manual, section on function files). Frame: the function's own,
 * in which the file's transform has been undone.
 */

enum orl_ray_input {
    ORL_RAY_DX, /* direction of the ray */
    ORL_RAY_DY,
    ORL_RAY_DZ,
    ORL_RAY_NX, /* normal of the surface, on its front */
    ORL_RAY_NY,
    ORL_RAY_NZ,
    ORL_RAY_PX, /* hit point */
    ORL_RAY_PY,
    ORL_RAY_PZ,
    ORL_RAY_T,    /* distance from the start of the path */
    ORL_RAY_TS,   /* distance along this ray */
    ORL_RAY_RDOT, /* cosine between ray and normal, below 0 on the back */
    ORL_RAY_S,    /* length of the world unit in the function's units */
    ORL_RAY_TX,   /* the world's origin and unit vectors in the function's frame */
    ORL_RAY_TY,
    ORL_RAY_TZ,
    ORL_RAY_IX,
    ORL_RAY_IY,
    ORL_RAY_IZ,
    ORL_RAY_JX,
    ORL_RAY_JY,
    ORL_RAY_JZ,
    ORL_RAY_KX,
    ORL_RAY_KY,
    ORL_RAY_KZ,
    ORL_RAY_LU, /* coordinates on a mesh */
    ORL_RAY_LV,
    ORL_RAY_NXP, /* normal after textures */
    ORL_RAY_NYP,
    ORL_RAY_NZP,
    ORL_RAY_RDOTP,
    ORL_RAY_CRP, /* colour after patterns */
    ORL_RAY_CGP,
    ORL_RAY_CBP,
    ORL_RAY_DXA, /* direction to the light source of a prism */
    ORL_RAY_DYA,
    ORL_RAY_DZA,
    ORL_RAY_LIGHT_X, /* direction to the light for a lobe; set by the evaluator */
    ORL_RAY_LIGHT_Y,
    ORL_RAY_LIGHT_Z,
    ORL_RAY_DATA, /* up to three values from a data file or a picture; set by the evaluator */
    ORL_RAY_DATA_2,
    ORL_RAY_DATA_3,
    ORL_RAY_INPUTS
};

extern const char *const orl_function_ray_names[ORL_RAY_INPUTS];

/*
 * Oriel's own versions of function files that scenes use without including them. The names are
 * those of Radiance's library. The definitions follow its manual, the headers of its files, and the
 * underlying mathematics. They are found by file name, after the caller's own files.
 */

#define ORL_STANDARD_START "rayinit.cal" /* implicit start of every set of definitions */

/* Returns the text of a file, or NULL if there is none of that name. */
const char *orl_standard_text(const char *name);

#endif
