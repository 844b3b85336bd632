#include "health/modules.h"

#include <link.h>
#include <stdio.h>
#include <string.h>

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

void orl_modules_list(void)
{
    n_modules = 0;
    dl_iterate_phdr(add_module, NULL);
}

const char *orl_module_of(uintptr_t address, uintptr_t *ret_offset)
{
    for (int i = 0; i < n_modules; i++) {
        if (address < modules[i].begin || address >= modules[i].end)
            continue;
        *ret_offset = address - modules[i].base;
        return modules[i].name;
    }
    return NULL;
}
