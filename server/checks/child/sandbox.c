#include "checks/child/child_checks.h"
#include "process/limits.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define FILTER_ARCH AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define FILTER_ARCH AUDIT_ARCH_AARCH64
#endif

/* Allowed system calls: memory, threads, the socket, open files, and time. */
#ifdef FILTER_ARCH
static const unsigned allowed[] = {
    __NR_read,
    __NR_readv,
    __NR_write,
    __NR_writev,
    __NR_close,
    __NR_lseek,
    __NR_fstat,
    __NR_recvfrom,
    __NR_recvmsg,
    __NR_sendto,
    __NR_sendmsg,
    __NR_mmap,
    __NR_munmap,
    __NR_mprotect,
    __NR_mremap,
    __NR_madvise,
    __NR_brk,
    __NR_futex,
    __NR_set_robust_list,
#ifdef __NR_rseq
    __NR_rseq,
#endif
    __NR_sched_yield,
    __NR_sched_getaffinity,
    __NR_getpid,
    __NR_gettid,
    __NR_getrandom,
    __NR_clock_gettime,
    __NR_clock_nanosleep,
    __NR_nanosleep,
    __NR_rt_sigaction,
    __NR_rt_sigprocmask,
    __NR_rt_sigreturn,
    __NR_sigaltstack,
    __NR_tgkill,
    __NR_restart_syscall,
    __NR_exit,
    __NR_exit_group,
};

enum { ALLOWED = sizeof allowed / sizeof *allowed };

/*
 * All other calls fail with EPERM, so that libraries do without optional features. Threads are
 * allowed, processes are not. Only the arguments of clone tell them apart, so clone3 is not
 * allowed.
 */
static int filter_calls(void)
{
    struct sock_filter filter[ALLOWED + 16];
    size_t n = 0;
    filter[n++] =
        (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, arch));
    filter[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, FILTER_ARCH, 1, 0);
    filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS);
    filter[n++] =
        (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
#ifdef __NR_clone3
    filter[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clone3, 0, 1);
    filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
#endif
    for (size_t i = 0; i < ALLOWED; i++) {
        const unsigned char to_end = (unsigned char)(ALLOWED - i + 3);
        filter[n++] =
            (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, allowed[i], to_end, 0);
    }
    filter[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, __NR_clone, 0, 2);
    filter[n++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS,
                                               offsetof(struct seccomp_data, args[0]));
    filter[n++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0);
    filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
    filter[n++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const struct sock_fprog program = {.len = (unsigned short)n, .filter = filter};
    return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0);
}
#else
static int filter_calls(void)
{
    return 0;
}
#endif

/* Lowers a resource limit to `most`; never raises it. */
static int lower_limit(__rlimit_resource_t resource, uint64_t most)
{
    struct rlimit limit;
    if (getrlimit(resource, &limit) != 0)
        return -1;
    if (limit.rlim_max == RLIM_INFINITY || limit.rlim_max > most)
        limit.rlim_max = (rlim_t)most;
    limit.rlim_cur = limit.rlim_max;
    return setrlimit(resource, &limit);
}

/* Makes the process the kernel's first choice when memory runs out. Without /proc the kernel
 * chooses by size alone. */
static void prefer_oom_kill(void)
{
    const int fd = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (fd < 0)
        return;
    if (write(fd, "1000", 4) < 0)
        errno = 0;
    close(fd);
}

/* Bytes that Embree maps but does not touch, and a thread's stack. */
#define RESERVED (144UL << 20)

int orl_sandbox_enter(const struct orl_sandbox_limits *bounds, struct orl_error *err)
{
    enum { FILES = 64 };
    prefer_oom_kill();
    /* SIGXCPU comes at cpu_s; SIGKILL, which cannot be caught, one second later. */
    const struct rlimit cpu = {bounds->cpu_s, (rlim_t)bounds->cpu_s + 1};
    int rc = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    rc = rc ? rc : lower_limit(RLIMIT_CORE, 0);
    rc = rc ? rc : lower_limit(RLIMIT_FSIZE, 0);
    rc = rc ? rc : lower_limit(RLIMIT_NOFILE, FILES);
    rc = rc ? rc : setrlimit(RLIMIT_CPU, &cpu);
    if (rc == 0 && !ORL_SANITIZED)
        rc = lower_limit(RLIMIT_DATA, bounds->memory + RESERVED);
    if (rc == 0 && !ORL_SANITIZED)
        rc = filter_calls();
    return rc ? orl_error_set(err, ORL_ERR_INTERNAL, "cannot set up the sandbox of a check: %s",
                              strerror(errno))
              : 0;
}
