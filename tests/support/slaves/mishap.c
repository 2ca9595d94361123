/* An FMI 2.0 slave that counts time, and at the time `at` crashes, aborts, hangs, exits, babbles or
 * logs without end, as `kind` says. With -DON_LOAD it crashes while it is loaded, with -DHANG_ON_LOAD
 * it stays there, with -DFORK_ON_LOAD it leaves a process behind, whose number is written to the file
 * that the environment's MISHAP names. */
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING };
enum { U, Y, AT, KIND };
enum { NONE, CRASH, ABORT, HANG, EXIT, BABBLE, ENDLESS, LOG, ESCAPE, GARBAGE };

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *rest[4];
} Callbacks;

typedef struct {
    double value[4];
    Callbacks callbacks;
    char name[64];
} Slave;

static volatile int sink, *nowhere;

#ifdef ON_LOAD
__attribute__((constructor)) static void load(void) { printf("no way in\n"), *nowhere = 1; }
#endif

#ifdef HANG_ON_LOAD
__attribute__((constructor)) static void load(void) { for (;;) sink++; }
#endif

#ifdef FORK_ON_LOAD
__attribute__((constructor)) static void load(void) {
    int child = fork();
    if (!child) for (;;) pause();
    FILE *file = fopen(getenv("MISHAP"), "w");
    fprintf(file, "%d\n", child), fclose(file);
}
#endif

/* Writes what is no message to every pipe that is open. */
static void litter(void) {
    static const char garbage[] = "\xff{garbage\n{}\n[1]\n{\"status\": 99, \"text\": 1, \"time\": []}\n";
    struct stat found;
    for (int fd = 3; fd < 256; fd++)
        if (!fstat(fd, &found) && S_ISFIFO(found.st_mode) && (fcntl(fd, F_GETFL) & O_ACCMODE) == O_WRONLY)
            write(fd, garbage, sizeof garbage - 1);
}

EXPORT int fmi2DoStep(void *c, double time, double h, int no_return) {
    Slave *s = c;
    (void)no_return;
    int due = time + 0.5 * h > s->value[AT];
    switch (due ? (int)s->value[KIND] : NONE) {
    case CRASH: printf("last words\n"); *nowhere = 1; break;
    case ABORT: abort();
    case HANG: for (;;) sink++;
    case EXIT: exit(3);
    case BABBLE: for (int i = 0; i < 5000; i++) printf("%d bottles of beer\n", i); break;
    case ENDLESS: for (;;) printf("bottles of beer\n");
    case LOG:
        for (int i = 0; i < 3; i++)
            s->callbacks.logger(s->callbacks.rest[3], s->name, WARNING, "logStatusWarning", "warm");
        break;
    case ESCAPE:
        s->callbacks.logger(s->callbacks.rest[3], s->name, WARNING, "logStatusWarning",
                            "\x1b[31mred\x1b[0m\nnext");
        break;
    case GARBAGE: litter(); break;
    }
    s->value[Y] = time + h + s->value[U];
    return OK;
}

EXPORT int fmi2SetReal(void *c, const uint32_t *r, size_t n, const double *v) {
    for (size_t i = 0; i < n; i++) ((Slave *)c)->value[r[i]] = v[i];
    return OK;
}

EXPORT int fmi2GetReal(void *c, const uint32_t *r, size_t n, double *v) {
    for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->value[r[i]];
    return OK;
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Slave *s = calloc(1, sizeof *s);
    strncpy(s->name, name, sizeof s->name - 1);
    s->callbacks = *callbacks;
    return s;
}

EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
#define ACCEPTED(name) EXPORT int name(void) { return OK; }
ACCEPTED(fmi2SetDebugLogging) ACCEPTED(fmi2SetupExperiment) ACCEPTED(fmi2EnterInitializationMode)
ACCEPTED(fmi2ExitInitializationMode) ACCEPTED(fmi2Terminate) ACCEPTED(fmi2Reset)
ACCEPTED(fmi2GetInteger) ACCEPTED(fmi2GetBoolean) ACCEPTED(fmi2GetString) ACCEPTED(fmi2SetInteger)
ACCEPTED(fmi2SetBoolean) ACCEPTED(fmi2SetString) ACCEPTED(fmi2GetFMUstate)
ACCEPTED(fmi2SetFMUstate) ACCEPTED(fmi2FreeFMUstate) ACCEPTED(fmi2SerializedFMUstateSize)
ACCEPTED(fmi2SerializeFMUstate) ACCEPTED(fmi2DeSerializeFMUstate) ACCEPTED(fmi2CancelStep)
ACCEPTED(fmi2SetRealInputDerivatives) ACCEPTED(fmi2GetDirectionalDerivative)
ACCEPTED(fmi2GetRealOutputDerivatives) ACCEPTED(fmi2GetStatus) ACCEPTED(fmi2GetRealStatus)
ACCEPTED(fmi2GetIntegerStatus) ACCEPTED(fmi2GetBooleanStatus) ACCEPTED(fmi2GetStringStatus)
