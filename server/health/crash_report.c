#include "health/crash.h"

#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <stdio.h>
#include <string.h>
#include <ucontext.h>
#include <unistd.h>

/* ---- Modules --------------------------------------------------------------------------------- */

/*
 * The modules are the program and its libraries. Fault handlers look code addresses up in them, and
 * may call almost no functions. Threads: list once, before any handler may run; look up from any.
 */

enum { MOST = 128 };

static struct module {
    char name[32];
    uintptr_t base, begin, end; /* base: origin of offsets; begin, end: range of its code */
} modules[MOST];
static int n_modules;

/* Adds a module to the list. The program itself has an empty name there. */
static int add_module(struct dl_phdr_info *info, size_t size, void *unused)
{
    const char *slash = strrchr(info->dlpi_name, '/');
    const char *name = info->dlpi_name[0] ? info->dlpi_name : "orield";
    (void)size, (void)unused;
    for (int i = 0; i < info->dlpi_phnum && n_modules < MOST; i++) {
        const ElfW(Phdr) *const part = &info->dlpi_phdr[i];
        if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
            continue;
        struct module *const m = &modules[n_modules++];
        snprintf(m->name, sizeof m->name, "%s", slash ? slash + 1 : name);
        m->base = info->dlpi_addr;
        m->begin = info->dlpi_addr + part->p_vaddr;
        m->end = m->begin + part->p_memsz;
    }
    return 0;
}

/* Lists the modules loaded now. Modules loaded later are not known. */
static void list_modules(void)
{
    n_modules = 0;
    dl_iterate_phdr(add_module, NULL);
}

/* Returns the module's name (borrowed); *ret_offset is the address as an offset into it, as
 * addr2line takes it. NULL: the address is in no module. */
static const char *module_of(uintptr_t address, uintptr_t *ret_offset)
{
    for (int i = 0; i < n_modules; i++) {
        if (address < modules[i].begin || address >= modules[i].end)
            continue;
        *ret_offset = address - modules[i].base;
        return modules[i].name;
    }
    return NULL;
}

/* ---- The report ------------------------------------------------------------------------------ */

enum { MOST_FRAMES = 24, LINE_MAX_BYTES = 1024 };

static bool lines_are_json;
static int probe[2] = {-1, -1}; /* a pipe: write() to it fails for unreadable addresses */

static _Thread_local struct {
    uint64_t id;
    const char *method, *path; /* NULL: no request */
} current;

void orl_crash_request_begin(uint64_t id, const char *method, const char *path)
{
    current.id = id;
    current.method = method;
    current.path = path;
}

void orl_crash_request_end(void)
{
    current.method = current.path = NULL;
}

/* ---- Lines, without the C library's formatted output ---------------------------------------- */

struct line {
    char text[LINE_MAX_BYTES];
    size_t used;
};

static void add_char(struct line *line, char c)
{
    if (line->used + 4 < sizeof line->text) /* leaves space for the end of the line */
        line->text[line->used++] = c;
}

static void add_text(struct line *line, const char *text)
{
    while (*text)
        add_char(line, *text++);
}

/* Adds text from a client. Characters that could end a value or a line become question marks. */
static void add_foreign(struct line *line, const char *text)
{
    for (; *text; text++)
        add_char(line, *text > ' ' && *text < 127 && *text != '"' && *text != '\\' ? *text : '?');
}

static void add_number(struct line *line, uint64_t value, unsigned base)
{
    char digits[24];
    size_t n = 0;
    do
        digits[n++] = "0123456789abcdef"[value % base];
    while ((value /= base) > 0);
    while (n > 0)
        add_char(line, digits[--n]);
}

static void add_hex(struct line *line, uint64_t value)
{
    add_text(line, "0x");
    add_number(line, value, 16);
}

/* Adds a code address as a module and an offset into it. */
static void add_code(struct line *line, uintptr_t address)
{
    uintptr_t offset = address;
    const char *module = module_of(address, &offset);
    add_text(line, module ? module : "?");
    add_char(line, '+');
    add_hex(line, offset);
}

static void begin_line(struct line *line, const char *event)
{
    line->used = 0;
    add_text(line, lines_are_json ? "{\"level\":\"error\",\"event\":\"" : "level=error event=");
    add_text(line, event);
    if (lines_are_json)
        add_char(line, '"');
}

static void begin_pair(struct line *line, const char *key)
{
    add_text(line, lines_are_json ? ",\"" : " ");
    add_text(line, key);
    add_text(line, lines_are_json ? "\":" : "=");
}

static void add_quote(struct line *line)
{
    if (lines_are_json)
        add_char(line, '"');
}

static void add_number_pair(struct line *line, const char *key, uint64_t value)
{
    begin_pair(line, key);
    add_number(line, value, 10);
}

