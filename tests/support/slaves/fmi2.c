/* An FMI 2.0 slave for the tests with variables of every type, whose value references are the same
 * in each: input 0, output 1, which follows it; for Real also the start value of an offset, 2, that
 * is added, and input 3 of output 4. It counts its steps in Integer 2. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double real[8], rate[8];
    int integer[8], boolean[8];
    char text[8][128];
} Slave;

static void evaluate(Slave *s) {
    s->real[1] = s->real[0] + s->real[2];
    s->real[4] = s->real[3];
    s->integer[1] = s->integer[0];
    s->integer[4] = s->integer[3];
    s->boolean[1] = s->boolean[0];
    snprintf(s->text[1], sizeof s->text[1], "%.100s", s->text[0]);
}

#define TYPE(name, ctype, member)                                                  \
    EXPORT int fmi2Get##name(void *c, const uint32_t *r, size_t n, ctype *v) {     \
        for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->member[r[i]];          \
        return OK;                                                                 \
    }                                                                              \
    EXPORT int fmi2Set##name(void *c, const uint32_t *r, size_t n, const ctype *v) { \
        for (size_t i = 0; i < n; i++) ((Slave *)c)->member[r[i]] = v[i];          \
        evaluate(c);                                                               \
        return OK;                                                                 \
    }
TYPE(Real, double, real)
TYPE(Integer, int, integer)
TYPE(Boolean, int, boolean)

EXPORT int fmi2GetString(void *c, const uint32_t *r, size_t n, const char **v) {
    for (size_t i = 0; i < n; i++) v[i] = ((Slave *)c)->text[r[i]];
    return OK;
}
EXPORT int fmi2SetString(void *c, const uint32_t *r, size_t n, const char *const *v) {
    Slave *s = c;
    for (size_t i = 0; i < n; i++) snprintf(s->text[r[i]], sizeof s->text[r[i]], "%s", v[i]);
    evaluate(s);
    return OK;
}
EXPORT int fmi2SetRealInputDerivatives(void *c, const uint32_t *r, size_t n, const int *order, const double *v) {
    (void)order;
    for (size_t i = 0; i < n; i++) ((Slave *)c)->rate[r[i]] = v[i];
    return OK;
}
EXPORT int fmi2GetDirectionalDerivative(void *c, const uint32_t *unknown, size_t n, const uint32_t *known,
                                        size_t m, const double *seed, double *result) {
    (void)c;
    for (size_t i = 0; i < n; i++) {
        result[i] = 0.0;
        for (size_t j = 0; j < m; j++)
            if (unknown[i] == known[j] + 1) result[i] += seed[j];
    }
    return OK;
}
EXPORT int fmi2DoStep(void *c, double time, double h, int no_return) {
    Slave *s = c;
    (void)time, (void)no_return;
    for (int i = 0; i < 8; i++) s->real[i] += s->rate[i] * h, s->rate[i] = 0.0;
    s->integer[2]++;
    evaluate(s);
    return OK;
}
EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(Slave));
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
#define ACCEPTED(name) \
    EXPORT int name(void) { return OK; }
#define REFUSED(name) \
    EXPORT int name(void) { return ERROR; }
ACCEPTED(fmi2SetDebugLogging) ACCEPTED(fmi2SetupExperiment) ACCEPTED(fmi2Terminate) ACCEPTED(fmi2Reset)
ACCEPTED(fmi2EnterInitializationMode) ACCEPTED(fmi2ExitInitializationMode)
REFUSED(fmi2GetFMUstate) REFUSED(fmi2SetFMUstate) REFUSED(fmi2FreeFMUstate)
REFUSED(fmi2SerializedFMUstateSize) REFUSED(fmi2SerializeFMUstate) REFUSED(fmi2DeSerializeFMUstate)
REFUSED(fmi2CancelStep) REFUSED(fmi2GetRealOutputDerivatives) REFUSED(fmi2GetStatus)
REFUSED(fmi2GetRealStatus) REFUSED(fmi2GetIntegerStatus) REFUSED(fmi2GetBooleanStatus)
REFUSED(fmi2GetStringStatus)
