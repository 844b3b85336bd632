#include "process/dashboard_files.h"

#include <string.h>

/* The literals are long: gcc and clang accept literals of any length. */
#pragma GCC diagnostic ignored "-Woverlength-strings"
#include "dashboard.h"

const char *orl_dashboard_version(void)
{
    return page_version;
}

const struct orl_dashboard_file *orl_dashboard_file_find(const char *name)
{
    for (size_t i = 0; i < sizeof page_files / sizeof *page_files; i++)
        if (strcmp(page_files[i].name, name) == 0)
            return &page_files[i];
    return NULL;
}
