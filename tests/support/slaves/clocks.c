/* An FMI 3.0 slave for the tests with clocks and bytes. `tick` ticks every 0.25 s: `count` counts it,
 * and `sampled` is the input `given` at its last tick, plus the time. Every third tick, `third` ticks.
 * `kick` is ticked by others, `kicks` counts it, and 0.125 s later `down` ticks, at whose last time
 * `when` is. What belongs to a clock is refused while that does not tick. It integrates 1 to `x`,
 * and at the time `event_at`, which it says beforehand, wants an event that adds 10 to it. The bytes
 * `blob_out` are those of `blob_in` in reverse order. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { X = 1, EVENT_AT, TICK = 10, COUNT, SAMPLED, GIVEN, THIRD = 20, KICK, KICKS, DOWN, WHEN,
       BLOB_IN = 30, BLOB_OUT, VARIABLES };
typedef void (*Log)(void *, int, const char *, const char *);

typedef struct {
    double real[VARIABLES], time, due;
    int32_t whole[VARIABLES];
    bool active[VARIABLES], in_event, stepping, counting, done;
    uint8_t in[64], out[64];
    size_t size;
    Log log;
    void *environment;
} Slave;

static int refuse(Slave *s, const char *why) {
    s->log(s->environment, ERROR, "logStatusError", why);
    return ERROR;
}

static uint32_t clock_of(uint32_t r) {
    return r == COUNT || r == SAMPLED || r == GIVEN ? TICK : r == KICKS ? KICK : r == WHEN ? DOWN : 0;
}

static int allowed(Slave *s, uint32_t r) {
    uint32_t clock = clock_of(r);
    return !clock || !s->stepping || (s->in_event && s->active[clock])
        ? OK : refuse(s, "a clocked variable while its clock does not tick");
}

static void evaluate(Slave *s) {
    if (s->active[TICK] && !s->done) {
        s->done = true;
        s->whole[COUNT]++;
        s->active[THIRD] = s->whole[COUNT] % 3 == 0;
    }
    if (s->active[TICK]) s->real[SAMPLED] = s->real[GIVEN] + s->time;
}

EXPORT int fmi3SetClock(void *c, const uint32_t *r, size_t n, const bool *v) {
    Slave *s = c;
    if (!s->in_event) return refuse(s, "a clock outside of event mode");
    for (size_t i = 0; i < n; i++) {
        s->active[r[i]] = v[i];
        if (r[i] == KICK) s->whole[KICKS]++, s->counting = true, s->due = s->time + 0.125;
        if (r[i] == DOWN && fabs(s->time - s->due) > 1e-9) return refuse(s, "not down yet");
        if (r[i] == DOWN) s->real[WHEN] = s->time;
        if (r[i] == TICK && fabs(remainder(s->time, 0.25)) > 1e-9) return refuse(s, "no time to tick");
    }
    return OK;
}

EXPORT int fmi3GetClock(void *c, const uint32_t *r, size_t n, bool *v) {
    Slave *s = c;
    if (!s->in_event) return refuse(s, "a clock is read outside of event mode");
    evaluate(s);
    for (size_t i = 0; i < n; i++) v[i] = s->active[r[i]];
    return OK;
}

EXPORT int fmi3GetIntervalDecimal(void *c, const uint32_t *r, size_t n, double *v, int *qualifier) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) {
        qualifier[i] = r[i] == TICK ? 2 : s->counting ? 2 : 1;
        v[i] = r[i] == TICK ? 0.25 : s->due - s->time;
        if (r[i] == DOWN) s->counting = false;
    }
    return OK;
}

EXPORT int fmi3GetShiftDecimal(void *c, const uint32_t *r, size_t n, double *v) {
    (void)c, (void)r;
    for (size_t i = 0; i < n; i++) v[i] = 0.0;
    return OK;
}

#define TYPE(name, ctype, member)                                                                   \
    EXPORT int fmi3Get##name(void *c, const uint32_t *r, size_t n, ctype *v, size_t size) {         \
        Slave *s = c;                                                                               \
        (void)size;                                                                                 \
        evaluate(s);                                                                                \
        for (size_t i = 0; i < n; i++) {                                                            \
            if (allowed(s, r[i])) return ERROR;                                                     \
            v[i] = s->member[r[i]];                                                                 \
        }                                                                                           \
        return OK;                                                                                  \
    }                                                                                               \
    EXPORT int fmi3Set##name(void *c, const uint32_t *r, size_t n, const ctype *v, size_t size) {   \
        Slave *s = c;                                                                               \
        (void)size;                                                                                 \
        for (size_t i = 0; i < n; i++) {                                                            \
            if (allowed(s, r[i])) return ERROR;                                                     \
            s->member[r[i]] = v[i];                                                                 \
        }                                                                                           \
        return OK;                                                                                  \
    }
TYPE(Float64, double, real)
TYPE(Int32, int32_t, whole)

EXPORT int fmi3SetBinary(void *c, const uint32_t *r, size_t n, const size_t *sizes, const uint8_t *const *v,
                         size_t count) {
    Slave *s = c;
    (void)r, (void)count;
    for (size_t i = 0; i < n; i++) {
        if (sizes[i] > sizeof s->in) return refuse(s, "too many bytes");
        s->size = sizes[i];
        memcpy(s->in, v[i], s->size);
    }
    return OK;
}

EXPORT int fmi3GetBinary(void *c, const uint32_t *r, size_t n, size_t *sizes, const uint8_t **v, size_t count) {
    Slave *s = c;
    (void)r, (void)count;
    for (size_t i = 0; i < s->size; i++) s->out[i] = s->in[s->size - 1 - i];
    for (size_t i = 0; i < n; i++) sizes[i] = s->size, v[i] = s->out;
    return OK;
}

EXPORT int fmi3DoStep(void *c, double time, double h, bool no_set, bool *event, bool *terminate, bool *early,
                      double *last) {
    Slave *s = c;
    (void)no_set;
    if (s->in_event) return refuse(s, "a step in event mode");
    if (h <= 0.0) return refuse(s, "a step of no length");
    if (fabs(time - s->time) > 1e-9) return refuse(s, "a step from another time");
    double at = s->real[EVENT_AT];
    if (time < at - 1e-9 && time + h > at + 1e-9) return refuse(s, "a step over its event");
    s->time = time + h;
    s->real[X] += h;
    *event = fabs(s->time - at) < 1e-9;
    *terminate = *early = false;
    *last = s->time;
    return OK;
}

EXPORT int fmi3EnterEventMode(void *c) { return ((Slave *)c)->in_event = true, OK; }
EXPORT int fmi3EnterStepMode(void *c) { return ((Slave *)c)->in_event = false, OK; }

EXPORT int fmi3UpdateDiscreteStates(void *c, bool *again, bool *terminate, bool *nominals, bool *values,
                                    bool *defined, double *next) {
    Slave *s = c;
    evaluate(s);
    *again = *terminate = *nominals = *values = false;
    if (fabs(s->time - s->real[EVENT_AT]) < 1e-9 && s->real[EVENT_AT] > 0.0) s->real[X] += 10.0;
    *defined = s->time < s->real[EVENT_AT] - 1e-9;
    *next = s->real[EVENT_AT];
    memset(s->active, 0, sizeof s->active);
    s->done = false;
    return OK;
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                         bool visible, bool logging, bool event_mode, bool early,
                                         const uint32_t *intermediate, size_t count, void *environment,
                                         Log log, void *update) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early;
    (void)intermediate, (void)count, (void)update;
    Slave *s = calloc(1, sizeof *s);
    s->log = log, s->environment = environment;
    s->real[GIVEN] = 100.0;
    return s;
}

EXPORT int fmi3EnterInitializationMode(void *c, bool defined, double tolerance, double start, bool stops,
                                       double stop) {
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    return ((Slave *)c)->time = start, OK;
}

EXPORT int fmi3ExitInitializationMode(void *c) {
    Slave *s = c;
    return s->in_event = s->stepping = true, OK;
}

EXPORT void fmi3FreeInstance(void *c) { free(c); }
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
#define ACCEPTED(name) \
    EXPORT int name(void) { return OK; }
#define REFUSED(name) \
    EXPORT int name(void) { return ERROR; }
#define BOTH(name) REFUSED(fmi3Get##name) REFUSED(fmi3Set##name)
ACCEPTED(fmi3Reset) ACCEPTED(fmi3SetDebugLogging) ACCEPTED(fmi3Terminate)
BOTH(Float32) BOTH(Int8) BOTH(UInt8) BOTH(Int16) BOTH(UInt16) BOTH(UInt32) BOTH(Int64) BOTH(UInt64)
BOTH(Boolean) BOTH(String) BOTH(FMUState) BOTH(ContinuousStates)
REFUSED(fmi3ActivateModelPartition) REFUSED(fmi3CompletedIntegratorStep)
REFUSED(fmi3DeserializeFMUState) REFUSED(fmi3EnterContinuousTimeMode)
REFUSED(fmi3EnterConfigurationMode) REFUSED(fmi3ExitConfigurationMode)
REFUSED(fmi3EvaluateDiscreteStates) REFUSED(fmi3FreeFMUState) REFUSED(fmi3GetAdjointDerivative)
REFUSED(fmi3GetContinuousStateDerivatives) REFUSED(fmi3GetDirectionalDerivative)
REFUSED(fmi3GetEventIndicators) REFUSED(fmi3GetIntervalFraction)
REFUSED(fmi3GetNominalsOfContinuousStates) REFUSED(fmi3GetNumberOfContinuousStates)
REFUSED(fmi3GetNumberOfEventIndicators) REFUSED(fmi3GetNumberOfVariableDependencies)
REFUSED(fmi3GetOutputDerivatives) REFUSED(fmi3GetShiftFraction)
REFUSED(fmi3GetVariableDependencies) REFUSED(fmi3InstantiateModelExchange)
REFUSED(fmi3InstantiateScheduledExecution) REFUSED(fmi3SerializeFMUState)
REFUSED(fmi3SerializedFMUStateSize) REFUSED(fmi3SetIntervalDecimal)
REFUSED(fmi3SetIntervalFraction) REFUSED(fmi3SetShiftDecimal) REFUSED(fmi3SetShiftFraction)
REFUSED(fmi3SetTime)
