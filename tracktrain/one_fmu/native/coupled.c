/* Equations that are other FMUs: what the core asks of a block, done by these and their master. */
#include "coupled.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "system.h"

static double *parameters(State *s) { return s->value + FIRST_PARAMETER; }
static double *inputs(State *s) { return s->value + FIRST_INPUT; }

const char *first_lost(const double *x, const double *u) {
    (void)x;
    for (int i = 0; i < N_INPUTS; i++)
        if (!finite_number(u[i])) return VARIABLE_INFO[FIRST_INPUT - 1 + i].name;
    return NULL;
}

static void heard(void *environment, const char *name, int status, const char *category, const char *text, ...) {
    (void)category;
    Coupled *c = environment;
    char said[400], whole[512];
    va_list arguments;
    if (status == 0 || !c->owner->report) return;
    va_start(arguments, text);
    vsnprintf(said, sizeof said, text, arguments);
    va_end(arguments);
    snprintf(whole, sizeof whole, "%s: %s", name, said);
    c->owner->report(c->owner->environment, status == 1 ? WARNING : ERROR, whole);
}

/* The instance that stands for whoever drives the inputs: its outputs are these, along lines. */
static int read_outside(void *environment, const uint32_t *reference, size_t count, double *value) {
    Coupled *c = environment;
    for (size_t i = 0; i < count; i++) value[i] = c->outside[reference[i]];
    return 0;
}

static int step_outside(void *environment, double time, double size, int no_return) {
    (void)no_return;
    Coupled *c = environment;
    for (int i = 0; i < N_INPUTS; i++)
        c->outside[i] = c->from[i] + c->owner->state.rate[i] * (time + size - c->begin);
    return 0;
}

static int refuse(void) { return 3; }

static Function function_of(int instance, int number) {
    if (instance < INSTANCES) return fmu_of(instance)->call[number - AT_SET_REAL];
    if (number == AT_GET_REAL) return (Function)read_outside;
    return number == AT_DO_STEP ? (Function)step_outside : (Function)refuse;
}

/* The tables as they are before a run, with the addresses of this instance. */
static void lay_out(Coupled *c) {
    memset(c->image, 0, sizeof c->image);
    memcpy(c->image, IMAGE, sizeof IMAGE);
    for (size_t i = 0; i < sizeof IMAGE_PLACE / sizeof *IMAGE_PLACE; i++)
        c->image[IMAGE_PLACE[i].word] = (uint64_t)(uintptr_t)((char *)c->image + IMAGE_PLACE[i].byte);
    for (size_t i = 0; i < sizeof IMAGE_BINDING / sizeof *IMAGE_BINDING; i++) {
        const Binding *b = IMAGE_BINDING + i;
        void *own = b->instance < INSTANCES ? c->component[b->instance] : c;
        c->image[b->word] = b->function == AT_INSTANCE ? (uint64_t)(uintptr_t)own
                                                       : (uint64_t)(uintptr_t)function_of(b->instance, b->function);
    }
}

static double *row_of(Coupled *c, int64_t k) {
    return (double *)((char *)c->image + ROWS_BYTE) + (k - c->course.first) * COLUMNS;
}

static Status complain(Coupled *c, const int64_t *report, int64_t k) {
    double time = c->course.origin + (double)k * c->course.step;
    c->course.broken = 1;
    if (report[1] == NOT_FINITE) {
        const double *row = row_of(c, k);
        int n = 0;
        while (n < COLUMNS - 1 && finite_number(row[n])) n++;
        return core_fail(c->owner, "%s is no longer finite at t = %.17g s: the coupling is unstable; take a smaller "
                                   "macro step", COLUMN_NAME[n], time);
    }
    if (report[1] == NOT_CONVERGED)
        return core_fail(c->owner, "the values at t = %.17g s do not settle in %d passes along the connections", time,
                         PASSES);
    if (report[1] == LOOP) return core_fail(c->owner, "an algebraic loop does not converge at t = %.17g s", time);
    return core_fail(c->owner, "%s refused %s in the macro step to t = %.17g s", INSTANCE_NAME[report[2]],
                     CALL_NAME[report[1]], time);
}

/* Calls a loop for the rows `first` to `last`. */
static Status walk(Coupled *c, int32_t (*loop)(const void *), int arguments, int64_t first, int64_t last) {
    int64_t *word = (int64_t *)c->image + arguments, *report = (int64_t *)((char *)c->image + REPORT_BYTE);
    word[0] = first;
    word[1] = last;
    memcpy(word + 2, &c->course.origin, sizeof(double));
    memcpy(word + 3, &c->course.step, sizeof(double));
    word[4] = c->course.first;
    report[0] = first + 1;
    report[1] = report[2] = report[3] = 0;
    int32_t error = loop(word);
    if (error) {
        c->course.broken = 1;
        return core_fail(c->owner, "%s", errors[2 * error - 1]);
    }
    return report[1] ? complain(c, report, loop == ADVANCE_LOOP ? report[0] : first) : OK;
}

