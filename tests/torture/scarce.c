/*
 * Makes allocations fail if faulty.c, loaded beside it, returns that one is due. It is separate
 * from faulty.c because nothing may replace malloc under sanitizers.
 */
#include <errno.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

enum { FAULTY_MEMORY = 8 };
extern int faulty_is_due(int what);

/* The C library's allocator, under names that need no look-up, which would allocate. */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t boundary, size_t size);

void *malloc(size_t size)
{
    return faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    return faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_realloc(old, size);
}

void *aligned_alloc(size_t boundary, size_t size)
{
    return faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_memalign(boundary, size);
}

void *memalign(size_t boundary, size_t size);
void *memalign(size_t boundary, size_t size)
{
    return faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_memalign(boundary, size);
}

int posix_memalign(void **ret_memory, size_t boundary, size_t size)
{
    void *memory = faulty_is_due(FAULTY_MEMORY) ? NULL : __libc_memalign(boundary, size);
    if (!memory)
        return ENOMEM;
    *ret_memory = memory;
    return 0;
}

void *mmap(void *at, size_t size, int protection, int flags, int fd, off_t offset)
{
    return faulty_is_due(FAULTY_MEMORY)
               ? MAP_FAILED
               : (void *)syscall(SYS_mmap, at, size, protection, flags, fd, offset);
}

void *mmap64(void *at, size_t size, int protection, int flags, int fd, off64_t offset)
{
    return mmap(at, size, protection, flags, fd, offset);
}
