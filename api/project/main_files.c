#include "project/main_files.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/array.h>
#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>
#include <oriel/job/run.h>

enum { MOST_DEFINERS = 16, DEEPEST = 8 };

struct token {
    const char *at;
    size_t size;
    size_t file; /* index of the main or material file in which it was found */
};

struct tokens {
    struct token *items;
    size_t count, room;
};

/* State of the scan. Words point into the texts, which stay open. */
struct order_scan {
    const char *const *names;
    size_t count;
    const struct orl_files *files;
    struct orl_file *texts; /* texts of opened files */
    bool *opened, *scanned;
    struct tokens defined, used;
    size_t file; /* index of the file being scanned */
    bool out_of_memory;
};

static bool is_token(const struct token *token, const char *text)
{
    return token->size == strlen(text) && memcmp(token->at, text, token->size) == 0;
}

static bool is_one_of(const struct token *token, const char *const *texts)
{
    while (*texts && !is_token(token, *texts))
        texts++;
    return *texts != NULL;
}

static void add_token(struct order_scan *order_scan, struct tokens *tokens,
                      const struct token *token)
{
    if (is_token(token, "void"))
        return;
    if (orl_array_reserve(&tokens->items, &tokens->room, tokens->count, sizeof *tokens->items))
        tokens->items[tokens->count++] = (struct token){token->at, token->size, order_scan->file};
    else
        order_scan->out_of_memory = true;
}

/* ---- Scanning a file ------------------------------------------------------------------------- */

static void scan_file(struct order_scan *order_scan, size_t index, unsigned depth);

/* Scans the files whose name's last part is the word's. Folders are ignored: they do not matter
 * for the order. */
static void scan_files_named(struct order_scan *order_scan, const struct token *token,
                             unsigned depth)
{
    size_t begin = token->size;
    while (begin > 0 && token->at[begin - 1] != '/')
        begin--;
    const size_t size = token->size - begin;
    for (size_t i = 0; i < order_scan->count && depth < DEEPEST; i++) {
        const char *slash = strrchr(order_scan->names[i], '/');
        const char *last = slash ? slash + 1 : order_scan->names[i];
        if (strlen(last) == size && memcmp(last, token->at + begin, size) == 0 &&
            !order_scan->scanned[i])
            scan_file(order_scan, i, depth + 1);
    }
}

/* Scans a command after its first word, which starts with '!'. A backslash continues a line. */
static void scan_command(struct order_scan *order_scan, struct orl_scanner *scanner,
                         struct orl_slice first, unsigned depth)
{
    static const char *const skies[] = {"gensky", "gendaylit", NULL};
    static const struct token sky = {"skyfunc", 7, 0};
    const unsigned options = scanner->options;
    struct orl_slice next = {first.text + 1, first.length - 1};
    struct token before = {"", 0, 0};
    scanner->options = ORL_SCANNER_CONTINUATIONS;
    bool more = next.length > 0 || orl_scanner_word_of_line(scanner, &next);
    for (size_t i = 0; more; i++) {
        const struct token token = {next.text, next.length, 0};
        const bool file = token.size > 4 && strncasecmp(token.at + token.size - 4, ".rad", 4) == 0;
        if (i == 0 && is_one_of(&token, skies))
            add_token(order_scan, &order_scan->defined, &sky);
        else if (file)
            scan_files_named(order_scan, &token, depth);
        else if (is_token(&before, "-m") ||
                 (i == 1 && before.size > 3 && memcmp(before.at, "gen", 3) == 0))
            add_token(order_scan, &order_scan->used, &token);
        before = token;
        more = orl_scanner_word_of_line(scanner, &next);
    }
    scanner->options = options;
}

/* Returns the next word of a primitive, and skips comments and, where one may begin, commands. */
static bool next_of_scene(struct order_scan *order_scan, struct orl_scanner *scanner, bool first,
                          unsigned depth, struct token *ret_token)
{
    struct orl_slice next;
    while (orl_scanner_word(scanner, &next)) {
        if (first && *next.text == '!') {
            scan_command(order_scan, scanner, next, depth);
            continue;
        }
        *ret_token = (struct token){next.text, next.length, 0};
        return true;
    }
    return false;
}

