#include "core.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CASADI_SYMBOL_EXPORT static
#include "equations.h"

static int finite_number(double value) { return fabs(value) <= DBL_MAX; }

static int all_finite(const double *value, size_t count) {
    double sum = 0.0;
    for (size_t i = 0; i < count; i++) sum += value[i] * 0.0;
    return sum == 0.0;
}

/* Name of a state, or of an input that follows its tangent, that is not finite; NULL if none. */
static const char *first_lost(const double *x, const double *u) {
    if (all_finite(x, N_STATES) && all_finite(u, N_INPUTS)) return NULL;
    for (int i = 0; i < N_STATES; i++)
        if (!finite_number(x[i])) return STATE_NAME[i];
    for (int i = 0; i < N_INPUTS; i++)
        if (!finite_number(u[i])) return VARIABLE_INFO[FIRST_INPUT - 1 + i].name;
    return NULL;
}

Status core_fail(Instance *instance, const char *format, ...) {
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (instance->report) instance->report(instance->environment, ERROR, message);
    return ERROR;
}

static double *parameters(State *s) { return s->value + FIRST_PARAMETER; }
static double *inputs(State *s) { return s->value + FIRST_INPUT; }
static double *outputs_of(State *s) { return s->value + FIRST_OUTPUT; }

Instance *core_create(Report report, void *environment) {
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->report = report;
    instance->environment = environment;
    core_reset(instance);
    return instance;
}

void core_free(Instance *instance) { free(instance); }

void core_reset(Instance *instance) {
    State *s = &instance->state;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < N_PARAMETERS + N_INPUTS; i++)
        s->value[FIRST_PARAMETER + i] = VARIABLE_INFO[i].start;
    s->phase = INSTANTIATED;
    s->derived_stale = s->states_stale = s->outputs_stale = 1;
    memset(instance->page_filled, 0, sizeof instance->page_filled);
}

/* Calls a generated function; the caller has set the arguments and results. */
#define CALL(function) function(instance->arg, instance->res, instance->iw, instance->w, 0)

/* The arguments (x, u, p, d) that most functions begin with. */
static void common_arguments(Instance *instance, const double *x, const double *u) {
    State *s = &instance->state;
    instance->arg[0] = x;
    instance->arg[1] = u;
    instance->arg[2] = parameters(s);
    instance->arg[3] = s->d;
}

static Status refresh_derived(Instance *instance) {
    State *s = &instance->state;
    if (!s->derived_stale) return OK;
    instance->arg[0] = parameters(s);
    instance->res[0] = s->d;
    CALL(derived);
    if (!all_finite(s->d, N_DERIVED))
        return core_fail(instance, "these parameter values give no finite model; check for zero or "
                                   "contradicting masses, lengths and stiffnesses");
    s->derived_stale = 0;
    memset(instance->page_filled, 0, sizeof instance->page_filled);
    return OK;
}

static Status refresh_states(Instance *instance) {
    State *s = &instance->state;
    if (refresh_derived(instance) != OK) return ERROR;
    if (!s->states_stale) return OK;
    instance->arg[0] = parameters(s);
    instance->arg[1] = s->d;
    instance->arg[2] = inputs(s);
    instance->res[0] = s->x;
    CALL(initial);
    s->states_stale = 0;
    return OK;
}

#if TABLE_STATIONS
/* A table can be asked for any station; beyond this many pages the number would lose digits. */
static const double FARTHEST_PAGE = 1e12;

static const double *table_node(Instance *instance, double node) {
    double number = floor(node / TABLE_NODES);
    int64_t wanted = (int64_t)number;
    int slot = (int)(((wanted % TABLE_SLOTS) + TABLE_SLOTS) % TABLE_SLOTS);
    if (!instance->page_filled[slot] || instance->page_number[slot] != wanted) {
        instance->arg[0] = &number;
        instance->arg[1] = instance->state.d;
        instance->res[0] = instance->page[slot];
        CALL(page);
        instance->page_number[slot] = wanted;
        instance->page_filled[slot] = 1;
    }
    return instance->page[slot] + (int64_t)(node - number * TABLE_NODES) * TABLE_VALUES;
}

static Status refresh_lookup(Instance *instance) {
    State *s = &instance->state;
    double station[TABLE_STATIONS];
    common_arguments(instance, s->x, inputs(s));
    instance->res[0] = station;
    CALL(stations);
    for (int i = 0; i < TABLE_STATIONS; i++) {
        double place = station[i] / TABLE_SPACING, node = floor(place);
        double *column = instance->lookup + i * TABLE_ROWS;
        if (!(fabs(node) < FARTHEST_PAGE * TABLE_NODES))
            return core_fail(instance, "station %g is beyond what the table can address", station[i]);
        column[0] = place - node;
        memcpy(column + 1, table_node(instance, node), TABLE_VALUES * sizeof(double));
        memcpy(column + 1 + TABLE_VALUES, table_node(instance, node + 1.0),
               TABLE_VALUES * sizeof(double));
    }
    return OK;
}
#else
static Status refresh_lookup(Instance *instance) {
    (void)instance;
    return OK;
}
#endif

