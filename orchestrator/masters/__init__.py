"""Masters: how the slaves are coupled over a macro step, one algorithm a file.

`base` says what a master is and finds them; `coupling` decides how inputs are led; `loop` has the
compiled macro loops.
"""