/* Skips the three argument lists. For some types the first argument names a modifier. */
static void skip_arguments(struct order_scan *order_scan, struct orl_scanner *scanner,
                           bool names_modifier)
{
    struct token token;
    for (int list = 0; list < 3 && next_of_scene(order_scan, scanner, false, 0, &token); list++) {
        unsigned long left = 0;
        for (size_t i = 0; i < token.size && i < 9 && token.at[i] >= '0' && token.at[i] <= '9'; i++)
            left = 10 * left + (unsigned long)(token.at[i] - '0');
        for (bool named = names_modifier && list == 0;
             left > 0 && next_of_scene(order_scan, scanner, false, 0, &token);
             left--, named = false)
            if (named)
                add_token(order_scan, &order_scan->used, &token);
    }
}

static void scan_text(struct order_scan *order_scan, struct orl_scanner *scanner, unsigned depth)
{
    static const char *const surfaces[] = {"polygon", "sphere",   "bubble", "cone",
                                           "cup",     "cylinder", "tube",   "ring",
                                           "source",  "instance", "mesh",   NULL};
    static const char *const others[] = {"illum", "mirror", "antimatter", NULL};
    struct token modifier, type, name;
    while (next_of_scene(order_scan, scanner, true, depth, &modifier) &&
           next_of_scene(order_scan, scanner, false, depth, &type) &&
           next_of_scene(order_scan, scanner, false, depth, &name)) {
        add_token(order_scan, &order_scan->used, &modifier);
        if (!is_one_of(&type, surfaces))
            add_token(order_scan, &order_scan->defined, &name);
        if (!is_token(&type, "alias"))
            skip_arguments(order_scan, scanner, is_one_of(&type, others));
        else if (next_of_scene(order_scan, scanner, false, depth, &name))
            add_token(order_scan, &order_scan->used, &name);
    }
}

static void scan_file(struct order_scan *order_scan, size_t index, unsigned depth)
{
    order_scan->scanned[index] = true;
    if (!order_scan->opened[index] &&
        order_scan->files->open(order_scan->files->ctx, order_scan->names[index],
                                &order_scan->texts[index], NULL) < 0)
        return; /* reading the scene reports the error */
    order_scan->opened[index] = true;
    const struct orl_file *file = &order_scan->texts[index];
    struct orl_scanner scanner;
    /* Reading the scene reports a binary file. */
    if (orl_scanner_init(&scanner, NULL, file->data, file->size, ORL_SCANNER_COMMENTS, NULL) == 0)
        scan_text(order_scan, &scanner, depth);
}

/* ---- Dependencies ---------------------------------------------------------------------------- */

static int compare_names(const struct token *a, const struct token *b)
{
    const int order_scan = memcmp(a->at, b->at, a->size < b->size ? a->size : b->size);
    return order_scan != 0 ? order_scan : (a->size > b->size) - (a->size < b->size);
}

static int compare_words(const void *a, const void *b)
{
    const struct token *x = a, *y = b;
    const int order_scan = compare_names(x, y);
    return order_scan != 0 ? order_scan : (x->file > y->file) - (x->file < y->file);
}

static void sort_once(struct tokens *tokens)
{
    size_t kept = 0;
    if (tokens->count > 0)
        qsort(tokens->items, tokens->count, sizeof *tokens->items, compare_words);
    for (size_t i = 0; i < tokens->count; i++)
        if (kept == 0 || compare_words(&tokens->items[kept - 1], &tokens->items[i]) != 0)
            tokens->items[kept++] = tokens->items[i];
    tokens->count = kept;
}

/* Finds at most MOST_DEFINERS definitions of the name, in file order: returns their number, and
 * the first index in *ret_first. */
