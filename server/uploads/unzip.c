#include "uploads/uploads.h"

#include <archive.h>
#include <archive_entry.h>
#include <locale.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/job/run.h>

#include "process/limits.h"
#include "project/main_files.h"

enum { CHUNK = 64 << 10 };

/* An archive being unpacked. */
struct unpacking {
    const struct orl_folders *folders;
    struct archive *archive;
    struct orl_bundle files; /* so far; all are resources */
    struct orl_incoming incoming;
    uint64_t before, bytes, most_bytes; /* before: bytes of other files; bytes: unpacked */
    char *buffer;
};

bool orl_is_zip_type(const char *type)
{
    static const char *const types[] = {"application/zip", "application/x-zip-compressed"};
    const size_t length = type ? strcspn(type, "; \t") : 0;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strlen(types[i]) == length && strncasecmp(types[i], type, length) == 0)
            return true;
    return false;
}

static int refuse_entry(struct orl_error *err, int code, const char *name, const char *what)
{
    orl_error_set(err, code, "the zip's entry '%.200s' is refused: %s", name, what);
    orl_error_at(err, name, 0, NULL);
    return code;
}

/* Refuses a damaged archive with libarchive's message. */
static int refuse_damaged(const struct unpacking *u, const char *name, struct orl_error *err)
{
    const char *why = archive_error_string(u->archive);
    orl_error_set(err, ORL_ERR_SYNTAX, "the zip is damaged%s%.200s%s: %.120s", name ? " at '" : "",
                  name ? name : "", name ? "'" : "", why ? why : "it ends too early");
    if (name)
        orl_error_at(err, name, 0, NULL);
    return ORL_ERR_SYNTAX;
}

/*
 * Counts the entries' headers, wherever bytes look like one, to limit them: libarchive keeps data
 * of every entry in memory.
 */
static int count_entries(const struct orl_file *archive, struct orl_error *err)
{
    static const char header[4] = {'P', 'K', 1, 2};
    const char *at = archive->data, *end = archive->data + archive->size;
    size_t count = 0;
    while ((at = memmem(at, (size_t)(end - at), header, sizeof header)) != NULL) {
        at += sizeof header;
        if (++count > ORL_SERVER_ZIP_ENTRIES)
            return orl_error_set(err, ORL_ERR_LIMIT, "the zip has more than %u entries",
                                 ORL_SERVER_ZIP_ENTRIES);
    }
    return 0;
}

/* ---- One entry ------------------------------------------------------------------------------- */

/* Returns true for files that desktops leave in folders. */
static bool is_litter(const char *name)
{
    static const char *const litter[] = {".DS_Store", "Thumbs.db", "desktop.ini"};
    const char *slash = strrchr(name, '/'), *last = slash ? slash + 1 : name;
    for (size_t i = 0; i < sizeof litter / sizeof *litter; i++)
        if (strcmp(last, litter[i]) == 0)
            return true;
    return strncmp(name, "__MACOSX/", 9) == 0 || strcmp(name, "__MACOSX") == 0;
}

/* Returns the entry's name without a leading "./" and a trailing "/". */
static int read_name(struct archive_entry *entry, char ret_name[ORL_PATH_MAX],
                     struct orl_error *err)
{
    const char *name = archive_entry_pathname(entry);
    if (!name)
        return orl_error_set(err, ORL_ERR_INVALID, "a name in the zip is not UTF-8");
    while (name[0] == '.' && name[1] == '/')
        name += 2;
    snprintf(ret_name, ORL_PATH_MAX, "%s", name);
    const size_t length = strlen(ret_name);
    if (archive_entry_filetype(entry) == AE_IFDIR && length > 1 && ret_name[length - 1] == '/')
        ret_name[length - 1] = '\0';
    return 0;
}