static void add_hex_pair(struct line *line, const char *key, uint64_t value)
{
    begin_pair(line, key);
    add_quote(line);
    add_hex(line, value);
    add_quote(line);
}

static void add_text_pair(struct line *line, const char *key, const char *value)
{
    begin_pair(line, key);
    add_quote(line);
    add_foreign(line, value);
    add_quote(line);
}

static void end_line(struct line *line)
{
    if (lines_are_json)
        line->text[line->used++] = '}';
    line->text[line->used++] = '\n';
    if (write(STDERR_FILENO, line->text, line->used) < 0)
        return;
}

/* ---- The report ----------------------------------------------------------------------------- */

static void write_request(void)
{
    struct line line;
    if (!current.method)
        return;
    begin_line(&line, "crashed-request");
    add_number_pair(&line, "id", current.id);
    add_text_pair(&line, "method", current.method);
    add_text_pair(&line, "path", current.path);
    end_line(&line);
}

struct registers {
    uintptr_t pc, sp, link; /* link: where the return address is kept in a register; else 0 */
    bool known;
};

static struct registers read_registers(const void *context)
{
    struct registers registers = {0};
    const ucontext_t *at = context;
#if defined(__x86_64__)
    if (at)
        registers = (struct registers){.pc = (uintptr_t)at->uc_mcontext.gregs[REG_RIP],
                                       .sp = (uintptr_t)at->uc_mcontext.gregs[REG_RSP],
                                       .known = true};
#elif defined(__aarch64__)
    if (at)
        registers = (struct registers){.pc = at->uc_mcontext.pc,
                                       .sp = at->uc_mcontext.sp,
                                       .link = at->uc_mcontext.regs[30],
                                       .known = true};
#else
    (void)at;
#endif
    return registers;
}

/* Reads a word of memory. Returns false if the address is not readable. */
static bool read_word(uintptr_t address, uintptr_t *ret_word)
{
    return probe[1] >= 0 &&
           write(probe[1], (const void *)address, sizeof *ret_word) == sizeof *ret_word &&
           read(probe[0], ret_word, sizeof *ret_word) == sizeof *ret_word;
}

/* Returns the return address of a call that has left all modules; 0: unknown. */
static uintptr_t find_return_address(const struct registers *registers)
{
    uintptr_t offset, word = 0;
    if (!registers->known || module_of(registers->pc, &offset))
        return 0;
    if (registers->link)
        return registers->link;
    return read_word(registers->sp, &word) ? word : 0;
}

static void write_registers(const struct orl_crash *crash)
{
    const struct registers registers = read_registers(crash->context);
    const uintptr_t caller = find_return_address(&registers);
    struct line line;
    if (!registers.known || !crash->info)
        return;
    begin_line(&line, "crashed-registers");
    begin_pair(&line, "code");
    if (crash->info->si_code < 0)
        add_char(&line, '-');
    add_number(&line,
               (uint64_t)(crash->info->si_code < 0 ? -(int64_t)crash->info->si_code
                                                   : crash->info->si_code),
               10);
    if (crash->info->si_code > 0) /* sent by the kernel for a fault of this thread */
        add_hex_pair(&line, "address", (uintptr_t)crash->info->si_addr);
    add_hex_pair(&line, "pc", registers.pc);
    add_hex_pair(&line, "sp", registers.sp);
    if (caller) {
        begin_pair(&line, "caller");
        add_quote(&line);
        add_code(&line, caller);
        add_quote(&line);
    }
    end_line(&line);
}

static void write_frames(void)
{
    void *frames[MOST_FRAMES];
    struct line line;
    const int n = backtrace(frames, MOST_FRAMES);
    begin_line(&line, "crashed-at");
    begin_pair(&line, "frames");
    add_quote(&line);
    for (int i = 0; i < n; i++) {
        if (i > 0)
            add_char(&line, ',');
        add_code(&line, (uintptr_t)frames[i]);
    }
    add_quote(&line);
    end_line(&line);
}

void orl_crash_report_line(const char *event, int signum, const char *job)
{
    struct line line;
    begin_line(&line, event);
    add_number_pair(&line, "signal", (uint64_t)signum);
    add_text_pair(&line, "job", job[0] ? job : "-");
    end_line(&line);
}

void orl_crash_report_write(const struct orl_crash *crash)
{
    orl_crash_report_line("crashed", crash->signum, crash->job);
    write_request();
    write_registers(crash);
    write_frames();
}

void orl_crash_report_open(bool json)
{
    void *frame;
    lines_are_json = json;
    if (probe[0] < 0 && pipe2(probe, O_CLOEXEC | O_NONBLOCK) != 0)
        probe[0] = probe[1] = -1;
    backtrace(&frame, 1); /* loads the unwinder now, since a handler must not */
    list_modules();
}
