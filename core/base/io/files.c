#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/limits.h>
#include <sys/mman.h>
#include <sys/stat.h>

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

bool orl_name_has_ending(const char *name, const char *ending)
{
    const size_t length = strlen(name), tail = strlen(ending);
    return length > tail && strcasecmp(name + length - tail, ending) == 0;
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

bool orl_files_hint_case(const struct orl_files *files, const char *name, struct orl_error *err)
{
    char other[1024];
    if (!files->other_case || !files->other_case(files->ctx, name, other, sizeof other))
        return false;
    orl_error_hint(err,
                   "there is '%.300s', whose name differs in upper and lower case: rename it, or "
                   "correct the reference",
                   other);
    return true;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static int memory_open(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    const struct orl_memory_files *memory = ctx;
    for (size_t i = 0; i < memory->count; i++) {
        if (strcmp(memory->names[i], name) == 0) {
            *ret_file = memory->contents[i];
            return 0;
        }
    }
    return orl_error_set(err, ORL_ERR_NOT_FOUND, "no file named '%s'", name);
}

static void memory_close(void *ctx, struct orl_file *file)
{
    (void)ctx;
    (void)file;
}

struct orl_files orl_files_from_memory(struct orl_memory_files *memory)
{
    return (struct orl_files){.ctx = memory, .open = memory_open, .close = memory_close};
}

/* ---- Folders --------------------------------------------------------------------------------- */

static bool folder_other_case(void *ctx, const char *name, char *ret_name, size_t size)
{
    return orl_find_ignoring_case(ctx, name, ret_name, size);
}

static int report_open_failure(const char *folder, const char *name, int why, struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(folder);
    if (why == ORL_OPEN_NOT_REGULAR)
        return orl_error_set(err, ORL_ERR_IO, "'%s' is not a regular file", name);
    const int code = orl_error_set(err, why == ENOENT ? ORL_ERR_NOT_FOUND : ORL_ERR_IO,
                                   "cannot open '%s': %s", name, strerror(why));
    if (why == ENOENT)
        orl_files_hint_case(&files, name, err);
    return code;
}

static int folder_open(void *ctx, const char *name, struct orl_file *ret_file,
                       struct orl_error *err)
{
    const char *folder = ctx;
    char path[4096];
    struct stat st;
    int code = 0;
    const int length = name[0] == '/' ? snprintf(path, sizeof path, "%s", name)
                                      : snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length < 0 || (size_t)length >= sizeof path)
        return orl_error_set(err, ORL_ERR_LIMIT, "the path of '%s' is too long", name);
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0)
        return report_open_failure(folder, name, errno, err);
    if (fstat(fd, &st) != 0) {
        code = orl_error_set(err, ORL_ERR_IO, "cannot read '%s': %s", name, strerror(errno));
    } else if ((unsigned long)st.st_size > ORL_LIMIT_FILE_BYTES) {
        code = orl_error_set(err, ORL_ERR_LIMIT, "'%s' is larger than %lu MiB", name,
                             ORL_LIMIT_FILE_BYTES >> 20);
    } else if (st.st_size == 0) {
        *ret_file = (struct orl_file){"", 0, NULL};
    } else {
        void *data = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
        if (data == MAP_FAILED)
            code = orl_error_set(err, ORL_ERR_IO, "cannot map '%s': %s", name, strerror(errno));
        else
            *ret_file = (struct orl_file){data, (size_t)st.st_size, data};
    }
    close(fd);
    return code;
}

static void folder_close(void *ctx, struct orl_file *file)
{
    (void)ctx;
    if (file->handle)
        munmap(file->handle, file->size);
    file->handle = NULL;
}

void orl_files_release_pages(void *ctx, const struct orl_file *file, size_t begin, size_t end)
{
    const size_t page = 4096;
    (void)ctx;
    begin = begin / page * page;
    end = end / page * page;
    if (file->handle && begin < end && end <= file->size)
        madvise((char *)file->handle + begin, end - begin, MADV_DONTNEED);
}

struct orl_files orl_files_from_folder(const char *folder)
{
    /* The provider only reads through ctx; the cast drops const for the common struct. */
    return (struct orl_files){.ctx = (void *)(uintptr_t)folder,
                              .open = folder_open,
                              .close = folder_close,
                              .passed = orl_files_release_pages,
                              .other_case = folder_other_case};
}
