#include "process/embedded_files.h"

#include <string.h>

/* The contract is longer than the 4095 bytes that C17 guarantees for one literal; gcc and clang
 * accept it. */
#pragma GCC diagnostic ignored "-Woverlength-strings"
#include "embedded.h"

size_t orl_embedded_file_count(void)
{
    return sizeof orl_embedded / sizeof *orl_embedded;
}

struct orl_embedded_file orl_embedded_file_at(size_t index)
{
    return (struct orl_embedded_file){orl_embedded[index].name, orl_embedded[index].text};
}

const char *orl_embedded_file_find(const char *name)
{
    for (size_t i = 0; i < orl_embedded_file_count(); i++)
        if (strcmp(orl_embedded[i].name, name) == 0)
            return orl_embedded[i].text;
    return NULL;
}

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

#include "guide_files.h"

const struct orl_guide_file *orl_guide_files(size_t *ret_count)
{
    *ret_count = sizeof guide_files / sizeof *guide_files;
    return guide_files;
}
