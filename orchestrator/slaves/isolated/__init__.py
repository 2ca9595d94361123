"""FMUs in processes of their own: one that crashes, hangs or babbles ends the run, not the program.

`protocol` says what both processes share, `adaptors` are the functions on the side of the masters,
`slave` is the instance as the orchestrator sees it, `worker` the process behind it. It is no
defence against an FMU that means harm: its process may do whatever the user may.
"""
