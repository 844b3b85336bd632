#include "main_order.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/scanner.h>

enum { MOST_DEFINERS = 16, DEEPEST = 8 };

struct word {
    const char *at;
    size_t size;
    size_t file; /* index of the main or material file in which it was found */
};

struct words {
    struct word *items;
    size_t count, room;
};

/* State of the scan. Words point into the texts, which stay open. */
struct order {
    const char *const *names;
    size_t count;
    const struct orl_files *files;
    struct orl_file *texts; /* texts of opened files */
    bool *opened, *seen;
    struct words defined, used;
    size_t file; /* index of the file being scanned */
    bool out_of_memory;
};

static bool is_word(const struct word *word, const char *text)
{
    return word->size == strlen(text) && memcmp(word->at, text, word->size) == 0;
}

static bool is_one_of(const struct word *word, const char *const *texts)
{
    while (*texts && !is_word(word, *texts))
        texts++;
    return *texts != NULL;
}

static void add_word(struct order *order, struct words *words, const struct word *word)
{
    if (is_word(word, "void"))
        return;
    if (words->count == words->room) {
        const size_t room = words->room ? 2 * words->room : 256;
        struct word *grown = realloc(words->items, room * sizeof *grown);
        if (!grown) {
            order->out_of_memory = true;
            return;
        }
        words->items = grown;
        words->room = room;
    }
    words->items[words->count++] = (struct word){word->at, word->size, order->file};
}

/* ---- Scanning a file ------------------------------------------------------------------------- */

static void look_at_file(struct order *order, size_t index, unsigned depth);

/* Scans the files whose name's last part is the word's. Folders are ignored: they do not matter
 * for the order. */
static void look_at_named(struct order *order, const struct word *word, unsigned depth)
{
    size_t begin = word->size;
    while (begin > 0 && word->at[begin - 1] != '/')
        begin--;
    const size_t size = word->size - begin;
    for (size_t i = 0; i < order->count && depth < DEEPEST; i++) {
        const char *slash = strrchr(order->names[i], '/');
        const char *last = slash ? slash + 1 : order->names[i];
        if (strlen(last) == size && memcmp(last, word->at + begin, size) == 0 && !order->seen[i])
            look_at_file(order, i, depth + 1);
    }
}

/* Scans a command after its first word, which starts with '!'. A backslash continues a line. */
static void look_at_command(struct order *order, struct orl_scanner *scanner,
                            struct orl_slice first, unsigned depth)
{
    static const char *const skies[] = {"gensky", "gendaylit", NULL};
    static const struct word sky = {"skyfunc", 7, 0};
    const unsigned options = scanner->options;
    struct orl_slice next = {first.text + 1, first.length - 1};
    struct word before = {"", 0, 0};
    scanner->options = ORL_SCANNER_CONTINUATIONS;
    bool more = next.length > 0 || orl_scanner_word_of_line(scanner, &next);
    for (size_t i = 0; more; i++) {
        const struct word word = {next.text, next.length, 0};
        const bool file = word.size > 4 && strncasecmp(word.at + word.size - 4, ".rad", 4) == 0;
        if (i == 0 && is_one_of(&word, skies))
            add_word(order, &order->defined, &sky);
        else if (file)
            look_at_named(order, &word, depth);
        else if (is_word(&before, "-m") ||
                 (i == 1 && before.size > 3 && memcmp(before.at, "gen", 3) == 0))
            add_word(order, &order->used, &word);
        before = word;
        more = orl_scanner_word_of_line(scanner, &next);
    }
    scanner->options = options;
}

/* Returns the next word of a primitive, and skips comments and, where one may begin, commands. */
static bool next_of_scene(struct order *order, struct orl_scanner *scanner, bool first,
                          unsigned depth, struct word *ret_word)
{
    struct orl_slice next;
    while (orl_scanner_word(scanner, &next)) {
        if (first && *next.text == '!') {
            look_at_command(order, scanner, next, depth);
            continue;
        }
        *ret_word = (struct word){next.text, next.length, 0};
        return true;
    }
    return false;
}

/* Skips the three argument lists. For some types the first argument names a modifier. */
static void skip_arguments(struct order *order, struct orl_scanner *scanner, bool names_modifier)
{
    struct word word;
    for (int list = 0; list < 3 && next_of_scene(order, scanner, false, 0, &word); list++) {
        unsigned long left = 0;
        for (size_t i = 0; i < word.size && i < 9 && word.at[i] >= '0' && word.at[i] <= '9'; i++)
            left = 10 * left + (unsigned long)(word.at[i] - '0');
        for (bool named = names_modifier && list == 0;
             left > 0 && next_of_scene(order, scanner, false, 0, &word); left--, named = false)
            if (named)
                add_word(order, &order->used, &word);
    }
}

