/*
 * The description of a JSON value: its bounds, words and members, from the YAML of api/schema.
 *
 * The build generates one constant for each value of a document, in a header of its own:
 * orl_schema_goal_at is the member "at" of the component Goal. Decoders check values against it;
 * OpenAPI and the guide's reference are made from the same files. All of it is static and
 * read-only.
 */
#ifndef ORL_API_JSON_JSON_SCHEMA_H
#define ORL_API_JSON_JSON_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct orl_json_described;

/* Fields of other types than the value's are zero. */
struct orl_json_schema {
    const char *meaning; /* first sentence of the description, or NULL */
    double least, most;  /* bounds of a number, inclusive; infinite where there is none */
    bool above, below;   /* true to exclude the least, or the most, itself */
    uint64_t from, to;   /* inclusive bounds of a whole number */
    size_t longest;      /* bytes of a string */
    size_t fewest_items, most_items;
    bool has_preset;
    double preset;            /* the default of a number, a flag (0 or 1), or a word by its index */
    const char *const *words; /* the strings that are allowed, ending with NULL; NULL: any */
    const struct orl_json_schema *items;
    const struct orl_json_described *members; /* of an object, ending with a NULL name */
};

/* A member of an object. */
struct orl_json_described {
    const char *name;
    bool required;
    const struct orl_json_schema *schema;
};

#endif