static Status settle(Coupled *c, int stepping) {
    memcpy(c->outside, inputs(&c->owner->state), N_INPUTS * sizeof(double));
    return walk(c, SETTLE_LOOP, stepping ? SETTLE_STEPPING_ARGUMENTS : SETTLE_ARGUMENTS, c->course.row, c->course.row);
}

static Status check(Coupled *c, int instance, int status, const char *what) {
    if (status <= 1) return OK;
    c->course.broken = 1;
    return core_fail(c->owner, "%s cannot %s", INSTANCE_NAME[instance], what);
}

/* Gives the FMUs the parameters that they have not; changed: whether there were any. */
static Status give_parameters(Coupled *c, int all, int *changed) {
    const double *value = parameters(&c->owner->state);
    for (int i = 0; i < N_WITHIN_PARAMETERS; i++) {
        const Own *own = PARAMETER_OF + i;
        const Fmu2 *fmu = fmu_of(own->instance);
        if (!all && value[i] == c->given[i]) continue;
        Kind kind = VARIABLE_INFO[i].kind;
        int whole = (int)value[i];
        void *component = c->component[own->instance];
        int status = kind == REAL      ? fmu->set_real(component, &own->reference, 1, value + i)
                     : kind == BOOLEAN ? fmu->set_boolean(component, &own->reference, 1, &whole)
                                       : fmu->set_integer(component, &own->reference, 1, &whole);
        if (check(c, own->instance, status, "take its parameters") != OK) return ERROR;
        c->given[i] = value[i];
        *changed = 1;
    }
    return OK;
}

static Status make(Instance *instance) {
    Coupled *c = calloc(1, sizeof *c);
    if (!c) return core_fail(instance, "not enough memory for the FMUs within");
    instance->within = c;
    c->owner = instance;
    c->callbacks = (Callbacks){heard, calloc, free, NULL, c};
    for (int i = 0; i < INSTANCES; i++) {
        c->component[i] = fmu_of(i)->instantiate(INSTANCE_NAME[i], 1, fmu_of(i)->guid, "", &c->callbacks, 0, 0);
        if (check(c, i, c->component[i] ? 0 : 3, "be instantiated") != OK) {
            release_equations(instance);
            return ERROR;
        }
    }
    return OK;
}

void release_equations(Instance *instance) {
    Coupled *c = instance->within;
    for (int i = 0; c && i < INSTANCES; i++) {
        if (!c->component[i]) continue;
        if (c->course.stepping && !c->course.broken) fmu_of(i)->terminate(c->component[i]);
        fmu_of(i)->free(c->component[i]);
    }
    free(c);
    instance->within = NULL;
}

void forget_caches(Instance *instance) { (void)instance; /* states are stale after a reset, and begin anew */ }

/* From here on values and outputs are those of initialization. */
Status refresh_states(Instance *instance) {
    State *s = &instance->state;
    int fresh = instance->within == NULL, changed;
    if (!s->states_stale && !fresh) return OK;
    if (fresh && make(instance) != OK) return ERROR;
    Coupled *c = instance->within;
    for (int i = 0; i < INSTANCES && !fresh; i++)
        if (check(c, i, fmu_of(i)->reset(c->component[i]), "be reset") != OK) return ERROR;
    c->course = (Course){.origin = s->time, .step = parameters(s)[N_WITHIN_PARAMETERS]};
    if (give_parameters(c, 1, &changed) != OK) return ERROR;
    for (int i = 0; i < INSTANCES; i++) {
        int status = fmu_of(i)->setup(c->component[i], 0, 0.0, s->time, 0, 0.0);
        if (status <= 1) status = fmu_of(i)->enter(c->component[i]);
        if (check(c, i, status, "be initialized") != OK) return ERROR;
    }
    lay_out(c);
    if (settle(c, 0) != OK) return ERROR;
    s->states_stale = s->derived_stale = 0;
    return OK;
}

Status bring_along(Instance *instance) {
    State *s = &instance->state;
    if (refresh_states(instance) != OK) return ERROR;
    Coupled *c = instance->within;
    if (c->course.broken) return core_fail(instance, "a step failed before: reset, or restore a saved state");
    if (s->phase <= INITIALIZING) return OK;
    int changed = 0;
    if (!c->course.stepping) {
        for (int i = 0; i < INSTANCES; i++)
            if (check(c, i, fmu_of(i)->leave(c->component[i]), "be initialized") != OK) return ERROR;
        c->course.stepping = changed = 1;
    }
    if (s->derived_stale && give_parameters(c, 0, &changed) != OK) return ERROR;
    s->derived_stale = 0;
    changed |= memcmp(row_of(c, c->course.row) + OUTSIDE_COLUMN, inputs(s), N_INPUTS * sizeof(double)) != 0;
    return changed ? settle(c, 1) : OK;
}