static int check_kind(const struct unpacking *u, struct archive_entry *entry, const char *name,
                      struct orl_error *err)
{
    const char *format = archive_format_name(u->archive);
    if (archive_entry_symlink(entry) || archive_entry_hardlink(entry) ||
        archive_entry_filetype(entry) == AE_IFLNK)
        return refuse_entry(err, ORL_ERR_INVALID, name, "it is a link");
    if (archive_entry_filetype(entry) != AE_IFREG && archive_entry_filetype(entry) != AE_IFDIR)
        return refuse_entry(err, ORL_ERR_INVALID, name, "it is neither a file nor a folder");
    if (archive_entry_is_encrypted(entry))
        return refuse_entry(err, ORL_ERR_UNSUPPORTED, name, "it is encrypted");
    if (archive_entry_filetype(entry) == AE_IFREG && format && !strstr(format, "(deflation)") &&
        !strstr(format, "(uncompressed)"))
        return refuse_entry(err, ORL_ERR_UNSUPPORTED, name,
                            "only deflate compression is supported");
    return 0;
}

static int add_bytes(struct unpacking *u, const char *name, size_t size, struct orl_error *err)
{
    u->bytes += size;
    if (u->before + u->bytes > ORL_SERVER_SCENE_BYTES)
        return refuse_entry(err, ORL_ERR_LIMIT, name,
                            "the unpacked upload is larger than a scene may be");
    if (u->bytes > u->most_bytes)
        return refuse_entry(err, ORL_ERR_LIMIT, name, "the zip unpacks to too many times its size");
    return orl_incoming_append(&u->incoming, u->buffer, size, err);
}

static int unpack_file(struct unpacking *u, const char *name, struct orl_error *err)
{
    int rc = orl_incoming_begin(&u->incoming, u->folders, name, true, err);
    while (rc == 0) {
        const la_ssize_t n = archive_read_data(u->archive, u->buffer, CHUNK);
        if (n == 0)
            break;
        rc = n < 0 ? refuse_damaged(u, name, err) : add_bytes(u, name, (size_t)n, err);
    }
    orl_incoming_end(&u->incoming);
    return rc;
}

static int unpack_entry(struct unpacking *u, struct archive_entry *entry, struct orl_error *err)
{
    char name[ORL_PATH_MAX] = "";
    int rc = read_name(entry, name, err);
    if (rc || is_litter(name) || name[0] == '\0')
        return rc;
    rc = orl_bundle_check_name(name, err);
    if (rc == 0)
        rc = check_kind(u, entry, name, err);
    if (rc == 0 && archive_entry_filetype(entry) == AE_IFREG)
        rc = unpack_file(u, name, err);
    return rc;
}

/* ---- The archive ----------------------------------------------------------------------------- */

static int unpack_all(struct unpacking *u, const struct orl_file *archive, struct orl_error *err)
{
    struct archive_entry *entry;
    int rc = 0;
    archive_read_support_format_zip_seekable(u->archive);
    if (archive_read_open_memory(u->archive, archive->data, archive->size) != ARCHIVE_OK)
        return refuse_damaged(u, NULL, err);
    while (rc == 0) {
        const int step = archive_read_next_header(u->archive, &entry);
        if (step == ARCHIVE_EOF)
            break;
        rc = step == ARCHIVE_OK || step == ARCHIVE_WARN ? unpack_entry(u, entry, err)
                                                        : refuse_damaged(u, NULL, err);
    }
    return rc;
}

/* Returns the length of the folder name that all files begin with, including '/'; 0: none. */
static size_t common_folder(const struct orl_bundle *files)
{
    const char *first = files->count ? files->files[0].name : "";
    const char *slash = strchr(first, '/');
    const size_t length = slash ? (size_t)(slash - first) + 1 : 0;
    for (size_t i = 1; i < files->count && length > 0; i++)
        if (strncmp(files->files[i].name, first, length) != 0)
            return 0;
    return length;
}

/* Returns true for a project's folder, whose files refer to each other by its name. */
static bool is_model_folder(const struct orl_bundle *files)
{
    static const char scene[] = "model/scene/";
    for (size_t i = 0; i < files->count; i++)
        if (strncmp(files->files[i].name, scene, sizeof scene - 1) == 0)
            return true;
    return false;
}

