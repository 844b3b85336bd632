/*
 * State and helpers of the search for a project in a folder, shared by project.c and
 * project_search.c. For api/project only.
 */
#ifndef ORL_API_PROJECT_PROJECT_SEARCH_H
#define ORL_API_PROJECT_PROJECT_SEARCH_H

#include <stdbool.h>

#include "project/project.h"

enum { ORL_PROJECT_NAME = 1024, ORL_PROJECT_INFO_BYTES = 16 << 20 };

struct orl_project_search {
    const char **names; /* sorted */
    size_t count;
    const struct orl_files *files;
    const struct orl_project_choice *choice;
    const char *root; /* model folder, with its slash; borrowed from a name */
    size_t root_length;
    bool *used;    /* per name: true if it is part of the result */
    bool *is_main; /* per name: true if it is in the scene */
    json_t *main, *grids, *views, *states, *skies, *left_out, *warnings; /* owned */
    struct orl_error *err;
};

int orl_project_no_memory(const struct orl_project_search *f);
bool orl_project_ends_with(const char *name, const char *ending);
/* Returns the part of a name below a folder of the model, or NULL. */
const char *orl_project_below(const struct orl_project_search *f, const char *name,
                              const char *folder);
int orl_project_compare_names(const void *a, const void *b); /* for names[], by qsort and bsearch */
/* Returns the file of that name and its index, or NULL if there is none. */
const char *orl_project_name(const struct orl_project_search *f, const char *name,
                             size_t *ret_index);
/* Reads a JSON document of bounded size. */
int orl_project_json(const struct orl_project_search *f, const char *name, json_t **ret_doc);
/* Adds a file to the scene, once even if several groups name it. */
int orl_project_add_main(struct orl_project_search *f, size_t index);

/* Add grids, views, skies and warnings of the model's translation to the result. */
int orl_project_add_grids(struct orl_project_search *f);
int orl_project_add_views(struct orl_project_search *f);
int orl_project_add_skies(struct orl_project_search *f);
int orl_project_add_warnings(struct orl_project_search *f);

#endif
