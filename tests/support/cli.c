#include "support/cli.h"

#include <fcntl.h>
#include <ftw.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { MAX_ARGS = 32 };

static int temporary_file(void)
{
    char name[] = "/tmp/oriel-cli-XXXXXX";
    const int fd = mkostemp(name, O_CLOEXEC);

    assert_true(fd >= 0);
    unlink(name);
    return fd;
}

/* Starts the program; closes the descriptors in this process. */
static struct cli_child start(const char *name, const char *const *args, int out_fd, int err_fd)
{
    const char *build = getenv("ORIEL_BUILD");
    char program[1024], *argv[MAX_ARGS] = {program};
    struct cli_child child = {.out_fd = out_fd, .err_fd = err_fd};

    snprintf(program, sizeof program, "%s/%s", build ? build : "build", name);
    assert_int_equal(access(program, X_OK), 0);
    for (int i = 0; args[i]; i++) {
        assert_true(i + 2 < MAX_ARGS);
        argv[i + 1] = (char *)(uintptr_t)args[i];
    }
    child.pid = fork();
    assert_true(child.pid >= 0);
    if (child.pid == 0) {
        dup2(child.out_fd, STDOUT_FILENO);
        dup2(child.err_fd, STDERR_FILENO);
        execv(program, argv);
        _exit(127);
    }
    return child;
}

struct cli_child cli_start_program(const char *name, const char *const *args)
{
    return start(name, args, temporary_file(), temporary_file());
}

struct cli_child cli_start(const char *const *args)
{
    return cli_start_program("oriel", args);
}

void cli_peek(const struct cli_child *child, char *ret_text)
{
    const ssize_t length = pread(child->out_fd, ret_text, CLI_OUTPUT_MAX - 1, 0);

    assert_true(length >= 0);
    ret_text[length] = '\0';
}

static void read_back(int fd, char *ret_text)
{
    const ssize_t length = pread(fd, ret_text, CLI_OUTPUT_MAX - 1, 0);

    assert_true(length >= 0);
    ret_text[length] = '\0';
    close(fd);
}

void cli_finish(struct cli_child *child, struct cli_result *ret_result)
{
    int status = 0;

    assert_int_equal(waitpid(child->pid, &status, 0), child->pid);
    ret_result->exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    read_back(child->out_fd, ret_result->out);
    read_back(child->err_fd, ret_result->err);
}

void cli_run(const char *const *args, struct cli_result *ret_result)
{
    struct cli_child child = cli_start(args);

    cli_finish(&child, ret_result);
}

void cli_run_merged(const char *const *args, struct cli_result *ret_result)
{
    const int log = temporary_file(), again = fcntl(log, F_DUPFD_CLOEXEC, 0);
    assert_true(again >= 0);
    struct cli_child child = start("oriel", args, log, again);

    cli_finish(&child, ret_result);
}

void cli_make_folder(char *path)
{
    strcpy(path, "/tmp/oriel-cli-XXXXXX");
    assert_non_null(mkdtemp(path));
}

static int remove_entry(const char *path, const struct stat *info, int type, struct FTW *where)
{
    (void)info, (void)type, (void)where;
    return remove(path);
}

void cli_remove_folder(const char *path)
{
    nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

void cli_write_file(const char *folder, const char *name, const char *text)
{
    char path[1024];
    FILE *file;

    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fputs(text, file) < 0, 0);
    assert_int_equal(fclose(file), 0);
}

char *cli_read_file(const char *folder, const char *name)
{
    char path[1024], *text;
    FILE *file;
    size_t length;

    snprintf(path, sizeof path, "%s/%s", folder, name);
    file = fopen(path, "rb");
    if (!file)
        return NULL;
    text = calloc(1, 1 << 20);
    assert_non_null(text);
    length = fread(text, 1, (1 << 20) - 1, file);
    text[length] = '\0';
    fclose(file);
    return text;
}

int cli_desk_set_up(void **state, const struct cli_file *files)
{
    struct cli_desk *desk = calloc(1, sizeof *desk);
    assert_non_null(desk);
    cli_make_folder(desk->folder);
    snprintf(desk->document, sizeof desk->document, "%s/%s", desk->folder, files->name);
    snprintf(desk->output, sizeof desk->output, "%s/out", desk->folder);
    for (; files->name; files++)
        cli_write_file(desk->folder, files->name, files->text);
    *state = desk;
    return 0;
}

int cli_desk_tear_down(void **state)
{
    struct cli_desk *desk = *state;
    cli_remove_folder(desk->folder);
    free(desk);
    return 0;
}
