/* An FMI 3.0 slave for the tests with variables of every type. Each output follows its input:
 * `<type>_out` is `<type>_in`, w = gain * v, transposed is m transposed, y = 10 x with as many
 * elements as the structural parameter n says, said is say with the prefix before it. The position
 * is the integral of the rate, by the midpoint rule in micro steps at which it asks for the rate.
 * At the time event_at it returns early for an event, whose iteration takes two updates; at end_at
 * it asks to end. In step mode it takes discrete inputs only without event mode, as the standard
 * has it. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { MOST = 16, VARIABLES = 64, MICRO_STEPS = 4, TYPES = 11 };
enum {
    RATE = 1, POSITION, FIRST = 10, /* pairs of input and output, one for each type */
    V = 40, W, GAIN, M, TRANSPOSED, N, X, Y, SAY, SAID, PREFIX, EVENTS, EVENT_AT, END_AT
};

typedef void (*Log)(void *, int, const char *, const char *);
typedef void (*Update)(void *, double, bool, bool, bool, bool, bool *, double *);
typedef struct {
    double real[VARIABLES][MOST];
    int64_t whole[VARIABLES][MOST];
    char text[VARIABLES][128];
    bool stepping, event_mode, in_event, asked, configuring;
    int updates;
    bool moving;
    Log log;
    Update update;
    void *environment;
} Slave;

static int refuse(Slave *s, const char *why) {
    s->log(s->environment, ERROR, "logStatusError", why);
    return ERROR;
}

static size_t size_of(const Slave *s, uint32_t reference) {
    switch (reference) {
    case V: case W: case GAIN: return 3;
    case M: case TRANSPOSED: return 4;
    case X: case Y: return (size_t)s->whole[N][0];
    default: return 1;
    }
}

static bool discrete(uint32_t r) {
    return r == M || r == SAY || (r > FIRST + 1 && r < FIRST + 2 * TYPES && r % 2 == 0);
}

static void evaluate(Slave *s) {
    for (int i = FIRST; i < FIRST + 2 * TYPES; i += 2) {
        s->real[i + 1][0] = s->real[i][0];
        s->whole[i + 1][0] = s->whole[i][0];
    }
    for (int i = 0; i < 3; i++) s->real[W][i] = s->real[GAIN][i] * s->real[V][i];
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) s->whole[TRANSPOSED][2 * i + j] = s->whole[M][2 * j + i];
    for (int i = 0; i < s->whole[N][0]; i++) s->real[Y][i] = 10.0 * s->real[X][i];
    snprintf(s->text[SAID], sizeof s->text[SAID], "%.50s%.50s", s->text[PREFIX], s->text[SAY]);
}

static int writable(Slave *s, uint32_t r) {
    if (s->stepping && s->event_mode && !s->in_event && discrete(r))
        return refuse(s, "a discrete input was set outside of event mode");
    if (r == N && !s->configuring) return refuse(s, "n was set outside of configuration mode");
    return OK;
}

#define TYPE(name, ctype, member)                                                                   \
    EXPORT int fmi3Get##name(void *c, const uint32_t *r, size_t n, ctype *v, size_t size) {         \
        Slave *s = c;                                                                               \
        size_t k = 0;                                                                               \
        for (size_t i = 0; i < n; i++)                                                              \
            for (size_t j = 0; j < size_of(s, r[i]); j++) v[k++] = (ctype)s->member[r[i]][j];       \
        return k == size ? OK : refuse(s, "wrong number of values to get");                         \
    }                                                                                               \
    EXPORT int fmi3Set##name(void *c, const uint32_t *r, size_t n, const ctype *v, size_t size) {   \
        Slave *s = c;                                                                               \
        size_t k = 0;                                                                               \
        for (size_t i = 0; i < n; i++) {                                                            \
            if (writable(s, r[i])) return ERROR;                                                    \
            for (size_t j = 0; j < size_of(s, r[i]); j++) s->member[r[i]][j] = v[k++];              \
        }                                                                                           \
        evaluate(s);                                                                                \
        return k == size ? OK : refuse(s, "wrong number of values to set");                         \
    }
