/* Distinguishes the main scene files of a folder from those that only other files name. */
#include <oriel/base/scanner.h>
#include <oriel/job/run.h>

#include <stdint.h>
#include <string.h>
#include <strings.h>

/* Limit of names looked up in one folder; it bounds the time. */
enum { MOST_NAMES = 100000 };

/* The folder's files and their state. */
struct main_file_finder {
    const char *const *names;
    size_t count;
    bool *main;
    size_t holder; /* index of the file that contains the current command */
    size_t n_names;
};

static bool is_radiance(const char *name, size_t length)
{
    return length > 4 && strncasecmp(name + length - 4, ".rad", 4) == 0;
}

/* Unmarks a file named by a command, unless it contains the command itself. */
static void unmark_file(struct main_file_finder *r, const char *folder, size_t folder_length,
                        const char *word, size_t length)
{
    for (size_t i = 0; i < r->count; i++) {
        const char *name = r->names[i];
        if (i != r->holder && strncmp(name, folder, folder_length) == 0 &&
            strncmp(name + folder_length, word, length) == 0 &&
            name[folder_length + length] == '\0')
            r->main[i] = false;
    }
}

static size_t folder_length(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) + 1 : 0;
}

/* Handles a name in a command: it is relative to the file that contains it, or to the top
 * folder. */
static void read_word(struct main_file_finder *r, const char *word, size_t length)
{
    const char *holder = r->names[r->holder];
    size_t folder = folder_length(holder);
    if (!is_radiance(word, length) || r->n_names++ >= MOST_NAMES)
        return;
    while (length > 2 && strncmp(word, "./", 2) == 0) {
        word += 2;
        length -= 2;
    }
    unmark_file(r, holder, 0, word, length);
    while (folder > 0 && length > 3 && strncmp(word, "../", 3) == 0) {
        for (folder--; folder > 0 && holder[folder - 1] != '/'; folder--)
            ;
        word += 3;
        length -= 3;
    }
    unmark_file(r, holder, folder, word, length);
}

/* Reads the commands of a file: lines that begin with '!', with their continuations after a
 * backslash. Binary files have none. */
static void read_commands(struct main_file_finder *r, const struct orl_file *text)
{
    struct orl_scanner scanner;
    struct orl_slice word;
    if (orl_scanner_init(&scanner, NULL, text->data, text->size, ORL_SCANNER_CONTINUATIONS, NULL) <
        0)
        return;
    while (orl_scanner_next_line(&scanner)) {
        const bool is_command = *scanner.at == '!';
        scanner.at += is_command;
        while (orl_scanner_word_of_line(&scanner, &word))
            if (is_command)
                read_word(r, word.text, word.length);
    }
}

/* Marks the files of the top folder: the one with Radiance files at the least depth. Marks none if
 * several folders qualify. */
static void mark_top(const char *const *names, size_t count, bool *ret_main)
{
    size_t fewest = SIZE_MAX, top = count;
    bool several = false;
    for (size_t i = 0; i < count; i++) {
        size_t depth = 0;
        for (const char *c = names[i]; *c; c++)
            depth += *c == '/';
        if (!is_radiance(names[i], strlen(names[i])) || depth > fewest)
            continue;
        const size_t length = folder_length(names[i]);
        several = depth == fewest && (several || folder_length(names[top]) != length ||
                                      strncmp(names[i], names[top], length) != 0);
        fewest = depth;
        top = i;
    }
    for (size_t i = 0; i < count; i++)
        ret_main[i] = top < count && !several && is_radiance(names[i], strlen(names[i])) &&
                      folder_length(names[i]) == folder_length(names[top]) &&
                      strncmp(names[i], names[top], folder_length(names[top])) == 0;
}

int orl_scene_guess_main(const char *const *names, size_t count, const struct orl_files *files,
                         bool *ret_main, struct orl_error *err)
{
    struct main_file_finder r = {.names = names, .count = count, .main = ret_main};
    int code = 0;
    mark_top(names, count, ret_main);
    for (r.holder = 0; r.holder < count && code == 0; r.holder++) {
        const char *name = names[r.holder];
        struct orl_file text;
        if (!is_radiance(name, strlen(name)))
            continue;
        code = files->open(files->ctx, name, &text, err);
        if (code == 0) {
            read_commands(&r, &text);
            files->close(files->ctx, &text);
        }
    }
    if (code == 0 && r.n_names > MOST_NAMES)
        code = orl_error_set(
            err, ORL_ERR_LIMIT,
            "the folder's commands name more than %d files: name the scene's files", MOST_NAMES);
    return code;
}
