/* The life of an instance, and its variables. */
#include "evaluate.h"

#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const INTERFACE_NAME[] = {"model exchange", "co-simulation"};

Status core_fail(Instance *instance, const char *format, ...) {
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (instance->report) instance->report(instance->environment, ERROR, message);
    return ERROR;
}

Instance *core_create(Interface interface, Report report, void *environment) {
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) return NULL;
    instance->interface = interface;
    instance->report = report;
    instance->environment = environment;
    core_reset(instance);
    return instance;
}

void core_free(Instance *instance) {
    if (instance) release_equations(instance);
    free(instance);
}

void core_reset(Instance *instance) {
    State *s = &instance->state;
    memset(s, 0, sizeof *s);
    for (int i = 0; i < N_PARAMETERS + N_INPUTS; i++)
        s->value[FIRST_PARAMETER + i] = VARIABLE_INFO[i].start;
    memcpy(s->given, s->value + FIRST_INPUT, N_INPUTS * sizeof(double));
    s->phase = INSTANTIATED;
    s->derived_stale = s->states_stale = s->outputs_stale = s->slopes_stale = 1;
    forget_caches(instance);
}

Status core_start(Instance *instance, double time) {
    State *s = &instance->state;
    if (!finite_number(time)) return core_fail(instance, "the start time must be finite");
    s->time = s->value[0] = time;
    s->phase = INITIALIZING;
    s->states_stale = s->outputs_stale = s->slopes_stale = 1;
    return OK;
}

Status core_finish_initialization(Instance *instance) {
    State *s = &instance->state;
    s->states_stale = s->outputs_stale = s->slopes_stale = 1;
    if (refresh_states(instance) != OK) return ERROR;
    const char *lost = first_lost(s->x, s->value + FIRST_INPUT);
    if (lost)
        return core_fail(instance, "%s is not finite at the start; check initial values and inputs", lost);
    s->phase = instance->interface == MODEL_EXCHANGE ? EVENT_MODE : STEPPING;
    return OK;
}

static int started(const State *s) { return s->phase > INITIALIZING; }

Status core_terminate(Instance *instance) {
    State *s = &instance->state;
    if (!started(s) || s->phase == TERMINATED)
        return core_fail(instance, "terminating ends a run, and none is under way");
    s->phase = TERMINATED;
    return OK;
}

static const char *const KIND_NAME[] = {"real", "integer", "boolean", "enumeration", "integer"};

static int is_kind(Kind own, Kind asked) {
    return own == asked || (asked == WHOLE && (own == INTEGER || own == ENUMERATION));
}

static int is_whole(Kind kind, double value) { return kind == REAL || value == floor(value); }

/* An end that is not given is the largest number there is. A pure number's unit is not shown. */
static Status out_of_range(Instance *instance, const VariableInfo *info, double value) {
    int pure = strcmp(info->unit, "1") == 0, below = info->minimum > -DBL_MAX, above = info->maximum < DBL_MAX;
    const char *space = pure ? "" : " ", *unit = pure ? "" : info->unit;
    char least[96] = "", most[96] = "";
    if (below) snprintf(least, sizeof least, " at least %g%s%s", info->minimum, space, unit);
    if (above) snprintf(most, sizeof most, " at most %g%s%s", info->maximum, space, unit);
    return core_fail(instance, "%s cannot be %g%s%s: it must be%s%s%s", info->name, value, space, unit, least,
                     below && above ? " and" : "", most);
}

static Status check_settable(Instance *instance, uint32_t reference, Kind kind, double value) {
    const State *s = &instance->state;
    if (reference == 0 || reference >= N_REFERENCES)
        return core_fail(instance, "value reference %u cannot be set: parameters and inputs are %d to %d",
                         (unsigned)reference, FIRST_PARAMETER, FIRST_OUTPUT - 1);
    /* Importers such as CasADi's set continuous states by their references. */
    if (continuous_place(STATE_REFERENCE, reference) >= 0 && instance->interface == MODEL_EXCHANGE) {
        const char *name = CALCULATED_NAME[reference - FIRST_OUTPUT];
        if (kind != REAL)
            return core_fail(instance, "%s is of type real and cannot be set as %s", name, KIND_NAME[kind]);
        if (s->phase != CONTINUOUS_MODE && s->phase != EVENT_MODE)
            return core_fail(instance, "%s is a state: it is set in event mode or continuous-time mode", name);
        return finite_number(value) ? OK
                                    : core_fail(instance, "the state %s cannot be %g: a finite number is needed",
                                                name, value);
    }
    if (reference >= FIRST_OUTPUT)
        return core_fail(instance, "%s is %s and cannot be set", CALCULATED_NAME[reference - FIRST_OUTPUT],
                         reference < FIRST_LOCAL      ? "an output"
                         : reference < FIRST_CONSTANT ? "a local variable"
                                                      : "a calculated parameter");
    const VariableInfo *info = VARIABLE_INFO + reference - 1;
    if (!is_kind(info->kind, kind))
        return core_fail(instance, "%s is of type %s and cannot be set as %s", info->name,
                         KIND_NAME[info->kind], KIND_NAME[kind]);
    if (!finite_number(value))
        return core_fail(instance, "%s cannot be %g: a finite number is needed", info->name, value);
    if (value < info->minimum || value > info->maximum)
        return out_of_range(instance, info, value);
    if (reference < FIRST_INPUT && started(s) && !info->tunable)
        return core_fail(instance, "%s is a fixed parameter: set it before the run starts", info->name);
    if (reference < FIRST_INPUT && s->phase == CONTINUOUS_MODE)
        return core_fail(instance, "%s is a parameter: in model exchange it is set in event mode", info->name);
    return OK;
}

