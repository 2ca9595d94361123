#if !defined(_WIN32)
#define _GNU_SOURCE /* for RTLD_DEFAULT, popen */
#endif

#include "python.h"

#include <stdatomic.h>
#include <string.h>

static Python python;
static atomic_int ready;
static atomic_flag starting = ATOMIC_FLAG_INIT;

#if defined(_WIN32)
#include <windows.h>

#include <psapi.h>

static void *symbol(void *library, const char *name) {
    FARPROC found = GetProcAddress((HMODULE)library, name);
    void *address;
    memcpy(&address, &found, sizeof address);
    return address;
}

/* The module of this program that is Python, else the one that the PATH leads to. */
static void *find_library(void) {
    HMODULE module[1024];
    DWORD bytes = 0;
    if (K32EnumProcessModules(GetCurrentProcess(), module, sizeof module, &bytes))
        for (DWORD i = 0; i < bytes / sizeof *module && i < 1024; i++)
            if (symbol(module[i], "Py_IsInitialized")) return module[i];
    return LoadLibraryA("python3.dll");
}

static const char MISSING[] = "no Python was found: python3.dll has to be on the PATH";
#else
#include <dlfcn.h>
#include <stdio.h>

static void *symbol(void *library, const char *name) { return dlsym(library, name); }

static const char ASK[] =
    "python3 -c \"import os, sysconfig as s; g = s.get_config_var; print(os.path.join("
    "g('PYTHONFRAMEWORKPREFIX') or g('LIBDIR'), g('INSTSONAME')))\" 2>/dev/null";

/* This program, if it is Python or has loaded it for all; else the library of the `python3` on the
 * PATH, visible to all, because modules of Python expect that. It stays loaded. */
static void *find_library(void) {
    char path[4096] = "";
    if (dlsym(RTLD_DEFAULT, "Py_IsInitialized")) return RTLD_DEFAULT;
    FILE *answer = popen(ASK, "r");
    if (!answer) return NULL;
    if (!fgets(path, sizeof path, answer)) path[0] = '\0';
    pclose(answer);
    path[strcspn(path, "\n")] = '\0';
    if (!*path) return NULL;
    void *library = dlopen(path, RTLD_NOW | RTLD_GLOBAL);
    const char *name = strrchr(path, '/');
    return library || !name ? library : dlopen(name + 1, RTLD_NOW | RTLD_GLOBAL);
}

static const char MISSING[] = "no Python was found: this program is none, and the python3 on the PATH, if "
                              "there is one, has no shared library";
#endif

static const char *load(void) {
    void *library = find_library();
#if defined(_WIN32)
    if (!library) return MISSING;
#else
    if (!library && library != RTLD_DEFAULT) return MISSING;
    if (!symbol(library, "Py_IsInitialized")) return MISSING;
#endif
    void *address;
#define FIND(result, name, arguments)                                       \
    if (!(address = symbol(library, #name))) return "this Python has no " #name; \
    memcpy(&python.name, &address, sizeof address);
    PYTHON_FUNCTIONS(FIND)
#undef FIND
    if (!(address = symbol(library, "PyExc_KeyboardInterrupt"))) return "this Python has no PyExc_KeyboardInterrupt";
    memcpy(&python.PyExc_KeyboardInterrupt, &address, sizeof address);
    if (!python.Py_IsInitialized()) {
        python.Py_InitializeEx(0); /* signals stay the program's */
        python.PyEval_SaveThread();
    }
    return NULL;
}

const Python *python_start(const char **why) {
    *why = NULL;
    while (atomic_flag_test_and_set(&starting)) continue;
    if (!atomic_load(&ready) && !(*why = load())) atomic_store(&ready, 1);
    atomic_flag_clear(&starting);
    return *why ? NULL : &python;
}

const Python *python_running(void) {
    return atomic_load(&ready) && python.Py_IsInitialized() ? &python : NULL;
}
