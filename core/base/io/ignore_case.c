#include "base/io/ignore_case.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { PATH_BYTES = 4096, NAME_BYTES = 256 };

/* Finds an entry of the folder that matches the name in any case; of several the first by name. */
static bool find_entry(const char *folder, const char *name, char ret_entry[NAME_BYTES])
{
    DIR *const entries = opendir(folder);
    ret_entry[0] = '\0';
    if (!entries)
        return false;
    for (const struct dirent *entry; (entry = readdir(entries)) != NULL;)
        if (strcasecmp(entry->d_name, name) == 0 &&
            (!ret_entry[0] || strcmp(entry->d_name, ret_entry) < 0))
            snprintf(ret_entry, NAME_BYTES, "%s", entry->d_name);
    closedir(entries);
    return ret_entry[0] != '\0';
}

/* Appends a component to a path. */
static bool append_component(char *path, size_t size, const char *part)
{
    const size_t length = strlen(path);
    const char *const between = length > 0 && path[length - 1] != '/' ? "/" : "";
    const int n = snprintf(path + length, size - length, "%s%s", between, part);
    return n >= 0 && (size_t)n < size - length;
}

bool orl_find_ignoring_case(const char *folder, const char *name, char *ret_name, size_t size)
{
    char path[PATH_BYTES], part[NAME_BYTES], entry[NAME_BYTES];
    bool found = name[0] != '\0', differs = false;
    snprintf(path, sizeof path, "%s", name[0] == '/' ? "/" : folder);
    snprintf(ret_name, size, "%s", name[0] == '/' ? "/" : "");
    while (found && *(name += strspn(name, "/"))) {
        const size_t length = strcspn(name, "/");
        const size_t base = strlen(path);
        snprintf(part, sizeof part, "%.*s", (int)length, name);
        name += length;
        found = length < sizeof part && append_component(path, sizeof path, part);
        if (found && access(path, F_OK) != 0) {
            path[base] = '\0';
            found = find_entry(path, part, entry) && append_component(path, sizeof path, entry);
            snprintf(part, sizeof part, "%s", entry);
            differs = true;
        }
        found = found && append_component(ret_name, size, part);
    }
    return found && differs;
}