static void store(State *s, uint32_t reference, double value) {
    s->outputs_stale = s->slopes_stale = 1;
    if (reference >= FIRST_OUTPUT) {
        s->x[continuous_place(STATE_REFERENCE, reference)] = value;
        return;
    }
    /* A parameter that is told again what it is has nothing follow from it. */
    if (reference < FIRST_INPUT && memcmp(s->value + reference, &value, sizeof value) == 0) return;
    s->value[reference] = value;
    if (reference < FIRST_INPUT) s->derived_stale = 1;
    else s->given[reference - FIRST_INPUT] = value;
    if (!started(s)) s->states_stale = 1;
}

/* Whether the references follow each other, all of them among `size` from `first` on: their numbers
 * are then moved together. Few are moved as fast one by one. */
static int is_row(const uint32_t *reference, size_t count, uint32_t first, uint32_t size) {
    return count > 3 && count <= size && reference[0] - first <= size - count &&
           memcmp(reference, REFERENCE + reference[0], count * sizeof *reference) == 0;
}

/* Stores numbers of inputs in both lists; how many: up to the first that is of no input or not finite. */
static inline size_t store_inputs(const uint32_t *reference, size_t count, const double *value, double *one,
                                  double *other) {
    size_t i = 0;
    if (is_row(reference, count, FIRST_INPUT, N_INPUTS))
        for (uint32_t input = reference[0] - FIRST_INPUT; i + 4 <= count && all_finite(value + i, 4); i += 4) {
            memcpy(one + input + i, value + i, 4 * sizeof *value);
            memcpy(other + input + i, value + i, 4 * sizeof *value);
        }
    for (; i < count; i++) {
        uint32_t input = reference[i] - FIRST_INPUT;
        if (input >= N_INPUTS || !finite_number(value[i])) break;
        one[input] = other[input] = value[i];
    }
    return i;
}

Status core_set(Instance *instance, const uint32_t *reference, size_t count, const double *value) {
    State *s = &instance->state;
    size_t i = 0;
    if (started(s) && count) { /* inputs of a run are the hot path */
        s->outputs_stale = s->slopes_stale = 1;
        i = store_inputs(reference, count, value, s->value + FIRST_INPUT, s->given);
    }
    for (; i < count; i++) {
        if (check_settable(instance, reference[i], REAL, value[i]) != OK) return ERROR;
        store(s, reference[i], value[i]);
    }
    return OK;
}

Status core_set_kind(Instance *instance, uint32_t reference, Kind kind, double value) {
    if (check_settable(instance, reference, kind, value) != OK) return ERROR;
    store(&instance->state, reference, value);
    return OK;
}

static Status refuse_rate(Instance *instance, uint32_t reference, double rate) {
    if (instance->interface != CO_SIMULATION)
        return core_fail(instance, "input derivatives are for co-simulation, and this instance for model exchange");
    if (reference < FIRST_INPUT || reference >= FIRST_OUTPUT)
        return core_fail(instance, "value reference %u is no input: only inputs (%d to %d) have a rate",
                         (unsigned)reference, FIRST_INPUT, FIRST_OUTPUT - 1);
    return core_fail(instance, "the rate of %s cannot be %g", VARIABLE_INFO[reference - 1].name, rate);
}

Status core_set_rates(Instance *instance, const uint32_t *reference, size_t count, const double *rate) {
    size_t i = 0;
    if (instance->interface == CO_SIMULATION)
        i = store_inputs(reference, count, rate, instance->state.rate, instance->state.rate);
    return i == count ? OK : refuse_rate(instance, reference[i], rate[i]);
}

Status core_set_ahead(Instance *instance, const uint32_t *reference, size_t count, const double *value,
                      double size) {
    State *s = &instance->state;
    for (size_t i = 0; i < count; i++) {
        uint32_t input = reference[i] - FIRST_INPUT;
        if (input >= N_INPUTS)
            return core_fail(instance, "value reference %u is no input: only inputs (%d to %d) are set within a step",
                             (unsigned)reference[i], FIRST_INPUT, FIRST_OUTPUT - 1);
        if (check_settable(instance, reference[i], REAL, value[i]) != OK) return ERROR;
        s->rate[input] += (value[i] - s->given[input]) / size;
        s->given[input] = value[i];
    }
    return OK;
}