Status refresh_outputs(Instance *instance) {
    State *s = &instance->state;
    if (!s->outputs_stale) return OK;
    if (bring_along(instance) != OK) return ERROR;
    Coupled *c = instance->within;
    memcpy(s->value + FIRST_OUTPUT, row_of(c, c->course.row), N_OUTPUTS * sizeof(double));
    s->outputs_stale = 0;
    return OK;
}

Status evaluate_derivatives(Instance *instance, double *rate) {
    (void)rate;
    return refresh_states(instance);
}

Status evaluate_indicators(Instance *instance, double *indicator) {
    (void)indicator;
    return refresh_states(instance);
}

Status evaluate_constants(Instance *instance, double *constant) {
    (void)constant;
    return refresh_states(instance);
}

Status update_memory(Instance *instance) { return refresh_states(instance); }

int continuous_place(const uint32_t *table, uint32_t reference) {
    (void)table, (void)reference;
    return -1;
}

Status core_directional(Instance *instance, const uint32_t *unknown, size_t unknown_count, const uint32_t *known,
                        size_t known_count, const double *seed, double *sensitivity) {
    (void)unknown, (void)unknown_count, (void)known, (void)known_count, (void)seed, (void)sensitivity;
    return core_fail(instance, "this FMU gives no derivatives: its outputs are those of FMUs that step");
}

/* More are a mistake in the step or in the parameter. */
static const double MOST_MACRO_STEPS = 1e8;

Status core_plan(Instance *instance, double time, double size, long *count) {
    State *s = &instance->state;
    double usual = parameters(s)[N_WITHIN_PARAMETERS];
    if (s->phase != STEPPING) return core_fail(instance, "doStep needs a finished initialization and no termination");
    if (!(size >= 0.0) || !finite_number(time + size))
        return core_fail(instance, "doStep from t = %g s by %g s: the step must be finite and not negative", time, size);
    double steps = ceil(size / usual - 1e-9);
    if (!(steps <= MOST_MACRO_STEPS))
        return core_fail(instance, "doStep by %g s would take %g macro steps of %g s", size, steps, usual);
    *count = steps > 1.0 ? (long)steps : 1;
    return bring_along(instance);
}

/* Has the newest row be row 0 of a grid of other times. */
static void begin_grid(Coupled *c, double time, double step) {
    memmove(row_of(c, c->course.first), row_of(c, c->course.row), COLUMNS * sizeof(double));
    c->course.row = c->course.first = 0;
    c->course.origin = time;
    c->course.step = step;
}

/* Keeps the rows that the master looks back at, and has room for more. */
static void make_room(Coupled *c) {
    int64_t first = c->course.row - BEHIND + 1;
    double *ends = (double *)((char *)c->image + ENDS_BYTE);
    size_t kept = (size_t)(c->course.row - first + 1);
    memmove(row_of(c, c->course.first), row_of(c, first), kept * COLUMNS * sizeof(double));
    memmove(ends, ends + (first - c->course.first) * LED, kept * LED * sizeof(double));
    c->course.first = first;
}

Status core_advance(Instance *instance, double time, double size, long count) {
    State *s = &instance->state;
    Coupled *c = instance->within;
    double usual = parameters(s)[N_WITHIN_PARAMETERS], step = size / (double)count;
    if (bring_along(instance) != OK) return ERROR;
    if (fabs(step - usual) <= 1e-9 * usual) step = usual;
    double due = c->course.origin + (double)c->course.row * c->course.step;
    if (step != c->course.step || fabs(time - due) > 1e-6 * step) begin_grid(c, time, step);
    memcpy(c->from, inputs(s), N_INPUTS * sizeof(double));
    c->begin = time;
    for (long left = size > 0.0 ? count : 0; left > 0;) {
        int64_t room = c->course.first + ROWS - 1 - c->course.row;
        if (room == 0) {
            make_room(c);
            continue;
        }
        int64_t next = c->course.row + (left < room ? left : room);
        if (walk(c, ADVANCE_LOOP, ADVANCE_ARGUMENTS, c->course.row, next) != OK) return ERROR;
        left -= (long)(next - c->course.row);
        c->course.row = next;
    }
    if (size > 0.0) memcpy(inputs(s), c->outside, N_INPUTS * sizeof(double));
    memset(s->rate, 0, sizeof s->rate);
    s->time = s->value[0] = time + size;
    s->outputs_stale = 1;
    return OK;
}

Status core_step(Instance *instance, double time, double size) {
    long count;
    if (core_plan(instance, time, size, &count) != OK) return ERROR;
    return core_advance(instance, time, size, count);
}
