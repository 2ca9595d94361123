/* FMI 2.0 co-simulation for a model in Python: each function of the standard is a call of a method.
 *
 * What goes to Python and what comes back is copied as bytes, so that neither side ever holds memory of
 * the other. A method returns (status, message, bytes); no exception leaves it but KeyboardInterrupt.
 * The library has no thread, no exit handler, and never ends Python. */
#include "fmi2.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bootstrap.h"
#include "python.h"
#include "visible.h"

#define EXPORT(type, name) VISIBLE type name

enum { CO_SIMULATION = 1, FILE_INPUT = 257 };

typedef struct {
    PyObject *slave;
    char *name;
    fmi2CallbackFunctions callbacks;
} Fmu;

static fmi2Status tell(Fmu *fmu, fmi2Status status, const char *message) {
    if (fmu->callbacks.logger) fmi2_log(&fmu->callbacks, fmu->name, status, "logStatusError", message);
    return status;
}

static fmi2Status refuse(Fmu *fmu, const char *message) { return fmu ? tell(fmu, FMI2_ERROR, message) : FMI2_ERROR; }

static char *copy_of(const char *text) {
    char *copy = malloc(strlen(text) + 1);
    return copy ? strcpy(copy, text) : NULL;
}

/* What to say after a failure within Python, and whether it is a Ctrl-C of the user's, which is to be
 * given back to the program when all else is done. */
static const char *clear(const Python *py, int *interrupted) {
    *interrupted = py->PyErr_ExceptionMatches(*py->PyExc_KeyboardInterrupt);
    py->PyErr_Clear();
    return *interrupted ? "interrupted" : "Python could not make this call: it may be out of memory";
}

/* Arguments by their kinds: d a double, n a size_t, b the bytes at a pointer, as many as the size_t
 * that follows it. NULL: an exception is set. */
static PyObject *arguments_of(const Python *py, const char *kinds, va_list values) {
    PyObject *arguments = py->PyTuple_New((ptrdiff_t)strlen(kinds));
    for (ptrdiff_t i = 0; arguments && kinds[i]; i++) {
        PyObject *one;
        if (kinds[i] == 'd') one = py->PyFloat_FromDouble(va_arg(values, double));
        else if (kinds[i] == 'n') one = py->PyLong_FromSize_t(va_arg(values, size_t));
        else {
            const char *bytes = va_arg(values, const char *);
            one = py->PyBytes_FromStringAndSize(bytes, (ptrdiff_t)va_arg(values, size_t));
        }
        if (one && py->PyTuple_SetItem(arguments, i, one) == 0) continue;
        py->Py_DecRef(arguments);
        arguments = NULL;
    }
    return arguments;
}

static PyObject *called(const Python *py, PyObject *function, PyObject *arguments) {
    PyObject *result = function && arguments ? py->PyObject_Call(function, arguments, NULL) : NULL;
    if (arguments) py->Py_DecRef(arguments);
    if (function) py->Py_DecRef(function);
    return result;
}

/* Calls a method, whose bytes go to `place`, `size` of them. The message is told when Python is free. */
static fmi2Status call(Fmu *fmu, const char *method, void *place, size_t size, const char *kinds, ...) {
    const Python *py = fmu ? python_running() : NULL;
    if (!py) return refuse(fmu, "Python has ended");
    int held = py->PyGILState_Ensure();
    va_list values;
    va_start(values, kinds);
    PyObject *arguments = arguments_of(py, kinds, values);
    va_end(values);
    PyObject *result = called(py, py->PyObject_GetAttrString(fmu->slave, method), arguments);
    fmi2Status status = FMI2_ERROR;
    int interrupted = 0;
    char *message = NULL;
    if (result) {
        status = (fmi2Status)py->PyLong_AsLong(py->PyTuple_GetItem(result, 0));
        PyObject *bytes = py->PyTuple_GetItem(result, 2);
        if (status != FMI2_OK) message = copy_of(py->PyBytes_AsString(py->PyTuple_GetItem(result, 1)));
        else if (size && (size_t)py->PyBytes_Size(bytes) == size) memcpy(place, py->PyBytes_AsString(bytes), size);
        py->Py_DecRef(result);
    } else message = copy_of(clear(py, &interrupted));
    py->PyGILState_Release(held);
    if (status != FMI2_OK) tell(fmu, status, message ? message : "not enough memory");
    free(message);
    if (interrupted) py->PyErr_SetInterrupt();
    return status;
}