static void look_at_text(struct order *order, struct orl_scanner *scanner, unsigned depth)
{
    static const char *const surfaces[] = {"polygon", "sphere",   "bubble", "cone",
                                           "cup",     "cylinder", "tube",   "ring",
                                           "source",  "instance", "mesh",   NULL};
    static const char *const others[] = {"illum", "mirror", "antimatter", NULL};
    struct word modifier, type, name;
    while (next_of_scene(order, scanner, true, depth, &modifier) &&
           next_of_scene(order, scanner, false, depth, &type) &&
           next_of_scene(order, scanner, false, depth, &name)) {
        add_word(order, &order->used, &modifier);
        if (!is_one_of(&type, surfaces))
            add_word(order, &order->defined, &name);
        if (!is_word(&type, "alias"))
            skip_arguments(order, scanner, is_one_of(&type, others));
        else if (next_of_scene(order, scanner, false, depth, &name))
            add_word(order, &order->used, &name);
    }
}

static void look_at_file(struct order *order, size_t index, unsigned depth)
{
    order->seen[index] = true;
    if (!order->opened[index] &&
        order->files->open(order->files->ctx, order->names[index], &order->texts[index], NULL) < 0)
        return; /* reading the scene reports the error */
    order->opened[index] = true;
    const struct orl_file *file = &order->texts[index];
    struct orl_scanner scanner;
    /* Reading the scene reports a binary file. */
    if (orl_scanner_init(&scanner, NULL, file->data, file->size, ORL_SCANNER_COMMENTS, NULL) == 0)
        look_at_text(order, &scanner, depth);
}

/* ---- Dependencies ---------------------------------------------------------------------------- */

static int compare_names(const struct word *a, const struct word *b)
{
    const int order = memcmp(a->at, b->at, a->size < b->size ? a->size : b->size);
    return order != 0 ? order : (a->size > b->size) - (a->size < b->size);
}

static int compare_words(const void *a, const void *b)
{
    const struct word *x = a, *y = b;
    const int order = compare_names(x, y);
    return order != 0 ? order : (x->file > y->file) - (x->file < y->file);
}

static void sort_once(struct words *words)
{
    size_t kept = 0;
    if (words->count > 0)
        qsort(words->items, words->count, sizeof *words->items, compare_words);
    for (size_t i = 0; i < words->count; i++)
        if (kept == 0 || compare_words(&words->items[kept - 1], &words->items[i]) != 0)
            words->items[kept++] = words->items[i];
    words->count = kept;
}

/* Finds at most MOST_DEFINERS definitions of the name, in file order: returns their number, and
 * the first index in *ret_first. */
static size_t find_definers(const struct words *defined, const struct word *name, size_t *ret_first)
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
static void find_needs(const struct order *order, bool *needs)
{
    const struct words *used = &order->used, *defined = &order->defined;
    for (size_t i = 0; i < used->count; i++) {
        const struct word *word = &used->items[i];
        size_t first = 0;
        const size_t n = find_definers(defined, word, &first);
        bool own = false;
        for (size_t k = first; k < first + n; k++)
            own = own || defined->items[k].file == word->file;
        for (size_t k = first; k < first + n && !own; k++)
            needs[word->file * order->count + defined->items[k].file] = true;
    }
}

/* Marks material files as main: for each name used but not defined in main files, the first file
 * that defines it. Returns true if any was marked. */
static bool take_materials(const struct order *order, bool *is_main)
{
    const struct words *used = &order->used, *defined = &order->defined;
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
    const size_t folder = slash ? (size_t)(slash - name) + 1 : 0, length = strlen(name);
    size_t top = 0;
    while (top < count && !is_main[top])
        top++;
    return top < count && length > 4 && strcasecmp(name + length - 4, ".mat") == 0 &&
           strncmp(names[top], name, folder) == 0 && !strchr(names[top] + folder, '/');
}

int orl_main_order(const char *const *names, size_t count, bool *is_main,
                   const struct orl_files *files, size_t *ret_order, size_t *ret_count,
                   struct orl_error *err)
{
    struct order order = {.names = names,
                          .count = count,
                          .files = files,
                          .texts = calloc(count + 1, sizeof *order.texts),
                          .opened = calloc(2 * count + 1, sizeof(bool)),
                          .seen = calloc(count + 1, sizeof(bool))};
    bool *needs = calloc(count * count + 1, sizeof *needs);
    order.out_of_memory = !order.texts || !order.opened || !order.seen || !needs;
    for (order.file = 0; order.file < count && !order.out_of_memory; order.file++) {
        if (!is_main[order.file] && !lies_beside(names, count, is_main, order.file))
            continue;
        memset(order.seen, 0, count);
        look_at_file(&order, order.file, 0);
    }
    if (!order.out_of_memory) {
        bool *left = order.opened + count;
        sort_once(&order.defined);
        sort_once(&order.used);
        while (take_materials(&order, is_main))
            ;
        memcpy(left, is_main, count);
        find_needs(&order, needs);
        *ret_count = put_in_order(needs, left, count, ret_order);
    }
    for (size_t i = 0; i < count && order.opened && order.texts; i++)
        if (order.opened[i])
            files->close(files->ctx, &order.texts[i]);
    free(order.texts);
    free(order.opened);
    free(order.seen);
    free(order.defined.items);
    free(order.used.items);
    free(needs);
    return order.out_of_memory
               ? orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu files", count)
               : 0;
}
