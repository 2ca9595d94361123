/* One block of the ring: a body that moves in two directions and turns, held by its neighbours.
 * A co-simulation slave of the plainest kind, of FMI 2.0 or, with -DFMI3, of FMI 3.0: a struct,
 * classical Runge-Kutta, no logging.
 * All outputs depend on the states only. */
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
#define MICRO_STEPS 4
enum { STATES = 6, INPUTS = 6, OUTPUTS = 8, PARAMETERS = 8 };
enum { X, VX, Y, VY, ANGLE, SPIN };
enum { LEFT_X, LEFT_VX, LEFT_Y, RIGHT_X, RIGHT_VX, RIGHT_Y };
enum { MASS, INERTIA, STIFFNESS, DAMPING, GROUND_STIFFNESS, GROUND_DAMPING, START_X, START_Y };

typedef struct {
    double input[INPUTS], output[OUTPUTS], parameter[PARAMETERS], state[STATES];
} Block;

static void derivative(const Block *b, const double *s, double *rate) {
    const double *u = b->input, *p = b->parameter;
    double from_left = p[STIFFNESS] * (u[LEFT_X] - s[X]) + p[DAMPING] * (u[LEFT_VX] - s[VX]);
    double from_right = p[STIFFNESS] * (u[RIGHT_X] - s[X]) + p[DAMPING] * (u[RIGHT_VX] - s[VX]);
    double ground = p[GROUND_STIFFNESS] * s[Y] + p[GROUND_DAMPING] * s[VY];
    double sideways = 0.25 * p[STIFFNESS] * (u[LEFT_Y] + u[RIGHT_Y] - 2.0 * s[Y]);
    double moment = 0.1 * p[STIFFNESS] * (u[RIGHT_Y] - u[LEFT_Y]);
    rate[X] = s[VX];
    rate[VX] = (from_left + from_right - 0.2 * p[GROUND_STIFFNESS] * s[X]) / p[MASS];
    rate[Y] = s[VY];
    rate[VY] = (sideways - ground) / p[MASS];
    rate[ANGLE] = s[SPIN];
    rate[SPIN] = (moment - p[GROUND_STIFFNESS] * s[ANGLE] - p[GROUND_DAMPING] * s[SPIN]) / p[INERTIA];
}

static void micro_step(Block *b, double h) {
    static const double at[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0, 2.0, 2.0, 1.0};
    double rate[STATES] = {0}, sum[STATES] = {0}, trial[STATES];
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < STATES; i++) trial[i] = b->state[i] + at[stage] * h * rate[i];
        derivative(b, trial, rate);
        for (int i = 0; i < STATES; i++) sum[i] += weight[stage] * rate[i];
    }
    for (int i = 0; i < STATES; i++) b->state[i] += h / 6.0 * sum[i];
}

static void evaluate(Block *b) {
    const double *s = b->state, *p = b->parameter;
    memcpy(b->output, s, sizeof b->state);
    b->output[6] = 0.5 * (p[MASS] * (s[VX] * s[VX] + s[VY] * s[VY]) + p[INERTIA] * s[SPIN] * s[SPIN]);
    b->output[7] = p[GROUND_STIFFNESS] * s[Y] + p[GROUND_DAMPING] * s[VY];
}

static void begin(Block *b) {
    memset(b->state, 0, sizeof b->state);
    b->state[X] = b->parameter[START_X];
    b->state[Y] = b->parameter[START_Y];
    evaluate(b);
}

static void reset(Block *b) {
    static const double usual[PARAMETERS] = {1000.0, 400.0, 4e5, 2e3, 8e4, 1e3, 0.0, 0.0};
    memset(b, 0, sizeof *b);
    memcpy(b->parameter, usual, sizeof usual);
}

/* Value references: inputs, outputs, parameters, in this order, as in the struct. */
static int set(void *c, const uint32_t *reference, size_t count, const double *value) {
    for (size_t i = 0; i < count; i++) {
        if (reference[i] >= INPUTS + OUTPUTS + PARAMETERS) return 3;
        ((double *)c)[reference[i]] = value[i];
    }
    return 0;
}

static int get(void *c, const uint32_t *reference, size_t count, double *value) {
    for (size_t i = 0; i < count; i++) {
        if (reference[i] >= INPUTS + OUTPUTS + PARAMETERS) return 3;
        value[i] = ((double *)c)[reference[i]];
    }
    return 0;
}

static void step_all(Block *b, double step) {
    for (int i = 0; i < MICRO_STEPS; i++) micro_step(b, step / MICRO_STEPS);
    evaluate(b);
}

static Block *instance(void) {
    Block *b = malloc(sizeof *b);
    if (b) reset(b);
    return b;
}

/* The rest of the standard: accepted where it changes nothing, refused where it is not offered. */
#define ACCEPTED(name) \
    EXPORT int name(void) { return 0; }
#define REFUSED(name) \
    EXPORT int name(void) { return 3; }

