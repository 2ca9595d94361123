/* Two FMI 2.0 slaves for the tests: a mass that takes the tangent of its force (-DMASS), or a
 * damper without states that gives derivatives. Both log what they refuse. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { VARIABLES = 8 };
#ifdef MASS
enum { FORCE, FORCE_PER_V, X, V, M, START_V, TIME_OF_FAILURE, COUNT };
#define INPUTS 2
#else
enum { SPEED, OUT, C, KIND, LOCKED };
#define INPUTS 1
#endif

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *rest[4];
} Callbacks;

typedef struct {
    double value[VARIABLES], rate[INPUTS];
    int whole[VARIABLES];
    Callbacks callbacks;
    char name[64];
} Slave;

static int refuse(Slave *s, const char *format, double value) {
    s->callbacks.logger(s->callbacks.rest[3], s->name, ERROR, "logStatusError", format, value);
    return ERROR;
}

static void evaluate(Slave *s) {
#ifndef MASS
    s->value[OUT] = -s->value[C] * s->value[SPEED] * (s->whole[LOCKED] ? 1e3 : 1.0);
#endif
    (void)s;
}

EXPORT int fmi2SetReal(void *c, const uint32_t *r, size_t n, const double *v) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) s->value[r[i]] = v[i];
#ifdef MASS
    if (!(s->value[M] > 0.0)) return refuse(s, "mass m = %g kg is not positive", s->value[M]);
#endif
    evaluate(s);
    return OK;
}

EXPORT int fmi2GetReal(void *c, const uint32_t *r, size_t n, double *v) {
    for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->value[r[i]];
    return OK;
}

EXPORT int fmi2SetInteger(void *c, const uint32_t *r, size_t n, const int *v) {
    for (size_t i = 0; i < n; i++) ((Slave *)c)->whole[r[i]] = v[i];
    evaluate(c);
    return OK;
}

EXPORT int fmi2SetBoolean(void *c, const uint32_t *r, size_t n, const int *v) {
    return fmi2SetInteger(c, r, n, v);
}

EXPORT int fmi2SetRealInputDerivatives(void *c, const uint32_t *r, size_t n, const int *order, const double *v) {
    for (size_t i = 0; i < n; i++) {
        if (order[i] != 1) return ERROR;
        ((Slave *)c)->rate[r[i]] = v[i];
    }
    return OK;
}

EXPORT int fmi2GetDirectionalDerivative(void *c, const uint32_t *unknown, size_t n, const uint32_t *known,
                                        size_t m, const double *seed, double *result) {
#ifdef MASS
    (void)c, (void)unknown, (void)n, (void)known, (void)m, (void)seed, (void)result;
    return ERROR;
#else
    (void)unknown, (void)known;
    if (n != 1 || m != 1) return ERROR;
    result[0] = -((Slave *)c)->value[C] * seed[0];
    return OK;
#endif
}

EXPORT int fmi2DoStep(void *c, double time, double h, int no_return) {
    Slave *s = c;
    (void)no_return;
#ifdef MASS
    enum { MICRO_STEPS = 50 };
    if (time + h > s->value[TIME_OF_FAILURE]) return refuse(s, "out of rails after %g s", time);
    double start = s->value[V], d = h / MICRO_STEPS;
    for (int i = 0; i < MICRO_STEPS; i++) { /* midpoint rule, implicit in the tangent */
        double force = s->value[FORCE] + s->rate[FORCE] * (i + 0.5) * d;
        double slope = s->value[FORCE_PER_V] / s->value[M];
        double a = (force / s->value[M] + slope * (s->value[V] - start)) / (1.0 - 0.5 * slope * d);
        s->value[X] += d * s->value[V] + 0.5 * d * d * a;
        s->value[V] += d * a;
    }
#else
    (void)time;
#endif
    for (int i = 0; i < INPUTS; i++) s->value[i] += s->rate[i] * h, s->rate[i] = 0.0;
    evaluate(s);
    return OK;
}

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    (void)type, (void)resources, (void)visible, (void)logging;
    Slave *s = calloc(1, sizeof *s);
    strncpy(s->name, name, sizeof s->name - 1);
    s->callbacks = *callbacks;
    if (strcmp(guid, "slave")) {
        s->callbacks.logger(s->callbacks.rest[3], name, ERROR, "logStatusError", "unknown GUID %s", guid);
        free(s);
        return NULL;
    }
#ifdef MASS
    s->value[M] = 1.0;
    s->value[TIME_OF_FAILURE] = 1e9;
#endif
    return s;
}

EXPORT void fmi2FreeInstance(void *c) { free(c); }

EXPORT int fmi2EnterInitializationMode(void *c) {
#ifdef MASS
    ((Slave *)c)->value[V] = ((Slave *)c)->value[START_V];
#endif
    evaluate(c);
    return OK;
}

EXPORT int fmi2ExitInitializationMode(void *c) {
#ifndef MASS
    if (((Slave *)c)->whole[KIND] == 2) return refuse(c, "a damper of kind %g is not made yet", 2.0);
#endif
    (void)c;
    return OK;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
#define ACCEPTED(name) \
    EXPORT int name(void) { return OK; }
#define REFUSED(name) \
    EXPORT int name(void) { return ERROR; }
ACCEPTED(fmi2SetDebugLogging) ACCEPTED(fmi2SetupExperiment) ACCEPTED(fmi2Terminate) ACCEPTED(fmi2Reset)
REFUSED(fmi2GetInteger) REFUSED(fmi2GetBoolean) REFUSED(fmi2GetString) REFUSED(fmi2SetString)
REFUSED(fmi2GetFMUstate) REFUSED(fmi2SetFMUstate) REFUSED(fmi2FreeFMUstate)
REFUSED(fmi2SerializedFMUstateSize) REFUSED(fmi2SerializeFMUstate) REFUSED(fmi2DeSerializeFMUstate)
REFUSED(fmi2CancelStep) REFUSED(fmi2GetRealOutputDerivatives) REFUSED(fmi2GetStatus)
REFUSED(fmi2GetRealStatus) REFUSED(fmi2GetIntegerStatus) REFUSED(fmi2GetBooleanStatus)
REFUSED(fmi2GetStringStatus)