/* The function `instantiate` of the bootstrap, which each library runs once; NULL: an exception is set. */
static PyObject *instantiate_function(const Python *py) {
    static PyObject *function;
    PyObject *names = function ? NULL : py->PyDict_New(), *code, *done;
    if (!names || py->PyDict_SetItemString(names, "__builtins__", py->PyEval_GetBuiltins()) != 0) return function;
    code = py->Py_CompileString(BOOTSTRAP, "bootstrap.py of the FMU", FILE_INPUT);
    done = code ? py->PyEval_EvalCode(code, names, names) : NULL;
    if (code) py->Py_DecRef(code);
    if (!done) return NULL;
    py->Py_DecRef(done);
    return function = py->PyDict_GetItemString(names, "instantiate"); /* kept, and so are the names */
}

static PyObject *made(const Python *py, const char *kinds, ...) {
    PyObject *function = instantiate_function(py);
    if (!function) return NULL;
    py->Py_IncRef(function);
    va_list values;
    va_start(values, kinds);
    PyObject *arguments = arguments_of(py, kinds, values);
    va_end(values);
    return called(py, function, arguments);
}

/* NULL, or why there is no instance, to be freed. */
static char *start(Fmu *fmu, const char *resources, const char *guid, int *interrupted) {
    const char *why;
    const Python *py = python_start(&why);
    if (!py) return copy_of(why);
    int held = py->PyGILState_Ensure();
    PyObject *slave = made(py, "bb", resources, strlen(resources), guid, strlen(guid));
    char *message = NULL;
    if (!slave) message = copy_of(clear(py, interrupted));
    else if (py->PyBytes_Size(slave) >= 0) {
        message = copy_of(py->PyBytes_AsString(slave));
        py->Py_DecRef(slave);
    } else {
        py->PyErr_Clear(); /* it is not bytes, but an instance */
        fmu->slave = slave;
    }
    py->PyGILState_Release(held);
    return fmu->slave || message ? message : copy_of("not enough memory");
}

EXPORT(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT(const char *, fmi2GetVersion)(void) { return "2.0"; }

EXPORT(fmi2Status, fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]) {
    (void)on, (void)count, (void)categories; /* errors are always told, and there is nothing else */
    return c ? FMI2_OK : FMI2_ERROR;
}

EXPORT(void, fmi2FreeInstance)(fmi2Component c) {
    Fmu *fmu = c;
    if (!fmu) return;
    const Python *py = fmu->slave ? python_running() : NULL;
    if (py) { /* else it went with Python */
        int held = py->PyGILState_Ensure();
        py->Py_DecRef(fmu->slave);
        py->PyGILState_Release(held);
    }
    free(fmu->name);
    free(fmu);
}

EXPORT(fmi2Component, fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                       const fmi2CallbackFunctions *callbacks, fmi2Boolean visible,
                                       fmi2Boolean logging) {
    (void)visible, (void)logging;
    Fmu *fmu = calloc(1, sizeof *fmu);
    if (!fmu) return NULL;
    if (callbacks) fmu->callbacks = *callbacks;
    fmu->name = copy_of(name ? name : "");
    char *problem = NULL;
    int interrupted = 0;
    if (!fmu->name) problem = copy_of("not enough memory");
    else if (type != CO_SIMULATION) problem = copy_of("this FMU is for co-simulation (1) alone");
    else if (!*fmu->name) problem = copy_of("an instance needs a name");
    else if (!guid || !resources) problem = copy_of("the GUID or the location of the resources is missing: it is NULL");
    else problem = start(fmu, resources, guid, &interrupted);
    if (fmu->slave) return fmu;
    refuse(fmu, problem ? problem : "not enough memory");
    free(problem);
    fmi2FreeInstance(fmu);
    if (interrupted) python_running()->PyErr_SetInterrupt();
    return NULL;
}

EXPORT(fmi2Status, fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                        fmi2Real start_time, fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance;
    return stop_defined ? call(c, "setup_experiment", NULL, 0, "dd", start_time, stop)
                        : call(c, "setup_experiment", NULL, 0, "d", start_time);
}

#define PLAIN(name, method) \
    EXPORT(fmi2Status, name)(fmi2Component c) { return call(c, method, NULL, 0, ""); }
PLAIN(fmi2EnterInitializationMode, "enter_initialization_mode")
PLAIN(fmi2ExitInitializationMode, "exit_initialization_mode")
PLAIN(fmi2Terminate, "terminate")
PLAIN(fmi2Reset, "reset")

#define NEEDS(condition) \
    if (!(condition)) return refuse(c, "a list or a place of the call is missing: it is NULL")