static Status refresh_outputs(Instance *instance) {
    State *s = &instance->state;
    if (!s->outputs_stale) return OK;
    if (refresh_states(instance) != OK || refresh_lookup(instance) != OK) return ERROR;
    common_arguments(instance, s->x, inputs(s));
    instance->arg[4] = instance->lookup;
    instance->res[0] = outputs_of(s);
    CALL(outputs);
    s->outputs_stale = 0;
    return OK;
}

Status core_start(Instance *instance, double time) {
    State *s = &instance->state;
    if (!finite_number(time)) return core_fail(instance, "the start time must be finite");
    s->time = s->value[0] = time;
    s->phase = INITIALIZING;
    s->states_stale = s->outputs_stale = 1;
    return OK;
}

Status core_finish_initialization(Instance *instance) {
    State *s = &instance->state;
    s->states_stale = s->outputs_stale = 1;
    if (refresh_states(instance) != OK) return ERROR;
    const char *lost = first_lost(s->x, inputs(s));
    if (lost)
        return core_fail(instance, "%s is not finite at the start; check initial values and inputs", lost);
    s->phase = RUNNING;
    return OK;
}

static const char *const KIND_NAME[] = {"real", "integer", "boolean", "enumeration"};

static Status check_settable(Instance *instance, uint32_t reference, Kind kind, double value) {
    const State *s = &instance->state;
    if (reference == 0 || reference >= N_VALUES)
        return core_fail(instance, "value reference %u cannot be set: parameters and inputs are %d to %d",
                         (unsigned)reference, FIRST_PARAMETER, FIRST_OUTPUT - 1);
    if (reference >= FIRST_OUTPUT)
        return core_fail(instance, "%s is an output and cannot be set", OUTPUT_NAME[reference - FIRST_OUTPUT]);
    const VariableInfo *info = VARIABLE_INFO + reference - 1;
    int pure = strcmp(info->unit, "1") == 0; /* a pure number's unit is not shown */
    int same = info->kind == kind || (info->kind == ENUMERATION && kind == INTEGER);
    if (!same)
        return core_fail(instance, "%s is of type %s and cannot be set as %s", info->name,
                         KIND_NAME[info->kind], KIND_NAME[kind]);
    if (!finite_number(value))
        return core_fail(instance, "%s cannot be %g: a finite number is needed", info->name, value);
    if (value < info->minimum || value > info->maximum)
        return core_fail(instance, "%s cannot be %g%s%s: its range is %g to %g", info->name, value,
                         pure ? "" : " ", pure ? "" : info->unit, info->minimum, info->maximum);
    if (reference < FIRST_INPUT && s->phase == RUNNING && !info->tunable)
        return core_fail(instance, "%s is a fixed parameter: set it before the run starts", info->name);
    return OK;
}

static void store(State *s, uint32_t reference, double value) {
    s->value[reference] = value;
    s->outputs_stale = 1;
    if (reference < FIRST_INPUT) s->derived_stale = 1;
    if (s->phase != RUNNING) s->states_stale = 1;
}

Status core_set(Instance *instance, const uint32_t *reference, size_t count, const double *value) {
    State *s = &instance->state;
    for (size_t i = 0; i < count; i++) {
        uint32_t r = reference[i];
        /* An input's number is the hot path: in range of the references and finite. */
        int plain = r - FIRST_INPUT < N_INPUTS && finite_number(value[i]);
        if (!plain && check_settable(instance, r, REAL, value[i]) != OK) return ERROR;
        store(s, r, value[i]);
    }
    return OK;
}

Status core_set_kind(Instance *instance, uint32_t reference, Kind kind, double value) {
    if (check_settable(instance, reference, kind, value) != OK) return ERROR;
    store(&instance->state, reference, value);
    return OK;
}

Status core_set_rate(Instance *instance, uint32_t reference, double rate) {
    if (reference < FIRST_INPUT || reference >= FIRST_OUTPUT)
        return core_fail(instance, "value reference %u is no input: only inputs (%d to %d) have a rate",
                         (unsigned)reference, FIRST_INPUT, FIRST_OUTPUT - 1);
    if (!finite_number(rate))
        return core_fail(instance, "the rate of %s cannot be %g", VARIABLE_INFO[reference - 1].name, rate);
    instance->state.rate[reference - FIRST_INPUT] = rate;
    return OK;
}

static Status check_readable(Instance *instance, uint32_t reference) {
    if (reference >= N_VALUES)
        return core_fail(instance, "there is no value reference %u: the highest is %d",
                         (unsigned)reference, N_VALUES - 1);
    Kind own = reference < FIRST_PARAMETER ? REAL : VARIABLE_INFO[reference - 1].kind;
    if (own != REAL)
        return core_fail(instance, "%s is of type %s and cannot be read as real",
                         VARIABLE_INFO[reference - 1].name, KIND_NAME[own]);
    return OK;
}

