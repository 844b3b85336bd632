/* Links of the guide's pages. */
#include <stdio.h>
#include <string.h>

#include "guide/markdown.h"

static const char root[] = "client/guide/";

static const char module[] = "client/javascript/oriel.js"; /* the daemon serves it, too */

/* Removes "." and ".." from a path, in place. Returns false if it leaves the source tree. */
static bool normalise_path(char *path)
{
    char *to = path;
    for (char *from = path; *from;) {
        const size_t length = strcspn(from, "/");
        char *next = from + length + (from[length] == '/');
        if (length == 2 && strncmp(from, "..", 2) == 0) {
            if (to == path)
                return false;
            to--;
            while (to > path && to[-1] != '/')
                to--;
        } else if (length > 0 && !(length == 1 && *from == '.')) {
            memmove(to, from, (size_t)(next - from));
            to += next - from;
        }
        from = next;
    }
    *to = '\0';
    return true;
}

/* Writes the address of a file of the source tree; returns false if the daemon does not serve it.
 */
static bool write_address(const char *path, const char *fragment, char ret_url[ORL_GUIDE_URL])
{
    if (strcmp(path, module) == 0)
        return snprintf(ret_url, ORL_GUIDE_URL, "/oriel.js") > 0;
    if (strncmp(path, root, sizeof root - 1) != 0)
        return false;
    const char *name = path + sizeof root - 1;
    size_t length = strlen(name);
    if (length > 3 && strcmp(name + length - 3, ".md") == 0)
        length -= 3;
    if (length == 5 && strncmp(name, "index", 5) == 0)
        length = 0;
    const int used = snprintf(ret_url, ORL_GUIDE_URL, "/guide%s%.*s%s", length ? "/" : "",
                              (int)length, name, fragment);
    return used < ORL_GUIDE_URL;
}

const char *orl_guide_resolve(const char *name, const char *link, char ret_url[ORL_GUIDE_URL])
{
    char path[ORL_GUIDE_URL];
    if (link[0] == '#' || link[0] == '/' || strncmp(link, "http://", 7) == 0 ||
        strncmp(link, "https://", 8) == 0 || strncmp(link, "mailto:", 7) == 0)
        return link;
    const char *slash = strrchr(name, '/');
    const size_t folder = slash ? (size_t)(slash - name) + 1 : 0;
    const size_t length = strcspn(link, "#");
    const int used =
        snprintf(path, sizeof path, "%s%.*s%.*s", root, (int)folder, name, (int)length, link);
    if (used >= ORL_GUIDE_URL || !normalise_path(path) ||
        !write_address(path, link + length, ret_url))
        ret_url[0] = '\0';
    return ret_url;
}