TYPE(Float64, double, real)
TYPE(Float32, float, real)
TYPE(Int8, int8_t, whole)
TYPE(UInt8, uint8_t, whole)
TYPE(Int16, int16_t, whole)
TYPE(UInt16, uint16_t, whole)
TYPE(Int32, int32_t, whole)
TYPE(UInt32, uint32_t, whole)
TYPE(Int64, int64_t, whole)
TYPE(UInt64, uint64_t, whole)
TYPE(Boolean, bool, whole)

EXPORT int fmi3GetString(void *c, const uint32_t *r, size_t n, const char **v, size_t size) {
    (void)size;
    for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->text[r[i]];
    return OK;
}

EXPORT int fmi3SetString(void *c, const uint32_t *r, size_t n, const char *const *v, size_t size) {
    Slave *s = c;
    (void)size;
    for (size_t i = 0; i < n; i++) {
        if (strstr(v[i], "taboo")) return refuse(s, "that is not said here");
        snprintf(s->text[r[i]], sizeof s->text[r[i]], "%s", v[i]);
    }
    evaluate(s);
    return OK;
}

EXPORT int fmi3GetBinary(void *c, const uint32_t *r, size_t n, size_t *sizes, const uint8_t **v, size_t size) {
    (void)c, (void)r, (void)size;
    for (size_t i = 0; i < n; i++) sizes[i] = 3, v[i] = (const uint8_t *)"foo";
    return OK;
}

EXPORT int fmi3GetClock(void *c, const uint32_t *r, size_t n, bool *v) {
    (void)c, (void)r;
    for (size_t i = 0; i < n; i++) v[i] = false;
    return OK;
}

EXPORT int fmi3GetDirectionalDerivative(void *c, const uint32_t *unknown, size_t n, const uint32_t *known,
                                        size_t m, const double *seed, size_t seeds, double *result,
                                        size_t results) {
    Slave *s = c; /* of w with respect to v, and of float64_out with respect to float64_in */
    double of_v[3] = {0}, of_one = 0.0;
    for (size_t i = 0, k = 0; i < m; k += size_of(s, known[i++])) {
        if (known[i] == V) memcpy(of_v, seed + k, sizeof of_v);
        if (known[i] == FIRST) of_one = seed[k];
        if (k + size_of(s, known[i]) > seeds) return refuse(s, "too few seeds");
    }
    for (size_t i = 0, k = 0; i < n; k += size_of(s, unknown[i++])) {
        if (k + size_of(s, unknown[i]) > results) return refuse(s, "too few results");
        if (unknown[i] == W)
            for (int j = 0; j < 3; j++) result[k + (size_t)j] = s->real[GAIN][j] * of_v[j];
        else
            result[k] = of_one;
    }
    return OK;
}

EXPORT int fmi3DoStep(void *c, double time, double h, bool no_set, bool *event, bool *terminate, bool *early,
                      double *last) {
    Slave *s = c;
    double end = time + h, at = s->real[EVENT_AT][0];
    (void)no_set;
    *event = *terminate = *early = false;
    if (s->asked && s->event_mode) return refuse(s, "a step in spite of an event");
    if (s->event_mode && time < at && at < end) end = at, *event = *early = s->asked = true;
    if (end > s->real[END_AT][0]) *terminate = true;
    double d = (end - time) / MICRO_STEPS;
    for (int i = 0; i < MICRO_STEPS; i++) {
        bool wanted = false;
        double when = 0.0;
        if (s->update && s->moving)
            s->update(s->environment, time + (i + 0.5) * d, true, true, false, false, &wanted, &when);
        s->real[POSITION][0] += d * s->real[RATE][0];
    }
    evaluate(s);
    *last = end;
    return OK;
}

EXPORT int fmi3EnterEventMode(void *c) {
    Slave *s = c;
    s->in_event = true;
    s->updates = 0;
    return OK;
}

EXPORT int fmi3UpdateDiscreteStates(void *c, bool *again, bool *terminate, bool *nominals, bool *values,
                                    bool *defined, double *next) {
    Slave *s = c;
    *nominals = *values = *defined = *terminate = false;
    *next = 0.0;
    *again = s->asked && ++s->updates < 2;
    if (s->asked && !*again) s->whole[EVENTS][0]++, s->asked = false;
    return OK;
}