static size_t find_definers(const struct tokens *defined, const struct token *name,
                            size_t *ret_first)
{
    size_t low = 0, high = defined->count, n = 0;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (compare_names(&defined->items[middle], name) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    while (low + n < defined->count && n < MOST_DEFINERS &&
           compare_names(&defined->items[low + n], name) == 0)
        n++;
    *ret_first = low;
    return n;
}

/* Sets needs[i * count + j] if file i uses a name that file j defines and i does not. */
static void find_needs(const struct order_scan *order_scan, bool *needs)
{
    const struct tokens *used = &order_scan->used, *defined = &order_scan->defined;
    for (size_t i = 0; i < used->count; i++) {
        const struct token *token = &used->items[i];
        size_t first = 0;
        const size_t n = find_definers(defined, token, &first);
        bool own = false;
        for (size_t k = first; k < first + n; k++)
            own = own || defined->items[k].file == token->file;
        for (size_t k = first; k < first + n && !own; k++)
            needs[token->file * order_scan->count + defined->items[k].file] = true;
    }
}

/* Marks material files as main: for each name used but not defined in main files, the first file
 * that defines it. Returns true if any was marked. */
static bool add_material_files(const struct order_scan *order_scan, bool *is_main)
{
    const struct tokens *used = &order_scan->used, *defined = &order_scan->defined;
    bool taken = false;
    for (size_t i = 0; i < used->count; i++) {
        size_t first = 0;
        const size_t n =
            is_main[used->items[i].file] ? find_definers(defined, &used->items[i], &first) : 0;
        bool known = n == 0;
        for (size_t k = first; k < first + n; k++)
            known = known || is_main[defined->items[k].file];
        if (!known)
            is_main[defined->items[first].file] = taken = true;
    }
    return taken;
}

static bool waits_for_other(const bool *needs, const bool *left, size_t count, size_t index)
{
    for (size_t j = 0; j < count; j++)
        if (left[j] && needs[index * count + j])
            return true;
    return false;
}

/* Repeatedly picks the first file that waits for no other, or the first of all if every one waits.
 * left: the main files; cleared. */
static size_t put_in_order(const bool *needs, bool *left, size_t count, size_t *ret_order)
{
    size_t placed = 0;
    for (;;) {
        size_t first = count, next = count;
        for (size_t i = 0; i < count && next == count; i++) {
            if (left[i] && first == count)
                first = i;
            if (left[i] && !waits_for_other(needs, left, count, i))
                next = i;
        }
        if (first == count)
            return placed;
        next = next < count ? next : first;
        ret_order[placed++] = next;
        left[next] = false;
    }
}

/* Returns true for a material file (.mat) in the main files' folder. */
static bool lies_beside(const char *const *names, size_t count, const bool *is_main, size_t index)
{
    const char *name = names[index], *slash = strrchr(name, '/');
    const size_t folder = slash ? (size_t)(slash - name) + 1 : 0;
    size_t top = 0;
    while (top < count && !is_main[top])
        top++;
    return top < count && orl_name_has_ending(name, ".mat") &&
           strncmp(names[top], name, folder) == 0 && !strchr(names[top] + folder, '/');
}

/*
 * Finds the reading order of a scene's main files: a modifier is defined before it is used.
 *
 * Each file is scanned for names that it defines and uses. The scan includes files that its
 * commands name, up to 8 deep. Files are not fully parsed. Files that cannot be opened are
 * skipped. Reading the scene reports all errors. If several files define a name, all of them (at
 * most 16) come before its users. File names decide cycles and ties.
 *
 * names: sorted. is_main: in and out; needed material files are added. ret_order: room for count;
 * gets the main files' indices in reading order. Errors: ORL_ERR_NOMEM.
 */
static int order_main_files(const char *const *names, size_t count, bool *is_main,
                            const struct orl_files *files, size_t *ret_order, size_t *ret_count,
                            struct orl_error *err)
{
    struct order_scan order_scan = {.names = names,
                                    .count = count,
                                    .files = files,
                                    .texts = calloc(count + 1, sizeof *order_scan.texts),
                                    .opened = calloc(2 * count + 1, sizeof(bool)),
                                    .scanned = calloc(count + 1, sizeof(bool))};
    bool *needs = calloc(count * count + 1, sizeof *needs);
    order_scan.out_of_memory =
        !order_scan.texts || !order_scan.opened || !order_scan.scanned || !needs;
    for (order_scan.file = 0; order_scan.file < count && !order_scan.out_of_memory;
         order_scan.file++) {
        if (!is_main[order_scan.file] && !lies_beside(names, count, is_main, order_scan.file))
            continue;
        memset(order_scan.scanned, 0, count);
        scan_file(&order_scan, order_scan.file, 0);
    }
    if (!order_scan.out_of_memory) {
        bool *left = order_scan.opened + count;
        sort_once(&order_scan.defined);
        sort_once(&order_scan.used);
        while (add_material_files(&order_scan, is_main))
            ;
        memcpy(left, is_main, count);
        find_needs(&order_scan, needs);
        *ret_count = put_in_order(needs, left, count, ret_order);
    }
    for (size_t i = 0; i < count && order_scan.opened && order_scan.texts; i++)
        if (order_scan.opened[i])
            files->close(files->ctx, &order_scan.texts[i]);
    free(order_scan.texts);
    free(order_scan.opened);
    free(order_scan.scanned);
    free(order_scan.defined.items);
    free(order_scan.used.items);
    free(needs);
    return order_scan.out_of_memory
               ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count)
               : 0;
}

