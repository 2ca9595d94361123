/* How the functions of the standard leave a library. */
#ifndef VISIBLE_H
#define VISIBLE_H

#if defined(_WIN32)
#define VISIBLE __declspec(dllexport)
#else
#define VISIBLE __attribute__((visibility("default")))
#endif

#endif
