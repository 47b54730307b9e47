/* What code of a library can do to the process that it runs in, by name. */
#include <dlfcn.h>
#include <fenv.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <ucontext.h>
#include <unistd.h>
#include <unwind.h>

/* Of C11, which the headers of C99 leave out. */
extern void quick_exit(int status);
/* Of the C library alone. */
extern int daemon(int keeps_folder, int keeps_descriptors);

static void take(int number) { (void)number; }

static void block_signals(void) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, NULL);
}

/* Signals that nobody handles, as many as there are, which come all at once. */
static void send_many(void) {
    sigset_t all, before;
    int number;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    for (number = SIGRTMIN; number <= SIGRTMAX; number++) {
        raise(number);
    }
    raise(SIGUSR1);
    raise(SIGPROF);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static void *alarm_later(void *nothing) {
    alarm(1);
    return nothing;
}

/* Of the C library: what `thread_local` of C++ and `thread_local!` of Rust call. */
extern int __cxa_thread_atexit_impl(void (*destructor)(void *), void *of, void *library);

static volatile int *volatile no_address = NULL;

static void exit_of(void *of) {
    (void)of;
    exit(0);
}

static void crash_of(void *of) {
    (void)of;
    *no_address = 1;
}

/* Has it called at the end of the present thread, by the destructor of a key. */
static void at_key(void (*destructor)(void *)) {
    pthread_key_t key;
    if (pthread_key_create(&key, destructor) == 0) {
        pthread_setspecific(key, &key);
    }
}

static void limit(int resource) {
    struct rlimit none;
    getrlimit(resource, &none);
    none.rlim_cur = 0;
    setrlimit(resource, &none);
}

/* Where code of this library jumps to: from another call of it, and within one. */
static jmp_buf earlier, within;

/* A part of the library with a stack of its own, which each call continues, as coroutines do. */
static jmp_buf part, rest;
static ucontext_t beginner, begun;

static void run_part(void) {
    if (setjmp(part) == 0) {
        swapcontext(&begun, &beginner);
    }
    fprintf(stderr, "the part with its own stack continues\n");
    longjmp(rest, 1);
}

static void begin_part(void) {
    static char stack[1 << 16];
    getcontext(&begun);
    begun.uc_stack.ss_sp = stack;
    begun.uc_stack.ss_size = sizeof stack;
    makecontext(&begun, run_part, 0);
    swapcontext(&beginner, &begun);
}

static void continue_part(void) {
    if (setjmp(rest) == 0) {
        longjmp(part, 1);
    }
}

static void jump_within(void) {
    if (setjmp(within) == 0) {
        longjmp(within, 1);
    }
    fprintf(stderr, "has jumped within its call\n");
}

/* Does it, if it is one of these. */
static void act_on_process(const char *does) {
    if (strcmp(does, "hangs") == 0) {
        for (;;) {
            sleep(1);
        }
    } else if (strcmp(does, "crashes") == 0) {
        raise(SIGSEGV);
    } else if (strcmp(does, "rounds up") == 0) {
        fesetround(FE_UPWARD);
    } else if (strcmp(does, "prints") == 0) {
        printf("printed by a library\n");
    } else if (strcmp(does, "aborts") == 0) {
        abort();
    } else if (strcmp(does, "throws") == 0) {
        /* What `throw` in C++ does. */
        static struct _Unwind_Exception thrown;
        memcpy(&thrown.exception_class, "GNUCC++", 8);
        _Unwind_RaiseException(&thrown);
        abort();
    } else if (strcmp(does, "exit") == 0) {
        exit(0);
    } else if (strcmp(does, "local exits") == 0) {
        __cxa_thread_atexit_impl(exit_of, NULL, NULL);
    } else if (strcmp(does, "local crashes") == 0) {
        __cxa_thread_atexit_impl(crash_of, NULL, NULL);
    } else if (strcmp(does, "key exits") == 0) {
        at_key(exit_of);
    } else if (strcmp(does, "key crashes") == 0) {
        at_key(crash_of);
    } else if (strcmp(does, "limits memory") == 0) {
        limit(RLIMIT_AS);
        limit(RLIMIT_DATA);
    } else if (strcmp(does, "limits descriptors") == 0) {
        limit(RLIMIT_NOFILE);
    } else if (strcmp(does, "limits files") == 0) {
        limit(RLIMIT_FSIZE);
    } else if (strcmp(does, "closes itself") == 0) {
        Dl_info self;
        void *handle = dladdr((void *)limit, &self) == 0 ? NULL : dlopen(self.dli_fname, RTLD_NOW);
        int count;
        for (count = 0; handle != NULL && count < 10; count++) {
            dlclose(handle);
        }
    } else if (strcmp(does, "frees twice") == 0) {
        char *volatile memory = malloc(24);
        free(memory);
        free(memory);
    } else if (strcmp(does, "_exit") == 0) {
        _exit(0);
    } else if (strcmp(does, "_Exit") == 0) {
        _Exit(0);
    } else if (strcmp(does, "quick_exit") == 0) {
        quick_exit(0);
    } else if (strcmp(does, "daemon") == 0) {
        if (daemon(1, 1) != 0) {
            abort();
        }
    } else if (strcmp(does, "fork") == 0) {
        pid_t child = fork();
        if (child > 0) {
            int status = -1;
            waitpid(child, &status, 0);
            fprintf(stderr, "the child has ended with %d\n", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
        }
    } else if (strcmp(does, "fork and exec") == 0) {
        int status = -1;
        pid_t child = fork();
        if (child == 0) {
            execl("/nowhere/at/all", "all", (char *)NULL);
            _exit(7);
        }
        waitpid(child, &status, 0);
        fprintf(stderr, "the child has ended with %d\n", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
    } else if (strcmp(does, "SIGUSR1") == 0) {
        raise(SIGUSR1);
    } else if (strcmp(does, "many signals") == 0) {
        send_many();
    } else if (strcmp(does, "SIGQUIT") == 0) {
        raise(SIGQUIT);
    } else if (strcmp(does, "SIGTSTP") == 0) {
        raise(SIGTSTP);
    } else if (strcmp(does, "SIGXCPU") == 0) {
        raise(SIGXCPU);
    } else if (strcmp(does, "SIGTERM") == 0) {
        raise(SIGTERM);
    } else if (strcmp(does, "SIGINT to all") == 0) {
        kill(getpid(), SIGINT);
        sleep(1);
    } else if (strcmp(does, "forbids files") == 0) {
        umask(0777);
    } else if (strcmp(does, "SIGRTMAX") == 0) {
        raise(SIGRTMAX);
    } else if (strcmp(does, "cancels its thread") == 0) {
        pthread_cancel(pthread_self());
        sleep(1);
    } else if (strcmp(does, "SIGUSR2 to all") == 0) {
        kill(getpid(), SIGUSR2);
    } else if (strcmp(does, "alarm") == 0) {
        pthread_t thread;
        pthread_create(&thread, NULL, alarm_later, NULL);
        pthread_join(thread, NULL);
        sleep(2);
    } else if (strcmp(does, "closes 1") == 0) {
        close(1);
    } else if (strcmp(does, "closes 2") == 0) {
        close(2);
    } else if (strcmp(does, "closes others") == 0 || strcmp(does, "closes all") == 0) {
        int descriptor;
        for (descriptor = strcmp(does, "closes all") == 0 ? 0 : 3; descriptor < 1024; descriptor++) {
            close(descriptor);
        }
    } else if (strcmp(does, "blocks signals") == 0) {
        block_signals();
    } else if (strcmp(does, "takes SIGSEGV") == 0) {
        signal(SIGSEGV, take);
    } else if (strcmp(does, "resets SIGSEGV") == 0) {
        signal(SIGSEGV, SIG_DFL);
    } else if (strcmp(does, "resets SIGPIPE") == 0) {
        signal(SIGPIPE, SIG_DFL);
    } else if (strcmp(does, "ignores SIGCHLD") == 0) {
        signal(SIGCHLD, SIG_IGN);
    } else if (strcmp(does, "takes SIGINT") == 0) {
        signal(SIGINT, SIG_IGN);
    } else if (strcmp(does, "aborts later") == 0) {
        kill(getpid(), SIGABRT);
        sleep(1);
    } else if (strcmp(does, "marks a place") == 0) {
        if (setjmp(earlier) != 0) {
            fprintf(stderr, "is in a call that has returned\n");
        }
    } else if (strcmp(does, "jumps to an earlier call") == 0) {
        longjmp(earlier, 1);
    } else if (strcmp(does, "jumps within its call") == 0) {
        jump_within();
    } else if (strcmp(does, "begins a part") == 0) {
        begin_part();
    } else if (strcmp(does, "continues a part") == 0) {
        continue_part();
    } else if (strcmp(does, "ends its thread") == 0) {
        pthread_exit(NULL);
    }
}