static size_t folder_length(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? (size_t)(slash - name) + 1 : 0;
}

/* Returns the index of the name made of folder and name, or count if there is none. */
static size_t find_name(const char *const *names, size_t count, const char *folder, size_t length,
                        const char *name)
{
    size_t i = 0;
    while (i < count &&
           (strncmp(names[i], folder, length) != 0 || strcmp(names[i] + length, name) != 0))
        i++;
    return i;
}

/* Resolves the scene files that a job document lists. Returns 0 if doc is no such document, or if
 * a file is missing or listed twice. */
static size_t read_document(const json_t *doc, const char *const *names, size_t count,
                            const char *folder, size_t length, size_t *ret_chosen)
{
    const json_t *list = json_object_get(json_object_get(doc, "scene"), "files");
    const size_t listed = json_array_size(list);
    for (size_t i = 0; i < listed; i++) {
        const char *name = json_string_value(json_array_get(list, i));
        const size_t found = name ? find_name(names, count, folder, length, name) : count;
        if (found == count || listed > count)
            return 0;
        for (size_t k = 0; k < i; k++)
            if (ret_chosen[k] == found)
                return 0;
        ret_chosen[i] = found;
    }
    return listed;
}

/* Chooses the files by the job documents in the top folder, where the file top lies. *ret_count
 * stays 0 if there is none. */
static int choose_by_documents(const char *const *names, size_t count, const char *top,
                               const struct orl_files *files, size_t *ret_chosen, size_t *ret_count,
                               struct orl_error *err)
{
    const size_t length = folder_length(top);
    bool by_render = false;
    int code = 0;
    size_t *chosen = malloc((count + 1) * sizeof *chosen);
    if (!chosen)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    for (size_t i = 0; i < count && code == 0 && !by_render; i++) {
        struct orl_file text;
        if (!orl_name_has_ending(names[i], ".json") || folder_length(names[i]) != length ||
            strncmp(names[i], top, length) != 0)
            continue;
        code = files->open(files->ctx, names[i], &text, err);
        if (code < 0)
            break;
        json_t *doc =
            text.size <= ORL_LIMIT_JOB_BYTES ? json_loadb(text.data, text.size, 0, NULL) : NULL;
        files->close(files->ctx, &text);
        const char *kind = json_string_value(json_object_get(doc, "kind"));
        const bool render = !kind || strcmp(kind, "render") == 0;
        const size_t listed = read_document(doc, names, count, top, length, chosen);
        json_decref(doc);
        if (listed > 0 && (render || *ret_count == 0)) {
            memcpy(ret_chosen, chosen, listed * sizeof *chosen);
            *ret_count = listed;
            by_render = render;
        }
    }
    free(chosen);
    return code;
}

int orl_main_files_choose(const char *const *names, size_t count, const struct orl_files *files,
                          size_t *ret_chosen, size_t *ret_count, struct orl_error *err)
{
    bool *is_main = calloc(count + 1, sizeof *is_main);
    size_t top = 0;
    *ret_count = 0;
    if (!is_main)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    int code = orl_scene_guess_main(names, count, files, is_main, err);
    while (top < count && !is_main[top])
        top++;
    if (code == 0 && top < count)
        code = choose_by_documents(names, count, names[top], files, ret_chosen, ret_count, err);
    if (code == 0 && *ret_count == 0)
        code = order_main_files(names, count, is_main, files, ret_chosen, ret_count, err);
    free(is_main);
    return code;
}

int orl_main_files_ranks(const char *const *names, size_t count, const struct orl_files *files,
                         unsigned *ret_ranks, struct orl_error *err)
{
    size_t *chosen = malloc((count + 1) * sizeof *chosen), n = 0;
    if (!chosen)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count);
    const int code = orl_main_files_choose(names, count, files, chosen, &n, err);
    memset(ret_ranks, 0, count * sizeof *ret_ranks);
    for (size_t i = 0; i < n && code == 0; i++)
        ret_ranks[chosen[i]] = (unsigned)i + 1;
    free(chosen);
    return code;
}