EXPORT int fmi3EnterStepMode(void *c) { return ((Slave *)c)->in_event = false, OK; }
EXPORT int fmi3EnterConfigurationMode(void *c) { return ((Slave *)c)->configuring = true, OK; }

EXPORT int fmi3ExitConfigurationMode(void *c) {
    Slave *s = c;
    s->configuring = false;
    return s->whole[N][0] <= MOST ? OK : refuse(s, "at most 16 elements");
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                         bool visible, bool logging, bool event_mode, bool early,
                                         const uint32_t *intermediate, size_t count, void *environment,
                                         Log log, Update update) {
    (void)name, (void)resources, (void)visible, (void)logging, (void)early;
    Slave *s = calloc(1, sizeof *s);
    s->log = log, s->update = update, s->environment = environment, s->event_mode = event_mode;
    if (strcmp(token, "types")) {
        refuse(s, "unknown token");
        free(s);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) s->moving |= intermediate[i] == RATE;
    for (int i = 0; i < 3; i++) s->real[GAIN][i] = i + 1.0, s->real[V][i] = 0.25 * (i + 1);
    s->whole[N][0] = 2;
    s->real[EVENT_AT][0] = s->real[END_AT][0] = 1e9;
    strcpy(s->text[PREFIX], "he said: ");
    evaluate(s);
    return s;
}

EXPORT int fmi3EnterInitializationMode(void *c, bool defined, double tolerance, double start, bool stops,
                                       double stop) {
    (void)defined, (void)tolerance, (void)start, (void)stops, (void)stop;
    return evaluate(c), OK;
}

EXPORT int fmi3ExitInitializationMode(void *c) {
    Slave *s = c;
    s->stepping = true;
    s->in_event = s->event_mode;
    return OK;
}

EXPORT void fmi3FreeInstance(void *c) { free(c); }
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
#define ACCEPTED(name) \
    EXPORT int name(void) { return OK; }
#define REFUSED(name) \
    EXPORT int name(void) { return ERROR; }
ACCEPTED(fmi3Reset) ACCEPTED(fmi3SetDebugLogging) ACCEPTED(fmi3Terminate)
REFUSED(fmi3ActivateModelPartition) REFUSED(fmi3CompletedIntegratorStep)
REFUSED(fmi3DeserializeFMUState) REFUSED(fmi3EnterContinuousTimeMode)
REFUSED(fmi3EvaluateDiscreteStates) REFUSED(fmi3FreeFMUState) REFUSED(fmi3GetAdjointDerivative)
REFUSED(fmi3GetContinuousStateDerivatives)
REFUSED(fmi3GetContinuousStates) REFUSED(fmi3GetEventIndicators) REFUSED(fmi3GetFMUState)
REFUSED(fmi3GetIntervalDecimal) REFUSED(fmi3GetIntervalFraction)
REFUSED(fmi3GetNominalsOfContinuousStates) REFUSED(fmi3GetNumberOfContinuousStates)
REFUSED(fmi3GetNumberOfEventIndicators) REFUSED(fmi3GetNumberOfVariableDependencies)
REFUSED(fmi3GetOutputDerivatives) REFUSED(fmi3GetShiftDecimal) REFUSED(fmi3GetShiftFraction)
REFUSED(fmi3GetVariableDependencies) REFUSED(fmi3InstantiateModelExchange)
REFUSED(fmi3InstantiateScheduledExecution) REFUSED(fmi3SerializeFMUState)
REFUSED(fmi3SerializedFMUStateSize) REFUSED(fmi3SetBinary) REFUSED(fmi3SetClock)
REFUSED(fmi3SetContinuousStates) REFUSED(fmi3SetFMUState) REFUSED(fmi3SetIntervalDecimal)
REFUSED(fmi3SetIntervalFraction) REFUSED(fmi3SetShiftDecimal) REFUSED(fmi3SetShiftFraction)
REFUSED(fmi3SetTime)
