/* An FMI 2.0 slave with bad or rare manners, of which -DMANNER=... chooses one. It takes u, gives
 * y = the sum of all u * h so far and now = u, and has a local variable twice = 2 y. The parameter
 * `at` says from which time on the manner shows, in a step; `answer` is a number for it. */
#define _GNU_SOURCE
#include <fenv.h>
#include <locale.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { U, Y, NOW, TWICE, AT, ANSWER, TOLERANCE, COUNT };
#define NONE 0
#define STATUS 1
#define LEAVE 2
#define CHANGE 3
#define END 4
#define LATE 5
#define DEAF 6
#define WRITE_ONLY 7
#define NO_LOG 8
#define NO_INSTANCE 9
#define BAD_START 10
#define BAD_READ 11
#define LOAD 12
#ifndef MANNER
#define MANNER NONE
#endif

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    double value[COUNT], time;
    int set, stepping, ended;
} Slave;

#if MANNER == LOAD
__attribute__((constructor)) static void load(void) { exit(0); }
#endif

static void misbehave(Slave *s, double end) {
    (void)s, (void)end;
#if MANNER == LEAVE
    exit((int)s->value[ANSWER]);
#elif MANNER == CHANGE
    fesetround(FE_UPWARD);
    setlocale(LC_ALL, "C");
    signal(SIGTERM, SIG_IGN);
    if (chdir("/")) return;
    umask(0);
#endif
}

EXPORT int fmi2DoStep(void *c, double time, double h, int no_return) {
    Slave *s = c;
    (void)no_return;
    double end = time + h;
    int due = end > s->value[AT] + 0.5 * h;
    s->set = 0, s->stepping = 1;
    if (due) misbehave(s, end);
    s->value[Y] += h * s->value[U];
    s->time = end;
    if (due && MANNER == STATUS) return (int)s->value[ANSWER];
    if (due && MANNER == END) return s->ended = 1, DISCARD;
    return OK;
}

EXPORT int fmi2SetReal(void *c, const uint32_t *r, size_t n, const double *v) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) s->value[r[i]] = v[i];
    s->set = 1;
    return MANNER == DEAF ? (int)s->value[ANSWER] : OK;
}

EXPORT int fmi2GetReal(void *c, const uint32_t *r, size_t n, double *v) {
    Slave *s = c;
    if (MANNER == BAD_READ) return (int)s->value[ANSWER];
    if (MANNER == LATE && s->stepping && s->set) return ERROR;
    s->value[NOW] = s->value[U], s->value[TWICE] = 2.0 * s->value[Y];
    for (size_t i = 0; i < n; i++) {
        if (MANNER == WRITE_ONLY && r[i] == U) return ERROR;
        v[i] = s->value[r[i]];
    }
    return OK;
}

EXPORT int fmi2SetupExperiment(void *c, int defined, double tolerance, double start, int stops, double stop) {
    Slave *s = c;
    (void)stops, (void)stop;
    s->time = start;
    s->value[TOLERANCE] = defined ? tolerance : -1.0;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *c) {
    return MANNER == BAD_START ? (int)((Slave *)c)->value[ANSWER] : OK;
}

EXPORT int fmi2ExitInitializationMode(void *c) {
    Slave *s = c;
    return s->stepping = 1, s->set = 0, OK;
}

EXPORT int fmi2GetBooleanStatus(void *c, int kind, int *value) {
    return *value = kind == 3 && ((Slave *)c)->ended, OK;
}

EXPORT int fmi2GetRealStatus(void *c, int kind, double *value) {
    return *value = kind == 2 ? ((Slave *)c)->time : 0.0, OK;
}

EXPORT int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *categories) {
    (void)c, (void)on, (void)n, (void)categories;
    return MANNER == NO_LOG ? ERROR : OK;
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    if (MANNER == NO_INSTANCE) return NULL;
    Slave *s = calloc(1, sizeof(Slave));
    s->value[AT] = 1e9, s->value[U] = 1.0;
    return s;
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
#define ACCEPTED(name) \
    EXPORT int name(void) { return OK; }
#define REFUSED(name) \
    EXPORT int name(void) { return ERROR; }
ACCEPTED(fmi2Terminate) ACCEPTED(fmi2Reset)
REFUSED(fmi2SetRealInputDerivatives) REFUSED(fmi2GetDirectionalDerivative)
REFUSED(fmi2GetInteger) REFUSED(fmi2SetInteger) REFUSED(fmi2GetBoolean) REFUSED(fmi2SetBoolean)
REFUSED(fmi2GetString) REFUSED(fmi2SetString)
REFUSED(fmi2GetFMUstate) REFUSED(fmi2SetFMUstate) REFUSED(fmi2FreeFMUstate)
REFUSED(fmi2SerializedFMUstateSize) REFUSED(fmi2SerializeFMUstate) REFUSED(fmi2DeSerializeFMUstate)
REFUSED(fmi2CancelStep) REFUSED(fmi2GetRealOutputDerivatives) REFUSED(fmi2GetStatus)
REFUSED(fmi2GetIntegerStatus) REFUSED(fmi2GetStringStatus)
