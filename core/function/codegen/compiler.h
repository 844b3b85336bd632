/*
 * Compiler from trees to programs: dependencies of an expression and one array of all instructions
 * (compile.c), and the instructions of its parts (emit_code.c, emit_calls.c). Inside of
 * core/function only.
 */
#ifndef ORL_FUNCTION_CODEGEN_COMPILER_H
#define ORL_FUNCTION_CODEGEN_COMPILER_H

#include "function/interpreter/machine.h"
#include "function/language/definitions.h"

/* A list of slots; owned. */
struct orl_slots {
    uint32_t *items;
    size_t n, room;
};

/* State of one compilation. Bodies and segments are indexed by slots; the expressions come
 * first. */
struct orl_compiler {
    struct orl_functions *functions;
    const struct orl_function_request *request;
    uint32_t number; /* id of the compilation: bodies with it have a slot */
    struct orl_formula **bodies;
    size_t n_bodies, bodies_room;
    /* One per body, followed by the segments of constants being folded. */
    struct orl_segment *segments;
    size_t n_segments, segments_room;
    struct orl_call_site *sites;
    size_t n_sites, sites_room;
    struct orl_argument *arguments;
    size_t n_arguments, arguments_room;
    double *tables;
    size_t n_tables, tables_room;
    struct orl_slots waiting; /* those that are referenced, but not compiled yet */
    struct orl_slots used;    /* those in the program whose references are not processed yet */
    struct orl_function_scratch *scratch;
    size_t n_instructions;
    uint32_t n_variables, folding; /* folding: operations left for constant folding */
    uint32_t depth;                /* recursion depth of emission */
    bool plain; /* true: constants are not folded, since the whole expression is being folded */
    uint64_t inputs, fixed_inputs;
    const char *file; /* file of the body being compiled */
    struct orl_error *err;
};

/* Compiles a body unless it is already compiled. */
int orl_emit_body(struct orl_compiler *c, uint32_t slot);
/* Compiles the bodies that were added to `waiting` after its first `base` entries; bodies with
 * errors stay uncompiled. */
int orl_emit_waiting(struct orl_compiler *c, size_t base);

/* Returns true if the segment is a single number. */
bool orl_segment_is_number(const struct orl_segment *segment, double *ret_number);

int orl_compiler_no_memory(struct orl_compiler *c);
/* Appends a slot to a list of the compiler. Returns 0 or ORL_ERR_NOMEM. */
int orl_compiler_add_slot(struct orl_compiler *c, struct orl_slots *slots, uint32_t slot);

/*
 * Code emission: emit_code.c appends instructions to a slot's segment and handles trees and
 * constants; emit_calls.c handles names, calls and choices. All functions with a code return 0 or
 * an error. Inside of core/function only.
 */

/* Recursion depth of emission beyond which constants are not folded. */
enum { ORL_FOLDING_DEPTH = 3000 };

/* Emits code that leaves a tree's value on top of the stack; constants are folded. */
int orl_emit(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);

int orl_emit_operation(struct orl_compiler *c, uint32_t slot, enum orl_operation operation,
                       uint64_t index, uint32_t count);
int orl_emit_number(struct orl_compiler *c, uint32_t slot, double number);

size_t orl_emit_length(const struct orl_compiler *c, uint32_t slot);
/* Sets the jump target of the instruction at `at` to the next instruction emitted. */
void orl_emit_patch_jump(struct orl_compiler *c, uint32_t slot, size_t at);
/* Removes a number if it is the only instruction emitted after position `since`. */
bool orl_emit_take_number(struct orl_compiler *c, uint32_t slot, size_t since, double *ret_number);

/* Schedules a body for compilation. */
int orl_emit_schedule_body(struct orl_compiler *c, uint32_t slot);

/* Adds the file and line to an error. Returns code. */
int orl_emit_locate_error(struct orl_compiler *c, int line, int code);

int orl_emit_variable(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
int orl_emit_call(struct orl_compiler *c, uint32_t slot, const struct orl_term *node);
/* Emits a call of a segment, or of a parameter. */
int orl_emit_site(struct orl_compiler *c, uint32_t slot, const struct orl_term *node,
                  enum orl_operation operation, uint32_t callee);

#endif