static void leave_out_folder(struct orl_bundle *files)
{
    const size_t length = is_model_folder(files) ? 0 : common_folder(files);
    for (size_t i = 0; i < files->count && length > 0; i++) {
        char *name = files->files[i].name;
        memmove(name, name + length, strlen(name + length) + 1);
    }
}

static void make_all_resources(struct orl_bundle *files)
{
    for (size_t i = 0; i < files->count; i++)
        files->files[i].resource = true;
}

int orl_unzip_guess(void *ctx, struct orl_bundle *files, unsigned *ret_places,
                    struct orl_error *err)
{
    const char *names[ORL_LIMIT_SCENE_FILES];
    const struct orl_files provider = orl_bundle_provider(files);
    (void)ctx;
    for (size_t i = 0; i < files->count; i++)
        names[i] = files->files[i].name;
    return orl_main_files_ranks(names, files->count, &provider, ret_places, err);
}

/* Puts main files first, in the order of their places; an insertion sort like orl_bundle_sort. */
static void give_roles(struct orl_bundle *files, unsigned *places)
{
    for (size_t i = 0; i < files->count; i++) {
        const struct orl_bundle_file file = files->files[i];
        const unsigned place = places[i];
        size_t k = i;
        for (; place > 0 && k > 0 && (places[k - 1] == 0 || places[k - 1] > place); k--) {
            files->files[k] = files->files[k - 1];
            places[k] = places[k - 1];
        }
        files->files[k] = file;
        files->files[k].resource = place == 0;
        places[k] = place;
    }
}

int orl_unzip_finish(struct orl_bundle *files, orl_unzip_guesser guess, void *ctx,
                     struct orl_bundle *bundle, struct orl_error *err)
{
    unsigned places[ORL_LIMIT_SCENE_FILES];
    int rc = 0;
    leave_out_folder(files);
    make_all_resources(files);
    if (guess) {
        orl_bundle_sort(files);
        rc = guess(ctx, files, places, err);
        if (rc == 0)
            give_roles(files, places);
    }
    return rc ? rc : orl_bundle_move(files, bundle, err);
}

/* libarchive converts names to the encoding of the thread's locale. */
static locale_t utf8;
static pthread_once_t utf8_is_made = PTHREAD_ONCE_INIT;

static void make_utf8(void)
{
    utf8 = newlocale(LC_CTYPE_MASK, "C.UTF-8", (locale_t)0);
}

void orl_unzip_prepare(void)
{
    pthread_once(&utf8_is_made, make_utf8);
}

int orl_unzip_entries(const struct orl_file *archive, const struct orl_folders *folders,
                      const struct orl_incoming_sink *sink, uint64_t before,
                      struct orl_bundle *ret_files, struct orl_error *err)
{
    struct unpacking u = {.folders = folders,
                          .before = before,
                          .most_bytes = ORL_SERVER_ZIP_FREE + ORL_SERVER_ZIP_RATIO * archive->size};
    int rc = count_entries(archive, err);
    if (rc)
        return rc;
    orl_unzip_prepare();
    const locale_t own = utf8 ? uselocale(utf8) : (locale_t)0;
    u.archive = archive_read_new();
    u.buffer = malloc(CHUNK);
    orl_incoming_init(&u.incoming, &u.files);
    u.incoming.sink = sink;
    if (u.archive && u.buffer)
        rc = unpack_all(&u, archive, err);
    else
        rc = orl_error_no_memory(err);
    archive_read_free(u.archive);
    if (utf8)
        uselocale(own);
    free(u.buffer);
    if (rc)
        orl_bundle_done(&u.files);
    else
        *ret_files = u.files;
    return rc;
}

int orl_unzip(const struct orl_file *archive, const struct orl_folders *folders, bool guess_roles,
              struct orl_bundle *bundle, struct orl_error *err)
{
    struct orl_bundle files = {0};
    int rc = orl_unzip_entries(archive, folders, NULL, orl_bundle_bytes(bundle), &files, err);
    if (rc == 0)
        rc = orl_unzip_finish(&files, guess_roles ? orl_unzip_guess : NULL, NULL, bundle, err);
    orl_bundle_done(&files);
    return rc;
}
