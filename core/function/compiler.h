/*
 * From trees to programs: what an expression needs (survey.c), its instructions (emit.c), and one
 * array of them all (compile.c). Inside of core/function only.
 */
#ifndef ORL_FUNCTION_COMPILER_H
#define ORL_FUNCTION_COMPILER_H

#include "function/definitions.h"
#include "function/machine.h"

/* One compilation. Bodies and segments go by slots: those of the expressions come first. */
struct orl_compiler {
    struct orl_functions *functions;
    const struct orl_function_request *request;
    uint32_t number; /* of the compilation: bodies with it have their slot */
    struct orl_formula **bodies;
    size_t n_bodies, bodies_room;
    struct orl_segment *segments; /* a body's, and beyond those what is being folded */
    size_t n_segments, segments_room;
    struct orl_site *sites;
    size_t n_sites, sites_room;
    struct orl_argument *arguments;
    size_t n_arguments, arguments_room;
    double *tables;
    size_t n_tables, tables_room;
    uint32_t *waiting; /* slots that are mentioned, and were not compiled */
    size_t n_waiting, waiting_room;
    uint32_t *used; /* slots of the program, whose own uses are to be looked at */
    size_t n_used, used_room;
    struct orl_function_scratch *scratch;
    size_t n_instructions;
    uint32_t n_variables, folding; /* folding: operations left for it */
    uint32_t depth;                /* of emission */
    bool plain;                    /* constants are not folded: the whole is about to be */
    uint64_t inputs, fixed_inputs;
    const char *file; /* of the body under way */
    struct orl_error *err;
};

/* Finds the bodies that the first n need, and which nodes are constant. */
int orl_survey(struct orl_compiler *c);

/* Compiles a body, unless it is. */
int orl_emit_body(struct orl_compiler *c, uint32_t slot);
/* Compiles what has come to wait since there were base of them; what has mistakes stays undone. */
int orl_emit_waiting(struct orl_compiler *c, size_t base);

/* True when the segment is no more than a number. */
bool orl_segment_is_number(const struct orl_segment *segment, double *ret_number);

int orl_compiler_no_memory(struct orl_compiler *c);

#endif