#define VALUES(name, type, method)                                                                          \
    EXPORT(fmi2Status, fmi2Get##name)(fmi2Component c, const fmi2ValueReference vr[], size_t count, type value[]) { \
        NEEDS(count == 0 || (vr && value));                                                                 \
        return call(c, "get_" method, value, count * sizeof *value, "b", (const char *)vr, count * sizeof *vr); \
    }                                                                                                       \
    EXPORT(fmi2Status, fmi2Set##name)(fmi2Component c, const fmi2ValueReference vr[], size_t count,         \
                                      const type value[]) {                                                 \
        NEEDS(count == 0 || (vr && value));                                                                 \
        return call(c, "set_" method, NULL, 0, "bb", (const char *)vr, count * sizeof *vr, (const char *)value, \
                    count * sizeof *value);                                                                 \
    }
VALUES(Real, fmi2Real, "real")
VALUES(Integer, fmi2Integer, "integer")
VALUES(Boolean, fmi2Boolean, "boolean")

#define NONE_OF(name, what, ...)                                                       \
    EXPORT(fmi2Status, name)(fmi2Component c, const fmi2ValueReference vr[], size_t count, __VA_ARGS__) { \
        (void)vr, (void)value;                                                         \
        return c && count == 0 ? FMI2_OK : refuse(c, "this FMU has no " what);         \
    }
NONE_OF(fmi2GetString, "strings", fmi2String value[])
NONE_OF(fmi2SetString, "strings", const fmi2String value[])

#define NO_DERIVATIVES(name, what, type)                                                                    \
    EXPORT(fmi2Status, name)(fmi2Component c, const fmi2ValueReference vr[], size_t count,                  \
                             const fmi2Integer order[], type value[]) {                                     \
        (void)vr, (void)order, (void)value;                                                                 \
        return c && count == 0 ? FMI2_OK : refuse(c, "this FMU has no derivatives of " what);               \
    }
NO_DERIVATIVES(fmi2SetRealInputDerivatives, "inputs", const fmi2Real)
NO_DERIVATIVES(fmi2GetRealOutputDerivatives, "outputs", fmi2Real)

EXPORT(fmi2Status, fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[],
                                                 size_t unknown_count, const fmi2ValueReference known[],
                                                 size_t known_count, const fmi2Real seed[], fmi2Real sensitivity[]) {
    (void)unknown, (void)unknown_count, (void)known, (void)known_count, (void)seed, (void)sensitivity;
    return refuse(c, "this FMU has no directional derivatives");
}

/* A state is a number by which Python knows it: one that was freed, or never was, is no harm. */
#define NUMBER(state) (size_t)(uintptr_t)(state)

EXPORT(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    NEEDS(state);
    return call(c, "get_fmu_state", state, sizeof *state, "n", NUMBER(*state));
}

EXPORT(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    return call(c, "set_fmu_state", NULL, 0, "n", NUMBER(state));
}

EXPORT(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    if (!state || !*state) return c ? FMI2_OK : FMI2_ERROR;
    fmi2Status status = call(c, "free_fmu_state", NULL, 0, "n", NUMBER(*state));
    *state = NULL;
    return status;
}

EXPORT(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    NEEDS(size);
    return call(c, "serialized_fmu_state_size", size, sizeof *size, "n", NUMBER(state));
}

EXPORT(fmi2Status, fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    NEEDS(bytes);
    return call(c, "serialize_fmu_state", bytes, size, "nn", NUMBER(state), size);
}

EXPORT(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    NEEDS(bytes && state);
    return call(c, "deserialize_fmu_state", state, sizeof *state, "nb", NUMBER(*state), bytes, size);
}

EXPORT(fmi2Status, fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real size, fmi2Boolean no_return) {
    (void)no_return;
    return call(c, "do_step", NULL, 0, "dd", time, size);
}

EXPORT(fmi2Status, fmi2CancelStep)(fmi2Component c) { return refuse(c, "no step runs in the background"); }

EXPORT(fmi2Status, fmi2GetRealStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    if (kind != FMI2_LAST_SUCCESSFUL_TIME) return c ? FMI2_DISCARD : FMI2_ERROR;
    NEEDS(value);
    return call(c, "get_time", value, sizeof *value, "");
}

EXPORT(fmi2Status, fmi2GetBooleanStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    if (kind != FMI2_TERMINATED || !c) return c ? FMI2_DISCARD : FMI2_ERROR;
    NEEDS(value);
    *value = 0;
    return FMI2_OK;
}

#define NO_STATUS(name, type)                                                             \
    EXPORT(fmi2Status, name)(fmi2Component c, fmi2StatusKind kind, type *value) { \
        (void)kind, (void)value;                                                          \
        return c ? FMI2_DISCARD : FMI2_ERROR;                                             \
    }
NO_STATUS(fmi2GetStatus, fmi2Status)
NO_STATUS(fmi2GetIntegerStatus, fmi2Integer)
NO_STATUS(fmi2GetStringStatus, fmi2String)
