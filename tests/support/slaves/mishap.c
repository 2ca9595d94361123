/* An FMI 2.0 slave that counts time, and at the time `at` crashes, aborts, hangs, exits, babbles or
 * logs without end, as `kind` says. With -DON_LOAD it crashes while it is loaded. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING };
enum { U, Y, AT, KIND };
enum { NONE, CRASH, ABORT, HANG, EXIT, BABBLE, ENDLESS, LOG };

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
