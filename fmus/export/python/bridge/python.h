/* Python's stable interface, as much of it as is used, found while the program runs: in the program
 * itself where that is Python, else in the library of the `python3` on the PATH. So one binary serves
 * every Python from 3.11 on, and loads where there is none. */
#ifndef PYTHON_H
#define PYTHON_H

#include <stddef.h>

typedef struct PyObject PyObject;

/* result, name, arguments; https://docs.python.org/3/c-api/stable.html */
#define PYTHON_FUNCTIONS(F)                                                             \
    F(int, Py_IsInitialized, (void))                                                    \
    F(void, Py_InitializeEx, (int signals))                                             \
    F(void *, PyEval_SaveThread, (void))                                                \
    F(int, PyGILState_Ensure, (void))                                                   \
    F(void, PyGILState_Release, (int))                                                  \
    F(void, Py_DecRef, (PyObject *))                                                    \
    F(void, Py_IncRef, (PyObject *))                                                    \
    F(PyObject *, Py_CompileString, (const char *text, const char *file, int start))    \
    F(PyObject *, PyEval_EvalCode, (PyObject *code, PyObject *globals, PyObject *locals)) \
    F(PyObject *, PyEval_GetBuiltins, (void))                                           \
    F(PyObject *, PyDict_New, (void))                                                   \
    F(int, PyDict_SetItemString, (PyObject *, const char *, PyObject *))                \
    F(PyObject *, PyDict_GetItemString, (PyObject *, const char *))                     \
    F(PyObject *, PyObject_GetAttrString, (PyObject *, const char *))                   \
    F(PyObject *, PyObject_Call, (PyObject *, PyObject *arguments, PyObject *by_name))  \
    F(PyObject *, PyTuple_New, (ptrdiff_t))                                             \
    F(int, PyTuple_SetItem, (PyObject *, ptrdiff_t, PyObject *))                        \
    F(PyObject *, PyTuple_GetItem, (PyObject *, ptrdiff_t))                             \
    F(PyObject *, PyFloat_FromDouble, (double))                                         \
    F(PyObject *, PyLong_FromSize_t, (size_t))                                          \
    F(long, PyLong_AsLong, (PyObject *))                                                \
    F(PyObject *, PyBytes_FromStringAndSize, (const char *, ptrdiff_t))                 \
    F(char *, PyBytes_AsString, (PyObject *))                                           \
    F(ptrdiff_t, PyBytes_Size, (PyObject *))                                            \
    F(int, PyErr_ExceptionMatches, (PyObject *))                                        \
    F(void, PyErr_Clear, (void))                                                        \
    F(void, PyErr_SetInterrupt, (void))

typedef struct {
#define MEMBER(result, name, arguments) result(*name) arguments;
    PYTHON_FUNCTIONS(MEMBER)
#undef MEMBER
    PyObject **PyExc_KeyboardInterrupt;
} Python;

/* Python, running; NULL, and why, if there is none. */
const Python *python_start(const char **why);
/* Python, if it still runs. */
const Python *python_running(void);

#endif