Status core_get(Instance *instance, const uint32_t *reference, size_t count, double *value) {
    State *s = &instance->state;
    for (size_t i = 0; i < count; i++) {
        uint32_t r = reference[i];
        int output = r - FIRST_OUTPUT < N_OUTPUTS;
        if (output && s->outputs_stale && refresh_outputs(instance) != OK) return ERROR;
        if (!output && check_readable(instance, r) != OK) return ERROR;
        value[i] = s->value[r];
    }
    return OK;
}

Status core_get_kind(Instance *instance, uint32_t reference, Kind kind, double *value) {
    if (reference == 0 || reference >= FIRST_OUTPUT)
        return core_fail(instance, "value reference %u cannot be read as %s: parameters are %d to %d",
                         (unsigned)reference, KIND_NAME[kind], FIRST_PARAMETER, FIRST_INPUT - 1);
    Kind own = VARIABLE_INFO[reference - 1].kind;
    if (own != kind && !(own == ENUMERATION && kind == INTEGER))
        return core_fail(instance, "%s is of type %s and cannot be read as %s",
                         VARIABLE_INFO[reference - 1].name, KIND_NAME[own], KIND_NAME[kind]);
    *value = instance->state.value[reference];
    return OK;
}

/* More micro steps than this in one step are taken for a mistake in the step or the parameters. */
static const double MOST_MICRO_STEPS = 1e8;

Status core_step(Instance *instance, double time, double size) {
    State *s = &instance->state;
    if (s->phase != RUNNING)
        return core_fail(instance, "doStep needs a finished initialization and no termination");
    if (!(size >= 0.0) || !finite_number(time + size))
        return core_fail(instance, "doStep from t = %g s by %g s: the step must be finite and not negative",
                         time, size);
    if (refresh_states(instance) != OK) return ERROR;

    double x[2][N_STATES + 1], u[2][N_INPUTS + 1], largest = size;
    memcpy(x[0], s->x, sizeof s->x);
    memcpy(u[0], inputs(s), N_INPUTS * sizeof(double));
    common_arguments(instance, x[0], u[0]);
    instance->res[0] = &largest;
    CALL(largest_step);
    double steps = ceil(size / largest - 1e-9);
    if (!(steps <= MOST_MICRO_STEPS))
        return core_fail(instance, "doStep by %g s needs micro steps of %g s: too many", size, largest);
    long count = steps > 1.0 ? (long)steps : 1;
    double micro = size / (double)count;
    int now = 0;
    for (long i = 0; i < count; i++, now = !now) {
        instance->arg[0] = x[now];
        instance->arg[1] = u[now];
        instance->arg[2] = s->rate;
        instance->arg[3] = parameters(s);
        instance->arg[4] = s->d;
        instance->arg[5] = &micro;
        instance->res[0] = x[!now];
        instance->res[1] = u[!now];
        CALL(step);
    }
    const char *lost = first_lost(x[now], u[now]);
    if (lost)
        return core_fail(instance, "%s is no longer finite after the step from t = %.17g s by %g s: "
                                   "the coupling or the micro step is unstable; take a smaller step",
                         lost, time, size);
    memcpy(s->x, x[now], sizeof s->x);
    memcpy(inputs(s), u[now], N_INPUTS * sizeof(double));
    memset(s->rate, 0, sizeof s->rate);
    s->time = s->value[0] = time + size;
    s->outputs_stale = 1;
    return OK;
}

Status core_directional(Instance *instance, const uint32_t *unknown, size_t unknown_count,
                        const uint32_t *known, size_t known_count, const double *seed,
                        double *sensitivity) {
    State *s = &instance->state;
    double direction[N_INPUTS + 1] = {0.0}, result[N_OUTPUTS + 1];
    for (size_t i = 0; i < known_count; i++) {
        if (known[i] - FIRST_INPUT >= N_INPUTS)
            return core_fail(instance, "value reference %u is no input to differentiate by", (unsigned)known[i]);
        direction[known[i] - FIRST_INPUT] += seed[i];
    }
    if (refresh_states(instance) != OK) return ERROR;
    if (s->outputs_stale && refresh_lookup(instance) != OK) return ERROR;
    common_arguments(instance, s->x, inputs(s));
    instance->arg[4] = instance->lookup;
    instance->arg[5] = direction;
    instance->res[0] = result;
    CALL(outputs_forward);
    for (size_t i = 0; i < unknown_count; i++) {
        if (unknown[i] - FIRST_OUTPUT >= N_OUTPUTS)
            return core_fail(instance, "value reference %u is no output to differentiate", (unsigned)unknown[i]);
        sensitivity[i] = result[unknown[i] - FIRST_OUTPUT];
    }
    return OK;
}

void core_restore(Instance *instance, const State *state) {
    if (memcmp(instance->state.d, state->d, sizeof state->d) != 0)
        memset(instance->page_filled, 0, sizeof instance->page_filled);
    memcpy(&instance->state, state, sizeof *state);
    instance->state.outputs_stale = 1; /* the lookup behind them is the instance's, not the state's */
}