#ifndef FMI3
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetReal(void *c, const uint32_t *reference, size_t count, const double *value) {
    return set(c, reference, count, value);
}
EXPORT int fmi2GetReal(void *c, const uint32_t *reference, size_t count, double *value) {
    return get(c, reference, count, value);
}
EXPORT int fmi2DoStep(void *c, double time, double step, int no_return) {
    (void)time, (void)no_return;
    return step_all(c, step), 0;
}
EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return instance();
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT int fmi2ExitInitializationMode(void *c) { return begin(c), 0; }
EXPORT int fmi2EnterInitializationMode(void *c) { return begin(c), 0; }
EXPORT int fmi2Reset(void *c) { return reset(c), 0; }
ACCEPTED(fmi2SetDebugLogging) ACCEPTED(fmi2SetupExperiment) ACCEPTED(fmi2Terminate)
REFUSED(fmi2GetInteger) REFUSED(fmi2SetInteger) REFUSED(fmi2GetBoolean) REFUSED(fmi2SetBoolean)
REFUSED(fmi2GetString) REFUSED(fmi2SetString) REFUSED(fmi2GetFMUstate) REFUSED(fmi2SetFMUstate)
REFUSED(fmi2FreeFMUstate) REFUSED(fmi2SerializedFMUstateSize) REFUSED(fmi2SerializeFMUstate)
REFUSED(fmi2DeSerializeFMUstate) REFUSED(fmi2GetDirectionalDerivative) REFUSED(fmi2CancelStep)
REFUSED(fmi2SetRealInputDerivatives) REFUSED(fmi2GetRealOutputDerivatives) REFUSED(fmi2GetStatus)
REFUSED(fmi2GetRealStatus) REFUSED(fmi2GetIntegerStatus) REFUSED(fmi2GetBooleanStatus)
REFUSED(fmi2GetStringStatus)
#else
EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT int fmi3SetFloat64(void *c, const uint32_t *reference, size_t count, const double *value,
                          size_t values) {
    (void)values;
    return set(c, reference, count, value);
}
EXPORT int fmi3GetFloat64(void *c, const uint32_t *reference, size_t count, double *value, size_t values) {
    (void)values;
    return get(c, reference, count, value);
}
EXPORT int fmi3DoStep(void *c, double time, double step, bool no_return, bool *event, bool *terminate,
                      bool *early, double *last) {
    (void)no_return;
    *event = *terminate = *early = false;
    *last = time + step;
    return step_all(c, step), 0;
}
EXPORT void *fmi3InstantiateCoSimulation(void) { return instance(); }
EXPORT void fmi3FreeInstance(void *c) { free(c); }
EXPORT int fmi3ExitInitializationMode(void *c) { return begin(c), 0; }
EXPORT int fmi3EnterInitializationMode(void *c) { return begin(c), 0; }
EXPORT int fmi3Reset(void *c) { return reset(c), 0; }
ACCEPTED(fmi3SetDebugLogging) ACCEPTED(fmi3Terminate) ACCEPTED(fmi3EnterEventMode)
ACCEPTED(fmi3EnterStepMode) ACCEPTED(fmi3EnterConfigurationMode)
ACCEPTED(fmi3ExitConfigurationMode)
REFUSED(fmi3ActivateModelPartition) REFUSED(fmi3CompletedIntegratorStep)
REFUSED(fmi3DeserializeFMUState) REFUSED(fmi3EnterContinuousTimeMode)
REFUSED(fmi3EvaluateDiscreteStates) REFUSED(fmi3FreeFMUState) REFUSED(fmi3GetAdjointDerivative)
REFUSED(fmi3GetBinary) REFUSED(fmi3GetBoolean) REFUSED(fmi3GetClock)
REFUSED(fmi3GetContinuousStateDerivatives) REFUSED(fmi3GetContinuousStates)
REFUSED(fmi3GetDirectionalDerivative) REFUSED(fmi3GetEventIndicators) REFUSED(fmi3GetFMUState)
REFUSED(fmi3GetFloat32) REFUSED(fmi3GetInt16) REFUSED(fmi3GetInt32) REFUSED(fmi3GetInt64)
REFUSED(fmi3GetInt8) REFUSED(fmi3GetIntervalDecimal) REFUSED(fmi3GetIntervalFraction)
REFUSED(fmi3GetNominalsOfContinuousStates) REFUSED(fmi3GetNumberOfContinuousStates)
REFUSED(fmi3GetNumberOfEventIndicators) REFUSED(fmi3GetNumberOfVariableDependencies)
REFUSED(fmi3GetOutputDerivatives) REFUSED(fmi3GetShiftDecimal) REFUSED(fmi3GetShiftFraction)
REFUSED(fmi3GetString) REFUSED(fmi3GetUInt16) REFUSED(fmi3GetUInt32) REFUSED(fmi3GetUInt64)
REFUSED(fmi3GetUInt8) REFUSED(fmi3GetVariableDependencies) REFUSED(fmi3InstantiateModelExchange)
REFUSED(fmi3InstantiateScheduledExecution) REFUSED(fmi3SerializeFMUState)
REFUSED(fmi3SerializedFMUStateSize) REFUSED(fmi3SetBinary) REFUSED(fmi3SetBoolean)
REFUSED(fmi3SetClock) REFUSED(fmi3SetContinuousStates) REFUSED(fmi3SetFMUState)
REFUSED(fmi3SetFloat32) REFUSED(fmi3SetInt16) REFUSED(fmi3SetInt32) REFUSED(fmi3SetInt64)
REFUSED(fmi3SetInt8) REFUSED(fmi3SetIntervalDecimal) REFUSED(fmi3SetIntervalFraction)
REFUSED(fmi3SetShiftDecimal) REFUSED(fmi3SetShiftFraction) REFUSED(fmi3SetString)
REFUSED(fmi3SetTime) REFUSED(fmi3SetUInt16) REFUSED(fmi3SetUInt32) REFUSED(fmi3SetUInt64)
REFUSED(fmi3SetUInt8) REFUSED(fmi3UpdateDiscreteStates)
#endif