static Status check_readable(Instance *instance, uint32_t reference) {
    if (reference >= N_REFERENCES)
        return core_fail(instance, "there is no value reference %u: the highest is %d",
                         (unsigned)reference, N_REFERENCES - 1);
    Kind own = reference < FIRST_PARAMETER || reference >= FIRST_OUTPUT ? REAL : VARIABLE_INFO[reference - 1].kind;
    if (own != REAL)
        return core_fail(instance, "%s is of type %s and cannot be read as real",
                         VARIABLE_INFO[reference - 1].name, KIND_NAME[own]);
    return OK;
}

/* A derivative that is no output, a memory state or a constant. */
static Status get_local(Instance *instance, uint32_t reference, double *value) {
    double rate[N_CONTINUOUS + 1], constant[N_CONSTANTS + 1];
    if (reference >= FIRST_CONSTANT) {
        if (evaluate_constants(instance, constant) != OK) return ERROR;
        *value = constant[reference - FIRST_CONSTANT];
        return OK;
    }
    if (refresh_states(instance) != OK) return ERROR;
    if (reference >= FIRST_MEMORY) {
        *value = instance->state.x[N_CONTINUOUS + reference - FIRST_MEMORY];
        return OK;
    }
    if (evaluate_derivatives(instance, rate) != OK) return ERROR;
    *value = rate[continuous_place(DERIVATIVE_REFERENCE, reference)];
    return OK;
}

Status core_get(Instance *instance, const uint32_t *reference, size_t count, double *value) {
    State *s = &instance->state;
    for (size_t i = 0; i < count;) {
        uint32_t r = reference[i];
        if (r - FIRST_OUTPUT < N_OUTPUTS) {
            if (s->outputs_stale && refresh_outputs(instance) != OK) return ERROR;
            if (is_row(reference + i, count - i, FIRST_OUTPUT, N_OUTPUTS)) {
                memcpy(value + i, s->value + r, (count - i) * sizeof *value);
                return OK;
            }
            for (; i < count && reference[i] - FIRST_OUTPUT < N_OUTPUTS; i++) value[i] = s->value[reference[i]];
            continue;
        }
        if (check_readable(instance, r) != OK) return ERROR;
        if (r < FIRST_LOCAL) value[i] = s->value[r];
        else if (get_local(instance, r, value + i) != OK) return ERROR;
        i++;
    }
    return OK;
}

Status core_get_kind(Instance *instance, uint32_t reference, Kind kind, double *value) {
    if (reference == 0 || reference >= FIRST_OUTPUT)
        return core_fail(instance, "value reference %u cannot be read as %s: parameters are %d to %d",
                         (unsigned)reference, KIND_NAME[kind], FIRST_PARAMETER, FIRST_INPUT - 1);
    Kind own = VARIABLE_INFO[reference - 1].kind;
    if (!is_kind(own, kind))
        return core_fail(instance, "%s is of type %s and cannot be read as %s",
                         VARIABLE_INFO[reference - 1].name, KIND_NAME[own], KIND_NAME[kind]);
    *value = instance->state.value[reference];
    return OK;
}

Status core_check_state(Instance *instance, const State *s) {
    const char *broken = NULL;
    int flags = s->derived_stale | s->states_stale | s->outputs_stale | s->slopes_stale;
    if ((unsigned)s->phase > TERMINATED || (flags & ~1) || !finite_number(s->time)) broken = "time or mode";
    for (uint32_t r = FIRST_PARAMETER; !broken && r < FIRST_OUTPUT; r++) {
        const VariableInfo *info = VARIABLE_INFO + r - 1;
        int possible = s->value[r] >= info->minimum && s->value[r] <= info->maximum;
        if (!possible || !is_whole(info->kind, s->value[r])) broken = info->name;
    }
    if (!broken && s->phase > INITIALIZING) {
        broken = first_lost(s->x, s->value + FIRST_INPUT);
        if (!broken && !all_finite(s->mode, N_MODES)) broken = "a mode";
    }
    if (broken) return core_fail(instance, "these bytes are a damaged state: %s is out of its range", broken);
    return OK;
}

Status core_restore(Instance *instance, const State *state) {
    Interface other = instance->interface == MODEL_EXCHANGE ? CO_SIMULATION : MODEL_EXCHANGE;
    int foreign = other == CO_SIMULATION ? state->phase == STEPPING
                                         : state->phase == EVENT_MODE || state->phase == CONTINUOUS_MODE;
    if (foreign)
        return core_fail(instance, "a state of %s cannot go on in an instance for %s",
                         INTERFACE_NAME[other], INTERFACE_NAME[instance->interface]);
    if (memcmp(instance->state.d, state->d, sizeof state->d) != 0)
        forget_caches(instance);
    memcpy(&instance->state, state, sizeof *state);
    /* The lookup behind the outputs, and slopes, are the instance's, not the state's. */
    instance->state.outputs_stale = instance->state.slopes_stale = 1;
    return OK;
}
